// Numbers gone bad, made from their bits at run time, so that no compiler flag can reason them away.
#pragma once

#include <bit>
#include <cstdint>

namespace hard_numbers {

template <typename T>
T of_bits(std::uint64_t bits) {
    const volatile std::uint64_t opaque = bits;
    if constexpr (sizeof(T) == 4) {
        return std::bit_cast<T>(static_cast<std::uint32_t>(opaque));
    } else {
        return std::bit_cast<T>(std::uint64_t{opaque});
    }
}

template <typename T>
inline constexpr std::uint64_t infinite_bits = sizeof(T) == 4 ? 0x7f800000u : 0x7ff0000000000000u;
template <typename T>
inline constexpr std::uint64_t sign_bit = std::uint64_t{1} << (8 * sizeof(T) - 1);

template <typename T>
T infinity() {
    return of_bits<T>(infinite_bits<T>);
}
template <typename T>
T minus_infinity() {
    return of_bits<T>(infinite_bits<T> | sign_bit<T>);
}
/// A quiet one.
template <typename T>
T nan() {
    return of_bits<T>(infinite_bits<T> | (infinite_bits<T> >> 1));
}
/// The one with the fewest bits set: signalling.
template <typename T>
T smallest_nan() {
    return of_bits<T>(infinite_bits<T> | 1);
}
template <typename T>
T minus_nan() {
    return of_bits<T>(infinite_bits<T> | (infinite_bits<T> >> 1) | sign_bit<T>);
}
template <typename T>
T largest() {
    return of_bits<T>(infinite_bits<T> - 1);
}
template <typename T>
T smallest() {
    return of_bits<T>(1);
}
template <typename T>
T minus_zero() {
    return of_bits<T>(sign_bit<T>);
}

}  // namespace hard_numbers
