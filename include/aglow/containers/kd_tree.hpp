// A kd-tree of points that stay: the k nearest, the nearest, and all within a radius, exactly.
//
// Halved at the exact median of the widest side and laid out without pointers: sixteen children a node, full leaves. A
// search guesses the radius from how crowded the place is, collects all within, and selects; a wrong guess costs time
// and never changes the answer. All that a search returns has one order and one set of bits, whatever the guess, the
// number of threads and the instruction set: AVX-512, AVX2 or SSE are used where the machine has them, under any
// flags.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <aglow/containers/kd_accept.hpp>
#include <aglow/containers/kd_build.hpp>
#include <aglow/containers/kd_cloud.hpp>
#include <aglow/containers/kd_kernels.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_probe.hpp>
#include <aglow/containers/kd_search.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// How far a search looks.
template <typename T>
struct kd_reach {
    /// Only what is strictly closer counts; the radius, squared. Zero finds nothing.
    T radius2{std::numeric_limits<T>::infinity()};
    /// Distance2 that the k-th is expected at, as of a neighbouring query; 0: guess from how crowded the tree is there.
    /// It changes the time, never the answer.
    T hint2{0};
};

/// One item found.
template <typename T>
struct kd_found {
    kd_slot slot;
    /// Squared distance from the query.
    T distance2;
};

/// Items found by a search, in ascending order of slots. A view of the scratch, valid until its next use.
template <typename T>
struct kd_neighbours {
    std::span<const kd_slot> slots;
    /// Squared distance of each from the query.
    std::span<const T> distances2;
    /// The largest of `distances2` if as many were found as asked for, else the squared radius asked for.
    T radius2;

    [[nodiscard]] std::size_t size() const { return slots.size(); }
    [[nodiscard]] bool empty() const { return slots.empty(); }
};

/// What a search needs room for; a thread keeps one and uses it for all its searches, of any tree.
template <typename T>
class kd_scratch {
    template <typename>
    friend class kd_tree;
    std::vector<detail::kd_probe<T>> probes_{1};
    detail::kd_candidates<T> found_;
};

/// Points that stay, of scalar `T`. It keeps positions and no items; an owner that stores its payload in the tree's
/// order (`payload[slot] = items[order()[slot]]`) finds it where the search found the position.
///
/// Exact: distances are `simd::distance2`, the same bits as any brute force that uses it; of items just as far as the
/// k-th, those of lower original index are kept. Coordinates may have any unit as long as the squares of distances
/// neither overflow nor underflow (|x| within 1e-18 to 1e18 for float). Expects finite query points.
/// All queries are const and safe from many threads, each with its own scratch.
template <typename T>
class kd_tree {
public:
    using scalar = T;

    /// A tree of nothing.
    kd_tree() = default;

    /// A tree of `position(item)` for every item. Positions that are not finite, or so far out that squared distances
    /// would not be (beyond 4e18 for float), are left out and counted in `dropped()`. The same tree for any executor.
    /// O(n log n), with 40 bytes more per point while it runs (float). Throws std::length_error for 2^32 - 65
    /// items or more.
    template <detail::NumberedItems Items, typename Position, Executor E = in_sequence>
        requires std::convertible_to<std::invoke_result_t<const Position&, detail::item_of<Items>>, vec3<T>> kd_tree(
            const Items& items, const Position& position, const E& run = {});

    /// Items in the tree.
    [[nodiscard]] std::size_t size() const { return tree_.size; }
    [[nodiscard]] bool empty() const { return tree_.size == 0; }
    /// Items left out because their position was not finite.
    [[nodiscard]] std::size_t dropped() const { return dropped_; }
    /// Tight box of all positions; empty for an empty tree.
    [[nodiscard]] bounds<T> box() const;
    /// Position of the item in `slot`. Expects slot < size().
    [[nodiscard]] vec3<T> position(kd_slot slot) const { return tree_.position(slot); }
    /// Original index of the item in each slot; empty once forgotten.
    [[nodiscard]] std::span<const std::uint32_t> order() const { return tree_.order; }
    /// Frees the original indices, 4 bytes an item. From then on ties are broken by slot, which is still unique.
    void forget_order() { tree_.order = std::vector<std::uint32_t>(); }
    /// Bytes of all that the tree holds.
    [[nodiscard]] std::size_t memory() const;

