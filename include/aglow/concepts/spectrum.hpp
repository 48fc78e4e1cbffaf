// What a host's colour must be able to do.
#pragma once

#include <concepts>
#include <type_traits>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A gray value is its own largest component.
template <std::floating_point T>
[[nodiscard]] constexpr T max_component(T a) {
    return a;
}

/// The largest component; one that is infinite or NaN wins.
template <std::floating_point T>
[[nodiscard]] constexpr T max_component(const vec3<T>& a) {
    if (!is_finite(a.x)) { return a.x; }
    if (!is_finite(a.y)) { return a.y; }
    if (!is_finite(a.z)) { return a.z; }
    const T m = a.x > a.y ? a.x : a.y;
    return m > a.z ? m : a.z;
}

/// A spectrum: radiance, irradiance, power or reflectance in as many bands as the host likes.
///
/// `S{}` is black; `a + b`, `a * b` (band by band) and `a * k` (a scalar) give spectra; `max_component(a)`, found by
/// argument-dependent lookup, is the largest band.
/// Must be true: + and * commute; black + a = a; a band that is infinite or NaN is what `max_component` returns.
template <typename S>
concept Spectrum = std::regular<S> && requires(const S& a, const S& b) {
    { max_component(a) } -> std::floating_point;
    { a + b } -> std::convertible_to<S>;
    { (a * b) } -> std::convertible_to<S>;
    { (a * max_component(b)) } -> std::convertible_to<S>;
};

/// The scalar that a spectrum's bands are made of.
template <Spectrum S>
using band_of = decltype(max_component(S{}));

/// What very many of a spectrum are summed in: double where it is ours to choose, the host's own as it is.
template <typename S>
struct long_sum {
    using type = S;
};
template <>
struct long_sum<float> {
    using type = double;
};
template <>
struct long_sum<vec3<float>> {
    using type = vec3<double>;
};

/// Whether every band is finite and none is negative: the test at the door of every sum.
template <Spectrum S>
[[nodiscard]] constexpr bool is_radiance(const S& a) {
    const band_of<S> high = max_component(a);
    const band_of<S> low = max_component(S(a * band_of<S>(-1)));
    return is_finite(high) && is_finite(low) && low <= 0;
}

template <Spectrum S>
[[nodiscard]] constexpr bool is_black(const S& a) {
    return max_component(a) <= 0;
}

/// The spectrum whose every band is one, made of black: what multiplies without change.
/// `white(std::type_identity<S>)`, found by argument-dependent lookup, where the host has it; else `S(k)`, which must
/// then fill all bands. An aggregate is never made so: its `S(k)` would be one band of light and the rest black.
template <Spectrum S>
[[nodiscard]] constexpr S white() {
    if constexpr (requires {
                      { white(std::type_identity<S>{}) } -> std::convertible_to<S>;
                  }) {
        return white(std::type_identity<S>{});
    } else {
        static_assert(std::constructible_from<S, band_of<S>> && !std::is_aggregate_v<S>,
                      "this spectrum needs an overload of white(std::type_identity<S>) beside it");
        return S(band_of<S>(1));
    }
}

}  // namespace aglow
