// Constants and tests of single numbers that hold under any compiler flag, -ffast-math included.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace aglow {

template <std::floating_point T>
inline constexpr T pi = T(3.14159265358979323846264338327950288L);

/// Whether `x` is neither infinite nor NaN. Looks at the bits, so -ffast-math cannot take it away.
template <std::floating_point T>
[[nodiscard]] constexpr bool is_finite(T x) {
    if constexpr (sizeof(T) == 4) {
        return (std::bit_cast<std::uint32_t>(x) & 0x7f800000u) != 0x7f800000u;
    } else {
        static_assert(sizeof(T) == 8, "float and double are the scalars of this library");
        return (std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000u) != 0x7ff0000000000000u;
    }
}

/// The largest number below one: where [0,1) ends.
template <std::floating_point T>
inline constexpr T one_below = T(1) - std::numeric_limits<T>::epsilon() / 2;

template <std::floating_point T>
[[nodiscard]] constexpr T square(T x) {
    return x * x;
}

}  // namespace aglow
