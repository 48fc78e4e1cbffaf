// A ray, and where it may start without meeting the surface that it leaves.
#pragma once

#include <limits>

#include <aglow/core/vec.hpp>

namespace aglow {

/// A half-line from `origin` along unit `direction`; whatever lies beyond `reach` does not matter to the asker.
template <typename T>
struct ray {
    vec3<T> origin{};
    vec3<T> direction{0, 0, 1};
    T reach{std::numeric_limits<T>::infinity()};
};

/// How far a computed hit may lie from the true surface, in scene units: a generous multiple of the rounding error of
/// a position in a scene whose largest coordinate is `extent`. Scales exactly with powers of two.
template <typename T>
[[nodiscard]] constexpr T position_error(T extent) {
    return extent * (64 * std::numeric_limits<T>::epsilon());
}

/// `point` moved by `error` along `normal` to the side that `direction` leaves on.
template <typename T>
[[nodiscard]] inline vec3<T> lift(const vec3<T>& point, const vec3<T>& normal, const vec3<T>& direction, T error) {
    return point + normal * (glm::dot(normal, direction) < 0 ? -error : error);
}

}  // namespace aglow
