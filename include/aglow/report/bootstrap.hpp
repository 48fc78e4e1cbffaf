// Intervals for any statistic of a few repeated runs, by drawing the runs again from themselves.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/report/confidence.hpp>
#include <aglow/report/quantiles.hpp>

namespace aglow {

struct bootstrap_options {
    /// Probability that the interval is meant to hold. With fewer than about 20 runs a percentile interval holds less.
    double confidence = 0.95;
    /// How often the runs are drawn anew.
    std::size_t resamples = 2000;
    /// The same seed gives the same interval, bit for bit.
    std::uint64_t seed = 0;
};

namespace detail {

/// A number below `count`, fixed by (seed, resample, place); Lemire's multiplication keeps it unbiased to 2^-32.
[[nodiscard]] constexpr std::size_t drawn_index(std::uint64_t seed, std::size_t resample, std::size_t place,
                                                std::size_t count) {
    const std::uint64_t word = mix(mix(seed, resample), place) >> 32;
    return static_cast<std::size_t>((word * static_cast<std::uint64_t>(count)) >> 32);
}

}  // namespace detail

/// Percentile interval (Efron 1979) of `statistic(indices)`, where `indices` names runs out of [0, count), some of them
/// more than once. The estimate is the statistic of every run once. Expects a statistic that is never NaN. Throws
/// `std::invalid_argument` where there is no run.
template <typename Statistic>
    requires std::is_invocable_r_v<double, const Statistic&, std::span<const std::size_t>>
[[nodiscard]] interval bootstrap(std::size_t count, const Statistic& statistic, const bootstrap_options& options = {}) {
    if (count == 0 || options.resamples == 0) { throw std::invalid_argument("bootstrap: no runs or no resamples"); }
    std::vector<std::size_t> indices(count);
    for (std::size_t i = 0; i < count; ++i) { indices[i] = i; }
    const double estimate = statistic(indices);
    std::vector<double> again(options.resamples);
    for (std::size_t r = 0; r < options.resamples; ++r) {
        for (std::size_t i = 0; i < count; ++i) { indices[i] = detail::drawn_index(options.seed, r, i, count); }
        again[r] = statistic(indices);
    }
    std::sort(again.begin(), again.end());
    const double miss = (1 - options.confidence) / 2;
    return {estimate, sorted_quantile(again, miss), sorted_quantile(again, 1 - miss)};
}

/// The numbers that `indices` name.
[[nodiscard]] inline std::vector<double> pick(std::span<const double> values, std::span<const std::size_t> indices) {
    std::vector<double> picked;
    picked.reserve(indices.size());
    for (const std::size_t i : indices) { picked.push_back(values[i]); }
    return picked;
}

[[nodiscard]] inline double plain_mean(std::span<const double> values) { return mean_of(values).mean(); }

/// Interval of a ratio of centres, `centre(above) / centre(below)`, such as a speed-up over seeds; the two sets of runs
/// are drawn independently. `centre` is `median` or `plain_mean` or the caller's own.
template <typename Centre>
    requires std::is_invocable_r_v<double, const Centre&, std::span<const double>>
[[nodiscard]] interval bootstrap_ratio(std::span<const double> above, std::span<const double> below,
                                       const Centre& centre, const bootstrap_options& options = {}) {
    if (above.empty() || below.empty() || options.resamples == 0) {
        throw std::invalid_argument("bootstrap_ratio: no runs or no resamples");
    }
    const auto drawn = [&](std::span<const double> values, std::size_t resample, std::uint64_t side) {
        std::vector<double> again(values.size());
        for (std::size_t i = 0; i < again.size(); ++i) {
            again[i] = values[detail::drawn_index(mix(options.seed, side), resample, i, values.size())];
        }
        return again;
    };
    std::vector<double> ratios(options.resamples);
    for (std::size_t r = 0; r < options.resamples; ++r) {
        ratios[r] = centre(drawn(above, r, 1)) / centre(drawn(below, r, 2));
    }
    std::sort(ratios.begin(), ratios.end());
    const double miss = (1 - options.confidence) / 2;
    return {centre(above) / centre(below), sorted_quantile(ratios, miss), sorted_quantile(ratios, 1 - miss)};
}

}  // namespace aglow
