// The probes of one audit, and the plain numbers made of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/report/audit_draw.hpp>
#include <aglow/report/audit_pixels.hpp>
#include <aglow/report/audit_result.hpp>
#include <aglow/report/conformal.hpp>
#include <aglow/report/probe.hpp>
#include <aglow/report/probe_reader.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow::detail {

/// Draws the probes of an audit and turns them into one number each, per statement. Expects options that were checked.
template <std::floating_point T>
class audit_sample {
public:
    explicit audit_sample(const audit_options& options) : options_{options} {}

    /// A pilot tells how many samples a probe needs; then the probes, all of them anew with more samples while their
    /// noise seems heavy-tailed, and more for classes that got too few.
    template <Probe P, Executor E>
    void draw(const audit_ground<T>& ground, const P& probe, const E& run) {
        read(ground.picture);
        audit_draw<T> draw{ground, options_};
        draw.pilot(probe, run);
        options_.class_probes = draw.class_probes();
        const std::vector<std::size_t> pixels = draw.main_pixels();
        std::vector<std::size_t> batches = draw.allotted(probe, run, pixels, audit_part::main_spread);
        records_ = draw.main(probe, run, pixels, batches, audit_part::main_probes);
        for (std::uint64_t again = 1; worth_drawing_anew(draw); ++again) {
            draw.quadruple();
            for (std::size_t& b : batches) { b *= 4; }
            records_ = draw.main(probe, run, pixels, batches, audit_part::anew + again);
        }
        slow_ = seems_heavy();
        called_for_ = draw.called_for(heavy_tailed());
        const std::vector<std::size_t>& rare = draw.rare_pixels();
        extra_ = draw.all(probe, run, rare, draw.allotted(probe, run, rare, audit_part::extra_spread),
                          audit_part::extra_probes);
        count(draw);
        per_batch_ = draw.samples_per_batch();
    }

    /// Draws `more` probes besides, with as many samples each. They look at `ground`, of a picture of the same view.
    template <Probe P, Executor E>
    void grow(const audit_ground<T>& ground, std::size_t more, const P& probe, const E& run) {
        audit_draw<T> draw = further_draw(ground, more);
        draw.deal(per_batch_);
        const std::vector<std::size_t> pixels = draw.main_pixels();
        for (probe_record& r : draw.main(probe, run, pixels, draw.allotted(probe, run, pixels, audit_part::main_spread),
                                         audit_part::main_probes)) {
            records_.push_back(std::move(r));
        }
        count(draw);
        slow_ = seems_heavy();
    }

    /// Gives every probe more samples, until there are `factor` times as many.
    template <Probe P, Executor E>
    void sharpen(const audit_ground<T>& ground, double factor, const P& probe, const E& run) {
        const auto more = static_cast<std::size_t>(std::ceil((factor - 1) * static_cast<double>(per_batch_)));
        audit_draw<T> draw = further_draw(ground, records_.size());
        draw.deal(more);
        std::vector<std::size_t> pixels;
        for (const probe_record& r : records_) { pixels.push_back(r.pixel); }
        const std::vector<std::size_t> batches = draw.allotted(probe, run, pixels, audit_part::main_spread);
        const std::vector<probe_record> fresh = draw.all(probe, run, pixels, batches, audit_part::main_probes);
        for (std::size_t i = 0; i < fresh.size(); ++i) { records_[i].merge(fresh[i]); }
        count(draw);
        per_batch_ += more;
        slow_ = seems_heavy();
    }

    /// Lets the same probes judge another picture of the same view.
    void read(const audited_picture<T>& picture) {
        picture_ = picture;
        mean_ = mean_value(picture.image);
        of_ = {picture.image, options_.dark * std::abs(mean_)};
    }

    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double dark_floor() const { return of_.floor; }
    [[nodiscard]] std::size_t probes() const { return records_.size() + extra_.size(); }
    [[nodiscard]] std::size_t samples_per_probe() const { return per_batch_ * probe_batches; }
    [[nodiscard]] std::size_t samples() const { return samples_; }
    [[nodiscard]] std::size_t broken() const { return broken_; }
    /// About how many samples would have been needed, where the budget did not allow them; else 0.
    [[nodiscard]] std::size_t called_for() const { return called_for_; }
    /// Share of the light that broken answers of the probes' host cost.
    [[nodiscard]] double lost_share() const { return samples_ > 0 ? lost_ / static_cast<double>(samples_) : 0; }

