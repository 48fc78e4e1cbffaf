// How far a picture is from its reference, by measures with one fixed meaning each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include <aglow/core/numbers.hpp>
#include <aglow/report/image_view.hpp>
#include <aglow/report/quantiles.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow {

struct image_error_options {
    /// ε of relMSE, added to the squared reference: a convention in the picture's own unit squared, not a tolerance.
    double epsilon = 0.01;
    /// Added to the denominators of relative errors, as a share of the reference's mean value: keeps black pixels
    /// finite.
    double dark = 0.02;
    /// Share of the pixel values with the largest squared errors that `relmse_trimmed` leaves out.
    double trimmed = 0.001;
};

/// Measures over all pixels and channels; I is the picture, R the reference, δ = `dark` · mean R.
struct image_error {
    double mape{0};            ///< mean of |I−R| / (|R| + δ); infinite where all of R is black and I is not
    double smape{0};           ///< mean of |I−R| / ((|I|+|R|)/2 + δ)
    double relmse{0};          ///< mean of (I−R)² / (R² + ε)
    double relmse_trimmed{0};  ///< the same without the largest `trimmed` of the terms
    double mse{0};             ///< mean of (I−R)²; below zero by chance where two halves of a reference are given
    double rmse{0};            ///< square root of `mse`, 0 where that is negative
    double energy_bias{0};     ///< (ΣI − ΣR) / ΣR, signed; 0 where ΣR is 0
    double relative_q50{0};    ///< median of |I−R| / (|R| + δ)
    double relative_q95{0};    ///< 95 % quantile of the same
    double relative_q99{0};    ///< 99 % quantile of the same
    double relative_max{0};    ///< largest of the same
    double absolute_max{0};    ///< largest |I−R|
    double reference_mape{0};  ///< noise of the reference, mean of |R1−R2|/2 / (|R| + δ); 0 where there is one only
    double reference_relmse{0};  ///< noise of the reference, mean of (R1−R2)²/4 / (R² + ε); 0 where there is one only
    std::size_t broken{0};       ///< pixels of the picture with an infinite or NaN channel; left out of all else
    std::size_t broken_reference{0};  ///< pixels of the reference of that kind; left out too
    std::size_t pixels{0};            ///< pixels that took part
};

namespace detail {

/// The sums and lists from which the measures are made, filled value by value.
class error_tally {
public:
    error_tally(const image_error_options& options, double mean) : options_{options}, floor_{options.dark * mean} {}

    /// `first` and `second` are independent halves of the reference, or the same number twice.
    void add(double value, double first, double second) {
        const double truth = 0.5 * first + 0.5 * second;
        const double gap = std::abs(value - truth);
        const double product = (value - first) * (value - second);  // mean is the squared error, without their noise
        const double half = 0.5 * std::abs(first - second);
        relative_.push_back(gap == 0 ? 0 : gap / (std::abs(truth) + floor_));
        squares_.push_back(gap * gap / (truth * truth + options_.epsilon));
        terms_.push_back(product / (truth * truth + options_.epsilon));
        smape_.add(gap == 0 ? 0 : gap / (0.5 * (std::abs(value) + std::abs(truth)) + floor_));
        mse_.add(product);
        value_.add(value);
        truth_.add(truth);
        noise_.add(half == 0 ? 0 : half / (std::abs(truth) + floor_));
        noise2_.add(half * half / (truth * truth + options_.epsilon));
        largest_ = std::max(largest_, gap);
    }

