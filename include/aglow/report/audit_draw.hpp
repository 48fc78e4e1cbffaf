// Which pixels an audit looks at, and how many samples each of them gets.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

/// Parts of an audit's random numbers; pilots are 2, 3, ...
namespace audit_part {
inline constexpr std::uint64_t main_probes = 0;
inline constexpr std::uint64_t extra_probes = 1;
inline constexpr std::uint64_t main_spread = 500;
inline constexpr std::uint64_t extra_spread = 501;
inline constexpr std::uint64_t anew = 1000;
inline constexpr std::uint64_t further = 2000;
}  // namespace audit_part

/// Whether patience reaches for four times so many samples of a probe.
[[nodiscard]] inline bool is_patient(const audit_options& options, std::size_t samples) {
    return 4 * static_cast<double>(samples) <= options.patience / square(options.noise * options.target);
}

/// Chooses pixels, deals samples out to them and draws their probes. Expects options that were checked.
template <std::floating_point T>
class audit_draw {
public:
    /// Keeps a reference to `ground`.
    audit_draw(const audit_ground<T>& ground, const audit_options& options)
        : picture_{ground.picture},
          options_{options},
          of_{picture_.image, ground.floor},
          shares_{ground.shares},
          uniform_{uniform_of(options.probes)} {}

    /// Takes so many samples to a batch on average, as a pilot would have found.
    void deal(std::size_t per_batch) { per_batch_ = per_batch; }
    [[nodiscard]] std::size_t samples_per_batch() const { return per_batch_; }
    [[nodiscard]] std::size_t samples() const { return samples_; }
    [[nodiscard]] std::size_t broken() const { return broken_; }
    [[nodiscard]] double lost() const { return lost_; }

    /// Finds the samples per batch for the wanted noise. A few single samples say little of a skewed noise, so the
    /// pilot is repeated with larger batches until these are within a factor 8 of what they call for.
    template <Probe P, Executor E>
    void pilot(const P& probe, const E& run) {
        std::size_t batch = 1;
        for (std::uint64_t round = 2;; ++round) {
            const std::vector<std::size_t> batches(pilot_probes, batch);
            wanted_ = wanted_batch(all(probe, run, uniform_pixels(pilot_probes, round), batches, round), batch);
            const std::size_t next = allowed_batch();
            if (wanted_ <= 8 * static_cast<double>(batch) || static_cast<double>(next) < wanted_) {
                fit_to_budget();
                return;
            }
            batch = (next + 3) / 4;
        }
    }

    /// Whether patience and budget reach for four times the samples.
    [[nodiscard]] bool may_quadruple() const {
        return is_patient() && 4 * static_cast<double>(per_batch_) <= affordable_batch();
    }

    /// About how many samples all probes call for, by their noise or because it seems `heavy` still; 0 where they got
    /// them, or patience ended before the budget.
    [[nodiscard]] std::size_t called_for(bool heavy) const {
        const double got = static_cast<double>(per_batch_);
        const double need = std::max(std::ceil(wanted_), heavy && is_patient() ? 4 * got : 0.0);
        if (!(need > got || is_short_)) { return 0; }
        return static_cast<std::size_t>(std::min(1e18, need * wanted_cost_));
    }

    void quadruple() { per_batch_ *= 4; }

    /// Uniform ones first, then those drawn where errors are feared.
    [[nodiscard]] std::vector<std::size_t> main_pixels() const {
        std::vector<std::size_t> pixels = uniform_pixels(options_.probes, audit_part::main_probes);
        for (std::size_t i = uniform_; i < pixels.size(); ++i) {
            pixels[i] = shares_.pixel_at(drawn_number(audit_part::main_probes, i));
        }
        return pixels;
    }

    /// How many probes a class gets at least, and the further pixels that the pilot found to be needed for that.
    [[nodiscard]] std::size_t class_probes() const { return options_.class_probes; }
    [[nodiscard]] const std::vector<std::size_t>& rare_pixels() const { return rare_; }

    /// Samples per batch of each probe, `samples_per_batch()` on average: most where the noise is largest beside the
    /// light, as Neyman (1934) shares a sample among strata. A look of its own tells, so that the probes stay unbiased.
    template <Probe P, Executor E>
    [[nodiscard]] std::vector<std::size_t> allotted(const P& probe, const E& run,
                                                    const std::vector<std::size_t>& pixels, std::uint64_t part) {
        std::vector<std::size_t> batches(pixels.size(), per_batch_);
        if (per_batch_ < 8) { return batches; }
        const std::vector<std::size_t> few(pixels.size(), per_batch_ / 8);
        std::vector<double> spreads;
        for (const probe_record& r : all(probe, run, pixels, few, part)) { spreads.push_back(of_.spread(r)); }
        const double mean = mean_of(spreads).mean();
        if (!(mean > 0)) { return batches; }
        for (std::size_t i = 0; i < batches.size(); ++i) {
            // What few samples say is not believed to the last: a quarter is dealt out evenly.
            const double share = 0.25 + 0.75 * std::min(spreads[i] / mean, 16.0);
            batches[i] = std::max<std::size_t>(1, static_cast<std::size_t>(share * static_cast<double>(per_batch_)));
        }
        return batches;
    }

