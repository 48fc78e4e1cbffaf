// Spheres side by side, the questions a search asks of many at once, and its finds.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// How far rounding may carry a distance past its limit: a search box is this much wider than the spheres it looks for.
template <typename T>
inline constexpr T search_margin = T(1) + 8 * std::numeric_limits<T>::epsilon();

/// A sphere as an index keeps it: a point belongs to it if `simd::distance2` from the centre is below `limit2`.
template <typename T>
struct stored_sphere {
    vec3<T> centre;
    T limit2;
    std::uint32_t item;

    [[nodiscard]] T radius() const { return std::sqrt(limit2); }
};

/// What a squared distance is below when the distance is at most `distance`, which is not negative.
template <typename T>
[[nodiscard]] T limit2_of(T distance) {
    const T distance2 = distance * distance;
    return distance2 <= std::numeric_limits<T>::max() ? simd::next_above(distance2) : distance2;
}

/// `Lanes` spheres by coordinate, as vector instructions like them. An unused lane has a `limit2` of 0.
template <typename T, unsigned Lanes>
struct sphere_lanes {
    T x[Lanes];
    T y[Lanes];
    T z[Lanes];
    T limit2[Lanes];

    /// Makes a lane that answers no question.
    void clear(std::uint32_t lane) { set(lane, vec3<T>{std::numeric_limits<T>::infinity()}, T(0)); }

    void set(std::uint32_t lane, const vec3<T>& centre, T limit) {
        x[lane] = centre.x;
        y[lane] = centre.y;
        z[lane] = centre.z;
        limit2[lane] = limit;
    }
    [[nodiscard]] vec3<T> centre(std::uint32_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// The same, and whose spheres they are.
template <typename T, unsigned Lanes>
struct sphere_block : sphere_lanes<T, Lanes> {
    std::uint32_t item[Lanes];

    void set(std::uint32_t lane, const stored_sphere<T>& sphere) {
        sphere_lanes<T, Lanes>::set(lane, sphere.centre, sphere.limit2);
        item[lane] = sphere.item;
    }
    [[nodiscard]] stored_sphere<T> at(std::uint32_t lane) const {
        return {this->centre(lane), this->limit2[lane], item[lane]};
    }
};

/// The finds of one search: items and, if wanted, the squared distances of their centres. On the stack until they are
/// many.
template <typename T, bool WithDistances = false>
class sphere_hits {
public:
    sphere_hits() = default;
    sphere_hits(const sphere_hits&) = delete;
    sphere_hits& operator=(const sphere_hits&) = delete;

    /// Makes room for `more` finds, and for a pack of lanes to be written behind them.
    void reserve(std::size_t more) {
        if (count_ + more + simd::lanes > capacity_) { move_to_heap(2 * (count_ + more) + simd::lanes); }
    }

    /// Appends a find. Expects room for it.
    void append(std::uint32_t item, T distance2) {
        items_[count_] = item;
        if constexpr (WithDistances) { distances2_[count_] = distance2; }
        ++count_;
    }

    /// Where the next find goes.
    struct place {
        std::uint32_t* item;
        T* distance2;

        /// Appends `first + lane` for the lanes in `mask`. Expects room for them.
        template <typename Pack>
        [[gnu::always_inline]] void append(std::uint32_t first, const Pack& distances2, std::uint32_t mask) {
            Pack::compress_numbers(item, first, mask);
            item += std::popcount(mask);
            if constexpr (WithDistances) {
                Pack::compress(distance2, distances2, mask);
                distance2 += std::popcount(mask);
            }
        }
    };
    [[nodiscard]] place end() { return {items_ + count_, distances2_ + (WithDistances ? count_ : 0)}; }
    void end_at(const place& last) { count_ = static_cast<std::size_t>(last.item - items_); }

    /// Drops the finds for which `wanted(item, distance2)` is false.
    template <typename Wanted>
    void keep_if(Wanted&& wanted) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            if (wanted(items_[i], distances2_[i])) { items_[kept++] = items_[i]; }
        }
        count_ = kept;
    }

    /// Calls the finds from number `first` on `name(item)` instead.
    template <typename Name>
    void rename(std::size_t first, const Name& name) {
        for (std::size_t i = first; i < count_; ++i) { items_[i] = name(items_[i]); }
    }

    [[nodiscard]] std::size_t size() const { return count_; }
    /// What was found, in the order of finding.
    [[nodiscard]] std::span<const std::uint32_t> items() const { return {items_, count_}; }

    /// Calls `visitor(items[i])` or `visitor(items[i], i)` for the found i, in ascending order; the visitor may return
    /// false to stop.
    template <typename Items, typename Visitor>
    void show(const Items& items, Visitor& visitor) {
        sort();
        const auto call = [&](std::uint32_t i) {
            if constexpr (std::is_invocable_v<Visitor&, decltype(items[i]), std::uint32_t>) {
                return visitor(items[i], i);
            } else {
                return visitor(items[i]);
            }
        };
        for (std::size_t i = 0; i < count_; ++i) {
            if constexpr (std::is_void_v<decltype(call(0u))>) {
                call(items_[i]);
            } else {
                if (!call(items_[i])) { return; }
            }
        }
    }

private:
    static constexpr std::size_t few = 1024;
    static constexpr std::size_t lanes = simd::lanes;

    void sort() {
        if (count_ > lanes) {
            std::sort(items_, items_ + count_);
        } else if (count_ > 1) {
            sort_sixteen();
        }
    }

    // Counts for every find how many are smaller: no branch depends on the order they came in.
    void sort_sixteen() {
        std::array<std::uint32_t, lanes> came, smaller{};
        std::copy_n(items_, lanes, came.begin());
        for (std::size_t i = 0; i < count_; ++i) {
            for (std::size_t j = 0; j < lanes; ++j) { smaller[j] += came[i] < came[j]; }
        }
        for (std::size_t i = 0; i < count_; ++i) { items_[smaller[i]] = came[i]; }
    }