    /// Whether the noise falls so slowly that its variance may be infinite, and no bound is known that says otherwise.
    [[nodiscard]] bool heavy_tailed() const { return slow_ && !options_.sample_bound; }

    /// Whether the noise falls so slowly, whatever bound is known.
    [[nodiscard]] bool slow() const { return slow_; }

    /// What rare samples of bounded size that were not met may add to the mean error: the part of Bernstein's
    /// inequality that does not shrink with the variance seen (Maurer & Pontil 2009, theorem 4). 0 where noise falls as
    /// it should.
    [[nodiscard]] double unmet_error(double confidence) const {
        return slow_ ? reach(confidence) * largest_jump([this](const probe_record& r) { return of_.darkest(r); }) : 0;
    }

    /// The same for the mean of `gaps()`.
    [[nodiscard]] double unmet_gap(double confidence) const {
        return slow_ ? reach(confidence) * largest_jump([](const probe_record&) { return 1.0; }) : 0;
    }

    /// Weighted relative error of each probed pixel, averaged over channels, with most of the probe's own noise taken
    /// out: their mean is the mean relative error of the picture.
    [[nodiscard]] std::vector<double> mean_errors() const {
        return each([&](const probe_record& r) {
            const double gap = less_noisy([&](unsigned chosen) { return of_.error(r, chosen); });
            return r.weight * (gap + of_.denominator_noise2(r));
        });
    }

    /// The mean relative error as it probably is, for plans: the square of what is seen grows about as the variance of
    /// the probes' noise, which is twice as large for halves of the batches. As often below the truth as above it.
    [[nodiscard]] likely_error likely() const {
        const std::vector<double> all =
            each([&](const probe_record& r) { return r.weight * of_.error(r, every_batch); });
        const std::vector<double> halves = each([&](const probe_record& r) {
            return r.weight * mean_over_choices<4>([&](unsigned half) { return of_.error(r, half); });
        });
        return without_noise(all, halves);
    }

    /// Weighted size of the noise of each probe, relative as its error is: half the distance of its halves.
    [[nodiscard]] std::vector<double> noises() const {
        return each([&](const probe_record& r) { return r.weight * of_.apart(r) / 2 / of_.scale(r); });
    }

    /// The same from below: what is as often above the mean relative error as below it, or seldomer.
    [[nodiscard]] std::vector<double> least_errors() const {
        return each(
            [&](const probe_record& r) { return r.weight * (of_.error_by_others(r) - of_.denominator_noise2(r)); });
    }

    /// Relative error of the pixels that were drawn uniformly, with the probe's noise left in, and what that noise may
    /// hide in the denominator: never too small on average.
    [[nodiscard]] std::vector<double> plain_errors() const {
        std::vector<double> errors;
        for (const probe_record& r : records_) {
            if (r.uniform) { errors.push_back(of_.error(r, every_batch) + of_.denominator_noise2(r)); }
        }
        return errors;
    }

    /// Weighted B−U of each probed pixel, of the mean of its channels.
    [[nodiscard]] std::vector<double> gaps() const {
        return each([&](const probe_record& r) {
            return r.weight * (picture_.image.gray(r.pixel) - of_.gray(r, every_batch));
        });
    }

    /// How slowly the probes' noise falls with their samples, as the 1/α of a stable law: 1/2 for a finite variance.
    /// Compares the differences of single batches with those of halves, which average four times as many samples.
    [[nodiscard]] double tail_index() const {
        double singles = 0;
        double halves = 0;
        for (const probe_record& r : records_) {
            if (!(of_.scale(r) > 0)) { continue; }  // black, in a black picture
            const double scale = 1 / of_.scale(r);
            singles += scale * mean_over_choices<2>([&](unsigned pair) {
                           const unsigned one = pair & (~pair + 1);
                           return std::abs(of_.gray(r, one) - of_.gray(r, pair ^ one));
                       });
            halves += scale * of_.apart(r);
        }
        return halves > 0 ? 1 - std::log2(singles / halves) / 2 : 0;
    }

