// When to look at a picture, how hard, and what follows from it: the rule of `render_until`.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include <aglow/report/audit.hpp>
#include <aglow/report/claim_plan.hpp>
#include <aglow/report/decay.hpp>
#include <aglow/report/until_history.hpp>
#include <aglow/report/until_result.hpp>

namespace aglow::detail {

/// What has been seen, and what to do next. One set of probes looks at all pictures: it grows and gets sharper where
/// that is worth its cost.
template <std::floating_point T>
class until_rule {
public:
    explicit until_rule(const render_until_options& options) : options_{options}, noise_{options.most_noise} {}

    /// Looks at the picture, and again with better probes until these tell enough, or cost too much.
    template <Probe P, Executor E>
    void look(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        if (sample_) {
            sample_->read(picture);
        } else {
            draw(picture, probe, run);
        }
        pixels_ = picture.image.pixels();
        history_.add(seen(work));
        while (unclear() && noise_ > options_.least_noise && may_be_sharper() && affordable(work)) {
            sharpen(std::max(noise_ / 2, options_.least_noise), picture, probe, work, run);
        }
        if (floor_is_feared()) {
            grow(4 * options_.scout_probes, picture, probe, work, run);
            if (noise_ > options_.audit.noise && may_be_sharper() && affordable(work)) {
                sharpen(std::max(noise_ / 2, options_.least_noise), picture, probe, work, run);
            }
        }
    }

    /// One step towards the probes of the cheapest claim, if that is due; false where there is nothing more to do.
    template <Probe P, Executor E>
    bool improve(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        const claim_plan best = plan(work);
        if (best.work > work) { return false; }
        claiming_ = true;
        // First fewer noisy probes are made sharp: more would have to be made so too.
        if (best.noise < 0.85 * noise_ && may_be_sharper()) {
            sharpen(best.noise, picture, probe, work, run);
        } else if (best.probes > probes()) {
            // Half as many more, and then a claim: fewer than planned may do.
            const std::size_t more = std::max(claim_outlook::least_probes, probes() + probes() / 2);
            grow(std::min(best.probes, more), picture, probe, work, run);
        } else if (sample_->heavy_tailed() && may_be_sharper()) {
            sharpen(noise_ / 2, picture, probe, work, run);
        } else {
            return false;
        }
        return true;
    }

    /// Makes a claim possible with what probes there are, made as good as an audit's: no more work is to be done.
    template <Probe P, Executor E>
    void look_at_last(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        claiming_ = true;
        if (noise_ > options_.audit.noise && may_be_sharper()) {
            sharpen(options_.audit.noise, picture, probe, work, run);
        }
        while (sample_->heavy_tailed() && may_be_sharper()) { sharpen(noise_ / 2, picture, probe, work, run); }
        grow(std::max<std::size_t>(200, options_.audit.probes), picture, probe, work, run);
    }

    /// Whether a claim is likely enough to hold to be made.
    [[nodiscard]] bool worth_a_claim(double work) const {
        if (!claiming_ || sample_->heavy_tailed() || probes() < claim_outlook::least_probes) { return false; }
        const claim_outlook known = outlook(work);
        return known.seen * known.decay.at(work) <
               1.1 * certifiable_error(known, {work, probes(), noise_}, known.z.front());
    }

    /// Claims the target. A claim gets a share of the probability to be wrong; since the claims go on until one holds,
    /// what is told of that one is as sure as all together, and no more.
    [[nodiscard]] audit_result claim() {
        audit_options how = options_.audit;
        how.confidence = 1 - miss(++claims_);
        audit_result result = judged(*sample_, how);
        result.confidence = options_.audit.confidence;
        history_.set_bound(result.mean_error_bound);
        broken_ = has_broken_probes(result);
        return result;
    }

    /// Whether the target is out of reach, or will never be claimed. What rare samples bring to the same probes looks
    /// like an error that stays: such probes are made sharper before anything is concluded from it, as far as patience
    /// goes.
    template <Probe P, Executor E>
    bool gives_up(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        sharpen_slow([&] { return target_is_excluded(); }, picture, probe, work, run);
        return target_is_excluded() || is_blinded(picture, probe, work, run) || is_stuck(picture, probe, work, run);
    }

    /// Whether so many claims failed that what may be wrong by another is nothing.
    [[nodiscard]] bool is_out_of_claims() const { return share_of_miss(claims_ + 1) < 1e-6; }

