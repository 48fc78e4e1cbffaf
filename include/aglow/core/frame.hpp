// An orthonormal frame around a direction, without branches or singularities.
#pragma once

#include <cmath>

#include <aglow/core/vec.hpp>

namespace aglow {

/// What turns the world into the frame of a unit normal, by half the work of its axes where these are not asked for.
/// Continuous on each side of the equator z = 0, where x and y jump (Duff et al. 2017, Building an Orthonormal Basis,
/// Revisited, listing 3).
template <typename T>
struct tilt {
    vec3<T> normal;
    T side;  ///< of the equator: 1 or -1
    T a;     ///< -1 / (side + normal.z)

    /// A vector of the world in the frame's coordinates.
    [[nodiscard]] vec3<T> to_local(const vec3<T>& v) const {
        const T along = normal.x * v.x + normal.y * v.y;
        const T lean = a * along - v.z;
        return {v.x + side * (normal.x * lean), side * v.y + normal.y * lean, along + normal.z * v.z};
    }
};

/// Right-handed orthonormal axes whose `z` is a given unit direction, usually a surface normal.
template <typename T>
struct frame {
    vec3<T> x{1, 0, 0};
    vec3<T> y{0, 1, 0};
    vec3<T> z{0, 0, 1};

    frame() = default;

    /// Expects unit `normal`.
    explicit frame(const vec3<T>& normal) : z{normal} {
        const T side = std::copysign(T(1), normal.z);
        const T a = T(-1) / (side + normal.z);
        const T b = normal.x * normal.y * a;
        x = {T(1) + side * normal.x * normal.x * a, side * b, -side * normal.x};
        y = {b, side + normal.y * normal.y * a, -normal.y};
    }
    /// The same of what is known of it by now; written out, since one through the other is more code in every path.
    explicit frame(const tilt<T>& t) : z{t.normal} {
        const T b = z.x * z.y * t.a;
        x = {T(1) + t.side * z.x * z.x * t.a, t.side * b, -t.side * z.x};
        y = {b, t.side + z.y * z.y * t.a, -z.y};
    }

    /// A vector given in this frame's coordinates, in the world's.
    [[nodiscard]] vec3<T> to_world(const vec3<T>& v) const { return x * v.x + y * v.y + z * v.z; }

    /// A vector of the world in this frame's coordinates.
    [[nodiscard]] vec3<T> to_local(const vec3<T>& v) const { return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)}; }
};

}  // namespace aglow
