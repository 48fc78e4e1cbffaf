// Mean and variance of numbers that come one by one, safe where the mean is far larger than the spread.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include <aglow/core/numbers.hpp>

namespace aglow {

/// Collects numbers one by one in constant memory (Welford 1962). Two collections can be merged; merging in a fixed
/// order gives the same bits for any number of threads. What is not finite is counted and never summed.
class running_mean {
public:
    constexpr void add(double x) {
        if (!is_finite(x)) {
            ++rejected_;
            return;
        }
        ++count_;
        const double delta = x - mean_;
        mean_ += delta / static_cast<double>(count_);
        spread_ += delta * (x - mean_);
    }

    /// Adds all that `other` has seen (Chan, Golub & LeVeque 1979).
    constexpr void merge(const running_mean& other) {
        rejected_ += other.rejected_;
        if (other.count_ == 0) { return; }
        const double ours = static_cast<double>(count_);
        const double theirs = static_cast<double>(other.count_);
        const double delta = other.mean_ - mean_;
        mean_ += delta * theirs / (ours + theirs);
        spread_ += other.spread_ + delta * delta * ours * theirs / (ours + theirs);
        count_ += other.count_;
    }

    [[nodiscard]] constexpr std::uint64_t count() const { return count_; }

    /// How many numbers were turned away because they were infinite or NaN.
    [[nodiscard]] constexpr std::uint64_t rejected() const { return rejected_; }

    /// Mean of the numbers so far; 0 before the first.
    [[nodiscard]] constexpr double mean() const { return mean_; }

    /// Unbiased sample variance; infinite below two numbers, for then nothing is known.
    [[nodiscard]] constexpr double variance() const {
        if (count_ < 2) { return std::numeric_limits<double>::infinity(); }
        return spread_ / static_cast<double>(count_ - 1);
    }

    [[nodiscard]] double deviation() const { return std::sqrt(variance()); }

    /// Standard error of `mean()`; infinite below two numbers.
    [[nodiscard]] double standard_error() const {
        if (count_ < 2) { return std::numeric_limits<double>::infinity(); }
        return std::sqrt(variance() / static_cast<double>(count_));
    }

private:
    std::uint64_t count_{0};
    std::uint64_t rejected_{0};
    double mean_{0};
    double spread_{0};
};

[[nodiscard]] inline running_mean mean_of(std::span<const double> values) {
    running_mean all;
    for (const double x : values) { all.add(x); }
    return all;
}

}  // namespace aglow