    /// The `k` accepted items nearest to `point`, strictly within the reach; fewer where there are fewer.
    template <KdAccept Accept = kd_accept_all>
    [[nodiscard]] kd_neighbours<T> nearest(const vec3<T>& point, std::size_t k, kd_scratch<T>& scratch,
                                           kd_reach<T> reach = {}, Accept&& accept = {}) const;

    /// As `nearest` for every point, faster where points are many: `visit(i, neighbours)` is called in order of i, and
    /// `accept(i, slot)` says what counts for point i. Expects that neither searches with this scratch.
    template <std::invocable<std::size_t, const kd_neighbours<T>&> Visit>
    void nearest(std::span<const vec3<T>> points, std::size_t k, kd_scratch<T>& scratch, kd_reach<T> reach,
                 Visit&& visit) const {
        nearest(points, k, scratch, reach, visit, kd_accept_all{});
    }
    template <std::invocable<std::size_t, const kd_neighbours<T>&> Visit, std::predicate<std::size_t, kd_slot> Accept>
    void nearest(std::span<const vec3<T>> points, std::size_t k, kd_scratch<T>& scratch, kd_reach<T> reach,
                 Visit&& visit, Accept&& accept) const;

    /// The accepted item nearest to `point`, strictly within the radius.
    template <KdAccept Accept = kd_accept_all>
    [[nodiscard]] std::optional<kd_found<T>> nearest_one(const vec3<T>& point,
                                                         T radius2 = std::numeric_limits<T>::infinity(),
                                                         Accept&& accept = {}) const;

    /// Calls `visit(slot, distance2)` for every item strictly within the radius, in ascending order of slots.
    template <std::invocable<kd_slot, T> Visit>
    void within(const vec3<T>& point, T radius2, Visit&& visit) const;

private:
    static constexpr std::size_t group = 8;
    using task = detail::kd_task<T>;
    using runner = detail::kd_best_runner<T>;

    /// What a search comes down to; `count` is 0 where nothing can be found.
    [[nodiscard]] task task_of(std::size_t k, kd_reach<T> reach) const {
        const T limit = std::min(reach.radius2, std::numeric_limits<T>::max());
        const auto count = limit > 0 ? static_cast<std::uint32_t>(std::min<std::size_t>(k, size())) : 0;
        return {count, limit, reach.hint2};
    }

    /// So many candidates that the search seldom has to sift them; of all there are, none has to go.
    [[nodiscard]] std::size_t room_for(task what) const {
        return std::min(2 * std::size_t{what.count} + 1024, size() + detail::kd_leaf_size);
    }

    /// Of a thousand points at one place a search for k can use k, unless it may refuse them.
    template <typename Accept>
    static std::uint32_t enough(task what) {
        return detail::kd_accepts_all<Accept> ? what.count : std::numeric_limits<std::uint32_t>::max();
    }
    static kd_neighbours<T> view(const detail::kd_candidates<T>& found, std::size_t k, T farthest, kd_reach<T> reach) {
        return {{found.slots.data(), found.count},
                {found.distances2.data(), found.count},
                found.count < k ? reach.radius2 : farthest};
    }

    detail::kd_storage<T> tree_;
    std::size_t dropped_{0};
};

template <typename T>
template <detail::NumberedItems Items, typename Position, Executor E>
    requires std::convertible_to<std::invoke_result_t<const Position&, detail::item_of<Items>>, vec3<T>>
    kd_tree<T>::kd_tree(const Items& items, const Position& position, const E& run) {
        const auto count = static_cast<std::size_t>(std::size(items));
        if (count >= std::numeric_limits<std::uint32_t>::max() - 64) {
            throw std::length_error("aglow::kd_tree: more items than a 32-bit slot can number");
        }
        detail::kd_cloud<T> cloud{count};
        const auto kept = static_cast<std::uint32_t>(detail::take(cloud, items, position, run));
        dropped_ = count - kept;
        detail::kd_cloud<T> spare{kept};
        tree_.shape(kept);
        if (kept > 0) { detail::kd_builder<T>{tree_, cloud, spare}.build(run); }
    }

template <typename T>
bounds<T> kd_tree<T>::box() const {
    bounds<T> all;
    if (empty()) { return all; }
    const detail::kd_node<T>& top = tree_.node(tree_.height, 0);
    for (unsigned i = 0; i < detail::kd_blocks(tree_.size, detail::kd_capacity(tree_.height - 1)); ++i) {
        all.add({top.low_x[i], top.low_y[i], top.low_z[i]});
        all.add({top.high_x[i], top.high_y[i], top.high_z[i]});
    }
    return all;
}

