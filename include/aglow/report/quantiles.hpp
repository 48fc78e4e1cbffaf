// Quantiles of a sample, and a bound on the quantile of what the sample was drawn from.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <aglow/report/distributions.hpp>

namespace aglow {

/// The numbers of `values` in rising order. Expects no NaN.
[[nodiscard]] inline std::vector<double> sorted(std::span<const double> values) {
    std::vector<double> rising(values.begin(), values.end());
    std::sort(rising.begin(), rising.end());
    return rising;
}

/// The places of `values` by rising value, equal ones by their place. Expects no NaN.
[[nodiscard]] inline std::vector<std::size_t> rising_order(std::span<const double> values) {
    std::vector<std::size_t> order(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) { order[i] = i; }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return values[a] < values[b] || (a < b && values[a] == values[b]); });
    return order;
}

/// The p-quantile of numbers in rising order, linear between neighbours (Hyndman & Fan 1996, type 7); 0 of nothing.
[[nodiscard]] inline double sorted_quantile(std::span<const double> rising, double p) {
    if (rising.empty()) { return 0; }
    const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(rising.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, rising.size() - 1);
    const double share = place - static_cast<double>(below);
    // Between infinities there is nothing to go by: inf - inf.
    if (!(share > 0 && rising[below] < rising[above])) { return rising[below]; }
    return std::lerp(rising[below], rising[above], share);
}

/// The p-quantile of `values`; 0 of nothing. O(n log n).
[[nodiscard]] inline double quantile(std::span<const double> values, double p) {
    return sorted_quantile(sorted(values), p);
}

[[nodiscard]] inline double median(std::span<const double> values) { return quantile(values, 0.5); }

/// A number that the p-quantile of the distribution behind `values` exceeds with probability at most 1 - `confidence`,
/// whatever that distribution is: an order statistic chosen by the binomial law. Nothing where there are too few values
/// (fewer than 59 for p = confidence = 0.95).
[[nodiscard]] inline std::optional<double> quantile_upper_bound(std::span<const double> values, double p,
                                                                double confidence) {
    const std::vector<double> rising = sorted(values);
    const std::size_t n = rising.size();
    for (auto below = static_cast<std::size_t>(p * static_cast<double>(n)); below < n; ++below) {
        // The (below + 1)-th smallest is at or above the quantile unless more than `below` values lie under it.
        if (binomial_cdf(below, n, p) >= confidence) { return rising[below]; }
    }
    return std::nullopt;
}

}  // namespace aglow
