// The k smallest of many numbers, exactly: guess a bracket, count, and rank the few inside by comparing all pairs.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/containers/kd_layout.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>

namespace aglow::detail {

/// Runs kernels with the best pack of the machine.
template <typename T>
struct kd_best_runner {
    template <typename Kernel, typename... Arguments>
    [[gnu::always_inline]] static inline auto run(Arguments&&... arguments) {
        return simd::run_best<T, Kernel>(arguments...);
    }
};

/// Runs kernels with one pack.
template <typename P>
struct kd_pack_runner {
    template <typename Kernel, typename... Arguments>
    [[gnu::always_inline]] static inline auto run(Arguments&&... arguments) {
        return simd::call<P, Kernel>(arguments...);
    }
};

/// Up to this many numbers are ranked by comparing all pairs.
inline constexpr std::uint32_t kd_few = 32;

/// Fills the sixteen places behind `count` numbers with what sorts last.
template <typename T>
void pad(T* numbers, std::uint32_t count) {
    std::fill_n(numbers + count, std::size_t{simd::lanes}, std::numeric_limits<T>::max());
}

/// The k-th smallest, k from 1, of few padded numbers: that which k - 1 are less than. Ranks are counted in steps up
/// from one.
struct kth_by_pairs_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline T run(const T* numbers, std::uint32_t count, std::uint32_t k) {
        using bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
        static_assert(kd_few == 2 * simd::lanes);
        const P some = P::load(numbers);
        const P others = P::load(numbers + (count > simd::lanes ? simd::lanes : 0));
        P some_ranks = P::all(T(1));
        P others_ranks = some_ranks;
        for (std::uint32_t i = 0; i < (count + 7) / 8 * 8; ++i) {
            const P pivot = P::all(numbers[i]);
            some_ranks = P::step(some_ranks, pivot, some);
            others_ranks = P::step(others_ranks, pivot, others);
        }
        const auto there = static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1);
        for (;; --k) {
            const P rank = P::all(std::bit_cast<T>(std::bit_cast<bits>(T(1)) + (k - 1)));
            const std::uint32_t has = P::equal(some_ranks, rank) | P::equal(others_ranks, rank) << simd::lanes;
            // Those just as far have the rank of the first of them.
            if ((has & there) != 0) { return numbers[std::countr_zero(has & there)]; }
        }
    }
};

struct kd_bracket {
    std::uint32_t below, inside;
};

/// Copies the padded numbers in [low, high) to `to`, pads them and counts those below.
struct cut_bracket_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_bracket run(const T* numbers, std::uint32_t count, T low, T high, T* to) {
        const P low16 = P::all(low);
        const P high16 = P::all(high);
        kd_bracket cut{0, 0};
        for (std::uint32_t i = 0; i < count; i += simd::lanes) {
            const P v = P::load(numbers + i);
            const std::uint32_t below = P::less(v, low16);
            const std::uint32_t inside = P::less(v, high16) & ~below;
            P::compress(to + cut.inside, v, inside);
            cut.below += P::count(below);
            cut.inside += P::count(inside);
        }
        P::store(to + cut.inside, P::all(std::numeric_limits<T>::max()));
        return cut;
    }
};

template <typename T>
struct kd_interval {
    T low, high;
};

/// The smallest and the largest of sixteen numbers or more; what stands behind the last is not read.
struct range_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_interval<T> run(const T* numbers, std::uint32_t count) {
        P low = P::load(numbers + (count - simd::lanes));
        P high = low;
        for (std::uint32_t i = 0; i + simd::lanes <= count; i += simd::lanes) {
            const P v = P::load(numbers + i);
            low = P::min(low, v);
            high = P::max(high, v);
        }
        return {P::smallest(low), P::largest(high)};
    }
};

/// The k-th smallest of any numbers, by way of a copy.
template <typename T>
[[nodiscard, gnu::noinline]] T kth_by_moving(const T* numbers, std::uint32_t count, std::uint32_t k, T* copy) {
    std::copy(numbers, numbers + count, copy);
    std::nth_element(copy, copy + (k - 1), copy + count);
    return copy[k - 1];
}