template <typename T>
std::size_t kd_tree<T>::memory() const {
    const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return bytes(tree_.leaves) + bytes(tree_.nodes) + bytes(tree_.crowds) + bytes(tree_.order);
}

template <typename T>
template <KdAccept Accept>
kd_neighbours<T> kd_tree<T>::nearest(const vec3<T>& point, std::size_t k, kd_scratch<T>& scratch, kd_reach<T> reach,
                                     Accept&& accept) const {
    const task what = task_of(k, reach);
    if (what.count == 0) { return {{}, {}, reach.radius2}; }
    scratch.found_.reserve(room_for(what));
    detail::kd_probe<T>& probe = scratch.probes_.front();
    probe.point = point;
    probe.enough = enough<Accept>(what);
    const T farthest = detail::search<runner>(tree_, probe, what, scratch.found_, detail::filter_of<T>(accept));
    return view(scratch.found_, k, farthest, reach);
}

template <typename T>
template <std::invocable<std::size_t, const kd_neighbours<T>&> Visit, std::predicate<std::size_t, kd_slot> Accept>
void kd_tree<T>::nearest(std::span<const vec3<T>> points, std::size_t k, kd_scratch<T>& scratch, kd_reach<T> reach,
                         Visit&& visit, Accept&& accept) const {
    const task what = task_of(k, reach);
    if (what.count == 0) {
        for (std::size_t i = 0; i < points.size(); ++i) { visit(i, kd_neighbours<T>{{}, {}, reach.radius2}); }
        return;
    }
    scratch.found_.reserve(room_for(what));
    scratch.probes_.resize(group);
    std::array<T, group> radius2;
    for (std::size_t first = 0; first < points.size(); first += group) {
        const std::span<detail::kd_probe<T>> probes{scratch.probes_.data(), std::min(group, points.size() - first)};
        for (std::size_t i = 0; i < probes.size(); ++i) {
            probes[i].point = points[first + i];
            probes[i].enough = enough<Accept>(what);
        }
        runner::template run<detail::approach_kernel>(tree_, probes, what, std::span<T>{radius2});
        detail::announce_leaves(tree_, probes.front(), accept);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            if (i + 1 < probes.size()) { detail::announce_leaves(tree_, probes[i + 1], accept); }
            auto accepts_here = [&, at = first + i](kd_slot slot) { return accept(at, slot); };
            detail::kd_filter<T> filter;
            if constexpr (detail::kd_accepts_all<Accept>) {
                filter = detail::filter_of<T>(accept);
            } else {
                filter = detail::filter_of<T>(accepts_here);
            }
            const T farthest = detail::find_nearest<runner>(tree_, probes[i], what.count, radius2[i], what.limit,
                                                            scratch.found_, filter);
            visit(first + i, view(scratch.found_, k, farthest, reach));
        }
    }
}

template <typename T>
template <KdAccept Accept>
std::optional<kd_found<T>> kd_tree<T>::nearest_one(const vec3<T>& point, T radius2, Accept&& accept) const {
    const task what = task_of(1, {radius2});
    if (what.count == 0) { return std::nullopt; }
    detail::kd_probe<T> probe;
    probe.point = point;
    probe.enough = enough<Accept>(what);
    probe.at_home = true;
    probe.elsewhere = false;
    const auto best =
        runner::template run<detail::nearest_one_kernel>(tree_, probe, what.limit, detail::filter_of<T>(accept));
    if (!best.found) { return std::nullopt; }
    return kd_found<T>{best.slot, best.distance2};
}

template <typename T>
template <std::invocable<kd_slot, T> Visit>
void kd_tree<T>::within(const vec3<T>& point, T radius2, Visit&& visit) const {
    constexpr std::uint32_t room = 512;
    const task what = task_of(1, {radius2});
    if (what.count == 0) { return; }
    detail::kd_probe<T> probe;
    probe.point = point;
    probe.at_home = false;
    probe.elsewhere = false;
    probe.enough = std::numeric_limits<std::uint32_t>::max();
    detail::start(probe, tree_.height, 0);
    T distances2[room + simd::lanes];
    kd_slot slots[room + simd::lanes];
    detail::kd_list<T> found{distances2, slots, 0, room};
    while (runner::template run<detail::scan_kernel>(tree_, probe, what.limit, found)) {
        for (std::uint32_t i = 0; i < found.count; ++i) { visit(slots[i], distances2[i]); }
        found.count = 0;
    }
}

}  // namespace aglow
