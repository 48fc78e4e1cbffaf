// The k smallest of many numbers, exactly: guess a bracket, count, and rank the few inside by comparing all pairs.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Up to this many numbers are ranked by comparing all pairs.
inline constexpr std::uint32_t kd_few = 32;

/// Fills the sixteen places behind `count` numbers with what sorts last.
template <typename P, typename T>
[[gnu::always_inline]] inline void pad(T* numbers, std::uint32_t count) {
    P::store(numbers + count, P::all(std::numeric_limits<T>::max()));
}

/// The k-th smallest, k from 1, of padded numbers.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline T kth_by_pairs(const T* numbers, std::uint32_t count, std::uint32_t k) {
    T kth = numbers[0];
    bool first = true;
    for (std::uint32_t i = 0; i < count; ++i) {
        const P pivot = P::all(numbers[i]);
        std::uint32_t below = 0;
        for (std::uint32_t j = 0; j < count; j += simd::lanes) {
            below += static_cast<std::uint32_t>(std::popcount(P::less(P::load(numbers + j), pivot)));
        }
        if (below < k && (first || kth < numbers[i])) {
            kth = numbers[i];
            first = false;
        }
    }
    return kth;
}

struct kd_bracket {
    std::uint32_t below, inside;
};

/// Copies the padded numbers in [low, high) to `to` and counts those below.
template <typename P, typename T>
[[gnu::always_inline]] inline kd_bracket cut_bracket(const T* numbers, std::uint32_t count, T low, T high, T* to) {
    const P low16 = P::all(low);
    const P high16 = P::all(high);
    kd_bracket cut{0, 0};
    for (std::uint32_t i = 0; i < count; i += simd::lanes) {
        const P v = P::load(numbers + i);
        const std::uint32_t below = P::less(v, low16);
        const std::uint32_t inside = P::less(v, high16) & ~below;
        P::compress(to + cut.inside, v, inside);
        cut.below += static_cast<std::uint32_t>(std::popcount(below));
        cut.inside += static_cast<std::uint32_t>(std::popcount(inside));
    }
    return cut;
}

/// The smallest and the largest of numbers padded with what sorts last.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline std::pair<T, T> range_of(const T* numbers, std::uint32_t count) {
    P low = P::load(numbers);
    P high = P::all(numbers[0]);
    for (std::uint32_t i = 0; i + simd::lanes <= count; i += simd::lanes) {
        const P v = P::load(numbers + i);
        low = P::min(low, v);
        high = P::max(high, v);
    }
    std::pair<T, T> range{P::smallest(low), P::largest(high)};
    for (std::uint32_t i = count / simd::lanes * simd::lanes; i < count; ++i) {
        range = {std::min(range.first, numbers[i]), std::max(range.second, numbers[i])};
    }
    return range;
}

/// The k-th smallest of any numbers, by way of a copy.
template <typename T>
[[nodiscard, gnu::noinline]] T kth_by_moving(const T* numbers, std::uint32_t count, std::uint32_t k, T* copy) {
    std::copy(numbers, numbers + count, copy);
    std::nth_element(copy, copy + (k - 1), copy + count);
    return copy[k - 1];
}

