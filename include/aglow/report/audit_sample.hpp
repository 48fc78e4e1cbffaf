// The probes of one audit: which pixels, how many samples, and the plain numbers made of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>
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
    /// Keeps a reference to `ground`.
    audit_sample(const audit_ground<T>& ground, const audit_options& options)
        : picture_{ground.picture},
          options_{options},
          mean_{ground.mean},
          of_{picture_.image, ground.floor},
          shares_{ground.shares} {}

    /// A pilot tells how many samples a probe needs; then the probes, all of them anew with more samples while their
    /// noise seems heavy-tailed, and more for classes that got too few.
    template <Probe P, Executor E>
    void draw(const P& probe, const E& run) {
        per_batch_ = pilot(probe, run);
        uniform_ = static_cast<std::size_t>(shares_.uniform_part() * static_cast<double>(options_.probes));
        const std::vector<std::size_t> pixels = main_pixels();
        std::vector<std::size_t> batches = allotted(probe, run, pixels, part_main_spread);
        records_ = draw_all(probe, run, pixels, batches, part_main);
        for (std::uint64_t again = 1; worth_drawing_anew(); ++again) {
            per_batch_ *= 4;
            for (std::size_t& b : batches) { b *= 4; }
            records_ = draw_all(probe, run, pixels, batches, part_anew + again);
        }
        slow_ = seems_heavy();
        const std::vector<std::size_t> rare = pixels_of_rare_classes();
        extra_ = draw_all(probe, run, rare, allotted(probe, run, rare, part_extra_spread), part_extra);
    }

    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double dark_floor() const { return of_.floor; }
    [[nodiscard]] std::size_t probes() const { return records_.size() + extra_.size(); }
    [[nodiscard]] std::size_t samples_per_probe() const { return per_batch_ * probe_batches; }
    [[nodiscard]] std::size_t samples() const { return samples_; }
    [[nodiscard]] std::size_t broken() const { return broken_; }

    /// Whether the noise falls so slowly that its variance may be infinite, and no bound is known that says otherwise.
    [[nodiscard]] bool heavy_tailed() const { return slow_ && !options_.sample_bound; }

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
        return each(records_.size(), [&](const probe_record& r) {
            const double gap = less_noisy([&](unsigned chosen) { return of_.error(r, chosen); });
            return shares_.weight(r.pixel) * (gap + of_.denominator_noise2(r));
        });
    }

    /// The mean relative error as it probably is, for plans: the square of what is seen grows about as the variance of
    /// the probes' noise, which is twice as large for halves of the batches. As often below the truth as above it.
    [[nodiscard]] likely_error likely() const {
        const auto seen = [&](const auto& of) { return each(records_.size(), of); };
        const std::vector<double> all =
            seen([&](const probe_record& r) { return shares_.weight(r.pixel) * of_.error(r, every_batch); });
        const std::vector<double> halves = seen([&](const probe_record& r) {
            return shares_.weight(r.pixel) * mean_over_choices<4>([&](unsigned half) { return of_.error(r, half); });
        });
        return without_noise(all, halves);
    }

    /// Weighted size of the noise of each probe, relative as its error is: half the distance of its halves.
    [[nodiscard]] std::vector<double> noises() const {
        return each(records_.size(),
                    [&](const probe_record& r) { return shares_.weight(r.pixel) * of_.apart(r) / 2 / of_.scale(r); });
    }

    /// Relative error of the pixels that were drawn uniformly, with the probe's noise left in: never too small on
    /// average.
    [[nodiscard]] std::vector<double> plain_errors() const {
        return each(uniform_, [&](const probe_record& r) { return of_.error(r, every_batch); });
    }

    /// Weighted B−U of each probed pixel, of the mean of its channels.
    [[nodiscard]] std::vector<double> gaps() const {
        return each(records_.size(), [&](const probe_record& r) {
            return shares_.weight(r.pixel) * (picture_.image.gray(r.pixel) - of_.gray(r, every_batch));
        });
    }

    /// How slowly the probes' noise falls with their samples, as the 1/α of a stable law: 1/2 for a finite variance.
    /// Compares the differences of single batches with those of halves, which average four times as many samples.
    [[nodiscard]] double tail_index() const {
        double singles = 0;
        double halves = 0;
        for (const probe_record& r : records_) {
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
        std::vector<std::uint32_t> classes;
        const auto add = [&](const probe_record& r) {
            all.push_back(&r);
            classes.push_back(class_of(picture_, r.pixel));
        };
        std::for_each(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(uniform_), add);
        std::for_each(extra_.begin(), extra_.end(), add);
        std::vector<class_scale> found;
        class_lists{classes, options_.class_probes}.for_each(
            [&](std::uint32_t id, std::span<const std::size_t> members, bool merged) {
                found.push_back({id, bar_scale(all, members, confidence), members.size(), merged});
            });
        return found;
    }

private:
    static constexpr std::size_t pilot_probes = 32;
    static constexpr std::uint64_t part_main = 0;  // parts of the audit's random numbers; pilots are 2, 3, ...
    static constexpr std::uint64_t part_extra = 1;
    static constexpr std::uint64_t part_main_spread = 500;
    static constexpr std::uint64_t part_extra_spread = 501;
    static constexpr std::uint64_t part_anew = 1000;
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
            largest = std::max(largest, shares_.weight(r.pixel) * jump);
        }
        return largest / static_cast<double>(records_.size());
    }

    [[nodiscard]] bool worth_drawing_anew() const {
        const double most = options_.patience / square(options_.noise * options_.target);
        const bool patient = 4 * static_cast<double>(samples_per_probe()) <= most;
        const bool affordable = 4 * static_cast<double>(per_batch_) <= affordable_batch();
        if (!patient || !affordable || !seems_heavy()) { return false; }
        const double jump = largest_jump([this](const probe_record& r) { return of_.darkest(r); });
        return reach(options_.confidence) * jump > 0.1 * options_.target;
    }

    template <typename Of>
    [[nodiscard]] std::vector<double> each(std::size_t first, const Of& of) const {
        std::vector<double> values(first);
        for (std::size_t i = 0; i < first; ++i) { values[i] = of(records_[i]); }
        return values;
    }

    /// Conformal quantile of |B−U|/guess over `members`, with three quarters of what the probes' noise adds to it taken
    /// out: its square grows about as the noise's variance, which is twice as large for halves of the batches. (All of
    /// it taken out, small classes fell below their coverage.)
    [[nodiscard]] double bar_scale(std::span<const probe_record* const> all, std::span<const std::size_t> members,
                                   double confidence) const {
        const auto at = [&](unsigned chosen) {
            std::vector<double> scores;
            for (const std::size_t i : members) {
                const probe_record& r = *all[i];
                const double gap = std::abs(picture_.image.gray(r.pixel) - of_.gray(r, chosen));
                scores.push_back(gap / usable_guess(picture_, r.pixel, of_.floor));
            }
            return conformal_quantile(scores, confidence).value_or(std::numeric_limits<double>::infinity());
        };
        const double whole = at(every_batch);
        if (!is_finite(whole)) { return whole; }
        const double halves2 = mean_over_choices<4>([&](unsigned half) { return square(at(half)); });
        return std::sqrt(std::max(1.75 * whole * whole - 0.75 * halves2, 0.25 * whole * whole));
    }

    [[nodiscard]] path_key key(std::uint64_t part, std::size_t i) const {
        return {options_.seed, mix(options_.stream, part), static_cast<std::uint64_t>(i)};
    }

    /// A number in [0, 1) that belongs to probe `i` of `part`.
    [[nodiscard]] double drawn_number(std::uint64_t part, std::size_t i) const {
        return unit_interval<double>(mix(key(part, i), ~0u, purpose::audit));
    }

    [[nodiscard]] std::size_t drawn(std::uint64_t part, std::size_t i, std::size_t count) const {
        return std::min(count - 1, static_cast<std::size_t>(drawn_number(part, i) * static_cast<double>(count)));
    }

    [[nodiscard]] std::vector<std::size_t> uniform_pixels(std::size_t count, std::uint64_t part) const {
        std::vector<std::size_t> pixels(count);
        for (std::size_t i = 0; i < count; ++i) { pixels[i] = drawn(part, i, picture_.image.pixels()); }
        return pixels;
    }

    /// Uniform ones first, then those drawn where errors are feared.
    [[nodiscard]] std::vector<std::size_t> main_pixels() const {
        std::vector<std::size_t> pixels = uniform_pixels(options_.probes, part_main);
        for (std::size_t i = uniform_; i < pixels.size(); ++i) {
            pixels[i] = shares_.pixel_at(drawn_number(part_main, i));
        }
        return pixels;
    }

    /// Further pixels of classes that the uniform draw hit too seldom.
    [[nodiscard]] std::vector<std::size_t> pixels_of_rare_classes() const {
        std::vector<std::size_t> pixels;
        if (picture_.classes.empty()) { return pixels; }
        std::vector<class_list> hits;
        for (std::size_t i = 0; i < uniform_; ++i) {
            members_of(hits, picture_.classes[records_[i].pixel]).push_back(i);
        }
        std::vector<class_list> members;
        for (std::size_t i = 0; i < picture_.classes.size(); ++i) {
            const std::uint32_t id = picture_.classes[i];
            if (members_of(hits, id).size() < options_.class_probes) { members_of(members, id).push_back(i); }
        }
        for (const auto& [id, own] : members) {
            for (std::size_t k = members_of(hits, id).size(); k < options_.class_probes; ++k) {
                pixels.push_back(own[drawn(part_extra, pixels.size(), own.size())]);
            }
        }
        return pixels;
    }

    /// Draws the probe of each pixel with its own number of samples in a batch, or with that of all.
    template <Probe P, Executor E>
    [[nodiscard]] std::vector<probe_record> draw_all(const P& probe, const E& run,
                                                     const std::vector<std::size_t>& pixels,
                                                     const std::vector<std::size_t>& batches, std::uint64_t part) {
        std::vector<probe_record> records(pixels.size());
        run(pixels.size(), [&](std::size_t i) {
            records[i] = draw_probe(probe, pixels[i], picture_.image.channels, batches[i], key(part, i));
        });
        for (const probe_record& r : records) {
            samples_ += r.samples;
            broken_ += r.broken;
        }
        return records;
    }

    /// Samples per batch of each probe, `per_batch_` on average: most where the noise is largest beside the light, as
    /// Neyman (1934) shares a sample among strata. A look of its own tells, so that the probes stay unbiased.
    template <Probe P, Executor E>
    [[nodiscard]] std::vector<std::size_t> allotted(const P& probe, const E& run,
                                                    const std::vector<std::size_t>& pixels, std::uint64_t part) {
        std::vector<std::size_t> batches(pixels.size(), per_batch_);
        if (per_batch_ < 8) { return batches; }
        const std::vector<std::size_t> few(pixels.size(), per_batch_ / 8);
        std::vector<double> spreads;
        for (const probe_record& r : draw_all(probe, run, pixels, few, part)) { spreads.push_back(of_.spread(r)); }
        const double mean = mean_of(spreads).mean();
        if (!(mean > 0)) { return batches; }
        for (std::size_t i = 0; i < batches.size(); ++i) {
            // What few samples say is not believed to the last: a quarter is dealt out evenly.
            const double share = 0.25 + 0.75 * std::min(spreads[i] / mean, 16.0);
            batches[i] = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(per_batch_)));
        }
        return batches;
    }

    /// Samples per batch for the wanted noise. A few single samples say little of a skewed noise, so the pilot is
    /// repeated with larger batches until these are within a factor 8 of what they call for.
    template <Probe P, Executor E>
    [[nodiscard]] std::size_t pilot(const P& probe, const E& run) {
        std::size_t batch = 1;
        for (std::uint64_t round = 2;; ++round) {
            const std::vector<std::size_t> batches(pilot_probes, batch);
            const double wanted =
                wanted_batch(draw_all(probe, run, uniform_pixels(pilot_probes, round), batches, round), batch);
            const double most = affordable_batch();
            const double next = std::clamp(std::ceil(std::min(wanted, most)), 1.0, 1e9);
            if (wanted <= 8 * static_cast<double>(batch) || next < wanted) { return static_cast<std::size_t>(next); }
            batch = static_cast<std::size_t>(std::ceil(next / 4));
        }
    }

    /// Samples per batch that give a probe the wanted relative standard error, judged by a pilot of batches of `batch`.
    [[nodiscard]] double wanted_batch(const std::vector<probe_record>& pilots, std::size_t batch) const {
        running_mean spread;
        for (const probe_record& r : pilots) { spread.add(of_.spread(r)); }
        return static_cast<double>(batch) / probe_batches * square(spread.mean() / (options_.noise * options_.target));
    }

    /// What the budget allows, the look that shares it out included.
    [[nodiscard]] double affordable_batch() const {
        const double left = static_cast<double>(options_.budget) - static_cast<double>(samples_);
        return std::floor(left / (1.125 * static_cast<double>(options_.probes * probe_batches)));
    }

    audited_picture<T> picture_;
    audit_options options_;
    double mean_;
    probe_reader<T> of_;
    const pixel_shares& shares_;
    std::size_t uniform_{0};
    std::size_t per_batch_{1};
    bool slow_{false};
    std::size_t samples_{0};
    std::size_t broken_{0};
    std::vector<probe_record> records_{};
    std::vector<probe_record> extra_{};
};

}  // namespace aglow::detail
