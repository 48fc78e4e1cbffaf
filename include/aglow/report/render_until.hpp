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
#include <type_traits>
#include <vector>

#include <aglow/core/callback.hpp>
#include <aglow/core/random.hpp>
#include <aglow/report/audit.hpp>
#include <aglow/report/claim_plan.hpp>
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
    /// Standard errors of probes as shares of the target, instead of `audit.noise`: scouts begin with the largest, and
    /// claims take what is cheapest between the smallest and half of the largest.
    double most_noise = 1.4;
    double least_noise = 0.35;
    /// Probes of a scout, and most probes of a claim.
    std::size_t scout_probes = 100;
    std::size_t most_probes = 2000;
    /// Work of one probe sample in the unit above; 0 where unknown, and then they are taken to cost nothing. A claim is
    /// made where picture and probes together are cheapest in the mean; a scout sharper than the one before takes at
    /// most a tenth of the work so far, or half of it where noise seems heavy-tailed.
    double probe_work = 0;
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
    require(options.probe_work >= 0 && is_finite(options.probe_work), "probe_work: negative or not finite");
}

/// The rule itself: what has been seen, and what to do next.
class until_rule {
public:
    explicit until_rule(const render_until_options& options) : options_{options} {}

    /// Small audits that claim nothing, ever sharper until they tell the error, or cost too much beside the picture.
    template <std::floating_point T, Probe P, Executor E>
    until_check scout(const audit_ground<T>& picture, const P& probe, double work, const E& run) {
        until_check seen{};
        const double enough = worth_a_sharper_look() ? 0.07 : 0.15;
        for (noise_ = options_.most_noise;; noise_ = std::max(noise_ / 2, options_.least_noise)) {
            seen = look(picture, probe, work, run);
            const double next_cost = 4 * samples_per_probe_ * static_cast<double>(seen.probes) * options_.probe_work;
            const bool clear = seen.error_deviation < enough * seen.error && !slow_;
            // Where noise falls slowly, a picture that goes on does not make it clearer: sharper probes do.
            const double most_cost = (slow_ ? 0.5 : 0.1) * work;
            if (clear || noise_ <= options_.least_noise || next_cost > most_cost) { break; }
        }
        return add(seen);
    }

    /// The cheapest claim, as far as can be told now.
    [[nodiscard]] claim_plan plan(double work) const {
        return cheapest_claim({.target = options_.audit.target,
                               .z = normal_quantile(1 - miss()),
                               .work = work,
                               .decay = decay(),
                               .doubt = 1 / std::sqrt(certainty2_),
                               .ratio = ratio_.mean(),
                               .noise = noise_,
                               .own = own_,
                               .samples = samples_per_probe_,
                               .sample_work = options_.probe_work,
                               .most_probes = options_.most_probes,
                               .most_noise = std::max(options_.least_noise, options_.most_noise / 2),
                               .least_noise = options_.least_noise});
    }

    /// Claims the target.
    template <std::floating_point T, Probe P, Executor E>
    audit_result claim(const audit_ground<T>& picture, const P& probe, const claim_plan& how, double work,
                       const E& run) {
        audit_options look = fresh_options();
        look.probes = how.probes;
        look.confidence = 1 - miss();
        look.noise = how.noise;
        ++claims_;
        audit_result result = audit_on(picture, probe, look, run);
        samples_ += result.samples;
        if (result.mean_error <= 0) { return result; }
        const double share =
            result.mean_error_deviation / std::sqrt(static_cast<double>(how.probes)) / result.mean_error;
        ratio_.add(result.mean_error_deviation / result.mean_error);
        add({work, result.likely_error, share * result.likely_error, result.mean_error_bound, how.probes});
        return result;
    }

    /// Whether the measurements exclude every floor at or below the target.
    [[nodiscard]] bool hopeless() const { return distinct_ >= 4 && decay().floor_low > options_.audit.target; }

    [[nodiscard]] decay_fit decay() const { return fit_decay(checks_for_fit_); }

    [[nodiscard]] double next_work(double work) const {
        const double next = std::clamp(plan(work).work, options_.least_growth * work, options_.most_growth * work);
        return std::min(next, options_.most_work);
    }

