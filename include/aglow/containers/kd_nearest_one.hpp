// The one point of a kd-tree nearest to a query: its home leaf first, then whatever box is closer than the best so far.
#pragma once

#include <bit>
#include <cstdint>

#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_probe.hpp>
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

template <typename T>
void offer(const kd_storage<T>& tree, kd_best<T>& best, std::uint32_t slot, T distance2, const kd_filter<T>& filter) {
    if (best.found && distance2 > best.distance2) { return; }
    if (best.found && distance2 == best.distance2 && tree.rank(slot) > tree.rank(best.slot)) { return; }
    if (filter.accepts != nullptr && !filter.accepts(filter.caller, slot)) { return; }
    best = {simd::next_above(distance2), distance2, slot, true};
}

template <typename P, typename T>
[[gnu::always_inline]] inline void visit_leaf(const kd_storage<T>& tree, const kd_probe<T>& probe, std::uint32_t leaf,
                                              kd_best<T>& best, const kd_filter<T>& filter) {
    for (std::uint32_t at = 0; at < kd_leaf_size; at += simd::lanes) {
        P d = point_distances2<P>(tree.leaves[leaf], at, probe.point);
        while (P::less(d, P::all(best.bound)) != 0) {
            const T nearest = P::smallest(d);
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(P::equal(d, P::all(nearest))));
            offer(tree, best, leaf * kd_leaf_size + at + lane, nearest, filter);
            d = P::without(d, lane);
        }
    }
}

/// Visits all leaves below a node that are closer than the best so far.
template <typename P, typename T>
[[gnu::always_inline]] inline void visit_below(const kd_storage<T>& tree, kd_probe<T>& probe, int level,
                                               std::uint32_t node, kd_best<T>& best, const kd_filter<T>& filter) {
    start(probe, level, node);
    while (advance<P>(tree, probe, best.bound, 0)) {
        visit_leaf<P>(tree, probe, probe.open[0][probe.next[0]++], best, filter);
    }
}

/// Whether a child of a node is done with an offer: it is a single place just as far as the best so far, where the
/// first slot has the lowest rank. Spares searches among a thousand points at one place.
template <typename T>
bool is_settled(const kd_storage<T>& tree, int level, std::uint32_t child, T distance2, kd_best<T>& best,
                const kd_filter<T>& filter) {
    if (filter.accepts != nullptr || !best.found || distance2 != best.distance2) { return false; }
    if (!is_place(tree.node(level, child / kd_fan), child % kd_fan)) { return false; }
    offer(tree, best, static_cast<std::uint32_t>(child * kd_capacity(level - 1)), distance2, filter);
    return true;
}

/// The nearest accepted point closer than `limit`. The tree is not empty.
template <typename P, typename T>
[[gnu::always_inline]] inline kd_best<T> find_nearest_one(const kd_storage<T>& tree, kd_probe<T>& probe, T limit,
                                                          const kd_filter<T>& filter) {
    kd_best<T> best{limit};
    go_home_kernel::run<P>(tree, probe);
    visit_leaf<P>(tree, probe, probe.home[0], best, filter);
    for (int level = 1; level <= tree.height; ++level) {
        const auto l = static_cast<std::size_t>(level);
        std::uint32_t done = 1u << probe.home[l - 1] % kd_fan;
        for (;;) {
            const std::uint32_t mask = P::less(P::load(probe.path[l]), P::all(best.bound)) & ~done;
            if (mask == 0) { break; }
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
            done |= 1u << lane;
            const std::uint32_t child = probe.home[l] * kd_fan + lane;
            if (is_settled(tree, level, child, probe.path[l][lane], best, filter)) { continue; }
            visit_below<P>(tree, probe, level - 1, child, best, filter);
        }
    }
    return best;
}

}  // namespace aglow::detail
