// A value with a guess of how wrong it may be.
#pragma once

#include <concepts>

#include <aglow/concepts/spectrum.hpp>

namespace aglow {

/// An estimated spectrum and a cheap guess of its largest band's error: what biased methods know of their own bias and
/// noise, 0 where there is none but the sampling noise of the caller. A guess, no bound: an audit turns it into one.
template <Spectrum S>
struct estimate {
    S value{};
    band_of<S> error{};

    friend estimate operator+(const estimate& a, const estimate& b) { return {a.value + b.value, a.error + b.error}; }
};

}  // namespace aglow
