// Three bands of light in four bytes: a byte for each and one exponent for all, rounded so that sums stay right.
//
// Ward 1991, Real Pixels; rounded up or down at random, since the nearest would shift the mean of many.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include <aglow/core/random.hpp>

namespace aglow {

/// Three bands, none negative, off by less than 1/127 of the largest, from 2^-126 to the largest float; smaller ones
/// become 0 or 2^-126 by chance. The mean over `word` is the value itself, and gray stays gray.
class shared_exponent {
public:
    shared_exponent() = default;

    /// Expects finite bands. `word`: uniform bits, the chance by which it is rounded.
    shared_exponent(const vec3<float>& v, std::uint64_t word) {
        const float top = std::max({v.x, v.y, v.z});
        // top = m 2^unit with m in [128, 256), or smaller than that; 255 is the most that a byte holds.
        int unit = std::max(static_cast<int>(std::bit_cast<std::uint32_t>(top) >> 23) - 134, -126);
        if (top * power_of_two(-unit) > 255 && unit < 120) { ++unit; }
        const vec3<float> x = v * power_of_two(-unit);
        const float chance = unit_interval<float>(word);
        x_ = rounded(x.x, chance);
        y_ = rounded(x.y, chance);
        z_ = rounded(x.z, chance);
        exponent_ = static_cast<std::uint8_t>(unit + 127);
    }

    [[nodiscard]] vec3<float> value() const {
        return vec3<float>{static_cast<float>(x_), static_cast<float>(y_), static_cast<float>(z_)} *
               power_of_two(exponent_ - 127);
    }

    friend bool operator==(const shared_exponent&, const shared_exponent&) = default;

private:
    /// 2^k, for k from -126 to 127.
    static float power_of_two(int k) { return std::bit_cast<float>(static_cast<std::uint32_t>(k + 127) << 23); }
    static std::uint8_t rounded(float x, float chance) {
        const int whole = static_cast<int>(x);
        return static_cast<std::uint8_t>(std::min(255, whole + (x - static_cast<float>(whole) > chance ? 1 : 0)));
    }

    std::uint8_t x_{0};
    std::uint8_t y_{0};
    std::uint8_t z_{0};
    std::uint8_t exponent_{1};
};

}  // namespace aglow