    /// Draws the probes of `main_pixels()`, and says how they were drawn.
    template <Probe P, Executor E>
    [[nodiscard]] std::vector<probe_record> main(const P& probe, const E& run, const std::vector<std::size_t>& pixels,
                                                 const std::vector<std::size_t>& batches, std::uint64_t part) {
        std::vector<probe_record> records = all(probe, run, pixels, batches, part);
        for (std::size_t i = 0; i < records.size(); ++i) {
            records[i].weight = shares_.weight(pixels[i]);
            records[i].uniform = i < uniform_;
        }
        return records;
    }

    /// Draws the probe of each pixel, with its own number of samples in a batch.
    template <Probe P, Executor E>
    [[nodiscard]] std::vector<probe_record> all(const P& probe, const E& run, const std::vector<std::size_t>& pixels,
                                                const std::vector<std::size_t>& batches, std::uint64_t part) {
        std::vector<probe_record> records(pixels.size());
        const double before = lost_by(probe);
        run(pixels.size(), [&](std::size_t i) {
            records[i] = draw_probe(probe, pixels[i], picture_.image.channels, batches[i], key(part, i));
        });
        lost_ += lost_by(probe) - before;
        for (const probe_record& r : records) {
            samples_ += r.samples;
            broken_ += r.broken;
        }
        return records;
    }

private:
    static constexpr std::size_t pilot_probes = 32;
    static constexpr std::size_t least_probes = 200;
    static constexpr std::size_t least_class_probes = 60;

    template <typename P>
    [[nodiscard]] static double lost_by(const P& probe) {
        if constexpr (KnowsLoss<P>) {
            return probe.lost();
        } else {
            return 0;
        }
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

    /// Samples per batch that give a probe the wanted relative standard error, judged by a pilot of batches of `batch`.
    [[nodiscard]] double wanted_batch(const std::vector<probe_record>& pilots, std::size_t batch) const {
        running_mean spread;
        for (const probe_record& r : pilots) { spread.add(of_.spread(r)); }
        return static_cast<double>(batch) / probe_batches * square(spread.mean() / (options_.noise * options_.target));
    }

    /// Whether patience reaches for four times the samples.
    [[nodiscard]] bool is_patient() const { return detail::is_patient(options_, per_batch_ * probe_batches); }

    /// Further pixels of classes that the uniform draw hits too seldom.
    [[nodiscard]] std::vector<std::size_t> pixels_of_rare_classes() const {
        std::vector<std::size_t> pixels;
        if (picture_.classes.empty()) { return pixels; }
        std::vector<class_list> hits;
        for (const std::size_t i : uniform_pixels(uniform_, audit_part::main_probes)) {
            members_of(hits, picture_.classes[i]).push_back(i);
        }
        std::vector<class_list> members;
        for (std::size_t i = 0; i < picture_.classes.size(); ++i) {
            const std::uint32_t id = picture_.classes[i];
            if (members_of(hits, id).size() < options_.class_probes) { members_of(members, id).push_back(i); }
        }
        for (const auto& [id, own] : members) {
            for (std::size_t k = members_of(hits, id).size(); k < options_.class_probes; ++k) {
                pixels.push_back(own[drawn(audit_part::extra_probes, pixels.size(), own.size())]);
            }
        }
        return pixels;
    }

    /// Where the budget is short there are fewer probes: few that see well tell more than many that see badly.
    void fit_to_budget() {
        rare_ = pixels_of_rare_classes();
        wanted_cost_ = sample_cost();
        const double share = affordable_batch() / wanted_;
        is_short_ = share < 1;
        if (is_short_) {
            const auto fewer = [share](std::size_t count, std::size_t least) {
                return std::max(std::min(count, least), static_cast<std::size_t>(share * static_cast<double>(count)));
            };
            options_.probes = fewer(options_.probes, least_probes);
            options_.class_probes = fewer(options_.class_probes, least_class_probes);
            uniform_ = uniform_of(options_.probes);
            rare_ = pixels_of_rare_classes();
        }
        per_batch_ = allowed_batch();
    }

    [[nodiscard]] std::size_t uniform_of(std::size_t probes) const {
        return static_cast<std::size_t>(shares_.uniform_part() * static_cast<double>(probes));
    }

    /// Samples of all probes for one in a batch, those of the look that shares them out included.
    [[nodiscard]] double sample_cost() const {
        return 1.125 * static_cast<double>((options_.probes + rare_.size()) * probe_batches);
    }

    /// What is wanted, or as much of that as the budget allows.
    [[nodiscard]] std::size_t allowed_batch() const {
        return static_cast<std::size_t>(std::clamp(std::ceil(std::min(wanted_, affordable_batch())), 1.0, 1e9));
    }

    /// What the budget allows.
    [[nodiscard]] double affordable_batch() const {
        const double left = static_cast<double>(options_.budget) - static_cast<double>(samples_);
        return std::max(0.0, std::floor(left / sample_cost()));
    }

    audited_picture<T> picture_;
    audit_options options_;
    probe_reader<T> of_;
    const pixel_shares& shares_;
    std::size_t uniform_;
    std::size_t per_batch_{1};
    std::vector<std::size_t> rare_{};
    double wanted_{0};       ///< samples per batch, by the pilot
    double wanted_cost_{0};  ///< of all probes that were asked for, for one sample in a batch
    bool is_short_{false};   ///< whether the budget does not reach for that
    std::size_t samples_{0};
    std::size_t broken_{0};
    double lost_{0};
};

}  // namespace aglow::detail
