// Intervals and bounds on a mean: Student's, one that knows of skewness, and two that assume nothing but a range.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <aglow/core/numbers.hpp>
#include <aglow/report/distributions.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow {

/// An estimate and the ends of its confidence interval.
struct interval {
    double estimate{0};
    double low{0};
    double high{0};

    [[nodiscard]] constexpr bool contains(double x) const { return low <= x && x <= high; }
};

/// Student's two-sided interval for the mean behind `values`; infinitely wide below two values.
[[nodiscard]] inline interval student_interval(const running_mean& values, double confidence) {
    constexpr double endless = std::numeric_limits<double>::infinity();
    if (values.count() < 2) { return {values.mean(), -endless, endless}; }
    const double t = student_t_quantile(0.5 + confidence / 2, static_cast<double>(values.count() - 1));
    const double half = t * values.standard_error();
    return {values.mean(), values.mean() - half, values.mean() + half};
}

/// Third standardised moment of `values`; 0 where they do not vary.
[[nodiscard]] inline double skewness(std::span<const double> values) {
    const running_mean all = mean_of(values);
    if (values.size() < 3 || all.variance() <= 0) { return 0; }
    double cubes = 0;
    for (const double x : values) { cubes += std::pow((x - all.mean()) / all.deviation(), 3); }
    return cubes / static_cast<double>(values.size());
}

/// One-sided bound: the mean behind `values` lies below it with probability about `confidence`. Student's quantile
/// through the monotone transformation that takes the skewness out (Hall 1992, eq. 2.4); infinite below two values.
[[nodiscard]] inline double skewed_upper_bound(std::span<const double> values, double confidence) {
    const running_mean all = mean_of(values);
    if (all.count() < 2) { return std::numeric_limits<double>::infinity(); }
    const double n = static_cast<double>(all.count());
    const double t = student_t_quantile(confidence, n - 1) / std::sqrt(n);
    const double skew = skewness(values);
    if (std::abs(skew) < 1e-3) { return all.mean() + t * all.deviation(); }
    const double turned = 3 / skew * (std::cbrt(1 - skew * (t + skew / (6 * n))) - 1);
    return all.mean() - all.deviation() * turned;
}

/// Two-sided interval that reaches as far as Student's and as `skewed_upper_bound` on either side: the first is right
/// for symmetric laws with long tails, the second for skewed ones.
[[nodiscard]] inline interval cautious_interval(std::span<const double> values, double confidence) {
    const interval student = student_interval(mean_of(values), confidence);
    std::vector<double> mirrored(values.begin(), values.end());
    for (double& x : mirrored) { x = -x; }
    const double low = -skewed_upper_bound(mirrored, 0.5 + confidence / 2);
    const double high = skewed_upper_bound(values, 0.5 + confidence / 2);
    return {student.estimate, std::min(student.low, low), std::max(student.high, high)};
}

/// One-sided bound for a mean of values in [0, 1], valid for every distribution (Maurer & Pontil 2009, theorem 4).
[[nodiscard]] inline double empirical_bernstein_upper_bound(std::span<const double> values, double confidence) {
    const running_mean all = mean_of(values);
    if (all.count() < 2) { return 1; }
    const double n = static_cast<double>(all.count());
    const double log_odds = std::log(2 / (1 - confidence));
    return std::min(1.0, all.mean() + std::sqrt(2 * all.variance() * log_odds / n) + 7 * log_odds / (3 * (n - 1)));
}

namespace detail {

/// log of the wealth of a gambler who bets on every value being below `mean`, with stakes set by the values before.
[[nodiscard]] inline double log_wealth(std::span<const double> values, double mean, double confidence) {
    const double n = static_cast<double>(values.size());
    double wealth = 0;
    double sum = 0.5;
    double squares = 0.25;
    double seen = 1;
    for (const double x : values) {
        const double stake = std::sqrt(2 * -std::log(1 - confidence) / (n * squares / seen));
        wealth += std::log1p(-std::min(stake, 0.75) * (x - mean));
        sum += x;
        seen += 1;
        squares += square(x - sum / seen);
    }
    return wealth;
}

}  // namespace detail

/// One-sided bound for a mean of values in [0, 1], valid for every distribution and much sharper than Bernstein's where
/// values are mostly small: the largest mean against which betting has not won 1/(1 - confidence) times its stake
/// (Waudby-Smith & Ramdas 2024, one-sided predictable plug-in). The order of `values` must be that of drawing.
[[nodiscard]] inline double betting_upper_bound(std::span<const double> values, double confidence) {
    const double goal = -std::log(1 - confidence);
    const auto won = [&](double mean) { return detail::log_wealth(values, mean, confidence); };
    double low = std::clamp(mean_of(values).mean(), 0.0, 1.0);
    double high = 1;
    // The stakes do not depend on `mean`, so the wealth rises with it: refuted means stay refuted further up.
    for (int i = 0; i < 50; ++i) {
        const double mean = low / 2 + high / 2;
        (won(mean) < goal ? low : high) = mean;
    }
    return high;
}

}  // namespace aglow
