// Russian roulette: paths end at random instead of at a fixed depth, and the survivors carry for the rest.
#pragma once

#include <algorithm>
#include <concepts>

#include <aglow/core/numbers.hpp>

namespace aglow {

/// The probability to go on when the largest component of the throughput goes from `before` to `after`
/// (Arvo & Kirk 1990): divided by it, the largest component of a survivor is no larger than `before` or `after`, unless
/// `ceiling` is below one. 0 for a path that is black, or not finite. Below 2^-24 random numbers of `float` go on too
/// often, as with 2^-24: by surfaces that reflect less than that.
template <std::floating_point T>
[[nodiscard]] constexpr T survival(T before, T after, T ceiling = T(1)) {
    if (!is_finite(after) || !is_finite(before) || after <= 0 || before <= 0) { return T(0); }
    return std::min(ceiling, after / before);
}

}  // namespace aglow