/// Copies those of padded numbers in `all` to `to` that the k-th is among: these in `guess`, or those at one side of
/// it.
template <typename Runner, typename T>
kd_bracket cut_to_rank(const T* numbers, std::uint32_t count, std::uint32_t k, kd_interval<T> all, kd_interval<T> guess,
                       T* to) {
    const kd_bracket cut = Runner::template run<cut_bracket_kernel>(numbers, count, guess.low, guess.high, to);
    if (cut.below < k && k <= cut.below + cut.inside) { return cut; }
    const kd_interval<T> side =
        k <= cut.below ? kd_interval<T>{all.low, guess.low} : kd_interval<T>{guess.high, all.high};
    return Runner::template run<cut_bracket_kernel>(numbers, count, side.low, side.high, to);
}

/// Two numbers between which the k-th is likely to lie if all are even in [low, high].
template <typename T>
[[nodiscard]] kd_interval<T> expected(std::uint32_t count, std::uint32_t k, kd_interval<T> range) {
    const auto [low, high] = range;
    const T n = static_cast<T>(count);
    const T rank = static_cast<T>(k) - T(0.5);
    const T slack = T(1.6) * std::sqrt(rank * (n - rank) / n) + 2;
    const T step = (high - low) / n;
    return {std::max(low, low + step * (rank - slack)), std::min(high, low + step * (rank + slack))};
}

/// The same where they are not even, judged by a few of them.
template <typename Runner, typename T>
[[nodiscard, gnu::noinline]] kd_interval<T> expected_by_sample(const T* numbers, std::uint32_t count, std::uint32_t k) {
    T sample[kd_few + simd::lanes];
    for (std::uint32_t i = 0; i < kd_few; ++i) {
        sample[i] = numbers[static_cast<std::size_t>(std::uint64_t{i} * count / kd_few)];
    }
    pad(sample, kd_few);
    const auto rank = static_cast<std::uint32_t>(std::uint64_t{k} * kd_few / count);
    const T* const few = sample;
    const auto at = [&](std::uint32_t r) { return Runner::template run<kth_by_pairs_kernel>(few, kd_few, r); };
    return {at(rank > 4 ? rank - 3 : 1), simd::next_above(at(std::min(rank + 4, kd_few)))};
}

/// The k-th smallest, k from 1, of numbers in [0, bound), faster where they are roughly even.
/// `given` and the two spares have room for sixteen more.
template <typename Runner, typename T>
[[nodiscard]] T kth_smallest(T* given, std::uint32_t count, std::uint32_t k, T bound, T* spare, T* other) {
    kd_interval<T> all{0, bound};
    pad(given, count);
    const T* numbers = given;
    for (int round = 0; count > kd_few && round < 8; ++round) {
        if (round > 0) {
            const auto [least, most] = Runner::template run<range_kernel>(numbers, count);
            if (least == most) { return least; }
            all = {least, simd::next_above(most)};
        }
        const kd_interval<T> guess =
            round < 2 ? expected(count, k, all) : expected_by_sample<Runner>(numbers, count, k);
        const kd_bracket cut = cut_to_rank<Runner>(numbers, count, k, all, guess, spare);
        k -= cut.below;
        count = cut.inside;
        numbers = spare;
        std::swap(spare, other);
    }
    if (count <= kd_few) { return Runner::template run<kth_by_pairs_kernel>(numbers, count, k); }
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

/// Keeps those of padded candidates that are closer than `bound`; returns how many.
struct keep_below_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline std::uint32_t run(T* distances2, std::uint32_t* slots, std::uint32_t count,
                                                           T bound) {
        const P limit = P::all(bound);
        std::uint32_t kept = 0;
        for (std::uint32_t i = 0; i < count; i += simd::lanes) {
            const P v = P::load(distances2 + i);
            const std::uint32_t mask = P::less(v, limit);
            P::compress(distances2 + kept, v, mask);
            P::compress(slots + kept, slots + i, mask);
            kept += P::count(mask);
        }
        return kept;
    }
};

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
template <typename Runner, typename T>
T keep_nearest(const kd_storage<T>& tree, kd_candidates<T>& found, std::uint32_t k, T bound) {
    T* const distances2 = found.distances2.data();
    const T farthest = kth_smallest<Runner>(distances2, found.count, k, bound, found.spare.data(), found.other.data());
    found.count = Runner::template run<keep_below_kernel>(distances2, found.slots.data(), found.count,
                                                          simd::next_above(farthest));
    if (found.count > k) { break_ties(tree, found, farthest, k); }
    return farthest;
}

}  // namespace aglow::detail
