// The exact k-th of many numbers, from a sorted sample that brackets it: how a kd-tree finds where to cut.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <tuple>

#include <aglow/containers/kd_select.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// A number of many, how many are less and how many are equal.
template <typename T>
struct kd_rank {
    T value;
    std::uint32_t less, equal;
};

/// Room to find numbers by rank in.
template <typename T>
class kd_room {
public:
    static constexpr std::uint32_t most_samples = 1024;

    /// Room for `most` numbers.
    explicit kd_room(std::uint32_t most) {
        for (auto& half : halves_) { half = std::make_unique_for_overwrite<T[]>(most + 2 * simd::lanes); }
    }
    [[nodiscard]] T* half(unsigned round) { return halves_[round % 2].get(); }

    /// Two numbers of a sample between which the k-th of many is likely to lie.
    [[gnu::noinline]] kd_interval<T> sampled(const T* numbers, std::uint32_t count, std::uint32_t k) {
        const std::uint32_t samples = count >= 64 * most_samples ? most_samples : count >= 2048 ? 256 : kd_few;
        const std::uint32_t step = count / samples;
        for (std::uint32_t i = 0; i < samples; ++i) { sample_[i] = numbers[i * step + step / 2]; }
        const double share = static_cast<double>(k) / count;
        const double slack = 2.2 * std::sqrt(samples * share * (1 - share)) + 1;
        const auto clamp = [&](double at) {
            return static_cast<std::uint32_t>(std::clamp(at, 1.0, static_cast<double>(samples)));
        };
        T* const low = sample_.data() + (clamp(samples * share - slack) - 1);
        T* const high = sample_.data() + (clamp(samples * share + slack) - 1);
        std::nth_element(sample_.data(), high, sample_.data() + samples);
        std::nth_element(sample_.data(), low, high);
        return {*low, *high};
    }

private:
    std::array<std::unique_ptr<T[]>, 2> halves_;
    std::array<T, most_samples> sample_;
};

/// `value` among many numbers, of which `less` more are less.
struct rank_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_rank<T> run(const T* numbers, std::uint32_t count, T value,
                                                        std::uint32_t less) {
        kd_rank<T> rank{value, less, 0};
        const P pivot = P::all(value);
        for (std::uint32_t i = 0; i < count; i += simd::lanes) {
            const P v = P::load(numbers + i);
            rank.less += P::count(P::less(v, pivot));
            rank.equal += P::count(P::equal(v, pivot));
        }
        return rank;
    }
};

/// Copies the numbers larger than `value` to `to`, pads them and counts the others.
struct cut_above_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_bracket run(const T* numbers, std::uint32_t count, T value, T* to) {
        kd_bracket cut{0, 0};
        const P pivot = P::all(value);
        for (std::uint32_t i = 0; i < count; i += simd::lanes) {
            const P v = P::load(numbers + i);
            const std::uint32_t here = count - i < simd::lanes ? (1u << (count - i)) - 1 : 0xffffu;
            const std::uint32_t above = P::less(pivot, v) & here;
            P::compress(to + cut.inside, v, above);
            cut.inside += P::count(above);
            cut.below += P::count(here & ~above);
        }
        P::store(to + cut.inside, P::all(std::numeric_limits<T>::max()));
        return cut;
    }
};

/// The k-th smallest, k from 1, of `count` numbers in [low, high], of which only whole packs are read: what stands
/// behind the last in its pack must sort last.
template <typename Runner, typename T>
kd_rank<T> find_median(kd_room<T>& room, const T* numbers, std::uint32_t count, std::uint32_t k, kd_interval<T> range) {
    constexpr kd_interval<T> all{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max()};
    constexpr std::uint32_t sample_from = 4096;
    std::uint32_t less = 0;
    for (unsigned round = 0; count > kd_few; ++round) {
        const bool even = count <= sample_from && round < 6;
        const kd_interval<T> guess = even ? expected(count, k, range) : room.sampled(numbers, count, k);
        T* const inside = room.half(round);
        kd_bracket cut;
        if (guess.low < guess.high) {
            cut = cut_to_rank<Runner>(numbers, count, k, all, guess, inside);
        } else {
            const kd_rank<T> tie = Runner::template run<rank_kernel>(numbers, count, guess.low, less);
            const std::uint32_t below = tie.less - less;
            if (below < k && k <= below + tie.equal) { return tie; }
            cut = k <= below ? Runner::template run<cut_bracket_kernel>(numbers, count, all.low, guess.low, inside)
                             : Runner::template run<cut_above_kernel>(numbers, count, guess.low, inside);
        }
        less += cut.below;
        k -= cut.below;
        count = cut.inside;
        numbers = inside;
        if (count > kd_few) { range = Runner::template run<range_kernel>(numbers, count); }
    }
    const T kth = Runner::template run<kth_by_pairs_kernel>(numbers, count, k);
    return Runner::template run<rank_kernel>(numbers, count, kth, less);
}

}  // namespace aglow::detail
