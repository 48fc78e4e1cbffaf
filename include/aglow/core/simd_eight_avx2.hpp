// Eight floats in an AVX2 register, and eight whole numbers: what `plain_eight` and `plain_words` say.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,popcnt")
#endif

namespace aglow::simd {

/// What kernels of eight floats ask for: `run_best<eight, Kernel>(...)`.
struct eight;

/// Eight whole numbers in a register.
struct avx2_words {
    using vector [[gnu::vector_size(32)]] = std::int32_t;
    using four [[gnu::vector_size(16)]] = std::int32_t;
    using pairs [[gnu::vector_size(32)]] = std::int64_t;
    using unaligned_four [[gnu::vector_size(16), gnu::aligned(1), gnu::may_alias]] = std::int32_t;
    using unaligned [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = std::int32_t;
    static constexpr std::size_t together = 4;
    vector v;

    static avx2_words all(std::int32_t x) { return {x - vector{}}; }
    static avx2_words load(const std::int32_t* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static void store(std::int32_t* to, avx2_words a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx2_words pick(avx2_words where, avx2_words a, avx2_words b) {
        return {(where.v & a.v) | (~where.v & b.v)};
    }
    static avx2_words below(std::size_t some) {
        return {vector{0, 1, 2, 3, 4, 5, 6, 7} < static_cast<std::int32_t>(some) - vector{}};
    }
    static std::uint32_t count_of(avx2_words where) {
        std::uint32_t mask;
        asm("vmovmskps %1, %0" : "=r"(mask) : "x"(where.v));
        return static_cast<std::uint32_t>(std::popcount(mask));
    }
    static avx2_words first_half(avx2_words a) { return {a.v << 16}; }
    static avx2_words last_half(avx2_words a) { return {a.v & -0x10000}; }
    static avx2_words column(const char* const* rows, std::size_t offset) {
        std::int32_t each[8];
        for (std::size_t i = 0; i < 8; ++i) { std::memcpy(&each[i], rows[i] + offset, sizeof(each[i])); }
        return {vector{each[0], each[1], each[2], each[3], each[4], each[5], each[6], each[7]}};
    }
    // Four by four are turned in each half of a register.
    static void columns(const char* const* rows, std::size_t offset, avx2_words* to) {
        const vector a = two(rows, 0, offset), b = two(rows, 1, offset);
        const vector c = two(rows, 2, offset), d = two(rows, 3, offset);
        const pairs ab = (pairs)__builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
        const pairs cd = (pairs)__builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
        to[0].v = (vector)__builtin_shufflevector(ab, cd, 0, 4, 2, 6);
        to[1].v = (vector)__builtin_shufflevector(ab, cd, 1, 5, 3, 7);
        const pairs ab2 = (pairs)__builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
        const pairs cd2 = (pairs)__builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
        to[2].v = (vector)__builtin_shufflevector(ab2, cd2, 0, 4, 2, 6);
        to[3].v = (vector)__builtin_shufflevector(ab2, cd2, 1, 5, 3, 7);
    }

private:
    static vector two(const char* const* rows, std::size_t i, std::size_t offset) {
        const four low = *reinterpret_cast<const unaligned_four*>(rows[i] + offset);
        vector both;
        asm("vinserti128 $1, %2, %t1, %0"
            : "=x"(both)
            : "x"(low), "m"(*reinterpret_cast<const unaligned_four*>(rows[i + 4] + offset)));
        return both;
    }
};

// Not among the friends of a class: g++ 12 compiles those for the machine of the flags.
inline avx2_words operator&(avx2_words a, avx2_words b) { return {a.v & b.v}; }
inline avx2_words operator-(avx2_words a, avx2_words b) { return {a.v - b.v}; }
inline avx2_words operator>>(avx2_words a, int bits) { return {a.v >> bits}; }
inline avx2_words operator<<(avx2_words a, int bits) { return {a.v << bits}; }

/// Eight floats in a register.
struct avx2_eight {
    using scalar = eight;
    using words = avx2_words;
    using vector [[gnu::vector_size(32)]] = float;
    using unaligned [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = float;
    using doubles [[gnu::vector_size(32)]] = double;
    using four [[gnu::vector_size(16)]] = float;
    static constexpr std::size_t count = 8;
    vector v;

    static avx2_eight load(const float* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static void store(float* to, avx2_eight a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx2_eight all(float x) { return {x - vector{}}; }
    static avx2_eight of(words a) { return {__builtin_convertvector(a.v, vector)}; }
    static avx2_eight from_bits(words a) { return {(vector)a.v}; }
    static avx2_eight min(avx2_eight a, avx2_eight b) {
        vector least;
        asm("vminps %2, %1, %0" : "=x"(least) : "x"(a.v), "xm"(b.v));
        return {least};
    }
    static avx2_eight max(avx2_eight a, avx2_eight b) {
        vector most;
        asm("vmaxps %2, %1, %0" : "=x"(most) : "x"(a.v), "xm"(b.v));
        return {most};
    }
    static avx2_eight picked(const float* table, words places) {
        vector picked;
        asm("vpermps %2, %1, %0" : "=x"(picked) : "x"(places.v), "xm"(load(table).v));
        return {picked};
    }
    static avx2_eight abs(avx2_eight a) { return {(vector)((words::vector)a.v & 0x7fffffff)}; }
    static avx2_eight root(avx2_eight a) {
        vector r;
        asm("vsqrtps %1, %0" : "=x"(r) : "xm"(a.v));
        return {r};
    }
    static avx2_eight where(words holds, avx2_eight a) { return {(vector)((words::vector)a.v & holds.v)}; }
    template <std::size_t N>
    static void add_sums(const avx2_eight (&of)[N], std::array<float, N>& to) {
        constexpr std::size_t by_four = N / 4 * 4;
        for (std::size_t i = 0; i < by_four; i += 4) {
            const four all = sums(halves(of[i]), halves(of[i + 1]), halves(of[i + 2]), halves(of[i + 3]));
            for (std::size_t k = 0; k < 4; ++k) { to[i + k] += all[k]; }
        }
        for (std::size_t i = by_four; i < N; ++i) { to[i] += sum(halves(of[i])); }
    }
    /// A product by itself: fused with a sum it would have other bits.
    static avx2_eight product(vector x) {
        asm("" : "+x"(x));
        return {x};
    }
    static double sum_of_squares(avx2_eight a) {
        const doubles low = wide(__builtin_shufflevector(a.v, a.v, 0, 1, 2, 3));
        const doubles high = wide(__builtin_shufflevector(a.v, a.v, 4, 5, 6, 7));
        const doubles half = product(low * low) + product(high * high);
        const doubles sums = half + __builtin_shufflevector(half, half, 2, 3, 2, 3);
        return sums[0] + sums[1];
    }

private:
    static four halves(avx2_eight a) {
        return __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3) + __builtin_shufflevector(a.v, a.v, 4, 5, 6, 7);
    }
    // In the order of `plain_eight`: the even ones and the odd ones of each, then both.
    static four sums(four a, four b, four c, four d) {
        const four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5) + __builtin_shufflevector(a, b, 2, 6, 3, 7);
        const four cd = __builtin_shufflevector(c, d, 0, 4, 1, 5) + __builtin_shufflevector(c, d, 2, 6, 3, 7);
        return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    }
    static float sum(four a) {
        const four half = a + __builtin_shufflevector(a, a, 2, 3, 2, 3);
        return half[0] + half[1];
    }
    static doubles product(doubles x) {
        asm("" : "+x"(x));
        return x;
    }
    static doubles wide(four a) {
        doubles w;
        asm("vcvtps2pd %1, %0" : "=x"(w) : "xm"(a));
        return w;
    }
};

inline avx2_eight operator+(avx2_eight a, avx2_eight b) { return {a.v + b.v}; }
inline avx2_eight operator-(avx2_eight a, avx2_eight b) { return {a.v - b.v}; }
inline avx2_eight operator*(avx2_eight a, avx2_eight b) { return avx2_eight::product(a.v * b.v); }
inline avx2_eight operator/(avx2_eight a, avx2_eight b) { return {a.v / b.v}; }
inline avx2_words operator<(avx2_eight a, avx2_eight b) { return {a.v < b.v}; }
inline avx2_words operator<=(avx2_eight a, avx2_eight b) { return {a.v <= b.v}; }

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
