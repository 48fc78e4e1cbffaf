// Where a search of a kd-tree begins: the leaf where its point lives, and how far to look around.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// Nodes opened at one go: bounds the room that a search needs, however many nodes it meets.
inline constexpr std::uint32_t kd_stride = 8;

/// One query on its way: the path to the node where it lives, and the nodes it still has to open, by level.
template <typename T>
struct kd_probe {
    vec3<T> point;
    /// How many points of one place the search can use.
    std::uint32_t enough;
    /// The place whose leaves were listed last, and how many points of it.
    std::uint32_t listed;
    vec3<T> place;
    bool at_home;
    /// Whether it lives far from the one before it, whose leaves are in the cache, and asks for its own ahead.
    bool elsewhere;
    /// Where the search stands, and where it started.
    int level, top;
    std::array<std::uint32_t, kd_max_height + 1> home, count, next;
    alignas(64) T path[kd_max_height + 1][kd_fan];
    std::uint32_t open[kd_max_height + 1][kd_stride * kd_fan + simd::lanes];
};

/// How far `at` lies outside each of sixteen intervals.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline P outside(const T* low, const T* high, T at) {
    const P here = P::all(at);
    return P::max(P::max(P::sub(P::load(low), here), P::sub(here, P::load(high))), P::all(T(0)));
}

/// Squared distances from a point to the sixteen boxes of a node. Rounded as those of points are, so none is larger
/// than that of a point in the box.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline P box_distances2(const kd_node<T>& node, const vec3<T>& point) {
    return P::length2(outside<P>(node.low_x, node.high_x, point.x), outside<P>(node.low_y, node.high_y, point.y),
                      outside<P>(node.low_z, node.high_z, point.z));
}

/// Goes one level down towards the nearest box and keeps the distances it saw.
template <typename P, typename T>
[[gnu::always_inline]] inline void step_home(const kd_storage<T>& tree, kd_probe<T>& probe, std::size_t level) {
    const std::uint32_t node = probe.home[level];
    const P d = box_distances2<P>(tree.node(static_cast<int>(level), node), probe.point);
    P::store(probe.path[level], d);
    // Most often the point is in a box, and the smallest need not be waited for.
    std::uint32_t nearest = P::equal(d, P::all(T(0)));
    if (nearest == 0) { nearest = P::equal(d, P::all(P::smallest(d))); }
    probe.home[level - 1] = node * kd_fan + static_cast<std::uint32_t>(std::countr_zero(nearest));
}

/// Finds the leaf nearest to the point, greedily, and the distances on the way.
struct go_home_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_storage<T>& tree, kd_probe<T>& probe) {
        auto level = static_cast<std::size_t>(tree.height);
        probe.home[level] = 0;
        for (; level > 0; --level) { step_home<P>(tree, probe, level); }
        probe.at_home = true;
    }
};

/// As go_home, and sees whether that is far from where the probe lived before: then it asks for its leaves ahead.
struct move_home_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_storage<T>& tree, kd_probe<T>& probe) {
        const std::uint32_t last = probe.home[2];
        go_home_kernel::run<P>(tree, probe);
        probe.elsewhere = probe.home[2] != last;
        if (probe.elsewhere) { simd::prefetch_all(tree.leaves[probe.home[0]]); }
    }
};

/// Squared radius of about m points, of which `root` is m^(2/3), judged by the leaf where the probe lives: of 32 even
/// points a square has the diagonal 14.2 / sqrt(m) radii, a cube 8.8 / cbrt(m). Twice as much, to be on the safe side.
template <typename T>
[[nodiscard]] T leaf_radius2(const kd_storage<T>& tree, const kd_probe<T>& probe, T m, T root) {
    const kd_node<T>& node = tree.node(1, probe.home[1]);
    const std::uint32_t i = probe.home[0] % kd_fan;
    const T x = node.high_x[i] - node.low_x[i];
    const T y = node.high_y[i] - node.low_y[i];
    const T z = node.high_z[i] - node.low_z[i];
    const bool flat = 4 * std::min(std::min(x, y), z) < std::max(std::max(x, y), z);
    return (x * x + y * y + z * z) * (flat ? m / 100 : root / 39);
}

/// Squared radius within which about k points are expected, and a few more, so that it seldom holds fewer.
template <typename T>
[[nodiscard]] T guess_radius2(const kd_storage<T>& tree, const kd_probe<T>& probe, std::uint32_t k) {
    const T wanted = static_cast<T>(k) + 3 * std::sqrt(static_cast<T>(k)) + 1;
    const T root = std::cbrt(wanted * wanted);
    const kd_crowd<T>& crowd = tree.crowds[probe.home[1]];
    T spread2 = std::max(std::max(crowd.line * wanted * wanted, crowd.area * wanted), crowd.volume * root);
    // Where a node holds both a crowd and a desert, the leaf knows better.
    const T leaf2 = leaf_radius2(tree, probe, wanted, root);
    if (2 * leaf2 < spread2) { spread2 = leaf2; }
    const T away2 = probe.path[1][probe.home[0] % kd_fan];
    return away2 > 0 ? away2 + spread2 + 2 * std::sqrt(away2) * std::sqrt(spread2) : spread2;
}

/// Squared radius that surely holds all points of the smallest node around the probe with k points, from `level` up;
/// `limit` where there is none.
template <typename T>
[[nodiscard, gnu::noinline]] T covering_radius2(const kd_storage<T>& tree, const kd_probe<T>& probe, std::uint32_t k,
                                                int level, T limit) {
    for (; level < tree.height; ++level) {
        const std::uint32_t home = probe.home[static_cast<std::size_t>(level)];
        const std::uint64_t first = kd_capacity(level) * home;
        if (std::min(kd_capacity(level), tree.size - first) < k) { continue; }
        const kd_node<T>& node = tree.node(level + 1, home / kd_fan);
        const std::uint32_t i = home % kd_fan;
        const auto far = [](T low, T high, T at) { return std::max(std::abs(low - at), std::abs(high - at)); };
        const T reach2 = simd::length2(far(node.low_x[i], node.high_x[i], probe.point.x),
                                       far(node.low_y[i], node.high_y[i], probe.point.y),
                                       far(node.low_z[i], node.high_z[i], probe.point.z));
        return reach2 < limit ? simd::next_above(reach2) : limit;
    }
    return limit;
}

}  // namespace aglow::detail
