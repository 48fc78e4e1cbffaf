// How crowded a part of a kd-tree is: the guess that a search for k starts with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Length, area and volume of what points fill.
template <typename T>
struct kd_measure {
    T length, area, volume;
};

template <typename T>
[[nodiscard]] kd_measure<T> measure_of(const bounds<T>& box) {
    const vec3<T> e = box.extent();
    std::array<T, 3> side{e.x, e.y, e.z};
    std::nth_element(side.begin(), side.begin() + 1, side.end());  // of three, the middle one sorts all
    return {side[2], side[2] * side[1], side[2] * side[1] * side[0]};
}

/// Sums of products of coordinates, lane by lane so that they are taken sixteen at a time.
template <typename T>
struct kd_moments {
    static constexpr std::size_t terms = 9;
    T sum[terms][simd::lanes]{};

    void add(const T* x, const T* y, const T* z, const vec3<T>& centre, T scale) {
        for (std::size_t i = 0; i < simd::lanes; ++i) {
            const T a = (x[i] - centre.x) * scale;
            const T b = (y[i] - centre.y) * scale;
            const T c = (z[i] - centre.z) * scale;
            const T term[terms]{a, b, c, a * a, b * b, c * c, a * b, a * c, b * c};
            for (std::size_t t = 0; t < terms; ++t) { sum[t][i] += term[t]; }
        }
    }
    [[nodiscard]] T mean(std::size_t term, T count) const {
        T all = 0;
        for (const T lane : sum[term]) { all += lane; }
        return all / count;
    }
};

/// What the full leaves from `first` to before `last` fill, however it is turned: an even sheet of sides a and b has
/// variances a^2/12 and b^2/12 along them, and the invariants of the covariance see no axes.
template <typename T>
[[nodiscard]] kd_measure<T> measure_of(const kd_storage<T>& tree, std::uint32_t first, std::uint32_t last,
                                       const bounds<T>& box) {
    const vec3<T> centre = box.centre();
    const T size = max_abs(box.extent());
    kd_moments<T> m;
    for (std::uint32_t leaf = first; leaf < last; ++leaf) {
        const kd_leaf<T>& points = tree.leaves[leaf];
        for (std::uint32_t at = 0; at < kd_leaf_size; at += simd::lanes) {
            m.add(points.x + at, points.y + at, points.z + at, centre, 1 / size);
        }
    }
    std::array<T, 9> e{};
    for (std::size_t t = 0; t < 9; ++t) { e[t] = m.mean(t, static_cast<T>((last - first) * kd_leaf_size)); }
    const T xx = e[3] - e[0] * e[0];
    const T yy = e[4] - e[1] * e[1];
    const T zz = e[5] - e[2] * e[2];
    const T xy = e[6] - e[0] * e[1];
    const T xz = e[7] - e[0] * e[2];
    const T yz = e[8] - e[1] * e[2];
    const T minors = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
    const T determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    const auto root = [](T x) { return std::sqrt(std::max(x, T(0))); };
    return {root(12 * (xx + yy + zz)) * size, 12 * root(minors) * size * size,
            std::sqrt(T(1728)) * root(determinant) * size * size * size};
}

/// How crowded the node of leaves i with its box and `count` points is, taken for even over what it fills.
template <typename T>
[[nodiscard]] kd_crowd<T> crowd_of(const kd_storage<T>& tree, std::uint32_t i, const bounds<T>& box,
                                   std::uint32_t count) {
    kd_measure<T> fills = measure_of(box);
    const std::uint32_t full = count / kd_leaf_size;
    if (fills.volume > 0 && full > 1) {
        const kd_measure<T> turned = measure_of(tree, i * kd_fan, i * kd_fan + full, box);
        // A box is the better measure where it fits.
        const auto better = [](T a, T b) { return b < T(0.8) * a ? b : a; };
        fills = {fills.length, better(fills.area, turned.area), better(fills.volume, turned.volume)};
    }
    const T n = static_cast<T>(count);
    const T radius = std::cbrt(fills.volume * (T(0.75) / (pi<T> * n)));
    return {square(fills.length / (2 * n)), fills.area / (pi<T> * n), square(radius), 0};
}

}  // namespace aglow::detail
