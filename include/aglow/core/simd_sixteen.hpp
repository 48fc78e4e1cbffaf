// Sixteen floats in an AVX-512 register, for kernels that have many alike to work out: eight at a time elsewhere.
//
// No more of `plain_eight` and `plain_words` than such kernels ask for.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include <aglow/core/simd_best.hpp>
#include <aglow/core/simd_eight.hpp>

namespace aglow::simd {

/// What such kernels ask for: `run_best<sixteen, Kernel>(...)`. They run with `V::count` lanes.
struct sixteen;

}  // namespace aglow::simd

#if defined(__x86_64__) && defined(__GNUC__)
// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx2,bmi,popcnt")
#endif

namespace aglow::simd {

/// Sixteen whole numbers in a register.
struct avx512_words {
    using vector [[gnu::vector_size(64)]] = std::int32_t;
    using pairs [[gnu::vector_size(64)]] = std::int64_t;
    using unaligned [[gnu::vector_size(64), gnu::aligned(4), gnu::may_alias]] = std::int32_t;
    using half [[gnu::vector_size(32)]] = std::int32_t;
    using unaligned_half [[gnu::vector_size(32), gnu::aligned(1), gnu::may_alias]] = std::int32_t;
    static constexpr std::size_t together = 8;
    vector v;

    static avx512_words all(std::int32_t x) { return {x - vector{}}; }
    static avx512_words load(const std::int32_t* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static void store(std::int32_t* to, avx512_words a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx512_words pick(avx512_words where, avx512_words a, avx512_words b) {
        return {(where.v & a.v) | (~where.v & b.v)};
    }
    static avx512_words first_half(avx512_words a) { return {a.v << 16}; }
    static avx512_words last_half(avx512_words a) { return {a.v & -0x10000}; }
    static avx512_words column(const char* const* rows, std::size_t offset) {
        std::int32_t each[16];
        for (std::size_t i = 0; i < 16; ++i) { __builtin_memcpy(&each[i], rows[i] + offset, sizeof(each[i])); }
        return {*reinterpret_cast<const unaligned*>(each)};
    }
    // Four by four are turned in each quarter of a register, then quarters are put where they belong.
    static void columns(const char* const* rows, std::size_t offset, avx512_words* to) {
        vector first[4], last[4];
        turn(rows, offset, first);
        turn(rows + 8, offset, last);
        put(first[0], last[0], to[0], to[4]);
        put(first[1], last[1], to[1], to[5]);
        put(first[2], last[2], to[2], to[6]);
        put(first[3], last[3], to[3], to[7]);
    }

private:
    // Of eight rows, with the first and the last four columns of the first and the last four rows in a quarter each.
    static void turn(const char* const* rows, std::size_t offset, vector (&to)[4]) {
        const vector a = two(rows, 0, offset), b = two(rows, 1, offset);
        const vector c = two(rows, 2, offset), d = two(rows, 3, offset);
        const pairs ab = first_pairs(a, b), cd = first_pairs(c, d), ab2 = last_pairs(a, b), cd2 = last_pairs(c, d);
        to[0] = (vector)__builtin_shufflevector(ab, cd, 0, 8, 2, 10, 4, 12, 6, 14);
        to[1] = (vector)__builtin_shufflevector(ab, cd, 1, 9, 3, 11, 5, 13, 7, 15);
        to[2] = (vector)__builtin_shufflevector(ab2, cd2, 0, 8, 2, 10, 4, 12, 6, 14);
        to[3] = (vector)__builtin_shufflevector(ab2, cd2, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    static void put(vector a, vector b, avx512_words& even, avx512_words& odd) {
        even.v = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27);
        odd.v = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31);
    }
    static vector two(const char* const* rows, std::size_t i, std::size_t offset) {
        const half low = *reinterpret_cast<const unaligned_half*>(rows[i] + offset);
        vector both;
        asm("vinserti64x4 $1, %2, %g1, %0"
            : "=v"(both)
            : "v"(low), "m"(*reinterpret_cast<const unaligned_half*>(rows[i + 4] + offset)));
        return both;
    }
    static pairs first_pairs(vector a, vector b) {
        return (pairs)__builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    }
    static pairs last_pairs(vector a, vector b) {
        return (pairs)__builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    }
};

inline avx512_words operator&(avx512_words a, avx512_words b) { return {a.v & b.v}; }
inline avx512_words operator-(avx512_words a, avx512_words b) { return {a.v - b.v}; }
inline avx512_words operator>>(avx512_words a, int bits) { return {a.v >> bits}; }
inline avx512_words operator<<(avx512_words a, int bits) { return {a.v << bits}; }

/// Sixteen floats in a register.
struct avx512_sixteen {
    using scalar = sixteen;
    using words = avx512_words;
    using vector [[gnu::vector_size(64)]] = float;
    using unaligned [[gnu::vector_size(64), gnu::aligned(4), gnu::may_alias]] = float;
    static constexpr std::size_t count = 16;
    vector v;

    static avx512_sixteen load(const float* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static void store(float* to, avx512_sixteen a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx512_sixteen all(float x) { return {x - vector{}}; }
    static avx512_sixteen of(words a) { return {__builtin_convertvector(a.v, vector)}; }
    static avx512_sixteen from_bits(words a) { return {(vector)a.v}; }
    static avx512_sixteen min(avx512_sixteen a, avx512_sixteen b) {
        vector least;
        asm("vminps %2, %1, %0" : "=v"(least) : "v"(a.v), "vm"(b.v));
        return {least};
    }
    static avx512_sixteen max(avx512_sixteen a, avx512_sixteen b) {
        vector most;
        asm("vmaxps %2, %1, %0" : "=v"(most) : "v"(a.v), "vm"(b.v));
        return {most};
    }
    /// The numbers that lie at `places`, which are below sixteen, from `table` on.
    static avx512_sixteen picked(const float* table, words places) {
        vector picked;
        asm("vpermps %2, %1, %0" : "=v"(picked) : "v"(places.v), "vm"(load(table).v));
        return {picked};
    }
    static avx512_sixteen abs(avx512_sixteen a) { return {(vector)((words::vector)a.v & 0x7fffffff)}; }
    static avx512_sixteen root(avx512_sixteen a) {
        vector r;
        asm("vsqrtps %1, %0" : "=v"(r) : "vm"(a.v));
        return {r};
    }
    static avx512_sixteen where(words holds, avx512_sixteen a) { return {(vector)((words::vector)a.v & holds.v)}; }
    /// A product by itself: fused with a sum it would have other bits.
    static avx512_sixteen product(vector x) {
        asm("" : "+v"(x));
        return {x};
    }
};

inline avx512_sixteen operator+(avx512_sixteen a, avx512_sixteen b) { return {a.v + b.v}; }
inline avx512_sixteen operator-(avx512_sixteen a, avx512_sixteen b) { return {a.v - b.v}; }
inline avx512_sixteen operator*(avx512_sixteen a, avx512_sixteen b) { return avx512_sixteen::product(a.v * b.v); }
inline avx512_sixteen operator/(avx512_sixteen a, avx512_sixteen b) { return {a.v / b.v}; }
inline avx512_words operator<(avx512_sixteen a, avx512_sixteen b) { return {a.v < b.v}; }
inline avx512_words operator<=(avx512_sixteen a, avx512_sixteen b) { return {a.v <= b.v}; }

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

namespace aglow::simd {

template <>
struct packs_of<sixteen> {
#if defined(__x86_64__) && defined(__GNUC__)
    using avx512 = avx512_sixteen;
    using avx2 = avx2_eight;
#endif
    using any = plain_eight;
};

}  // namespace aglow::simd
