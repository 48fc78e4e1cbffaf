// The distributions that confidence rests on: normal, beta, Student's t and binomial, with their quantiles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <aglow/core/log_gamma.hpp>
#include <aglow/core/numbers.hpp>

namespace aglow {

/// P(Z <= z) of a standard normal variable.
[[nodiscard]] inline double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

[[nodiscard]] inline double normal_pdf(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * pi<double>); }

namespace detail {

/// Solves `rising(x) = p` on [low, high] to the last bit by halving; `rising` must not fall.
template <typename F>
[[nodiscard]] double solve_rising(const F& rising, double p, double low, double high) {
    for (double x = low / 2 + high / 2; x > low && x < high; x = low / 2 + high / 2) {
        (rising(x) < p ? low : high) = x;
    }
    return low / 2 + high / 2;
}

/// The continued fraction of the incomplete beta function, by Lentz's method (Abramowitz & Stegun 26.5.8).
[[nodiscard]] inline double beta_fraction(double x, double a, double b) {
    constexpr double tiny = 1e-300;
    constexpr int terms = 10'000;
    const auto guarded = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1;
    double d = 1 / guarded(1 - (a + b) * x / (a + 1));
    double f = d;
    for (int i = 1; i < terms; ++i) {
        const double m = i;
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / guarded(1 + even * d);
        c = guarded(1 + even / c);
        f *= c * d;
        d = 1 / guarded(1 + odd * d);
        c = guarded(1 + odd / c);
        f *= c * d;
        if (std::abs(c * d - 1) < 1e-16) { break; }
    }
    return f;
}

}  // namespace detail

/// z with `normal_cdf(z)` = p; -inf and +inf at 0 and 1.
[[nodiscard]] inline double normal_quantile(double p) {
    if (p <= 0) { return -std::numeric_limits<double>::infinity(); }
    if (p >= 1) { return std::numeric_limits<double>::infinity(); }
    return p > 0.5 ? -normal_quantile(1 - p) : detail::solve_rising(normal_cdf, p, -40, 1);
}

/// P(X <= x) of a Beta(a, b) variable: the regularised incomplete beta function. Expects a, b > 0.
[[nodiscard]] inline double beta_cdf(double x, double a, double b) {
    if (x <= 0) { return 0; }
    if (x >= 1) { return 1; }
    if (x > (a + 1) / (a + b + 2)) { return 1 - beta_cdf(1 - x, b, a); }
    const double scale = log_gamma(a + b) - log_gamma(a) - log_gamma(b);
    return std::exp(scale + a * std::log(x) + b * std::log1p(-x)) / a * detail::beta_fraction(x, a, b);
}

/// x with `beta_cdf(x, a, b)` = p.
[[nodiscard]] inline double beta_quantile(double p, double a, double b) {
    return detail::solve_rising([&](double x) { return beta_cdf(x, a, b); }, p, 0, 1);
}

/// P(T <= t) of Student's t with `freedom` > 0 degrees of freedom (Abramowitz & Stegun 26.7.1).
[[nodiscard]] inline double student_t_cdf(double t, double freedom) {
    const double tail = 0.5 * beta_cdf(freedom / (freedom + t * t), freedom / 2, 0.5);
    return t > 0 ? 1 - tail : tail;
}

/// t with `student_t_cdf(t, freedom)` = p; -inf and +inf at 0 and 1.
[[nodiscard]] inline double student_t_quantile(double p, double freedom) {
    if (p > 0.5) { return -student_t_quantile(1 - p, freedom); }
    if (p <= 0) { return -std::numeric_limits<double>::infinity(); }
    double low = -2;
    while (student_t_cdf(low, freedom) > p) { low *= 2; }
    return detail::solve_rising([&](double t) { return student_t_cdf(t, freedom); }, p, low, 0);
}

/// P(X <= hits) of a binomial variable: `trials` tries that succeed with probability `p`.
[[nodiscard]] inline double binomial_cdf(std::uint64_t hits, std::uint64_t trials, double p) {
    if (hits >= trials) { return 1; }
    return 1 - beta_cdf(p, static_cast<double>(hits) + 1, static_cast<double>(trials - hits));
}

/// The largest success probability that `hits` of `trials` still allow at `confidence` (Clopper & Pearson 1934).
[[nodiscard]] inline double binomial_upper_bound(std::uint64_t hits, std::uint64_t trials, double confidence) {
    if (hits >= trials) { return 1; }
    return beta_quantile(confidence, static_cast<double>(hits) + 1, static_cast<double>(trials - hits));
}

}  // namespace aglow
