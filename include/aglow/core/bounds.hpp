// An axis-aligned box that grows.
#pragma once

#include <limits>

#include <aglow/core/vec.hpp>

namespace aglow {

/// An axis-aligned box; a fresh one is empty (`low > high`) and takes the shape of what is added.
template <typename T>
struct bounds {
    vec3<T> low{std::numeric_limits<T>::max()};
    vec3<T> high{std::numeric_limits<T>::lowest()};

    [[nodiscard]] constexpr bool empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
    [[nodiscard]] constexpr vec3<T> centre() const { return low * T(0.5) + high * T(0.5); }
    [[nodiscard]] constexpr vec3<T> extent() const { return empty() ? vec3<T>{} : high - low; }

    /// Length of the diagonal; 0 for an empty box or a single point.
    [[nodiscard]] T diagonal() const {
        const T longest = max_abs(extent());
        // In units of the longest side: squares of very small or very large lengths leave the range of floats.
        return longest > 0 ? longest * glm::length(extent() / longest) : T(0);
    }

    /// Radius of the sphere around `centre()` that holds the box.
    [[nodiscard]] T radius() const { return diagonal() / 2; }

    [[nodiscard]] constexpr bool contains(const vec3<T>& p) const {
        return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
    }

    constexpr void add(const vec3<T>& p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    constexpr void add(const bounds& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

/// The share of the box's size that coordinates of scalar `T` cannot tell there: an ulp of the farthest corner over the
/// diagonal. Above 1 % a scene lies too far from the origin for its scalar. 0 for an empty box, 1 for a single point.
template <typename T>
[[nodiscard]] T coordinate_loss(const bounds<T>& box) {
    if (box.empty()) { return T(0); }
    const T low = max_abs(box.low);
    const T high = max_abs(box.high);
    const T ulp = (low > high ? low : high) * std::numeric_limits<T>::epsilon();
    const T size = box.diagonal();
    return ulp < size ? ulp / size : T(1);
}

}  // namespace aglow
