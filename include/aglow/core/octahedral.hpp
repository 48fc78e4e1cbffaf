// Unit directions in a few bytes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A unit direction in four bytes, off by at most 6.5e-5 rad: the octahedral map with 16 bits an axis
/// (Cigolle et al. 2014, A Survey of Efficient Representations for Independent Unit Vectors).
class octahedral {
public:
    octahedral() = default;

    /// Expects `v` of any length but zero, finite.
    template <typename T>
    explicit octahedral(const vec3<T>& v) {
        const T sum = std::abs(v.x) + std::abs(v.y) + std::abs(v.z);
        T x = v.x / sum;
        T y = v.y / sum;
        if (v.z < 0) {
            const T folded = (1 - std::abs(y)) * sign(x);
            y = (1 - std::abs(x)) * sign(y);
            x = folded;
        }
        x_ = quantise(x);
        y_ = quantise(y);
    }

    template <typename T>
    [[nodiscard]] vec3<T> direction() const {
        return unfolded(folded<T>());
    }

    /// The place on the unfolded octahedron, in [-1, 1].
    template <typename T>
    [[nodiscard]] vec2<T> folded() const {
        // Rounds so that 32767 steps are one.
        return {static_cast<T>(x_) * (T(1) / T(32767)), static_cast<T>(y_) * (T(1) / T(32767))};
    }
    /// The direction of such a place.
    template <typename T>
    [[nodiscard]] static vec3<T> unfolded(const vec2<T>& at) {
        const T z = 1 - std::abs(at.x) - std::abs(at.y);
        const T fold = z < 0 ? -z : T(0);
        const T x = at.x - sign(at.x) * fold;
        const T y = at.y - sign(at.y) * fold;
        const T scale = inverse_root(x * x + y * y + z * z);
        return {x * scale, y * scale, z * scale};
    }

    friend bool operator==(const octahedral&, const octahedral&) = default;

private:
    template <typename T>
    static T sign(T x) {
        return x < 0 ? T(-1) : T(1);
    }
    template <typename T>
    static std::int16_t quantise(T x) {
        return static_cast<std::int16_t>(std::lround(std::clamp(x, T(-1), T(1)) * T(32767)));
    }

    std::int16_t x_{0};
    std::int16_t y_{0};
};

}  // namespace aglow