    [[nodiscard]] image_error result() {
        if (relative_.empty()) { return of_nothing(); }
        image_error e{};
        const running_mean relative = mean_of(relative_);
        e.mape = relative.rejected() > 0 ? std::numeric_limits<double>::infinity() : relative.mean();
        e.smape = smape_.mean();
        e.mse = mse_.mean();
        e.rmse = std::sqrt(std::max(0.0, e.mse));
        e.energy_bias = truth_.mean() == 0 ? 0 : (value_.mean() - truth_.mean()) / truth_.mean();
        e.reference_mape = noise_.mean();
        e.reference_relmse = noise2_.mean();
        e.absolute_max = largest_;
        add_quantiles(e);
        add_squares(e);
        return e;
    }

private:
    /// Of a picture that no pixel can be used of.
    static image_error of_nothing() {
        constexpr double endless = std::numeric_limits<double>::infinity();
        image_error e{};
        for (double* error : {&e.mape, &e.smape, &e.relmse, &e.relmse_trimmed, &e.mse, &e.rmse, &e.relative_q50,
                              &e.relative_q95, &e.relative_q99, &e.relative_max, &e.absolute_max}) {
            *error = endless;
        }
        return e;
    }

    void add_quantiles(image_error& e) {
        std::sort(relative_.begin(), relative_.end());
        e.relative_q50 = sorted_quantile(relative_, 0.50);
        e.relative_q95 = sorted_quantile(relative_, 0.95);
        e.relative_q99 = sorted_quantile(relative_, 0.99);
        e.relative_max = sorted_quantile(relative_, 1.00);
    }

    void add_squares(image_error& e) {
        const auto left_out = static_cast<std::size_t>(options_.trimmed * static_cast<double>(terms_.size()));
        running_mean all;
        std::size_t larger = terms_.size();
        for (const std::size_t i : rising_order(squares_)) {
            all.add(terms_[i]);
            if (--larger == left_out) { e.relmse_trimmed = all.mean(); }
        }
        e.relmse = all.mean();
    }

    image_error_options options_;
    double floor_;
    std::vector<double> relative_{};
    std::vector<double> squares_{};
    std::vector<double> terms_{};  ///< the squares without the noise of the halves
    running_mean smape_{}, mse_{}, value_{}, truth_{}, noise_{}, noise2_{};
    double largest_{0};
};

}  // namespace detail

/// The errors of `image` against a reference given as two independent halves, whose noise cancels out of all squared
/// measures: the mean of (I−R1)(I−R2) is the squared error of I, whatever the halves' noise. The other measures use the
/// mean of the halves. Throws `std::invalid_argument` for pictures of different shapes or options out of range.
template <std::floating_point T, std::floating_point U>
[[nodiscard]] image_error compare(const image_view<T>& image, const image_view<U>& first, const image_view<U>& second,
                                  const image_error_options& options = {}) {
    require_same_shape(image, first, "reference");
    require_same_shape(image, second, "second half of the reference");
    if (!(options.trimmed >= 0 && options.trimmed < 1)) { throw std::invalid_argument("trimmed: not in [0, 1)"); }
    if (!(options.epsilon > 0)) { throw std::invalid_argument("epsilon: not positive"); }
    if (!(options.dark > 0)) { throw std::invalid_argument("dark: not positive"); }
    detail::error_tally tally{options, 0.5 * mean_value(first) + 0.5 * mean_value(second)};
    std::size_t used = 0;
    std::size_t broken = 0;
    std::size_t broken_reference = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const bool known = first.finite(i) && second.finite(i);
        broken += image.finite(i) ? 0 : 1;
        broken_reference += known ? 0 : 1;
        if (!known || !image.finite(i)) { continue; }
        ++used;
        for (std::size_t c = 0; c < image.channels; ++c) { tally.add(image.at(i, c), first.at(i, c), second.at(i, c)); }
    }
    image_error e = tally.result();
    e.pixels = used;
    e.broken = broken;
    e.broken_reference = broken_reference;
    return e;
}

/// The errors of `image` against a reference that is taken as the truth.
template <std::floating_point T, std::floating_point U>
[[nodiscard]] image_error compare(const image_view<T>& image, const image_view<U>& reference,
                                  const image_error_options& options = {}) {
    return compare(image, reference, reference, options);
}

}  // namespace aglow