    /// The scale of each class that turns guesses into error bars.
    [[nodiscard]] std::vector<class_scale> scales(double confidence) const {
        std::vector<const probe_record*> all;
        class_lists lists{options_.class_probes};
        const auto add = [&](const probe_record& r) {
            all.push_back(&r);
            lists.add(class_of(picture_, r.pixel));
        };
        for (const probe_record& r : records_) {
            if (r.uniform) { add(r); }
        }
        std::for_each(extra_.begin(), extra_.end(), add);
        std::vector<class_scale> found;
        lists.for_each([&](std::uint32_t id, const std::vector<std::size_t>& members, bool merged) {
            found.push_back({id, bar_scale(all, members, confidence), members.size(), merged});
        });
        return found;
    }

private:
    static constexpr double heavy = 0.6;  // tail index that a finite variance seldom shows

    [[nodiscard]] bool seems_heavy() const { return tail_index() > heavy; }

    static double reach(double confidence) { return 7 * std::log(2 / (1 - confidence)) / 3; }

    /// How far one sample of the largest size moves the mean of values over `below`; infinite where no size is known.
    template <typename Below>
    [[nodiscard]] double largest_jump(const Below& below) const {
        const double size = options_.sample_bound.value_or(std::numeric_limits<double>::infinity());
        double largest = 0;
        for (const probe_record& r : records_) {
            const double jump = size / static_cast<double>(r.samples) / below(r);
            largest = std::max(largest, r.weight * jump);
        }
        return largest / static_cast<double>(records_.size());
    }

    [[nodiscard]] bool worth_drawing_anew(const audit_draw<T>& draw) const {
        if (!draw.may_quadruple() || !seems_heavy()) { return false; }
        const double jump = largest_jump([this](const probe_record& r) { return of_.darkest(r); });
        return reach(options_.confidence) * jump > 0.1 * options_.target;
    }

    /// Draws with numbers of their own.
    [[nodiscard]] audit_draw<T> further_draw(const audit_ground<T>& ground, std::size_t probes) {
        audit_options further = options_;
        further.probes = probes;
        further.stream = mix(options_.stream, audit_part::further + ++further_draws_);
        return {ground, further};
    }

    void count(const audit_draw<T>& draw) {
        samples_ += draw.samples();
        broken_ += draw.broken();
        lost_ += draw.lost();
    }

    template <typename Of>
    [[nodiscard]] std::vector<double> each(const Of& of) const {
        std::vector<double> values(records_.size());
        for (std::size_t i = 0; i < values.size(); ++i) { values[i] = of(records_[i]); }
        return values;
    }

    /// Conformal quantile of |B−U|/guess over `members`, with three quarters of what the probes' noise adds to it taken
    /// out: its square grows about as the noise's variance, which is twice as large for halves of the batches. (All of
    /// it taken out, small classes fell below their coverage.)
    [[nodiscard]] double bar_scale(const std::vector<const probe_record*>& all, const std::vector<std::size_t>& members,
                                   double confidence) const {
        const auto at = [&](unsigned chosen) {
            std::vector<double> scores;
            for (const std::size_t i : members) {
                const probe_record& r = *all[i];
                const double gap = std::abs(picture_.image.gray(r.pixel) - of_.gray(r, chosen));
                scores.push_back(gap > 0 ? gap / usable_guess(picture_, r.pixel, of_.floor) : 0);
            }
            return conformal_quantile(scores, confidence).value_or(std::numeric_limits<double>::infinity());
        };
        const double whole = at(every_batch);
        if (!is_finite(whole)) { return whole; }
        const double halves2 = mean_over_choices<4>([&](unsigned half) { return square(at(half)); });
        return std::sqrt(std::max(1.75 * whole * whole - 0.75 * halves2, 0.25 * whole * whole));
    }

    audited_picture<T> picture_{};
    audit_options options_;
    double mean_{0};
    probe_reader<T> of_{};
    bool slow_{false};
    std::size_t per_batch_{1};
    std::size_t samples_{0};
    std::size_t called_for_{0};
    std::size_t broken_{0};
    double lost_{0};
    std::uint64_t further_draws_{0};
    std::vector<probe_record> records_{};
    std::vector<probe_record> extra_{};
};

}  // namespace aglow::detail
