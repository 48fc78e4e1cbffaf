// Work on until an audit certifies the error that was asked for, or until it is clear that it never will.
//
// Fresh probes at every check and a miss probability that is shared out over the claims: α_k = α · 6/(π² k²), so that
// all claims together are wrong with probability at most α. Scouts, small audits that claim nothing, cost none of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <aglow/core/callback.hpp>
#include <aglow/core/random.hpp>
#include <aglow/report/audit.hpp>
#include <aglow/report/decay.hpp>

namespace aglow {

/// One look at the picture on the way.
struct until_check {
    double work{0};
    double error{0};            ///< estimate of the mean relative error
    double error_deviation{0};  ///< standard error of that
    double bound{0};            ///< what was claimed; 0 where this was a scout
    std::size_t probes{0};
};

struct until_progress {
    until_check last{};
    double predicted_work{0};  ///< work at which the target will be certified, as far as can be told; may be infinite
};

struct render_until_options {
    /// The target, the confidence over all claims together, and how probes are drawn.
    audit_options audit{};
    /// Work before the first look, in the host's unit: passes, samples, photons or seconds.
    double first_work = 1;
    /// The picture is given up when this much work is done.
    double most_work = std::numeric_limits<double>::infinity();
    /// Smallest and largest ratio of work between two looks.
    double least_growth = 1.15;
    double most_growth = 2;
    /// Standard errors of probes as shares of the target, instead of `audit.noise`: a look begins with the largest, and
    /// is repeated with half of it while the probes' own noise may be what keeps the error from being certified. What
    /// it adds to the bound costs work twice over where the error falls as its square root.
    double most_noise = 1.4;
    double least_noise = 0.35;
    /// Probes of a scout, and most probes of a claim.
    std::size_t scout_probes = 100;
    std::size_t most_probes = 2000;
    /// Work of one probe sample in the unit above; 0 where unknown. A claim takes at most `probe_share` of the work so
    /// far, or 200 probes where that is more.
    double probe_work = 0;
    double probe_share = 0.05;
    /// Called after every look; returning false ends the work.
    callback<const until_progress&> progress{};
};

enum class until_status { reached, unreachable, out_of_work, cancelled, broken };

/// `reached`: `certificate` is certified. `unreachable`: the error falls towards a floor above the target, so other
/// settings are needed. `out_of_work`: `most_work` is done. `broken`: the picture has pixels that are infinite or NaN.
struct until_result {
    until_status status{until_status::out_of_work};
    audit_result certificate{};  ///< of the last claim; its confidence is 1 - α_k
    decay_fit decay{};
    double work{0};
    double predicted_work{0};
    std::size_t claims{0};
    std::size_t probe_samples{0};
    std::vector<until_check> checks{};
};

namespace detail {

inline void require_until(const render_until_options& options) {
    const auto require = [](bool holds, const char* what) {
        if (!holds) { throw std::invalid_argument(what); }
    };
    require(options.first_work > 0 && is_finite(options.first_work), "first_work: not positive");
    require(options.most_work >= options.first_work, "most_work: below first_work");
    require(options.least_growth > 1, "least_growth: not above 1");
    require(options.most_growth >= options.least_growth, "most_growth: below least_growth");
    require(options.least_noise > 0, "least_noise: not positive");
    require(options.most_noise >= options.least_noise, "most_noise: below least_noise");
    require(options.scout_probes >= 30, "scout_probes: fewer than 30");
    require(options.most_probes >= 200, "most_probes: fewer than 200");
}

/// The rule itself: what has been seen, and what to do next.
class until_rule {
public:
    explicit until_rule(const render_until_options& options) : options_{options}, coarsest_{options.most_noise} {}

    /// Small audits that claim nothing, ever sharper until it is clear whether a claim would hold.
    template <std::floating_point T, Probe P, Executor E>
    until_check scout(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        until_check seen{};
        for (noise_ = coarsest_;; noise_ = std::max(noise_ / 2, options_.least_noise)) {
            seen = look(picture, probe, work, run);
            const bool own_noise = seen.error < 2 * noise_ * options_.audit.target;
            if (noise_ <= options_.least_noise || !own_noise || needed_probes(seen.error) <= affordable(work)) {
                break;
            }
        }
        return add(seen, deviation_);
    }

