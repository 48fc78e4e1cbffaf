// How a kd-tree lies in memory: full leaves, sixteen-fold nodes and no pointers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// Points of a leaf. Every leaf is full but the last, so leaf i holds the slots from i * kd_leaf_size on.
inline constexpr std::uint32_t kd_leaf_size = 32;
inline constexpr std::uint32_t kd_fan = simd::lanes;
/// 32 * 16^7 points are more than a 32-bit slot can tell apart.
inline constexpr int kd_max_height = 7;

/// Coordinates of the points of a leaf; places behind the last point hold the largest number there is.
template <typename T>
struct alignas(64) kd_leaf {
    T x[kd_leaf_size], y[kd_leaf_size], z[kd_leaf_size];
};

/// Tight boxes of up to sixteen children: child i of node n is n * 16 + i, one level below. Level 0 are the leaves.
/// A child that is not there has a box farther away than any point.
template <typename T>
struct alignas(64) kd_node {
    T low_x[kd_fan], low_y[kd_fan], low_z[kd_fan], high_x[kd_fan], high_y[kd_fan], high_z[kd_fan];
};

/// What is known of a node of leaves beside its boxes.
template <typename T>
struct kd_crowd {
    /// The squared radius that holds m points is about the largest of line * m^2, area * m and volume * m^(2/3). Only a
    /// guess comes from it, never an answer.
    T line, area, volume;
    /// The leaves, as lanes, whose points are all at one place.
    std::uint32_t places;
};

/// Points below one node of `level`.
[[nodiscard]] constexpr std::uint64_t kd_capacity(int level) { return std::uint64_t{kd_leaf_size} << (4 * level); }

[[nodiscard]] constexpr std::uint32_t kd_blocks(std::uint64_t count, std::uint64_t size) {
    return static_cast<std::uint32_t>((count + size - 1) / size);
}

/// All that a tree stores. Nodes of the top level come first.
template <typename T>
struct kd_storage {
    std::uint32_t size{0};
    int height{0};
    std::array<std::uint32_t, kd_max_height + 1> first_node{};
    std::vector<kd_leaf<T>> leaves;
    std::vector<kd_node<T>> nodes;
    std::vector<kd_crowd<T>> crowds;
    std::vector<std::uint32_t> order;

    [[nodiscard]] const kd_node<T>& node(int level, std::uint32_t i) const {
        return nodes[first_node[static_cast<std::size_t>(level)] + i];
    }
    [[nodiscard]] kd_node<T>& node(int level, std::uint32_t i) {
        return nodes[first_node[static_cast<std::size_t>(level)] + i];
    }
    [[nodiscard]] vec3<T> position(std::uint32_t slot) const {
        const kd_leaf<T>& leaf = leaves[slot / kd_leaf_size];
        const std::uint32_t i = slot % kd_leaf_size;
        return {leaf.x[i], leaf.y[i], leaf.z[i]};
    }
    /// What ties are broken by: the original index, or the slot where the owner let the order go.
    [[nodiscard]] std::uint32_t rank(std::uint32_t slot) const { return order.empty() ? slot : order[slot]; }

    /// Makes room for `count` points.
    void shape(std::uint32_t count) {
        size = count;
        height = 1;
        while (kd_capacity(height) < count) { ++height; }
        if (count == 0) { height = 0; }
        std::uint32_t nodes_so_far = 0;
        for (int level = height; level > 0; --level) {
            first_node[static_cast<std::size_t>(level)] = nodes_so_far;
            nodes_so_far += kd_blocks(count, kd_capacity(level));
        }
        leaves.resize(kd_blocks(count, kd_leaf_size));
        order.resize(count);
        nodes.resize(nodes_so_far);
        crowds.resize(kd_blocks(count, kd_capacity(1)));
    }
};

}  // namespace aglow::detail
