// The logarithm of the gamma function, safe from many threads.
#pragma once

#include <cmath>

#include <aglow/core/numbers.hpp>

namespace aglow {

/// log Γ(x) for x > 0, without the global that `std::lgamma` writes (Stirling's series after a shift past 16).
[[nodiscard]] inline double log_gamma(double x) {
    double shift = 0;
    for (; x < 16; x += 1) { shift += std::log(x); }
    const double y = 1 / (x * x);
    const double series = (1.0 / 12 - y * (1.0 / 360 - y * (1.0 / 1260 - y * (1.0 / 1680 - y / 1188)))) / x;
    return (x - 0.5) * std::log(x) - x + 0.5 * std::log(2 * pi<double>) + series - shift;
}

}  // namespace aglow