    /// Whether the last claim failed, and every other will, because the probes' own answers are broken.
    [[nodiscard]] bool is_broken() const { return broken_; }

    [[nodiscard]] decay_fit decay() const { return history_.decay(); }

    [[nodiscard]] claim_plan plan(double work) const { return cheapest_claim(outlook(work)); }

    [[nodiscard]] double next_work(double work) const {
        const double least = options_.least_growth * work;
        const double next = claiming_ ? least : std::clamp(plan(work).work, least, options_.most_growth * work);
        return std::min(next, options_.most_work);
    }

    /// Where the target will be certified, as far as can be told.
    [[nodiscard]] double predicted_work(double work) const {
        const claim_outlook known = outlook(work);
        const claim_plan best = cheapest_claim(known);
        return is_finite(best.work) ? certified_work(known, best, 1) : best.work;
    }

    [[nodiscard]] const std::vector<until_check>& checks() const { return history_.all(); }
    [[nodiscard]] std::size_t claims() const { return claims_; }
    [[nodiscard]] std::size_t samples() const { return sample_ ? sample_->samples() : 0; }

private:
    template <Probe P, Executor E>
    void draw(const audited_picture<T>& picture, const P& probe, const E& run) {
        audit_options look = options_.audit;
        look.probes = options_.scout_probes;
        look.noise = noise_;
        look.patience = 1;
        sample_.emplace(look);
        sample_->draw(audit_ground<T>{picture, options_.audit}, probe, run);
    }

    /// Gives the probes so many samples that their noise falls to `noise`.
    template <Probe P, Executor E>
    void sharpen(double noise, const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        const double before = noise_;
        sample_->sharpen(audit_ground<T>{picture, options_.audit}, square(noise_ / noise), probe, run);
        history_.add(seen(work));
        blunt_ = blunt_ || (!sample_->heavy_tailed() && noise_ > before * std::pow(noise / before, 0.25));
    }

    /// Sharpens probes whose noise falls slowly while that is what makes `it_seems` so, as far as patience goes.
    template <typename Seems, Probe P, Executor E>
    void sharpen_slow(const Seems& it_seems, const audited_picture<T>& picture, const P& probe, double work,
                      const E& run) {
        while (it_seems() && sample_->slow() && !blunt_ && is_patient()) {
            sharpen(noise_ / 2, picture, probe, work, run);
        }
    }

    /// Draws more probes until there are `count`.
    template <Probe P, Executor E>
    void grow(std::size_t count, const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        if (count <= probes()) { return; }
        sample_->grow(audit_ground<T>{picture, options_.audit}, count - probes(), probe, run);
        history_.add(seen(work));
    }

    /// Whether the probes' noise, which no picture changes, stays heavy-tailed to the end of patience, and that is not
    /// the chance of few.
    template <Probe P, Executor E>
    bool is_blinded(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        if (!claiming_ || !sample_->heavy_tailed() || may_be_sharper()) { return false; }
        grow(options_.audit.probes, picture, probe, work, run);
        return sample_->heavy_tailed() && !may_be_sharper();
    }

    /// Whether the picture comes so near the target, and no nearer, that not even the best probes certify it: four
    /// times the work changed nothing, nor did the best probes, nor sixteen times the work.
    template <Probe P, Executor E>
    bool is_stuck(const audited_picture<T>& picture, const P& probe, double work, const E& run) {
        if (!seems_out_of_reach(work)) { return false; }
        stuck_at_ = std::min(stuck_at_, work);
        const claim_outlook known = outlook(work);
        if (work < 4 * stuck_at_ || probes_cost(known, best_probes(known)) > 0.5 * work) { return false; }
        sharpen_slow([&] { return seems_out_of_reach(work); }, picture, probe, work, run);
        if (!sample_->slow()) {
            if (noise_ > options_.least_noise && may_be_sharper()) {
                sharpen(options_.least_noise, picture, probe, work, run);
            }
            grow(options_.most_probes, picture, probe, work, run);
        }
        if (target_is_excluded()) { return true; }
        return seems_out_of_reach(work) && work >= 16 * stuck_at_;
    }

    /// Whether not even the best probes would certify what the error falls to. Forgets when it began once it is not so.
    bool seems_out_of_reach(double work) {
        const claim_outlook known = outlook(work);
        const bool seems =
            history_.pictures() >= 4 &&
            known.seen * known.decay.floor > certifiable_error(known, best_probes(known), known.z.front());
        if (!seems) { stuck_at_ = std::numeric_limits<double>::infinity(); }
        return seems;
    }

