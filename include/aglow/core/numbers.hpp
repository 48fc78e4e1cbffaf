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

/// 1 / sqrt(x) within two ulp, exact for powers of four, and finite for 0; too small for what is less than 2^30 times
/// the least normal number. Unlike std::sqrt it has no errno to set, so that a compiler may work out a row of them side
/// by side. Expects finite `x` >= 0.
template <std::floating_point T>
[[nodiscard]] constexpr T inverse_root(T x) {
    using bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    constexpr bits magic = sizeof(T) == 4 ? bits(0x5f3759dfu) : bits(0x5fe6eb50c7b537a9u);
    // Zero goes to no infinity, without a branch; half of this is no subnormal number, which would be slow.
    const T a = x + 16 * std::numeric_limits<T>::min();
    T y = std::bit_cast<T>(static_cast<bits>(magic - (std::bit_cast<bits>(a) >> 1)));
    // Newton: 3e-2, 2e-3, 5e-6, 3e-11; the last step by its remainder, which loses no bits.
    for (int i = 0; i < (sizeof(T) == 4 ? 2 : 3); ++i) { y = y * (T(1.5) - T(0.5) * a * y * y); }
    return y + y * (T(0.5) * (1 - a * y * y));
}

/// sqrt(x) within three ulp, with no errno to set; too small where `inverse_root` is, and 0 for 0. Expects finite
/// `x` >= 0.
template <std::floating_point T>
[[nodiscard]] constexpr T root(T x) {
    return x * inverse_root(x);
}

}  // namespace aglow
