// An orthonormal frame around a direction, without branches or singularities.
#pragma once

#include <cmath>

#include <aglow/core/vec.hpp>

namespace aglow {

/// Right-handed orthonormal axes whose `z` is a given unit direction, usually a surface normal.
template <typename T>
struct frame {
    vec3<T> x{1, 0, 0};
    vec3<T> y{0, 1, 0};
    vec3<T> z{0, 0, 1};

    frame() = default;

    /// Expects unit `normal`. Continuous on each side of the equator z = 0, where x and y jump (Duff et al. 2017,
    /// Building an Orthonormal Basis, Revisited, listing 3).
    explicit frame(const vec3<T>& normal) : z{normal} {
        const T sign = std::copysign(T(1), normal.z);
        const T a = T(-1) / (sign + normal.z);
        const T b = normal.x * normal.y * a;
        x = {T(1) + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
        y = {b, sign + normal.y * normal.y * a, -normal.y};
    }

    /// A vector given in this frame's coordinates, in the world's.
    [[nodiscard]] vec3<T> to_world(const vec3<T>& v) const { return x * v.x + y * v.y + z * v.z; }

    /// A vector of the world in this frame's coordinates.
    [[nodiscard]] vec3<T> to_local(const vec3<T>& v) const { return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)}; }
};

}  // namespace aglow
