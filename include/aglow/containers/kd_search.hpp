// How a kd-tree is searched: guess the radius, collect what lies within, select; the answer does not depend on the
// guess.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_probe.hpp>
#include <aglow/containers/kd_select.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// Squared distances to the sixteen points of a leaf from place `at` on.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline P point_distances2(const kd_leaf<T>& leaf, std::uint32_t at,
                                                            const vec3<T>& point) {
    return P::length2(P::sub(P::load(leaf.x + at), P::all(point.x)), P::sub(P::load(leaf.y + at), P::all(point.y)),
                      P::sub(P::load(leaf.z + at), P::all(point.z)));
}

/// Stands a search before a node of `level`.
template <typename T>
void start(kd_probe<T>& probe, int level, std::uint32_t node) {
    const auto top = static_cast<std::size_t>(level);
    probe.top = level;
    probe.level = level;
    probe.listed = 0;
    probe.open[top][0] = node;
    probe.count[top] = 1;
    probe.next[top] = 0;
}

/// Stands a search for what is closer than `bound` before the lowest node on the way home that nothing of it lies
/// beside; a probe that is not at home, before the top.
template <typename P, typename T>
[[gnu::always_inline]] inline void start_around(const kd_storage<T>& tree, kd_probe<T>& probe, T bound) {
    auto level = static_cast<std::size_t>(tree.height);
    if (!probe.at_home) { return start(probe, tree.height, 0); }
    while (level > 1 && P::less(P::load(probe.path[level]), P::all(bound)) == 1u << probe.home[level - 1] % kd_fan) {
        --level;
    }
    start(probe, static_cast<int>(level), probe.home[level]);
}

/// Takes leaves of one place out of `mask` once enough of its points are listed: they come in the order of their rank,
/// so that those behind can not be among the nearest.
template <typename T>
[[gnu::noinline]] std::uint32_t thin_out(const kd_node<T>& node, kd_probe<T>& probe, std::uint32_t places,
                                         std::uint32_t mask) {
    for (std::uint32_t rest = places & mask; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
        const vec3<T> place{node.low_x[i], node.low_y[i], node.low_z[i]};
        if (probe.listed == 0 || place != probe.place) { probe.listed = 0; }
        probe.place = place;
        if (probe.listed >= probe.enough) {
            mask &= ~(1u << i);
        } else {
            probe.listed += kd_leaf_size;
        }
    }
    return mask;
}

/// Opens up to kd_stride nodes of the probe's level: their children closer than `bound` become the next level's list.
template <typename P, typename T>
[[gnu::always_inline]] inline void open_nodes(const kd_storage<T>& tree, kd_probe<T>& probe, T bound) {
    const auto level = static_cast<std::size_t>(probe.level--);
    const std::uint32_t last = std::min(probe.count[level], probe.next[level] + kd_stride);
    const P limit = P::all(bound);
    std::uint32_t* children = probe.open[level - 1];
    std::uint32_t count = 0;
    for (std::uint32_t i = probe.next[level]; i < last; ++i) {
        const std::uint32_t node = probe.open[level][i];
        const bool known = probe.at_home && node == probe.home[level];
        const P d = known ? P::load(probe.path[level])
                          : box_distances2<P>(tree.node(static_cast<int>(level), node), probe.point);
        std::uint32_t mask = P::less(d, limit);
        if (level == 1 && (tree.crowds[node].places & mask) != 0) {
            mask = thin_out(tree.node(1, node), probe, tree.crowds[node].places, mask);
        }
        P::compress_numbers(children + count, node * kd_fan, mask);
        count += P::count(mask);
    }
    probe.next[level] = last;
    probe.count[level - 1] = count;
    probe.next[level - 1] = 0;
}

/// Opens nodes until some of level `goal` are listed, in ascending order; false when there are no more.
template <typename P, typename T>
[[gnu::always_inline]] inline bool advance(const kd_storage<T>& tree, kd_probe<T>& probe, T bound, int goal) {
    for (;;) {
        const auto level = static_cast<std::size_t>(probe.level);
        if (probe.next[level] == probe.count[level]) {
            if (probe.level == probe.top) { return false; }
            ++probe.level;
        } else if (probe.level <= goal) {
            return true;
        } else {
            open_nodes<P>(tree, probe, bound);
        }
    }
}

/// Room for points found, in ascending order of slots; `room` counts without the sixteen more that a pack may touch.
template <typename T>
struct kd_list {
    T* distances2;
    std::uint32_t* slots;
    std::uint32_t count, room;
};

