// Unit directions as three small integers: quick to read back, with no root to take.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include <aglow/core/vec.hpp>

namespace aglow {

/// A unit direction as three signed integers of type `I`; reads back within half a step, not renormalised.
/// Six bytes of int16_t are right to 3e-5 rad, three of int8_t to 0.008 rad.
template <typename I>
class packed_direction {
public:
    packed_direction() = default;

    template <typename T>
    explicit packed_direction(const vec3<T>& v) : x_{pack(v.x)}, y_{pack(v.y)}, z_{pack(v.z)} {}

    template <typename T>
    [[nodiscard]] vec3<T> direction() const {
        return vec3<T>{static_cast<T>(x_), static_cast<T>(y_), static_cast<T>(z_)} * (1 / T(largest));
    }

    /// The direction times `length()`: for those who ask for a sign.
    template <typename T>
    [[nodiscard]] vec3<T> along() const {
        return {static_cast<T>(x_), static_cast<T>(y_), static_cast<T>(z_)};
    }
    template <typename T>
    [[nodiscard]] static constexpr T length() {
        return T(largest);
    }

    friend bool operator==(const packed_direction&, const packed_direction&) = default;

private:
    static constexpr I largest = std::numeric_limits<I>::max();

    template <typename T>
    static I pack(T x) {
        return static_cast<I>(std::lround((x < -1 ? T(-1) : x > 1 ? T(1) : x) * T(largest)));
    }

    I x_{};
    I y_{};
    I z_{};
};

}  // namespace aglow
