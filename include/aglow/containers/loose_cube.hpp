// A cube of an octree whose octants are loose: each may hold what reaches beyond it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// A cube from `middle - half` to `middle + half`. Octant i lies in the upper half of x, y or z where i has bit 0, 1
/// or 2.
template <typename T>
struct loose_cube {
    vec3<T> middle;
    T half;

    /// The cube around `p` on the grid of cubes that wide. Such cubes have no zero inside, and their midpoints are
    /// exact.
    [[nodiscard]] static loose_cube around(const vec3<T>& p, T half) {
        const T width = 2 * half;
        const auto middle_of = [width](T x) {
            const T below = std::floor(x / width);
            // A quotient of too small a number is 0, and its cube would lie on the other side.
            return ((x < 0 ? std::min(below, T(-1)) : below) + T(0.5)) * width;
        };
        return {{middle_of(p.x), middle_of(p.y), middle_of(p.z)}, half};
    }
    /// The one for a first sphere: at least twice as wide.
    [[nodiscard]] static loose_cube around_sphere(const vec3<T>& centre, T radius) {
        const T least = std::max(radius, max_abs(centre) * finest);
        return around(centre, std::ldexp(T(1), std::ilogb(least) + 2));
    }
    /// The cube twice as wide on whose grid this one is an octant.
    [[nodiscard]] loose_cube doubled() const { return around(middle, 2 * half); }

    /// Whether it has the centre of a sphere that is not wider than itself.
    [[nodiscard]] bool holds(const vec3<T>& centre, T radius) const {
        const vec3<T> low = middle - half;
        const vec3<T> high = middle + half;
        return radius <= half && centre.x >= low.x && centre.x < high.x && centre.y >= low.y && centre.y < high.y &&
               centre.z >= low.z && centre.z < high.z;
    }
    /// Whether its octants' midpoints are exact.
    [[nodiscard]] bool divisible() const { return half / 2 >= max_abs(middle) * finest; }

    [[nodiscard]] loose_cube octant(unsigned i) const {
        const T quarter = half / 2;
        return {middle + vec3<T>{i & 1u ? quarter : -quarter, i & 2u ? quarter : -quarter, i & 4u ? quarter : -quarter},
                quarter};
    }
    /// Which octant `p` lies in.
    [[nodiscard]] unsigned octant_of(const vec3<T>& p) const {
        return unsigned{p.x >= middle.x} | unsigned{p.y >= middle.y} << 1 | unsigned{p.z >= middle.z} << 2;
    }

    /// One bit for each octant that may hold a centre within `reach` of `p` along every axis.
    [[nodiscard]] unsigned octants_near(const vec3<T>& p, T reach) const {
        return halves_near(middle.x, p.x, reach, 0x55u) & halves_near(middle.y, p.y, reach, 0x33u) &
               halves_near(middle.z, p.z, reach, 0x0fu);
    }

private:
    // A cube is at least this wide beside its coordinates, which leaves its midpoint some bits to be exact.
    static constexpr T finest = 8 * std::numeric_limits<T>::epsilon();

    [[nodiscard]] unsigned halves_near(T at, T p, T reach, unsigned lower) const {
        const T low = p - reach;
        const T high = p + reach;
        const bool in_lower = low < at && high >= at - half;
        const bool in_upper = high >= at && low < at + half;
        return (in_lower ? lower : 0u) | (in_upper ? lower ^ 0xffu : 0u);
    }
};

}  // namespace aglow::detail
