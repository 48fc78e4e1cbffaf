// What random numbers may do by chance: tests that state how often they would fail a right program.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace statistics {

/// Q(a, x) = Γ(a, x) / Γ(a), the regularised upper incomplete gamma function, to about 1e-14 (Abramowitz & Stegun 1964,
/// 6.5.29 below x = a + 1 and the continued fraction 6.5.31 above, by Lentz's method).
inline double upper_gamma(double a, double x) {
    if (!(x > 0)) { return 1; }
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a;
        double sum = term;
        for (double n = 1; term > sum * 1e-17; ++n) {
            term *= x / (a + n);
            sum += term;
        }
        return std::max(0.0, 1 - front * sum);
    }
    const double tiny = std::numeric_limits<double>::min() * 1e10;
    double b = x + 1 - a;
    double c = 1 / tiny;
    double d = 1 / b;
    double h = d;
    for (double n = 1; n < 10000; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = an * d + b;
        d = 1 / (std::abs(d) < tiny ? tiny : d);
        c = b + an / c;
        c = std::abs(c) < tiny ? tiny : c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) { break; }
    }
    return front * h;
}

/// How often a χ² of so many degrees of freedom is at least `chi2`.
inline double chi2_p(double chi2, double degrees) { return upper_gamma(degrees / 2, chi2 / 2); }

/// How often a standard normal number is at least `z` away from 0, on either side.
inline double normal_p(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

/// What a χ² test found. `p`: how often a right program does at least as badly; refuse below 1e-4 or so.
struct chi2_result {
    double chi2;
    double degrees;
    double p;
};

/// Pearson's test of `counts` against `expected` counts. Cells that expect fewer than 5 are pooled, rarest first; what
/// falls where nothing is expected gives p = 0.
inline chi2_result chi2_test(std::span<const double> counts, std::span<const double> expected) {
    std::vector<std::size_t> order(counts.size());
    for (std::size_t i = 0; i < order.size(); ++i) { order[i] = i; }
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    double chi2 = 0;
    double degrees = -1;
    double pooled_count = 0;
    double pooled_expected = 0;
    for (const std::size_t i : order) {
        if (expected[i] <= 0 && counts[i] > 0) { return {std::numeric_limits<double>::infinity(), 0, 0}; }
        pooled_count += counts[i];
        pooled_expected += expected[i];
        if (pooled_expected < 5) { continue; }
        chi2 += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
        degrees += 1;
        pooled_count = 0;
        pooled_expected = 0;
    }
    // What is left over expects less than 5 all together: at odds with it only if far too much fell there.
    if (pooled_count > 40) { return {std::numeric_limits<double>::infinity(), degrees, 0}; }
    return {chi2, degrees, degrees > 0 ? chi2_p(chi2, degrees) : 1};
}

/// The same against equal expectations.
inline chi2_result chi2_uniform(std::span<const double> counts) {
    double total = 0;
    for (const double c : counts) { total += c; }
    const std::vector<double> expected(counts.size(), total / static_cast<double>(counts.size()));
    return chi2_test(counts, expected);
}

/// The mean of what is added, its spread and how far it is from where it should be.
class sample_mean {
public:
    void add(double x) {
        ++n_;
        const double d = x - mean_;
        mean_ += d / static_cast<double>(n_);
        squares_ += d * (x - mean_);
    }
    [[nodiscard]] std::size_t count() const { return n_; }
    [[nodiscard]] double mean() const { return mean_; }
    [[nodiscard]] double variance() const { return n_ > 1 ? squares_ / static_cast<double>(n_ - 1) : 0; }
    [[nodiscard]] double standard_error() const { return n_ > 0 ? std::sqrt(variance() / static_cast<double>(n_)) : 0; }

    /// How many standard errors the mean is from `truth`; where nothing varies, 0 within the rounding and infinite
    /// beyond it.
    [[nodiscard]] double z(double truth, double rounding = 1e-6) const {
        const double off = std::abs(mean_ - truth);
        const double slack = rounding * std::max(std::abs(truth), std::abs(mean_));
        if (off <= slack) { return 0; }
        return standard_error() > 0 ? (off - slack) / standard_error() : std::numeric_limits<double>::infinity();
    }

    /// Whether the mean is within `sigmas` standard errors of `truth`: 4 fails a right program once in 16,000 times.
    [[nodiscard]] bool agrees(double truth, double sigmas = 4, double rounding = 1e-6) const {
        return z(truth, rounding) <= sigmas;
    }

private:
    std::size_t n_{0};
    double mean_{0};
    double squares_{0};
};

/// ∫ f over [a, b] by Gauss-Legendre with 5 nodes in each of `panels` equal panels.
template <typename F>
double integral(double a, double b, int panels, F&& f) {
    constexpr std::array<double, 5> node{0, 0.5384693101056831, -0.5384693101056831, 0.9061798459386640,
                                         -0.9061798459386640};
    constexpr std::array<double, 5> weight{0.5688888888888889, 0.4786286704993665, 0.4786286704993665,
                                           0.2369268850561891, 0.2369268850561891};
    const double half = (b - a) / (2 * panels);
    double sum = 0;
    for (int panel = 0; panel < panels; ++panel) {
        const double centre = a + half * (2 * panel + 1);
        for (std::size_t i = 0; i < node.size(); ++i) { sum += weight[i] * f(centre + half * node[i]); }
    }
    return sum * half;
}

}  // namespace statistics
