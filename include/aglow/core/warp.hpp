// Maps from the unit square to directions and points, each beside its density.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A point of the unit disc, uniform by area, neighbours staying neighbours (Shirley & Chiu 1997).
template <typename T>
[[nodiscard]] vec2<T> concentric_disc(const vec2<T>& u) {
    const T x = 2 * u.x - 1;
    const T y = 2 * u.y - 1;
    if (x == 0 && y == 0) { return {0, 0}; }
    const bool wide = std::abs(x) > std::abs(y);
    const T radius = wide ? x : y;
    const T angle = wide ? (pi<T> / 4) * (y / x) : pi<T> / 2 - (pi<T> / 4) * (x / y);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

template <typename T>
[[nodiscard]] constexpr T concentric_disc_pdf() {
    return 1 / pi<T>;
}

/// A unit direction around +z with density proportional to its cosine (Malley's method). Never below the horizon.
template <typename T>
[[nodiscard]] vec3<T> cosine_hemisphere(const vec2<T>& u) {
    const vec2<T> p = concentric_disc(u);
    // The largest float below one still leaves a cosine above zero, so a density is never 0.
    const T cosine2 = std::max(std::numeric_limits<T>::epsilon(), 1 - p.x * p.x - p.y * p.y);
    return {p.x, p.y, std::sqrt(cosine2)};
}

/// Per steradian; 0 below the horizon.
template <typename T>
[[nodiscard]] constexpr T cosine_hemisphere_pdf(T cosine) {
    return cosine > 0 ? cosine / pi<T> : T(0);
}

/// A unit direction, uniform over the sphere.
template <typename T>
[[nodiscard]] vec3<T> uniform_sphere(const vec2<T>& u) {
    const T z = 1 - 2 * u.x;
    const T radius = 2 * std::sqrt(std::max(T(0), u.x * (1 - u.x)));
    const T angle = 2 * pi<T> * u.y;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

template <typename T>
[[nodiscard]] constexpr T uniform_sphere_pdf() {
    return 1 / (4 * pi<T>);
}

/// A unit direction around +z, uniform over the hemisphere.
template <typename T>
[[nodiscard]] vec3<T> uniform_hemisphere(const vec2<T>& u) {
    const T radius = std::sqrt(std::max(T(0), u.x * (2 - u.x)));
    const T angle = 2 * pi<T> * u.y;
    return {radius * std::cos(angle), radius * std::sin(angle), 1 - u.x};
}

template <typename T>
[[nodiscard]] constexpr T uniform_hemisphere_pdf() {
    return 1 / (2 * pi<T>);
}

/// A unit direction around +z within a cone, uniform by solid angle. The cone is named by `1 - cos(half angle)`, which
/// stays exact for narrow cones.
template <typename T>
[[nodiscard]] vec3<T> uniform_cone(const vec2<T>& u, T one_minus_cosine) {
    const T h = u.x * one_minus_cosine;
    const T radius = std::sqrt(std::max(T(0), h * (2 - h)));
    const T angle = 2 * pi<T> * u.y;
    return {radius * std::cos(angle), radius * std::sin(angle), 1 - h};
}

/// Per steradian, inside the cone, which is no single direction.
template <typename T>
[[nodiscard]] constexpr T uniform_cone_pdf(T one_minus_cosine) {
    return 1 / (2 * pi<T> * one_minus_cosine);
}

/// Barycentric weights (of the second and third corner) of a point uniform over a triangle (Osada et al. 2002, (1)).
template <typename T>
[[nodiscard]] vec2<T> uniform_triangle(const vec2<T>& u) {
    const T root = std::sqrt(u.x);
    return {root * (1 - u.y), root * u.y};
}

/// Per area of a triangle of area `area`.
template <typename T>
[[nodiscard]] constexpr T uniform_triangle_pdf(T area) {
    return 1 / area;
}

}  // namespace aglow
