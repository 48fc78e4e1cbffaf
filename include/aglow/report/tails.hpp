// Signs that a mean rests on a few huge numbers, so that no interval around it can be believed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <aglow/report/quantiles.hpp>

namespace aglow {

/// Index k of the tail of the magnitudes of `values`, P(|X| > x) ~ x^(-1/k), from its `top` largest (Hill 1975): the
/// variance is infinite above 1/2, the mean above 1. 0 where fewer than `top` + 1 values are positive.
[[nodiscard]] inline double hill_index(std::span<const double> values, std::size_t top) {
    std::vector<double> sizes;
    for (const double x : values) {
        if (x != 0) { sizes.push_back(std::abs(x)); }
    }
    if (top == 0 || sizes.size() <= top) { return 0; }
    const std::vector<double> rising = sorted(sizes);
    const std::size_t last = rising.size() - 1;
    double logs = 0;
    for (std::size_t i = 0; i < top; ++i) { logs += std::log(rising[last - i] / rising[last - top]); }
    return logs / static_cast<double>(top);
}

/// Share of the largest magnitude in the sum of all; 0 where all are zero.
[[nodiscard]] inline double largest_share(std::span<const double> values) {
    double sum = 0;
    double largest = 0;
    for (const double x : values) {
        sum += std::abs(x);
        largest = std::max(largest, std::abs(x));
    }
    return sum > 0 ? largest / sum : 0;
}

}  // namespace aglow