/// Asks for all that the listed nodes of `level` hold.
template <typename T>
void prefetch_listed(const kd_storage<T>& tree, const kd_probe<T>& probe, int level) {
    const auto l = static_cast<std::size_t>(level);
    for (std::uint32_t i = probe.next[l]; i < probe.count[l]; ++i) {
        const std::uint32_t n = probe.open[l][i];
        if (level == 0) {
            simd::prefetch_all(tree.leaves[n]);
        } else {
            simd::prefetch_all(tree.node(level, n));
        }
    }
}

/// Adds the points closer than `bound` of the leaves that come next, as many as there is room for; false when there are
/// no more.
struct scan_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline bool run(const kd_storage<T>& tree, kd_probe<T>& probe, T bound,
                                                  kd_list<T>& found) {
        if (!advance<P>(tree, probe, bound, 0)) { return false; }
        if (probe.elsewhere) { prefetch_listed(tree, probe, 0); }
        const P limit = P::all(bound);
        std::uint32_t count = found.count;
        for (; probe.next[0] < probe.count[0] && count + kd_leaf_size <= found.room; ++probe.next[0]) {
            const std::uint32_t i = probe.open[0][probe.next[0]];
            for (std::uint32_t at = 0; at < kd_leaf_size; at += simd::lanes) {
                const P d = point_distances2<P>(tree.leaves[i], at, probe.point);
                const std::uint32_t mask = P::less(d, limit);
                P::compress(found.distances2 + count, d, mask);
                P::compress_numbers(found.slots + count, i * kd_leaf_size + at, mask);
                count += P::count(mask);
            }
        }
        found.count = count;
        return true;
    }
};

/// The caller's word on what may be found, behind pointers that no kernel sees through; none of them: all may.
template <typename T>
struct kd_filter {
    void* caller{nullptr};
    /// Takes out the candidates from `first` on that the caller does not accept.
    void (*refuse)(void* caller, kd_candidates<T>& found, std::uint32_t first){nullptr};
    bool (*accepts)(void* caller, std::uint32_t slot){nullptr};
};

/// Collects what is closer than `bound`, or the k nearest of it where that is much more than k.
template <typename Runner, typename T>
void collect(const kd_storage<T>& tree, kd_probe<T>& probe, std::uint32_t k, T bound, kd_candidates<T>& found,
             const kd_filter<T>& filter) {
    kd_list<T> list{found.distances2.data(), found.slots.data(), found.count = 0, found.capacity()};
    while (Runner::template run<scan_kernel>(tree, probe, bound, list)) {
        const std::uint32_t before = found.count;
        found.count = list.count;
        if (filter.refuse != nullptr) { filter.refuse(filter.caller, found, before); }
        if (found.count + kd_leaf_size > list.room) {
            bound = std::min(bound, simd::next_above(keep_nearest<Runner>(tree, found, k, bound)));
        }
        list.count = found.count;
    }
}

/// The radius to try after one that held too few.
template <typename Runner, typename T>
[[nodiscard]] T larger_radius2(const kd_storage<T>& tree, kd_probe<T>& probe, std::uint32_t k, std::uint32_t had,
                               int attempt, T radius2, T limit) {
    // Where the caller refuses many, what it took says more than the tree; four times more at once, lest it was chance.
    if (attempt < 4 && had * 16 >= k && had > 0) {
        const T wanted = static_cast<T>(k) + 2 * std::sqrt(static_cast<T>(k)) + 1;
        return radius2 * std::min(T(4), T(1.25) * wanted / static_cast<T>(had));
    }
    if (!probe.at_home) { Runner::template run<go_home_kernel>(tree, probe); }
    return std::max(covering_radius2(tree, probe, k, attempt, limit), radius2);
}

/// Finds the k nearest accepted points closer than `limit`, starting with a radius of about `radius2`; returns the
/// distance2 of the k-th, or `limit` when there are fewer. The probe stands at its start.
template <typename Runner, typename T>
T find_nearest(const kd_storage<T>& tree, kd_probe<T>& probe, std::uint32_t k, T radius2, T limit,
               kd_candidates<T>& found, const kd_filter<T>& filter) {
    for (int attempt = 0;; ++attempt) {
        radius2 = std::min(radius2, limit);
        collect<Runner>(tree, probe, k, radius2, found, filter);
        if (found.count >= k) { return keep_nearest<Runner>(tree, found, k, radius2); }
        if (radius2 >= limit || attempt > kd_max_height) { return limit; }
        radius2 = larger_radius2<Runner>(tree, probe, k, found.count, attempt, radius2, limit);
        start(probe, tree.height, 0);
    }
}

}  // namespace aglow::detail