    /// Whether the measurements exclude every floor at or below the target. All are made by the same probes.
    [[nodiscard]] bool target_is_excluded() const {
        // What few pixels are off by is chance itself, whatever the probes know of it: it need not fall evenly.
        const double doubt = std::hypot(history_.last().error_deviation / history_.last().error,
                                        1 / std::sqrt(static_cast<double>(pixels_)));
        return history_.pictures() >= 4 && decay().floor_low * (1 - 2 * doubt) > options_.audit.target;
    }

    [[nodiscard]] std::size_t probes() const { return sample_->probes(); }

    [[nodiscard]] until_check seen(double work) {
        const std::vector<double> each = sample_->mean_errors();
        const running_mean errors = mean_of(each);
        bound_ = skewed_upper_bound(each, 1 - miss(claims_ + 1));
        if (errors.mean() > 0) { ratio_ = errors.deviation() / errors.mean(); }
        own_ = mean_of(sample_->noises()).mean();
        noise_ = std::max(0.01, own_ / 0.8 / options_.audit.target);  // E|n| of a normal n is 0.8 of its deviation
        const likely_error likely = sample_->likely();
        return {work, likely.error, likely.deviation, 0, probes()};
    }

    [[nodiscard]] bool unclear() const {
        const until_check& last = history_.last();
        return sample_->heavy_tailed() || !(last.error_deviation < 0.15 * last.error);
    }

    /// Whether sharper probes are cheap beside the picture. Where noise falls slowly, a picture that goes on does not
    /// make it clearer: sharper probes do.
    [[nodiscard]] bool affordable(double work) const {
        const double cost = 3 * static_cast<double>(sample_->samples_per_probe() * probes()) * options_.probe_work;
        return cost <= (sample_->heavy_tailed() ? 0.5 : 0.1) * work;
    }

    [[nodiscard]] claim_outlook outlook(double work) const {
        const until_check& last = history_.last();
        claim_outlook known{.target = options_.audit.target,
                            .growth = options_.least_growth,
                            .work = work,
                            .decay = decay(),
                            .doubt = 0.05,
                            .ratio = ratio_,
                            .probes = probes(),
                            .noise = noise_,
                            .own = own_,
                            .samples = static_cast<double>(sample_->samples_per_probe()),
                            .sample_work = options_.probe_work,
                            .most_probes = std::max(options_.most_probes, probes()),
                            .most_noise = std::max(options_.least_noise, options_.most_noise / 2),
                            .least_noise = options_.least_noise};
        for (std::size_t i = 0; i < known.z.size(); ++i) { known.z[i] = normal_quantile(1 - miss(claims_ + 1 + i)); }
        const double behind = error_behind(known, {last.work, probes(), noise_}, known.z.front(), bound_);
        const double expected = known.decay.at(last.work);
        known.seen = expected > 0 ? std::max(behind, 0.05 * bound_) / expected : 0;
        return known;
    }

    /// Whether more samples may help: not without end where noise seems heavy-tailed, nor where it did not fall.
    [[nodiscard]] bool may_be_sharper() const { return !blunt_ && (!sample_->heavy_tailed() || is_patient()); }

    /// Whether patience reaches for four times the samples.
    [[nodiscard]] bool is_patient() const { return detail::is_patient(options_.audit, sample_->samples_per_probe()); }

    /// Whether the error seems to stay above the target, or to need much more work.
    [[nodiscard]] bool floor_is_feared() const {
        if (history_.pictures() < 3) { return false; }
        const decay_fit fit = decay();
        return fit.floor > 0.8 * options_.audit.target || fit.work_to(options_.audit.target) > 8 * history_.last().work;
    }

    [[nodiscard]] double miss(std::size_t claim) const {
        return (1 - options_.audit.confidence) * share_of_miss(claim);
    }

    const render_until_options& options_;
    until_history history_{};
    std::size_t pixels_{1};
    std::optional<audit_sample<T>> sample_{};
    double noise_;       // of the probes, as a share of the target
    double own_{0};      // mean size of that
    double bound_{1};    // on the error, as the next claim would state it
    double ratio_{1};    // standard deviation over mean of a probe's error
    bool blunt_{false};  // whether more samples took off that less than a quarter of what they should, in octaves
    bool claiming_{false};
    bool broken_{false};
    std::size_t claims_{0};
    double stuck_at_{std::numeric_limits<double>::infinity()};  // work at which `is_stuck` began to seem so
};

}  // namespace aglow::detail
