// Unit directions in four bytes that are quick to turn into a frame: no root to take, and one division.
#pragma once

#include <cmath>
#include <cstdint>

#include <aglow/core/frame.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A unit direction, seen from the opposite pole of its hemisphere on the plane of the equator: (x, y) / (1 + |z|),
/// within the unit circle, and the hemisphere. Off by at most 7e-5 rad; the axes are exact.
class stereographic {
public:
    stereographic() = default;

    /// Expects `v` of any length whose square is a normal number.
    template <typename T>
    explicit stereographic(const vec3<T>& v) {
        const T scale = 1 / (std::sqrt(length2(v)) + std::abs(v.z));
        x_ = static_cast<std::int16_t>(std::lround(v.x * scale * T(32767)));
        y_ = static_cast<std::int16_t>(2 * std::lround(v.y * scale * T(16383)) + (v.z < 0 ? 1 : 0));
    }

    template <typename T>
    [[nodiscard]] vec3<T> direction() const {
        return turned<T>().normal;
    }
    template <typename T>
    [[nodiscard]] tilt<T> turned() const {
        return turned<T>(x_, y_);
    }

    /// The same from the integers it is kept as.
    template <typename T>
    [[nodiscard]] static tilt<T> turned(int x, int y) {
        const T u = static_cast<T>(x) * step_x<T>;
        const T v = static_cast<T>(y >> 1) * step_y<T>;
        const T side = static_cast<T>(1 - 2 * (y & 1));
        const T half = (1 + u * u + v * v) / 2;
        const T scale = 1 / half;
        // Rounding may carry a place across the circle: it lies on the equator then. By sums, since a compiler makes a
        // branch of max(x, 1) - 1.
        const T height = ((scale - 1) + std::abs(scale - 1)) / 2;
        const T inside = ((half + 1) - std::abs(half - 1)) / 2;
        // -1 / (side + z) = -side / scale
        return {{u * scale, v * scale, side * height}, side, -side * inside};
    }

    /// What the integers count.
    template <typename T>
    static constexpr T step_x = T(1) / T(32767);
    template <typename T>
    static constexpr T step_y = T(1) / T(16383);  ///< of all bits but the last, which tells the hemisphere

    friend bool operator==(const stereographic&, const stereographic&) = default;

private:
    std::int16_t x_{0};
    std::int16_t y_{0};
};

}  // namespace aglow
