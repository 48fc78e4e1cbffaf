// A value with a guess of how wrong it may be.
#pragma once

#include <cmath>
#include <concepts>

#include <aglow/concepts/spectrum.hpp>

namespace aglow {

/// An estimated spectrum and a cheap guess of its largest band's error: what biased methods know of their own bias and
/// noise, 0 where there is none but the sampling noise of the caller. A guess, no bound: an audit turns it into one.
///
/// `common` and `bias` tell what no number of pixels averages away; both are parts of the error that neighbours share.
template <Spectrum S>
struct estimate {
    S value{};
    band_of<S> error{};
    band_of<S> common{};  ///< standard deviation that all estimates from one map have together: its flux, its records
    band_of<S> bias{};    ///< by how much it may be too bright: noisy one by one, of use in the mean of many

    friend estimate operator+(const estimate& a, const estimate& b) {
        return {a.value + b.value, a.error + b.error, a.common + b.common, a.bias + b.bias};
    }
};

/// What all estimates from one map are off by together, relative to their value.
struct shared_error {
    double common{0};  ///< standard deviation
    double bias{0};    ///< signed: too bright is positive

    /// Both together, each sure of its own.
    friend shared_error operator+(const shared_error& a, const shared_error& b) {
        return {std::hypot(a.common, b.common), a.bias + b.bias};
    }

    /// The estimate of `value` that is off by this, and by `error` of its own (two standard deviations or so).
    template <Spectrum S>
    [[nodiscard]] estimate<S> on(const S& value, band_of<S> error) const {
        using B = band_of<S>;
        const B level = max_component(value);
        const B off = static_cast<B>(common) * level;
        return {value, std::hypot(error, 2 * off), off, static_cast<B>(bias) * level};
    }
};

}  // namespace aglow