    /// How many probes a claim needs now; 0 where it is better to work on.
    [[nodiscard]] std::size_t probes_for_claim(double work) const {
        // A coarse look stands alone: only sharp ones follow the law of the others.
        const until_check& last = checks_.back();
        const double error = noise_ > options_.least_noise ? last.error + last.error_deviation : smoothed_error(work);
        const double needed = needed_probes(error);
        if (!(needed <= affordable(work))) { return 0; }
        return std::max<std::size_t>(200, static_cast<std::size_t>(needed));
    }

    template <std::floating_point T, Probe P, Executor E>
    audit_result claim(const audited_picture<T>& picture, const P& probe, double work, std::size_t probes,
                       const E& run) {
        audit_options look = fresh_options();
        look.probes = probes;
        look.confidence = 1 - miss();
        look.noise = noise_;
        ++claims_;
        audit_result result = audit(picture, probe, look, run);
        samples_ += result.samples;
        // Every claim that fails makes the next one dearer: it shall not fail for noise again.
        if (result.status != audit_status::certified) { coarsest_ = std::max(noise_ / 2, options_.least_noise); }
        if (result.broken_pixels > 0) { return result; }
        const double error = result.mean_error_deviation / std::sqrt(static_cast<double>(probes));
        add({work, result.mean_error, error, result.mean_error_bound, probes}, result.mean_error_deviation);
        return result;
    }

    /// Whether the measurements exclude every floor at or below the target.
    [[nodiscard]] bool hopeless() const { return distinct_ >= 4 && decay().floor_low > options_.audit.target; }

    [[nodiscard]] decay_fit decay() const { return fit_decay(checks_for_fit_); }

    /// Work at which a claim with as many probes as are allowed should hold.
    [[nodiscard]] double predicted_work(double work) const {
        const double goal = options_.audit.target / (1 + 1.1 * z() * ratio_.mean() / std::sqrt(affordable(work)));
        return std::max(work, decay().work_to(goal));
    }

    [[nodiscard]] double next_work(double work) const {
        const double next = std::clamp(predicted_work(work), options_.least_growth * work, options_.most_growth * work);
        return std::min(next, options_.most_work);
    }

    [[nodiscard]] until_result result(until_status status, double work, audit_result certificate) const {
        until_result all{.status = status, .certificate = std::move(certificate), .decay = decay(), .work = work};
        all.predicted_work = status == until_status::reached || checks_.empty() ? work : predicted_work(work);
        all.claims = claims_;
        all.probe_samples = samples_;
        all.checks = checks_;
        return all;
    }

private:
    template <std::floating_point T, Probe P, Executor E>
    until_check look(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        audit_options look = fresh_options();
        look.probes = options_.scout_probes * (worth_a_sharper_look() ? 4 : 1);
        look.noise = noise_;
        look.patience = 1;
        audit_sample<T> sample{audited_picture<T>{.image = picture.image, .guess = picture.guess}, look};
        sample.draw(probe, run);
        const running_mean errors = mean_of(sample.mean_errors());
        samples_ += sample.samples();
        samples_per_probe_ = static_cast<double>(sample.samples_per_probe());
        deviation_ = errors.deviation();
        return {work, errors.mean(), errors.standard_error(), 0, look.probes};
    }

    /// Probes that a claim needs where the mean error is `error`; infinite where no number is enough.
    [[nodiscard]] double needed_probes(double error) const {
        const double gap = options_.audit.target - error;
        const double ratio = ratio_.count() > 0 ? ratio_.mean() : deviation_ / std::max(error, 1e-300);
        return gap > 0 ? 1.2 * square(z() * ratio * error / gap) : std::numeric_limits<double>::infinity();
    }

