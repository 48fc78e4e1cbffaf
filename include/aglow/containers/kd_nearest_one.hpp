// The one point of a kd-tree nearest to a query: its home leaf first, then whatever box is closer than the best so far.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_search.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// The nearest accepted point so far. What comes next must be closer than `bound`: just above `distance2`, so that one
/// just as far is still seen and may win by its rank.
template <typename T>
struct kd_best {
    T bound;
    T distance2{0};
    std::uint32_t slot{0};
    bool found{false};
};

template <typename P, typename T, typename Accept>
void offer(const kd_storage<T>& tree, kd_best<T>& best, std::uint32_t slot, T distance2, Accept& accept) {
    if (best.found && distance2 == best.distance2 && tree.rank(slot) > tree.rank(best.slot)) { return; }
    if (!accept(slot)) { return; }
    best = {simd::next_above(distance2), distance2, slot, true};
}

template <typename P, typename T, typename Accept>
void visit_leaf(const kd_storage<T>& tree, const kd_probe<T>& probe, std::uint32_t leaf, kd_best<T>& best,
                Accept& accept) {
    for (std::uint32_t at = 0; at < kd_leaf_size; at += simd::lanes) {
        P d = point_distances2<P>(tree.leaves[leaf], at, probe.point);
        while (P::less(d, P::all(best.bound)) != 0) {
            const T nearest = P::smallest(d);
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(P::equal(d, P::all(nearest))));
            offer<P>(tree, best, leaf * kd_leaf_size + at + lane, nearest, accept);
            d = P::without(d, lane);
        }
    }
}

/// Offers the child of a node that is a single place just as far as the best so far, which may win by rank alone: the
/// first of its slots is the lowest. Spares searches among a thousand points at one place.
template <typename P, typename T, typename Accept>
bool is_settled(const kd_storage<T>& tree, int level, std::uint32_t child, T distance2, kd_best<T>& best,
                Accept& accept) {
    if (!std::is_same_v<std::remove_cv_t<Accept>, kd_accept_all> || !best.found || distance2 != best.distance2) {
        return false;
    }
    const kd_node<T>& node = tree.node(level, child / kd_fan);
    const std::uint32_t i = child % kd_fan;
    if (!is_place(node, i)) { return false; }
    offer<P>(tree, best, static_cast<std::uint32_t>(child * kd_capacity(level - 1)), distance2, accept);
    return true;
}

template <typename P, typename T, typename Accept>
void visit_children(const kd_storage<T>& tree, const kd_probe<T>& probe, int level, std::uint32_t node,
                    const T* distances2, std::uint32_t but, kd_best<T>& best, Accept& accept);

template <typename P, typename T, typename Accept>
void visit_node(const kd_storage<T>& tree, const kd_probe<T>& probe, int level, std::uint32_t node, kd_best<T>& best,
                Accept& accept) {
    if (level == 0) { return visit_leaf<P>(tree, probe, node, best, accept); }
    alignas(64) T distances2[kd_fan];
    P::store(distances2, box_distances2<P>(tree.node(level, node), probe.point));
    visit_children<P>(tree, probe, level, node, distances2, 0, best, accept);
}

/// Visits the children of a node closer than the best so far, but for those of the mask `but`.
template <typename P, typename T, typename Accept>
void visit_children(const kd_storage<T>& tree, const kd_probe<T>& probe, int level, std::uint32_t node,
                    const T* distances2, std::uint32_t but, kd_best<T>& best, Accept& accept) {
    for (;;) {
        const std::uint32_t mask = P::less(P::load(distances2), P::all(best.bound)) & ~but;
        if (mask == 0) { return; }
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
        but |= 1u << lane;
        const std::uint32_t child = node * kd_fan + lane;
        if (is_settled<P>(tree, level, child, distances2[lane], best, accept)) { continue; }
        visit_node<P>(tree, probe, level - 1, child, best, accept);
    }
}

/// The nearest accepted point closer than `limit`. The tree is not empty.
template <typename P, typename T, typename Accept>
kd_best<T> find_nearest_one(const kd_storage<T>& tree, kd_probe<T>& probe, T limit, Accept& accept) {
    kd_best<T> best{limit};
    go_home<P>(tree, probe);
    if (probe.path[1][probe.home[0] % kd_fan] < limit) { visit_leaf<P>(tree, probe, probe.home[0], best, accept); }
    for (int level = 1; level <= tree.height; ++level) {
        const auto l = static_cast<std::size_t>(level);
        const std::uint32_t home = 1u << probe.home[l - 1] % kd_fan;
        visit_children<P>(tree, probe, level, probe.home[l], probe.path[l], home, best, accept);
    }
    return best;
}

}  // namespace aglow::detail