    void move_to_heap(std::size_t capacity) {
        auto items = std::make_unique<std::uint32_t[]>(capacity);
        std::copy_n(items_, count_, items.get());
        many_items_.swap(items);
        items_ = many_items_.get();
        if constexpr (WithDistances) {
            auto distances2 = std::make_unique<T[]>(capacity);
            std::copy_n(distances2_, count_, distances2.get());
            many_distances2_.swap(distances2);
            distances2_ = many_distances2_.get();
        }
        capacity_ = capacity;
    }

    std::array<std::uint32_t, few> few_items_;
    std::array<T, WithDistances ? few : 0> few_distances2_;
    std::unique_ptr<std::uint32_t[]> many_items_{};
    std::unique_ptr<T[]> many_distances2_{};
    std::uint32_t* items_ = few_items_.data();
    T* distances2_ = few_distances2_.data();
    std::size_t count_ = 0;
    std::size_t capacity_ = few;
};

/// Which spheres cover `point`?
template <typename T>
struct covering_question {
    vec3<T> point;

    /// Half the width of the box around the point that holds the centre of every answer with a radius up to `largest`.
    [[nodiscard]] T reach(T largest) const { return largest * search_margin<T>; }
    /// The box that meets the box around every answer.
    [[nodiscard]] bounds<T> box() const { return {point, point}; }
    [[nodiscard]] T limit2(T stored) const { return stored; }
    template <typename Pack>
    [[nodiscard, gnu::always_inline]] Pack limits2(const Pack& stored) const {
        return stored;
    }
};

/// Which spheres have their centre within a distance of `point`?
template <typename T>
struct within_question {
    vec3<T> point;
    T half_width;
    T limit;

    within_question(const vec3<T>& p, T distance)
        : point{p}, half_width{distance * search_margin<T>}, limit{limit2_of(distance)} {}

    [[nodiscard]] T reach(T) const { return half_width; }
    [[nodiscard]] bounds<T> box() const { return {point - half_width, point + half_width}; }
    [[nodiscard]] T limit2(T) const { return limit; }
    template <typename Pack>
    [[nodiscard, gnu::always_inline]] Pack limits2(const Pack&) const {
        return Pack::all(limit);
    }
};

/// Adds the answers in blocks of sixteen, `blocks[numbers[i]]` for i below `count`, to `found`, by place: sixteen times
/// the number of the block, and the lane.
struct ask_blocks {
    template <typename Pack, typename Block, typename Question, typename T, bool D>
    [[gnu::always_inline]] static void run(const Block* blocks, const std::uint32_t* numbers, std::uint32_t count,
                                           const Question& question, sphere_hits<T, D>& found) {
        // All that the loop needs is at hand by value: what it writes might else be what it reads.
        const Question asked = question;
        const Pack x = Pack::all(asked.point.x), y = Pack::all(asked.point.y), z = Pack::all(asked.point.z);
        found.reserve(count * simd::lanes);
        auto end = found.end();
        for (std::uint32_t i = 0; i < count; ++i) {
            const sphere_lanes<T, simd::lanes>& block = blocks[numbers[i]];
            const Pack distances2 = Pack::length2(Pack::sub(Pack::load(block.x), x), Pack::sub(Pack::load(block.y), y),
                                                  Pack::sub(Pack::load(block.z), z));
            end.append(numbers[i] * simd::lanes, distances2,
                       Pack::less(distances2, asked.limits2(Pack::load(block.limit2))));
        }
        found.end_at(end);
    }
};

/// Adds the answers among the first `count` spheres of a block to `found`, which has room for them; looks at no others,
/// for they may be in the making.
template <typename T, unsigned Lanes, typename Question, bool D>
void ask(const sphere_block<T, Lanes>& block, std::uint32_t count, const Question& question, sphere_hits<T, D>& found) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const T distance2 = simd::distance2(vec3<T>{block.x[i], block.y[i], block.z[i]}, question.point);
        if (distance2 < question.limit2(block.limit2[i])) { found.append(block.item[i], distance2); }
    }
}

#if defined(__AVX512F__) && defined(__AVX2__) && defined(__BMI__) && defined(__POPCNT__)
/// The same for floats, at once: a masked load touches no other lane.
template <unsigned Lanes, typename Question, bool D>
    requires(Lanes <= simd::lanes)
void ask(const sphere_block<float, Lanes>& block, std::uint32_t count, const Question& question,
         sphere_hits<float, D>& found) {
    const auto ready = static_cast<std::uint16_t>((1u << count) - 1u);
    const auto load = [ready](const float(&from)[Lanes]) {
        simd::avx512 a;
        asm("vmovups %1, %0%{%2%}%{z%}" : "=v"(a.v) : "m"(from), "Yk"(ready));
        return a;
    };
    const auto from_point = [](simd::avx512 a, float p) { return simd::avx512::sub(a, simd::avx512::all(p)); };
    const simd::avx512 distances2 =
        simd::avx512::length2(from_point(load(block.x), question.point.x), from_point(load(block.y), question.point.y),
                              from_point(load(block.z), question.point.z));
    const simd::avx512 limits2 = question.limits2(load(block.limit2));
    std::uint32_t mask = simd::avx512::less(distances2, limits2) & ready;
    if (mask == 0) { return; }
    float each[simd::lanes];
    simd::avx512::store(each, distances2);
    for (; mask != 0; mask &= mask - 1) {
        const int lane = std::countr_zero(mask);
        found.append(block.item[lane], each[lane]);
    }
}
#endif

}  // namespace aglow
