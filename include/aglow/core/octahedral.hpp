// Unit directions in a few bytes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A unit direction as two signed integers of type `I`: the octahedral map (Cigolle et al. 2014, A Survey of Efficient
/// Representations for Independent Unit Vectors), read back at the centre of its cell.
template <typename I>
class basic_octahedral {
public:
    basic_octahedral() = default;

    /// Expects `v` of any length but zero, with a finite |x| + |y| + |z|.
    template <typename T>
    explicit basic_octahedral(const vec3<T>& v) {
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
        // The place on the unfolded octahedron, in [-1, 1]; rounds so that the largest number of steps is one.
        const vec2<T> at{static_cast<T>(x_) * (T(1) / T(largest)), static_cast<T>(y_) * (T(1) / T(largest))};
        const T z = 1 - std::abs(at.x) - std::abs(at.y);
        const T fold = z < 0 ? -z : T(0);
        const T x = at.x - sign(at.x) * fold;
        const T y = at.y - sign(at.y) * fold;
        const T scale = inverse_root(x * x + y * y + z * z);
        return {x * scale, y * scale, z * scale};
    }

    /// The direction times a length of its own, without a root or a division: for those who ask for a sign.
    template <typename T>
    [[nodiscard]] vec3<T> along() const {
        const int z = largest - std::abs(int{x_}) - std::abs(int{y_});
        const int fold = std::max(0, -z);
        const int x = x_ - (x_ < 0 ? -fold : fold);
        const int y = y_ - (y_ < 0 ? -fold : fold);
        return {static_cast<T>(x), static_cast<T>(y), static_cast<T>(z)};
    }

    friend bool operator==(const basic_octahedral&, const basic_octahedral&) = default;

private:
    static constexpr I largest = std::numeric_limits<I>::max();

    template <typename T>
    static T sign(T x) {
        return x < 0 ? T(-1) : T(1);
    }
    template <typename T>
    static I quantise(T x) {
        return static_cast<I>(std::lround(std::clamp(x, T(-1), T(1)) * T(largest)));
    }

    I x_{0};
    I y_{0};
};

/// Four bytes, off by at most 6.5e-5 rad.
using octahedral = basic_octahedral<std::int16_t>;
/// Two bytes, off by at most 0.0168 rad.
using coarse_octahedral = basic_octahedral<std::int8_t>;

}  // namespace aglow
