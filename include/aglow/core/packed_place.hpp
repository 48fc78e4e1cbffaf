// Places within a box as 21 bits an axis: eight bytes, and as near as float tells places from each other there.
#pragma once

#include <algorithm>
#include <cstdint>

#include <aglow/core/bounds.hpp>

namespace aglow {

/// A box cut into 2^21 cells along each axis. Scales exactly with powers of two.
template <typename T>
class place_cells {
public:
    place_cells() = default;
    explicit place_cells(const bounds<T>& box)
        : low_{box.empty() ? vec3<T>{} : box.low}, step_{box.extent() * T(1.0 / most)} {}

    /// How far a place may lie from the centre of its cell, along the longest axis.
    [[nodiscard]] T error() const { return max_abs(step_) / 2; }

    /// The cell of `p`, the nearest one if it lies outside. Expects it finite.
    [[nodiscard]] std::uint64_t cell(const vec3<T>& p) const {
        return index(p.x - low_.x, step_.x) | index(p.y - low_.y, step_.y) << 21 | index(p.z - low_.z, step_.z) << 42;
    }

    /// The centre of `cell`; a box without thickness has its cells on itself.
    [[nodiscard]] vec3<T> centre(std::uint64_t cell) const {
        return {low_.x + middle(cell) * step_.x, low_.y + middle(cell >> 21) * step_.y,
                low_.z + middle(cell >> 42) * step_.z};
    }

private:
    static constexpr std::uint64_t most = std::uint64_t{1} << 21;

    static std::uint64_t index(T along, T step) {
        if (!(step > 0)) { return 0; }
        const T cell = std::clamp(along / step, T(0), T(most - 1));
        return static_cast<std::uint64_t>(static_cast<std::int32_t>(cell));
    }
    static T middle(std::uint64_t cell) {
        return static_cast<T>(static_cast<std::int32_t>(cell & (most - 1))) + T(0.5);
    }

    vec3<T> low_{};
    vec3<T> step_{};
};

}  // namespace aglow
