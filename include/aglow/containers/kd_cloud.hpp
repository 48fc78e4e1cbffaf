// Positions by coordinate: the form in which a kd-tree is built.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// Positions with the original index of each, and room to read and write whole packs.
template <typename T>
struct kd_cloud {
    std::array<std::unique_ptr<T[]>, 3> at;
    std::unique_ptr<std::uint32_t[]> index;

    explicit kd_cloud(std::size_t count) : index{std::make_unique_for_overwrite<std::uint32_t[]>(count + simd::lanes)} {
        for (auto& numbers : at) { numbers = std::make_unique_for_overwrite<T[]>(count + simd::lanes); }
    }
    /// Makes what stands behind the first `count` sort last.
    void close(std::size_t count) {
        for (auto& numbers : at) {
            std::fill_n(numbers.get() + count, std::size_t{simd::lanes}, std::numeric_limits<T>::max());
        }
    }
    /// Moves `count` points from place `from` down to place `to`.
    void move_down(std::size_t from, std::size_t count, std::size_t to) {
        if (from == to) { return; }
        for (auto& numbers : at) { std::copy_n(numbers.get() + from, count, numbers.get() + to); }
        std::copy_n(index.get() + from, count, index.get() + to);
    }
};

/// Whether squared distances from `p` can be finite. Looks at the bits: of positive numbers, infinity and NaN behind
/// them, the larger has the larger.
template <typename T>
[[nodiscard]] bool is_usable(const vec3<T>& p) {
    using bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    const auto magnitude = [](T x) { return std::bit_cast<bits>(x) & (~bits{0} >> 1); };
    const bits farthest = std::bit_cast<bits>(std::sqrt(std::numeric_limits<T>::max()) / 4);
    return std::max({magnitude(p.x), magnitude(p.y), magnitude(p.z)}) <= farthest;
}

/// So many items, each at its number: what a random-access range needs here of <ranges>, which is slow to read.
template <typename Items>
concept NumberedItems = requires(const Items& items, std::ptrdiff_t i) {
    std::begin(items)[i];
    { std::size(items) } -> std::convertible_to<std::size_t>;
};

/// What item number i of `Items` is.
template <typename Items>
using item_of = decltype(std::begin(std::declval<const Items&>())[0]);

/// `std::invoke(position, item)`.
template <typename T, typename Position, typename Item>
[[nodiscard]] vec3<T> place_of(const Position& position, Item&& item) {
    if constexpr (requires { position(item); }) {
        return position(item);
    } else if constexpr (requires { (item.*position)(); }) {
        return (item.*position)();
    } else if constexpr (requires { item.*position; }) {
        return item.*position;
    } else {
        return place_of<T>(position, *item);
    }
}

/// Takes the usable positions of items [first, last) to the places from `first` on; returns how many.
template <typename T, typename Items, typename Position>
std::size_t take_block(kd_cloud<T>& cloud, const Items& items, const Position& position, std::size_t first,
                       std::size_t last) {
    T* const x = cloud.at[0].get();
    T* const y = cloud.at[1].get();
    T* const z = cloud.at[2].get();
    std::uint32_t* const index = cloud.index.get();
    const auto item = std::begin(items);
    std::size_t to = first;
    for (std::size_t i = first; i < last; ++i) {
        const vec3<T> p = place_of<T>(position, item[static_cast<std::ptrdiff_t>(i)]);
        x[to] = p.x;
        y[to] = p.y;
        z[to] = p.z;
        index[to] = static_cast<std::uint32_t>(i);
        to += is_usable(p) ? 1u : 0u;
    }
    return to - first;
}

/// Takes the usable positions of all items, in their order; returns how many.
template <typename T, typename Items, typename Position, Executor E>
std::size_t take(kd_cloud<T>& cloud, const Items& items, const Position& position, const E& run) {
    constexpr std::size_t block = 1 << 14;
    const auto count = static_cast<std::size_t>(std::size(items));
    std::vector<std::size_t> taken((count + block - 1) / block);
    for_each_block(run, count, block, [&](std::size_t b, std::size_t first, std::size_t last) {
        taken[b] = take_block(cloud, items, position, first, last);
    });
    std::size_t all = 0;
    for (std::size_t b = 0; b < taken.size(); ++b) {
        cloud.move_down(b * block, taken[b], all);
        all += taken[b];
    }
    return all;
}

}  // namespace aglow::detail
