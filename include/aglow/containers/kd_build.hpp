// How a kd-tree is built: halve at the exact median of the widest side, until leaves are full; any number of threads
// and any instruction set make the same tree.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Positions by coordinate, with the original index of each.
template <typename T>
struct kd_cloud {
    std::array<std::vector<T>, 3> at;
    std::vector<std::uint32_t> index;

    void resize(std::size_t count) {
        for (std::vector<T>& coordinate : at) { coordinate.resize(count + simd::lanes); }
        index.resize(count + simd::lanes);
    }
};

/// Points that lie together, in one of the two clouds.
struct kd_range {
    std::uint32_t first, count;
    unsigned side;
};

/// Where a range is cut: so many points go left, those below `pivot` and the first `ties` that equal it.
template <typename T>
struct kd_cut {
    std::uint32_t axis, left, ties;
    T pivot;
};

template <typename T>
class kd_builder {
public:
    kd_builder(kd_storage<T>& tree, kd_cloud<T>& cloud, kd_cloud<T>& spare) : tree_{tree}, clouds_{&cloud, &spare} {}

    template <Executor E>
    void build(const E& run) {
        std::vector<range> wave{{0, tree_.size, 0}};
        while (wave.size() < 32 && wave.front().count > 8 * kd_capacity(1)) {
            std::vector<range> next(2 * wave.size());
            run(wave.size(), [&](std::size_t i) {
                const auto [left, right] = halve(wave[i]);
                next[2 * i] = left;
                next[2 * i + 1] = right;
            });
            wave = std::move(next);
        }
        run(wave.size(), [&](std::size_t i) { build(wave[i]); });
        for (int level = 1; level <= tree_.height; ++level) { finish_level(level, run); }
    }

private:
    using range = kd_range;

    /// How many points of a range go left: whole subtrees, so that all but the last are full.
    static std::uint32_t left_of(std::uint32_t count) {
        std::uint64_t child = kd_leaf_size;
        while (child * kd_fan < count) { child *= kd_fan; }
        return static_cast<std::uint32_t>((kd_blocks(count, child) + 1) / 2 * child);
    }

    void build(range r) {
        if (r.count == 0) { return; }
        if (r.count <= kd_leaf_size) { return finish_leaf(r); }
        const auto [left, right] = halve(r);
        build(left);
        build(right);
    }

    /// Moves a range to the other cloud, the left half first; one that fits in a leaf stays, as the left of its halves.
    std::pair<range, range> halve(range r) {
        if (r.count <= kd_leaf_size) { return {r, {r.first + r.count, 0, r.side}}; }
        const kd_cut<T> cut = choose(r, left_of(r.count));
        partition(r, cut);
        return {{r.first, cut.left, r.side ^ 1u}, {r.first + cut.left, r.count - cut.left, r.side ^ 1u}};
    }

    kd_cut<T> choose(range r, std::uint32_t left) {
        std::array<T, 3> extent{};
        std::array<std::uint32_t, 3> axes{0, 1, 2};
        for (std::uint32_t a = 0; a < 3; ++a) {
            const T* at = clouds_[r.side]->at[a].data() + r.first;
            const auto [low, high] = std::minmax_element(at, at + r.count);
            extent[a] = *high - *low;
        }
        std::stable_sort(axes.begin(), axes.end(), [&](auto a, auto b) { return extent[a] > extent[b]; });
        const kd_cut<T> widest = cut_at(r, axes[0], left);
        return widest;
    }

    kd_cut<T> cut_at(range r, std::uint32_t axis, std::uint32_t left) {
        const T* at = clouds_[r.side]->at[axis].data() + r.first;
        T* spare = clouds_[r.side ^ 1u]->at[axis].data() + r.first;
        std::copy(at, at + r.count, spare);
        std::nth_element(spare, spare + (left - 1), spare + r.count);
        const T pivot = spare[left - 1];
        const auto below = static_cast<std::uint32_t>(std::count_if(at, at + r.count, [&](T x) { return x < pivot; }));
        return {axis, left, left - below, pivot};
    }