    [[nodiscard]] until_result result(until_status status, double work, audit_result certificate) const {
        until_result all{.status = status, .certificate = std::move(certificate), .decay = decay(), .work = work};
        all.predicted_work = status == until_status::reached || checks_.empty() ? work : plan(work).work;
        all.claims = claims_;
        all.probe_samples = samples_;
        all.checks = checks_;
        return all;
    }

private:
    template <std::floating_point T, Probe P, Executor E>
    until_check look(const audit_ground<T>& picture, const P& probe, double work, const E& run) {
        audit_options look = fresh_options();
        look.probes = options_.scout_probes * (worth_a_sharper_look() ? 4 : 1);
        look.noise = noise_;
        look.patience = 1;
        audit_sample<T> sample{picture, look};
        sample.draw(probe, run);
        const running_mean errors = mean_of(sample.mean_errors());
        if (errors.mean() > 0) { ratio_.add(errors.deviation() / errors.mean()); }
        own_ = mean_of(sample.noises()).mean();
        slow_ = sample.heavy_tailed();
        samples_ += sample.samples();
        samples_per_probe_ = static_cast<double>(sample.samples_per_probe());
        const likely_error likely = sample.likely();
        return {work, likely.error, likely.deviation, 0, look.probes};
    }

    [[nodiscard]] audit_options fresh_options() {
        audit_options look = options_.audit;
        look.stream = mix(options_.audit.stream, ++looks_);
        return look;
    }

    /// Whether a look with more probes is worth its cost: the error seems to stay above the target, or to need much
    /// more work, or to have come near the target.
    [[nodiscard]] bool worth_a_sharper_look() const {
        if (distinct_ < 3) { return false; }
        const decay_fit fit = decay();
        const double work = checks_.back().work;
        return fit.floor > 0.8 * options_.audit.target || fit.work_to(options_.audit.target) > 8 * work ||
               checks_.back().error < 1.5 * options_.audit.target;
    }

    [[nodiscard]] double miss() const {
        const double k = static_cast<double>(claims_ + 1);
        return (1 - options_.audit.confidence) * 6 / square(pi<double> * k);
    }

    until_check add(const until_check& check) {
        if (checks_.empty() || checks_.back().work < check.work) { ++distinct_; }
        checks_.push_back(check);
        const double deviation = std::max(check.error_deviation, 1e-9 * std::abs(check.error));
        checks_for_fit_.push_back({check.work, check.error, deviation});
        if (check.error > 0) { certainty2_ += square(check.error / deviation); }
        return check;
    }

    const render_until_options& options_;
    std::vector<until_check> checks_{};
    std::vector<measured_error> checks_for_fit_{};
    std::size_t distinct_{0};
    std::size_t claims_{0};
    std::size_t samples_{0};
    std::uint64_t looks_{0};
    running_mean ratio_{};     ///< standard deviation over mean of a probe's error
    double certainty2_{1e-9};  ///< sum over looks of (error / its standard error)²
    double noise_{1};          ///< of the last scout's probes, as a share of the target
    double own_{0};            ///< mean size of that
    bool slow_{false};         ///< whether it seems heavy-tailed
    double samples_per_probe_{1};
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
        // A claim is on the mean alone: it needs no probes for the error bars of classes.
        const std::remove_cvref_t<decltype(picture)> plain{.image = picture.image, .guess = picture.guess};
        const detail::audit_ground ground{plain, options.audit};
        until_check last = rule.scout(ground, probe, work, run);
        const bool out_of_work = work >= options.most_work;
        claim_plan plan = rule.plan(work);
        if (out_of_work) { plan = {work, std::max<std::size_t>(200, options.audit.probes), options.audit.noise}; }
        if (plan.work <= work) {
            certificate = rule.claim(ground, probe, plan, work, run);
            last.bound = certificate.mean_error_bound;
        }
        const bool reached = certificate.status == audit_status::certified;
        const bool going_on = !options.progress || options.progress({last, reached ? work : rule.plan(work).work});
        if (reached) { return rule.result(until_status::reached, work, certificate); }
        if (!going_on) { return rule.result(until_status::cancelled, work, certificate); }
        if (rule.hopeless()) { return rule.result(until_status::unreachable, work, certificate); }
        if (out_of_work) { return rule.result(until_status::out_of_work, work, certificate); }
    }
}

}  // namespace aglow
