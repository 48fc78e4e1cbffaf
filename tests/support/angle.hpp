// The angle between two directions.
#pragma once

#include <cmath>

#include <aglow/core/vec.hpp>

namespace support {

/// In radians, between vectors of any length; exact for small angles.
template <typename T>
[[nodiscard]] double angle(const aglow::vec3<T>& a, const aglow::vec3<T>& b) {
    const aglow::vec3<double> u(a);
    const aglow::vec3<double> v(b);
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

}  // namespace support