/// The k-th smallest, k from 1, of numbers in [0, bound), which must be roughly even to be fast.
/// `numbers` and the two spares have room for sixteen more.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline T kth_smallest(T* numbers, std::uint32_t count, std::uint32_t k, T bound,
                                                        T* spare, T* other) {
    T low = 0;
    T high = bound;
    pad<P>(numbers, count);
    for (int round = 0; count > kd_few && round < 5; ++round) {
        if (round > 0) {
            const auto [least, most] = range_of<P>(numbers, count);
            if (least == most) { return least; }
            low = least;
            high = simd::next_above(most);
        }
        const T n = static_cast<T>(count);
        const T rank = static_cast<T>(k) - T(0.5);
        const T slack = T(1.6) * std::sqrt(rank * (n - rank) / n) + 2;
        const T step = (high - low) / n;
        const T from = std::max(low, low + step * (rank - slack));
        const T to = std::min(high, low + step * (rank + slack));
        kd_bracket cut = cut_bracket<P>(numbers, count, from, to, spare);
        if (k <= cut.below) {
            cut = cut_bracket<P>(numbers, count, low, from, spare);
            high = from;
        } else if (k <= cut.below + cut.inside) {
            low = from;
            high = to;
        } else {
            cut = cut_bracket<P>(numbers, count, to, high, spare);
            low = to;
        }
        k -= cut.below;
        count = cut.inside;
        pad<P>(spare, count);
        numbers = spare;
        std::swap(spare, other);
    }
    if (count <= kd_few) { return kth_by_pairs<P>(numbers, count, k); }
    return kth_by_moving(numbers, count, k, spare);
}

/// What a search found so far, in ascending order of slots.
template <typename T>
struct kd_candidates {
    std::vector<T> distances2, spare, other;
    std::vector<std::uint32_t> slots, ranks;
    std::uint32_t count{0};

    /// Room for `capacity` candidates.
    void reserve(std::size_t capacity) {
        const std::size_t room = capacity + simd::lanes;
        if (slots.size() >= room) { return; }
        for (std::vector<T>* numbers : {&distances2, &spare, &other}) { numbers->resize(room); }
        slots.resize(room);
    }
    [[nodiscard]] std::uint32_t capacity() const { return static_cast<std::uint32_t>(slots.size()) - simd::lanes; }
};

/// Keeps the candidates closer than `bound`.
template <typename P, typename T>
[[gnu::always_inline]] inline void keep_below(kd_candidates<T>& found, T bound) {
    const P limit = P::all(bound);
    pad<P>(found.distances2.data(), found.count);
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < found.count; i += simd::lanes) {
        const P v = P::load(found.distances2.data() + i);
        const std::uint32_t mask = P::less(v, limit);
        P::compress(found.distances2.data() + kept, v, mask);
        P::compress(found.slots.data() + kept, found.slots.data() + i, mask);
        kept += static_cast<std::uint32_t>(std::popcount(mask));
    }
    found.count = kept;
}

/// Keeps k of the candidates, which are no farther than `farthest`: of those just as far, the lowest by rank.
template <typename T>
[[gnu::noinline]] void break_ties(const kd_storage<T>& tree, kd_candidates<T>& found, T farthest, std::uint32_t k) {
    found.ranks.clear();
    for (std::uint32_t i = 0; i < found.count; ++i) {
        if (found.distances2[i] >= farthest) { found.ranks.push_back(tree.rank(found.slots[i])); }
    }
    const std::uint32_t excess = found.count - k;
    const auto last = found.ranks.end() - static_cast<std::ptrdiff_t>(excess) - 1;
    // Those of one place come sorted.
    if (!std::is_sorted(found.ranks.begin(), found.ranks.end())) {
        std::nth_element(found.ranks.begin(), last, found.ranks.end());
    }
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < found.count; ++i) {
        if (found.distances2[i] >= farthest && tree.rank(found.slots[i]) > *last) { continue; }
        found.distances2[kept] = found.distances2[i];
        found.slots[kept++] = found.slots[i];
    }
    found.count = kept;
}

/// Keeps the k nearest of at least k candidates, all closer than `bound`, and returns the distance2 of the k-th.
template <typename P, typename T>
[[gnu::always_inline]] inline T keep_nearest(const kd_storage<T>& tree, kd_candidates<T>& found, std::uint32_t k,
                                             T bound) {
    const T farthest =
        kth_smallest<P>(found.distances2.data(), found.count, k, bound, found.spare.data(), found.other.data());
    keep_below<P>(found, simd::next_above(farthest));
    if (found.count > k) { break_ties(tree, found, farthest, k); }
    return farthest;
}

}  // namespace aglow::detail
