// Two registers side by side, or two pairs of them: the same operations, twice as wide.
#pragma once

#include <bit>
#include <cstdint>

namespace aglow::simd {

/// A register is what a machine has: `width` numbers of a scalar, their operations, and how its machine compresses
/// sixteen whole numbers (`numbers`). Pairs make sixteen lanes of it, a pack. Always inlined, so that a pair is
/// compiled for the machine of the kernel that it stands in.
template <typename Half>
struct pair {
    using scalar = typename Half::scalar;
    using numbers = typename Half::numbers;
    static constexpr unsigned width = 2 * Half::width;
    Half a, b;

    [[gnu::always_inline]] static inline pair load(const scalar* from) {
        return {Half::load(from), Half::load(from + Half::width)};
    }
    [[gnu::always_inline]] static inline pair all(scalar x) {
        const Half half = Half::all(x);
        return {half, half};
    }
    [[gnu::always_inline]] static inline void store(scalar* to, const pair& p) {
        Half::store(to, p.a);
        Half::store(to + Half::width, p.b);
    }
    [[gnu::always_inline]] static inline pair sub(const pair& p, const pair& q) {
        return {Half::sub(p.a, q.a), Half::sub(p.b, q.b)};
    }
    [[gnu::always_inline]] static inline pair min(const pair& p, const pair& q) {
        return {Half::min(p.a, q.a), Half::min(p.b, q.b)};
    }
    [[gnu::always_inline]] static inline pair max(const pair& p, const pair& q) {
        return {Half::max(p.a, q.a), Half::max(p.b, q.b)};
    }
    [[gnu::always_inline]] static inline pair length2(const pair& x, const pair& y, const pair& z) {
        return {Half::length2(x.a, y.a, z.a), Half::length2(x.b, y.b, z.b)};
    }
    [[gnu::always_inline]] static inline std::uint32_t less(const pair& p, const pair& q) {
        return Half::less(p.a, q.a) | Half::less(p.b, q.b) << Half::width;
    }
    [[gnu::always_inline]] static inline std::uint32_t equal(const pair& p, const pair& q) {
        return Half::equal(p.a, q.a) | Half::equal(p.b, q.b) << Half::width;
    }
    [[gnu::always_inline]] static inline pair step(const pair& p, const pair& x, const pair& y) {
        return {Half::step(p.a, x.a, y.a), Half::step(p.b, x.b, y.b)};
    }
    [[gnu::always_inline]] static inline scalar smallest(const pair& p) { return Half::smallest(Half::min(p.a, p.b)); }
    [[gnu::always_inline]] static inline scalar largest(const pair& p) { return Half::largest(Half::max(p.a, p.b)); }
    [[gnu::always_inline]] static inline pair without(const pair& p, std::uint32_t lane) {
        return {Half::without(p.a, lane), Half::without(p.b, lane - Half::width)};
    }
    [[gnu::always_inline]] static inline std::uint32_t count(std::uint32_t mask) { return numbers::count(mask); }
    [[gnu::always_inline]] static inline void compress(scalar* to, const pair& p, std::uint32_t mask) {
        constexpr std::uint32_t low = (1u << Half::width) - 1;
        Half::compress(to, p.a, mask & low);
        Half::compress(to + numbers::count(mask & low), p.b, mask >> Half::width);
    }
    [[gnu::always_inline]] static inline void compress(std::uint32_t* to, const std::uint32_t* from,
                                                       std::uint32_t mask) {
        numbers::compress(to, from, mask);
    }
    [[gnu::always_inline]] static inline void compress_numbers(std::uint32_t* to, std::uint32_t first,
                                                               std::uint32_t mask) {
        numbers::compress_numbers(to, first, mask);
    }
};

}  // namespace aglow::simd
