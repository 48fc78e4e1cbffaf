// How a kd-tree is built: halve at the exact median of the widest side, until leaves are full. Any number of threads
// and any instruction set make the same tree, and points at the same place keep the order they came in.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_cloud.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_median.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Points that lie together, in one of the two clouds. `first` is the first slot of a leaf.
struct kd_range {
    std::uint32_t first, count;
    unsigned side;
};

/// Where a range is cut: `left` points go left, those below `pivot` and the first `ties` of the `tied` that equal it.
template <typename T>
struct kd_cut {
    std::uint32_t axis, left, ties, tied;
    T pivot;
};

template <typename P>
class kd_builder {
    using T = typename P::scalar;
    using range = kd_range;
    using median = kd_median<P>;
    struct side {
        std::uint32_t axis;
        T low, high;
        [[nodiscard]] T width() const { return high - low; }
    };

public:
    kd_builder(kd_storage<T>& tree, kd_cloud<T>& cloud, kd_cloud<T>& spare) : tree_{tree}, clouds_{&cloud, &spare} {}

    template <Executor E>
    void build(const E& run) {
        for (kd_cloud<T>* cloud : clouds_) { cloud->close(tree_.size); }
        const std::vector<range> parts = split_among(run);
        run(parts.size(), [&](std::size_t i) {
            median find{parts[i].count};
            build(parts[i], find);
        });
        for (int level = 1; level <= tree_.height; ++level) {
            for_each_block(run, kd_blocks(tree_.size, kd_capacity(level)), 256, [&](auto, auto first, auto last) {
                for (auto i = first; i < last; ++i) { finish_node<P>(tree_, level, static_cast<std::uint32_t>(i)); }
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
                median find{parts[i].count};
                std::tie(halves[2 * i], halves[2 * i + 1]) = halve(parts[i], find);
            });
            parts = std::move(halves);
        }
        return parts;
    }

    void build(range r, median& find) {
        if (r.count == 0) { return; }
        if (r.count <= kd_leaf_size) { return finish_leaf(r); }
        const auto [left, right] = halve(r, find);
        build(left, find);
        build(right, find);
    }

    /// Moves a range to the other cloud, the left half first; one that fits in a leaf stays, as the left of its halves.
    std::pair<range, range> halve(range r, median& find) {
        if (r.count <= kd_leaf_size) { return {r, {r.first + r.count, 0, r.side}}; }
        const kd_cut<T> cut = choose(r, left_of(r.count), find);
        partition(r, cut);
        return {{r.first, cut.left, r.side ^ 1u}, {r.first + cut.left, r.count - cut.left, r.side ^ 1u}};
    }

    /// How many points of a range go left: whole subtrees, so that all but the last are full.
    static std::uint32_t left_of(std::uint32_t count) {
        std::uint64_t child = kd_leaf_size;
        while (child * kd_fan < count) { child *= kd_fan; }
        return static_cast<std::uint32_t>((kd_blocks(count, child) + 1) / 2 * child);
    }

    /// The cut of the widest side; where more than 1/16 of the points tie at the median, as points on a wall do, that
    /// of the next side with fewer ties.
    kd_cut<T> choose(range r, std::uint32_t left, median& find) const {
        std::array<side, 3> sides{};
        for (std::uint32_t a = 0; a < 3; ++a) { sides[a] = side_of(r, a); }
        if (sides[0].width() < sides[1].width()) { std::swap(sides[0], sides[1]); }
        if (sides[1].width() < sides[2].width()) { std::swap(sides[1], sides[2]); }
        if (sides[0].width() < sides[1].width()) { std::swap(sides[0], sides[1]); }
        kd_cut<T> best = cut_at(r, sides[0], left, find);
        for (std::size_t i = 1; i < 3 && best.tied > r.count / 16 && sides[i].width() > sides[0].width() / 4; ++i) {
            const kd_cut<T> other = cut_at(r, sides[i], left, find);
            if (other.tied < best.tied) { best = other; }
        }
        return best;
    }

    [[nodiscard]] const T* numbers(range r, std::uint32_t axis) const {
        return clouds_[r.side]->at[axis].get() + r.first;
    }

    /// The side of a range, of more than sixteen points, along an axis.
    side side_of(range r, std::uint32_t axis) const {
        const T* at = numbers(r, axis);
        P low = P::load(at + (r.count - simd::lanes));
        P high = low;
        for (std::uint32_t i = 0; i + simd::lanes <= r.count; i += simd::lanes) {
            const P v = P::load(at + i);
            low = P::min(low, v);
            high = P::max(high, v);
        }
        return {axis, P::smallest(low), P::largest(high)};
    }

    kd_cut<T> cut_at(range r, side s, std::uint32_t left, median& find) const {
        const kd_rank<T> rank = find(numbers(r, s.axis), r.count, left, s.low, s.high);
        return {s.axis, left, left - rank.less, rank.equal, rank.value};
    }

    void partition(range r, kd_cut<T> cut) {
        const kd_cloud<T>& from = *clouds_[r.side];
        const T* key = from.at[cut.axis].get();
        const std::uint32_t end = r.first + r.count;
        const P pivot = P::all(cut.pivot);
        std::uint32_t l = r.first;
        std::uint32_t h = r.first + cut.left;
        for (std::uint32_t i = r.first; i < end; i += simd::lanes) {
            const P v = P::load(key + i);
            const std::uint32_t here = end - i < simd::lanes ? (1u << (end - i)) - 1 : 0xffffu;
            std::uint32_t left = P::less(v, pivot);
            if (cut.ties > 0) { left |= take_ties(P::equal(v, pivot), cut.ties); }
            left &= here;
            const std::uint32_t right = here & ~left;
            move(from, i, left, l, r.first + cut.left, r.side);
            move(from, i, right, h, end, r.side);
            l += static_cast<std::uint32_t>(std::popcount(left));
            h += static_cast<std::uint32_t>(std::popcount(right));
        }
    }

    /// The lowest of the tied lanes, as many as may still go left.
    static std::uint32_t take_ties(std::uint32_t tied, std::uint32_t& may) {
        const auto count = static_cast<std::uint32_t>(std::popcount(tied));
        if (count > may) {
            while (static_cast<std::uint32_t>(std::popcount(tied)) > may) { tied ^= std::bit_floor(tied); }
        }
        may -= std::min(count, may);
        return tied;
    }

    /// Moves the lanes of `mask` from place `i` of a cloud to place `to` of the other, writing nothing from `end` on.
    void move(const kd_cloud<T>& from, std::uint32_t i, std::uint32_t mask, std::uint32_t to, std::uint32_t end,
              unsigned from_side) {
        kd_cloud<T>& other = *clouds_[from_side ^ 1u];
        if (to + simd::lanes <= end) {
            for (std::size_t a = 0; a < 3; ++a) { P::compress(&other.at[a][to], P::load(&from.at[a][i]), mask); }
            P::compress(&other.index[to], &from.index[i], mask);
            return;
        }
        for (; mask != 0; mask &= mask - 1, ++to) {
            const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
            for (std::size_t a = 0; a < 3; ++a) { other.at[a][to] = from.at[a][i + lane]; }
            other.index[to] = from.index[i + lane];
        }
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
