// The boxes of a kd-tree's nodes and how crowded they are, made from the leaves upwards.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include <aglow/containers/kd_crowd.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_select.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>

namespace aglow::detail {

/// Tight box of the points of a leaf of which `count` are there.
template <typename T>
[[nodiscard]] bounds<T> leaf_box(const kd_leaf<T>& leaf, std::uint32_t count) {
    bounds<T> box;
    for (int a = 0; a < 3; ++a) {
        const T* const at = a == 0 ? leaf.x : a == 1 ? leaf.y : leaf.z;
        if (count < kd_leaf_size) {
            box.low[a] = *std::min_element(at, at + count);
            box.high[a] = *std::max_element(at, at + count);
        } else {
            const auto [low, high] = range_kernel::run<typename simd::packs_of<T>::any>(at, kd_leaf_size);
            box.low[a] = low;
            box.high[a] = high;
        }
    }
    return box;
}

/// Box around the first `count` children of a node.
template <typename T>
[[nodiscard]] bounds<T> node_box(const kd_node<T>& node, std::uint32_t count) {
    bounds<T> box;
    for (std::uint32_t i = 0; i < count; ++i) {
        box.add({node.low_x[i], node.low_y[i], node.low_z[i]});
        box.add({node.high_x[i], node.high_y[i], node.high_z[i]});
    }
    return box;
}

/// Whether the points of a child are all at one place.
template <typename T>
[[nodiscard]] bool is_place(const kd_node<T>& node, std::uint32_t i) {
    return node.low_x[i] == node.high_x[i] && node.low_y[i] == node.high_y[i] && node.low_z[i] == node.high_z[i];
}

/// Sets the boxes of node i of `level`, whose children are finished, and how crowded it is if those are leaves.
template <typename T>
void finish_node(kd_storage<T>& tree, int level, std::uint32_t i) {
    kd_node<T>& node = tree.node(level, i);
    const std::uint32_t children = std::min(kd_fan, kd_blocks(tree.size, kd_capacity(level - 1)) - i * kd_fan);
    for (std::uint32_t lane = 0; lane < kd_fan; ++lane) {
        const std::uint32_t child = i * kd_fan + lane;
        bounds<T> box;
        box.high = box.low;
        if (lane < children && level == 1) {
            box = leaf_box(tree.leaves[child], std::min(kd_leaf_size, tree.size - child * kd_leaf_size));
        } else if (lane < children) {
            const std::uint32_t below = kd_blocks(tree.size, kd_capacity(level - 2)) - child * kd_fan;
            box = node_box(tree.node(level - 1, child), std::min(kd_fan, below));
        }
        node.low_x[lane] = box.low.x;
        node.low_y[lane] = box.low.y;
        node.low_z[lane] = box.low.z;
        node.high_x[lane] = box.high.x;
        node.high_y[lane] = box.high.y;
        node.high_z[lane] = box.high.z;
    }
    if (level > 1) { return; }
    const auto capacity = static_cast<std::uint32_t>(kd_capacity(1));
    tree.crowds[i] = crowd_of(tree, i, node_box(node, children), std::min(capacity, tree.size - i * capacity));
    for (std::uint32_t lane = 0; lane < children; ++lane) {
        tree.crowds[i].places |= std::uint32_t{is_place(node, lane)} << lane;
    }
}

}  // namespace aglow::detail