    void partition(range r, kd_cut<T> cut) {
        const kd_cloud<T>& from = *clouds_[r.side];
        kd_cloud<T>& to = *clouds_[r.side ^ 1u];
        std::uint32_t l = r.first;
        std::uint32_t h = r.first + cut.left;
        for (std::uint32_t i = r.first; i < r.first + r.count; ++i) {
            const T x = from.at[cut.axis][i];
            bool goes_left = x < cut.pivot;
            if (x == cut.pivot && cut.ties > 0) {
                goes_left = true;
                --cut.ties;
            }
            const std::uint32_t j = goes_left ? l++ : h++;
            for (std::size_t a = 0; a < 3; ++a) { to.at[a][j] = from.at[a][i]; }
            to.index[j] = from.index[i];
        }
    }

    void finish_leaf(range r) {
        const kd_cloud<T>& from = *clouds_[r.side];
        kd_leaf<T>& leaf = tree_.leaves[r.first / kd_leaf_size];
        for (std::uint32_t i = 0; i < kd_leaf_size; ++i) {
            const bool there = i < r.count;
            constexpr T nowhere = std::numeric_limits<T>::max();
            leaf.x[i] = there ? from.at[0][r.first + i] : nowhere;
            leaf.y[i] = there ? from.at[1][r.first + i] : nowhere;
            leaf.z[i] = there ? from.at[2][r.first + i] : nowhere;
            if (there) { tree_.order[r.first + i] = from.index[r.first + i]; }
        }
    }

    template <Executor E>
    void finish_level(int level, const E& run) {
        const std::uint32_t nodes = kd_blocks(tree_.size, kd_capacity(level));
        for_each_block(run, nodes, 256, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const auto node = static_cast<std::uint32_t>(i);
                for (std::uint32_t lane = 0; lane < kd_fan; ++lane) { finish_box(level, node, lane); }
                if (level == 1) { finish_density(node); }
            }
        });
    }

    void finish_box(int level, std::uint32_t i, std::uint32_t lane) {
        kd_node<T>& node = tree_.node(level, i);
        const std::uint32_t child = i * kd_fan + lane;
        bounds<T> box;
        if (child < kd_blocks(tree_.size, kd_capacity(level - 1))) {
            if (level == 1) {
                for (std::uint32_t s = child * kd_leaf_size; s < std::min(tree_.size, (child + 1) * kd_leaf_size);
                     ++s) {
                    box.add(tree_.position(s));
                }
            } else {
                const kd_node<T>& below = tree_.node(level - 1, child);
                for (std::uint32_t j = 0; j < kd_fan; ++j) {
                    if (below.low_x[j] == std::numeric_limits<T>::max()) { continue; }
                    box.add({below.low_x[j], below.low_y[j], below.low_z[j]});
                    box.add({below.high_x[j], below.high_y[j], below.high_z[j]});
                }
            }
        } else {
            box.high = box.low;
        }
        node.low_x[lane] = box.low.x;
        node.low_y[lane] = box.low.y;
        node.low_z[lane] = box.low.z;
        node.high_x[lane] = box.high.x;
        node.high_y[lane] = box.high.y;
        node.high_z[lane] = box.high.z;
    }

    void finish_density(std::uint32_t i) {
        const std::uint32_t first = i * static_cast<std::uint32_t>(kd_capacity(1));
        const std::uint32_t last = std::min(tree_.size, first + static_cast<std::uint32_t>(kd_capacity(1)));
        bounds<T> box;
        for (std::uint32_t s = first; s < last; ++s) { box.add(tree_.position(s)); }
        const vec3<T> e = box.extent();
        std::array<T, 3> side{e.x, e.y, e.z};
        std::sort(side.begin(), side.end());
        const T n = static_cast<T>(last - first);
        const T root = std::cbrt(side[0]) * std::cbrt(side[1]) * std::cbrt(side[2]) * std::cbrt(T(0.75) / (pi<T> * n));
        tree_.densities[i] = {square(side[2] / (2 * n)), side[2] / n * side[1] / pi<T>, root * root};
    }

    kd_storage<T>& tree_;
    std::array<kd_cloud<T>*, 2> clouds_;
};

}  // namespace aglow::detail
