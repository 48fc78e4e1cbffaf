// How a range of points is halved: at the exact median of its widest side, in one pass that keeps the order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include <aglow/containers/kd_cloud.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_median.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// A range of a cloud that is to be moved to another, at the same places.
template <typename T>
struct kd_move {
    const kd_cloud<T>& from;
    kd_cloud<T>& to;
    std::uint32_t first, count;

    [[nodiscard]] const T* numbers(std::uint32_t axis) const { return from.at[axis].get() + first; }
};

/// Where a range is cut: `left` points go left, those below `pivot` and the first `ties` of the `tied` that equal it.
template <typename T>
struct kd_cut {
    std::uint32_t axis, left, ties, tied;
    T pivot;
};

template <typename T>
struct kd_side {
    std::uint32_t axis;
    kd_interval<T> range;
    [[nodiscard]] T width() const { return range.high - range.low; }
};

/// The cut of the widest side of a range of more than sixteen points; where more than 1/16 of the points tie at the
/// median, as points on a wall do, that of the next side with fewer ties.
template <typename Runner, typename T>
kd_cut<T> choose_cut(const kd_move<T>& move, std::uint32_t left, kd_room<T>& room) {
    std::array<kd_side<T>, 3> sides;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        sides[axis] = {axis, Runner::template run<range_kernel>(move.numbers(axis), move.count)};
    }
    if (sides[0].width() < sides[1].width()) { std::swap(sides[0], sides[1]); }
    if (sides[1].width() < sides[2].width()) { std::swap(sides[1], sides[2]); }
    if (sides[0].width() < sides[1].width()) { std::swap(sides[0], sides[1]); }
    kd_cut<T> best{};
    for (std::size_t i = 0; i < 3; ++i) {
        if (i > 0 && (best.tied <= move.count / 16 || sides[i].width() <= sides[0].width() / 4)) { break; }
        const std::uint32_t axis = sides[i].axis;
        const kd_rank<T> rank = find_median<Runner>(room, move.numbers(axis), move.count, left, sides[i].range);
        if (i == 0 || rank.equal < best.tied) { best = {axis, left, left - rank.less, rank.equal, rank.value}; }
    }
    return best;
}

/// The lowest of the tied lanes, as many as may still go left.
template <typename P>
[[gnu::always_inline]] inline std::uint32_t take_ties(std::uint32_t tied, std::uint32_t& may) {
    const auto count = P::count(tied);
    if (count > may) {
        while (P::count(tied) > may) { tied ^= std::bit_floor(tied); }
    }
    may -= std::min(count, may);
    return tied;
}

/// Moves the lanes of `mask` from place `i` of a cloud to place `to` of the other, one by one.
template <typename T>
[[gnu::noinline]] void move_few(const kd_move<T>& move, std::uint32_t i, std::uint32_t mask, std::uint32_t to) {
    for (; mask != 0; mask &= mask - 1, ++to) {
        const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
        for (std::size_t a = 0; a < 3; ++a) { move.to.at[a][to] = move.from.at[a][i + lane]; }
        move.to.index[to] = move.from.index[i + lane];
    }
}

/// As move_few, writing nothing from `end` on.
template <typename P, typename T>
[[gnu::always_inline]] inline void move_lanes(const kd_move<T>& move, std::uint32_t i, std::uint32_t mask,
                                              std::uint32_t to, std::uint32_t end) {
    if (to + simd::lanes > end) { return move_few(move, i, mask, to); }
    for (std::size_t a = 0; a < 3; ++a) { P::compress(&move.to.at[a][to], P::load(&move.from.at[a][i]), mask); }
    P::compress(&move.to.index[to], &move.from.index[i], mask);
}

/// Moves the points of a range that a cut sends left to its front in the other cloud, and the others behind them.
struct part_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_move<T>& move, kd_cut<T> cut) {
        const T* key = move.from.at[cut.axis].get();
        const std::uint32_t middle = move.first + cut.left;
        const std::uint32_t end = move.first + move.count;
        const P pivot = P::all(cut.pivot);
        std::uint32_t l = move.first;
        std::uint32_t h = middle;
        for (std::uint32_t i = move.first; i < end; i += simd::lanes) {
            const P v = P::load(key + i);
            const std::uint32_t here = end - i < simd::lanes ? (1u << (end - i)) - 1 : 0xffffu;
            std::uint32_t goes_left = P::less(v, pivot);
            if (cut.ties > 0) { goes_left |= take_ties<P>(P::equal(v, pivot), cut.ties); }
            goes_left &= here;
            const std::uint32_t goes_right = here & ~goes_left;
            move_lanes<P>(move, i, goes_left, l, middle);
            move_lanes<P>(move, i, goes_right, h, end);
            l += P::count(goes_left);
            h += P::count(goes_right);
        }
    }
};

/// Moves `left` points of a range to its front in the other cloud, and the others behind them.
template <typename Runner, typename T>
void halve(const kd_move<T>& move, std::uint32_t left, kd_room<T>& room) {
    Runner::template run<part_kernel>(move, choose_cut<Runner>(move, left, room));
}

}  // namespace aglow::detail
