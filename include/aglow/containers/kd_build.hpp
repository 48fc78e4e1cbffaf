// How a kd-tree is built: halve at the exact median of the widest side, until leaves are full. Any number of threads
// and any instruction set make the same tree, and points at the same place keep the order they came in.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <aglow/containers/kd_cloud.hpp>
#include <aglow/containers/kd_kernels.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Points that lie together, in one of the two clouds. `first` is the first slot of a leaf.
struct kd_range {
    std::uint32_t first, count;
    unsigned side;
};

/// How many points of a range go left: whole subtrees, so that all but the last are full.
[[nodiscard]] constexpr std::uint32_t kd_left_of(std::uint32_t count) {
    std::uint64_t child = kd_leaf_size;
    while (child * kd_fan < count) { child *= kd_fan; }
    return static_cast<std::uint32_t>((kd_blocks(count, child) + 1) / 2 * child);
}

/// Runs kernels as `Runner` says: `simd::run_best`, or with one pack where packs are compared.
template <typename T, typename Runner = kd_best_runner<T>>
class kd_builder {
    using range = kd_range;
    using room = kd_room<T>;

public:
    kd_builder(kd_storage<T>& tree, kd_cloud<T>& cloud, kd_cloud<T>& spare) : tree_{tree}, clouds_{&cloud, &spare} {}

    /// Expects a tree shaped for the points of the cloud, one or more.
    template <Executor E>
    void build(const E& run) {
        for (kd_cloud<T>* cloud : clouds_) { cloud->close(tree_.size); }
        const std::vector<range> parts = split_among(run);
        run(parts.size(), [&](std::size_t i) {
            room mine{parts[i].count};
            build(parts[i], mine);
        });
        for (int level = 1; level <= tree_.height; ++level) {
            for_each_block(run, kd_blocks(tree_.size, kd_capacity(level)), 256, [&](auto, auto first, auto last) {
                for (std::size_t i = first; i < last; ++i) { finish_node(tree_, level, static_cast<std::uint32_t>(i)); }
            });
        }
    }

private:
    static constexpr std::size_t parts_at_most = 32;
    static constexpr std::uint32_t smallest_part = 8192;

    /// Halves, and halves the halves, until there is work for many.
    template <Executor E>
    std::vector<range> split_among(const E& run) {
        std::vector<range> parts{{0, tree_.size, 0}};
        while (parts.size() < parts_at_most && parts.front().count > smallest_part) {
            std::vector<range> halves(2 * parts.size());
            run(parts.size(), [&](std::size_t i) {
                room mine{parts[i].count};
                std::tie(halves[2 * i], halves[2 * i + 1]) = halve(parts[i], mine);
            });
            parts = std::move(halves);
        }
        return parts;
    }

    void build(range r, room& mine) {
        if (r.count == 0) { return; }
        if (r.count <= kd_leaf_size) { return finish_leaf(r); }
        const auto [left, right] = halve(r, mine);
        build(left, mine);
        build(right, mine);
    }

    /// Moves a range to the other cloud, the left half first; one that fits in a leaf stays, as the left of its halves.
    std::pair<range, range> halve(range r, room& mine) {
        if (r.count <= kd_leaf_size) { return {r, {r.first + r.count, 0, r.side}}; }
        const std::uint32_t left = kd_left_of(r.count);
        const kd_move<T> move{*clouds_[r.side], *clouds_[r.side ^ 1u], r.first, r.count};
        detail::halve<Runner>(move, left, mine);
        return {{r.first, left, r.side ^ 1u}, {r.first + left, r.count - left, r.side ^ 1u}};
    }

    void finish_leaf(range r) {
        const kd_cloud<T>& from = *clouds_[r.side];
        kd_leaf<T>& leaf = tree_.leaves[r.first / kd_leaf_size];
        std::array<T*, 3> to{leaf.x, leaf.y, leaf.z};
        for (std::size_t a = 0; a < 3; ++a) {
            std::copy_n(from.at[a].get() + r.first, r.count, to[a]);
            std::fill_n(to[a] + r.count, kd_leaf_size - r.count, std::numeric_limits<T>::max());
        }
        std::copy_n(from.index.get() + r.first, r.count, tree_.order.data() + r.first);
    }

    kd_storage<T>& tree_;
    std::array<kd_cloud<T>*, 2> clouds_;
};

}  // namespace aglow::detail
