// Eight spheres side by side, and the questions a search asks of all eight at once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/core/vec.hpp>

namespace aglow {

/// Spheres by coordinate, as vector instructions like them, each with the number of the item it belongs to.
template <typename T>
struct sphere_block {
    static constexpr std::uint32_t capacity = 8;

    T x[capacity];
    T y[capacity];
    T z[capacity];
    T radius[capacity];
    std::uint32_t item[capacity];

    void set(std::uint32_t lane, const vec3<T>& centre, T r, std::uint32_t index) {
        x[lane] = centre.x;
        y[lane] = centre.y;
        z[lane] = centre.z;
        radius[lane] = r;
        item[lane] = index;
    }
};

/// An item that a search found, and the squared distance of its centre.
template <typename T>
struct sphere_hit {
    std::uint32_t item;
    T distance2;
};

/// The finds of one search. Lives on the stack until they are more than 64.
template <typename T>
class sphere_hits {
public:
    sphere_hits() = default;
    sphere_hits(const sphere_hits&) = delete;
    sphere_hits& operator=(const sphere_hits&) = delete;

    /// Appends the lanes of `block` whose bit is set in `mask`.
    void append(const sphere_block<T>& block, const T* distance2, std::uint32_t mask) {
        if (count_ + sphere_block<T>::capacity > capacity_) { spill(); }
        for (std::uint32_t i = 0; mask >> i != 0; ++i) {
            if (mask >> i & 1u) { hits_[count_++] = {block.item[i], distance2[i]}; }
        }
    }

    [[nodiscard]] sphere_hit<T>* begin() { return hits_; }
    [[nodiscard]] sphere_hit<T>* end() { return hits_ + count_; }

    /// Drops the finds for which `wanted` is false.
    template <typename Wanted>
    void keep_if(Wanted&& wanted) {
        const auto last = std::remove_if(begin(), end(), [&](const sphere_hit<T>& hit) { return !wanted(hit); });
        count_ = static_cast<std::size_t>(last - begin());
    }

    void sort() {
        std::sort(begin(), end(), [](const sphere_hit<T>& a, const sphere_hit<T>& b) { return a.item < b.item; });
    }

private:
    void spill() {
        std::vector<sphere_hit<T>> more(2 * capacity_);
        std::copy_n(hits_, count_, more.begin());
        many_.swap(more);
        hits_ = many_.data();
        capacity_ = many_.size();
    }

    std::array<sphere_hit<T>, 64> few_;
    std::vector<sphere_hit<T>> many_{};
    sphere_hit<T>* hits_ = few_.data();
    std::size_t count_ = 0;
    std::size_t capacity_ = few_.size();
};

/// How far rounding may carry a distance past its limit: a search box is this much wider than the spheres it looks for.
template <typename T>
inline constexpr T search_margin = T(1) + 8 * std::numeric_limits<T>::epsilon();

/// Which spheres cover `point`?
template <typename T>
struct covering_question {
    vec3<T> point;

    /// Half the width of the box around the point that holds the centre of every answer with a radius up to `largest`.
    [[nodiscard]] T reach(T largest) const { return largest * search_margin<T>; }
    [[nodiscard]] T limit2(T radius) const { return radius * radius; }
};

/// Which spheres have their centre within `distance` of `point`?
template <typename T>
struct within_question {
    vec3<T> point;
    T distance;

    [[nodiscard]] T reach(T) const { return distance * search_margin<T>; }
    [[nodiscard]] T limit2(T) const { return distance * distance; }
};

/// Adds the answers among the first `count` spheres of `block` to `found`.
template <typename T, typename Question>
void ask(const sphere_block<T>& block, std::uint32_t count, const Question& question, sphere_hits<T>& found) {
    T distance2[sphere_block<T>::capacity];
    std::uint32_t mask = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const T x = block.x[i] - question.point.x;
        const T y = block.y[i] - question.point.y;
        const T z = block.z[i] - question.point.z;
        distance2[i] = x * x + y * y + z * z;
        mask |= std::uint32_t{distance2[i] <= question.limit2(block.radius[i])} << i;
    }
    if (mask != 0) { found.append(block, distance2, mask); }
}

/// Shows `items[i]` for the finds, in ascending order of i, to `visitor`, which may return false to stop.
template <typename T, typename Items, typename Visitor>
void show(sphere_hits<T>& found, const Items& items, Visitor&& visitor) {
    found.sort();
    for (const sphere_hit<T>& hit : found) {
        if constexpr (std::is_void_v<decltype(visitor(items[hit.item]))>) {
            visitor(items[hit.item]);
        } else {
            if (!visitor(items[hit.item])) { return; }
        }
    }
}

}  // namespace aglow
