// Sixteen boxes in a few bytes each, asked all at once which of them meet another.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// Up to sixteen boxes, in steps of 1/255 of the box around them all.
template <typename T>
struct packed_boxes {
    static constexpr unsigned lanes = simd::lanes;

    vec3<T> origin;
    vec3<T> steps_per_length;
    std::array<std::uint8_t, lanes> low[3];
    std::array<std::uint8_t, lanes> high[3];

    /// Packs `boxes`, which lie in `all`.
    void pack(std::span<const bounds<T>> boxes, const bounds<T>& all) {
        origin = all.low;
        const vec3<T> extent = all.extent();
        for (int axis = 0; axis < 3; ++axis) {
            // Never 0: an endless length times that would be no number.
            steps_per_length[axis] = std::numeric_limits<T>::min();
            if (extent[axis] > 0) { steps_per_length[axis] = std::max(steps_per_length[axis], T(255) / extent[axis]); }
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                low[axis][i] = step((boxes[i].low[axis] - origin[axis]) * steps_per_length[axis]);
                high[axis][i] = step((boxes[i].high[axis] - origin[axis]) * steps_per_length[axis]);
            }
        }
    }

    /// One bit for each box that meets `asked`, and maybe for some that only nearly do; lanes without a box say
    /// anything. Rounding is no danger: the steps of a box and those of what is asked come from the same monotone
    /// function.
    [[nodiscard]] std::uint32_t near(const bounds<T>& asked) const {
        const vec3<T> from = (asked.low - origin) * steps_per_length;
        const vec3<T> to = (asked.high - origin) * steps_per_length;
        const bool apart = !(from.x < 256 && from.y < 256 && from.z < 256 && to.x >= 0 && to.y >= 0 && to.z >= 0);
        if (apart) { return 0; }
        std::array<std::uint8_t, lanes> meets;
        const std::uint8_t low_x = step(from.x), low_y = step(from.y), low_z = step(from.z);
        const std::uint8_t high_x = step(to.x), high_y = step(to.y), high_z = step(to.z);
        for (unsigned i = 0; i < lanes; ++i) {
            const unsigned x = unsigned{low[0][i] <= high_x} & unsigned{high[0][i] >= low_x};
            const unsigned y = unsigned{low[1][i] <= high_y} & unsigned{high[1][i] >= low_y};
            const unsigned z = unsigned{low[2][i] <= high_z} & unsigned{high[2][i] >= low_z};
            meets[i] = static_cast<std::uint8_t>(x & y & z);
        }
        return bits_of(meets);
    }

private:
    [[nodiscard]] static std::uint8_t step(T x) {
        return static_cast<std::uint8_t>(static_cast<int>(std::min(std::max(x, T(0)), T(255))));
    }

    // Gathers sixteen bytes of 0 or 1 into a mask.
    [[nodiscard]] static std::uint32_t bits_of(const std::array<std::uint8_t, lanes>& bytes) {
        const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(bytes);
        constexpr std::uint64_t gather = 0x0102040810204080u;
        return static_cast<std::uint32_t>(halves[0] * gather >> 56 | halves[1] * gather >> 56 << 8);
    }
};

}  // namespace aglow::detail
