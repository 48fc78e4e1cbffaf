// Points, directions and their smallest helpers: GLM's vectors with the scalar left open.
#pragma once

#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace aglow {

/// Two coordinates of scalar `T`, mostly a point of the unit square.
template <typename T>
using vec2 = glm::vec<2, T>;

/// A point, a direction or a normal of scalar `T`.
template <typename T>
using vec3 = glm::vec<3, T>;

/// Squared length of `v`.
template <typename T>
[[nodiscard]] constexpr T length2(const vec3<T>& v) {
    return v.x * v.x + v.y * v.y + v.z * v.z;
}

/// Squared distance between two points.
template <typename T>
[[nodiscard]] constexpr T distance2(const vec3<T>& a, const vec3<T>& b) {
    return length2(a - b);
}

/// Largest absolute coordinate of `v`: what the ulp of a position is measured by.
template <typename T>
[[nodiscard]] constexpr T max_abs(const vec3<T>& v) {
    // Maxima alone, which no processor has to guess.
    const T x = v.x > -v.x ? v.x : -v.x;
    const T y = v.y > -v.y ? v.y : -v.y;
    const T z = v.z > -v.z ? v.z : -v.z;
    const T larger = x > y ? x : y;
    return larger > z ? larger : z;
}

}  // namespace aglow
