// Russian roulette: paths end at random instead of at a fixed depth, and the survivors carry for the rest.
#pragma once

#include <algorithm>

namespace aglow {

/// The probability to go on when the largest component of the throughput goes from `before` to `after`
/// (Arvo & Kirk 1990): divided by it, the largest component of a survivor is no larger than before, unless `ceiling` is
/// below one. 0 for a black path.
template <typename T>
[[nodiscard]] constexpr T survival(T before, T after, T ceiling = T(1)) {
    if (!(after > 0) || !(before > 0)) { return T(0); }
    return std::min(ceiling, after / before);
}

}  // namespace aglow