    [[nodiscard]] audit_options fresh_options() {
        audit_options look = options_.audit;
        look.stream = mix(options_.audit.stream, ++looks_);
        return look;
    }

    /// Whether a sharper look is worth its cost: the error seems to stay above the target, or to have come near it.
    [[nodiscard]] bool worth_a_sharper_look() const {
        if (distinct_ < 3) { return false; }
        return decay().floor > 0.8 * options_.audit.target || checks_.back().error < 1.5 * options_.audit.target;
    }

    /// The error now, by all measurements together where they are enough for a fit.
    [[nodiscard]] double smoothed_error(double work) const {
        return distinct_ < 3 ? checks_.back().error : decay().at(work);
    }

    [[nodiscard]] double miss() const {
        const double k = static_cast<double>(claims_ + 1);
        return (1 - options_.audit.confidence) * 6 / square(pi<double> * k);
    }

    [[nodiscard]] double z() const { return normal_quantile(1 - miss()); }

    [[nodiscard]] double affordable(double work) const {
        const double most = static_cast<double>(options_.most_probes);
        if (!(options_.probe_work > 0)) { return most; }
        return std::clamp(options_.probe_share * work / (options_.probe_work * samples_per_probe_), 200.0, most);
    }

    until_check add(const until_check& check, double deviation) {
        if (checks_.empty() || checks_.back().work < check.work) { ++distinct_; }
        checks_.push_back(check);
        checks_for_fit_.push_back(
            {check.work, check.error, std::max(check.error_deviation, 1e-9 * std::abs(check.error))});
        if (check.error > 0) { ratio_.add(deviation / check.error); }
        return check;
    }

    const render_until_options& options_;
    double coarsest_;  ///< noise that a look begins with, as a share of the target
    std::vector<until_check> checks_{};
    std::vector<measured_error> checks_for_fit_{};
    std::size_t distinct_{0};
    std::size_t claims_{0};
    std::size_t samples_{0};
    std::uint64_t looks_{0};
    running_mean ratio_{};  ///< standard deviation over mean of a probe's error
    double samples_per_probe_{1};
    double noise_{0};      ///< of the last look's probes, as a share of the target
    double deviation_{0};  ///< of their errors
};

}  // namespace detail

/// Renders on until the mean relative error is certified to be at most `options.audit.target`. `advance(work)` brings
/// the picture to that total work and returns it as an `audited_picture`, valid until the next call; `probe` as for
/// `audit`. The same for any threads of `run`. Throws `std::invalid_argument` for options out of range.
template <typename Advance, Probe P, Executor E = in_sequence>
[[nodiscard]] until_result render_until(Advance&& advance, const P& probe, const render_until_options& options,
                                        const E& run = {}) {
    detail::require_until(options);
    detail::until_rule rule{options};
    audit_result certificate{};
    for (double work = options.first_work;; work = rule.next_work(work)) {
        const auto picture = advance(work);
        require_auditable(picture, options.audit);
        if (count_broken_pixels(picture.image) > 0) {
            certificate = detail::refuse_broken(picture, options.audit);
            return rule.result(until_status::broken, work, certificate);
        }
        until_check last = rule.scout(picture, probe, work, run);
        const bool out_of_work = work >= options.most_work;
        const std::size_t probes =
            out_of_work ? std::max<std::size_t>(200, options.audit.probes) : rule.probes_for_claim(work);
        if (probes > 0) {
            certificate = rule.claim(picture, probe, work, probes, run);
            last.bound = certificate.mean_error_bound;
        }
        const bool reached = certificate.status == audit_status::certified;
        const bool going_on = !options.progress || options.progress({last, reached ? work : rule.predicted_work(work)});
        if (reached) { return rule.result(until_status::reached, work, certificate); }
        if (!going_on) { return rule.result(until_status::cancelled, work, certificate); }
        if (rule.hopeless()) { return rule.result(until_status::unreachable, work, certificate); }
        if (out_of_work) { return rule.result(until_status::out_of_work, work, certificate); }
    }
}

}  // namespace aglow
