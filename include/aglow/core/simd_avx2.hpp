// Sixteen floats in two AVX2 registers, sixteen doubles in four.
//
// The compilers' vectors do the arithmetic; what the language has no word for is one instruction each.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <aglow/core/simd_pair.hpp>
#include <aglow/core/simd_tables.hpp>

// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,popcnt")
#endif

namespace aglow::simd {

struct avx2_numbers {
    using vector [[gnu::vector_size(32)]] = std::uint32_t;
    using unaligned [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = std::uint32_t;

    static std::uint32_t count(std::uint32_t mask) { return static_cast<std::uint32_t>(std::popcount(mask)); }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        compress(to, *reinterpret_cast<const unaligned*>(from), *reinterpret_cast<const unaligned*>(from + 8), mask);
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        const vector low = vector{0, 1, 2, 3, 4, 5, 6, 7} + first;
        compress(to, low, low + 8, mask);
    }
    /// Where the lanes of an eight-bit mask lie, one after another.
    static vector places(std::uint32_t mask) {
        vector eight;
        asm("vpmovzxbd %1, %0" : "=x"(eight) : "m"(lanes_of_8[mask]));
        return eight;
    }

private:
    static void compress(std::uint32_t* to, vector p, vector q, std::uint32_t mask) {
        pack(to, p, mask & 0xffu);
        pack(to + count(mask & 0xffu), q, mask >> 8);
    }
    static void pack(std::uint32_t* to, vector p, std::uint32_t mask) {
        vector packed;
        asm("vpermd %2, %1, %0" : "=x"(packed) : "x"(places(mask)), "xm"(p));
        *reinterpret_cast<unaligned*>(to) = packed;
    }
};

struct avx2_floats {
    using scalar = float;
    using numbers = avx2_numbers;
    using vector [[gnu::vector_size(32)]] = float;
    using unaligned [[gnu::vector_size(32), gnu::aligned(4), gnu::may_alias]] = float;
    using integers [[gnu::vector_size(32)]] = std::uint32_t;
    static constexpr unsigned width = 8;
    vector v;

    static avx2_floats load(const float* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static avx2_floats all(float x) { return {x - vector{}}; }
    static void store(float* to, avx2_floats a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx2_floats sub(avx2_floats a, avx2_floats b) { return {a.v - b.v}; }
    static avx2_floats min(avx2_floats a, avx2_floats b) {
        vector least;
        asm("vminps %2, %1, %0" : "=x"(least) : "x"(a.v), "xm"(b.v));
        return {least};
    }
    static avx2_floats max(avx2_floats a, avx2_floats b) {
        vector most;
        asm("vmaxps %2, %1, %0" : "=x"(most) : "x"(a.v), "xm"(b.v));
        return {most};
    }
    static avx2_floats length2(avx2_floats x, avx2_floats y, avx2_floats z) {
        return {rounded(square(x) + square(y)) + square(z)};
    }
    static std::uint32_t less(avx2_floats a, avx2_floats b) {
        vector is;
        asm("vcmpltps %2, %1, %0" : "=x"(is) : "x"(a.v), "xm"(b.v));
        return bits(is);
    }
    static std::uint32_t equal(avx2_floats a, avx2_floats b) {
        vector is;
        asm("vcmpeqps %2, %1, %0" : "=x"(is) : "x"(a.v), "xm"(b.v));
        return bits(is);
    }
    static avx2_floats step(avx2_floats a, avx2_floats x, avx2_floats y) {
        vector is;
        asm("vcmpltps %2, %1, %0" : "=x"(is) : "x"(x.v), "xm"(y.v));
        return {(vector)((integers)a.v - (integers)is)};
    }
    static float smallest(avx2_floats a) {
        a = min(a, {__builtin_shufflevector(a.v, a.v, 4, 5, 6, 7, 0, 1, 2, 3)});
        a = min(a, {__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1, 6, 7, 4, 5)});
        return min(a, {__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2, 5, 4, 7, 6)}).v[0];
    }
    static float largest(avx2_floats a) {
        a = max(a, {__builtin_shufflevector(a.v, a.v, 4, 5, 6, 7, 0, 1, 2, 3)});
        a = max(a, {__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1, 6, 7, 4, 5)});
        return max(a, {__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2, 5, 4, 7, 6)}).v[0];
    }
    static avx2_floats without(avx2_floats a, std::uint32_t lane) {
        const integers here{0, 1, 2, 3, 4, 5, 6, 7};
        return {here == lane - integers{} ? std::numeric_limits<float>::max() - vector{} : a.v};
    }
    static void compress(float* to, avx2_floats a, std::uint32_t mask) {
        vector packed;
        asm("vpermps %2, %1, %0" : "=x"(packed) : "x"(numbers::places(mask)), "xm"(a.v));
        *reinterpret_cast<unaligned*>(to) = packed;
    }

private:
    static std::uint32_t bits(vector is) {
        std::uint32_t mask;
        asm("vmovmskps %1, %0" : "=r"(mask) : "x"(is));
        return mask;
    }
    static vector rounded(vector x) {
        asm("" : "+x"(x));
        return x;
    }
    static vector square(avx2_floats a) { return rounded(a.v * a.v); }
};

struct avx2_doubles {
    using scalar = double;
    using numbers = avx2_numbers;
    using vector [[gnu::vector_size(32)]] = double;
    using unaligned [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
    using integers [[gnu::vector_size(32)]] = std::uint64_t;
    static constexpr unsigned width = 4;
    vector v;

    static avx2_doubles load(const double* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static avx2_doubles all(double x) { return {x - vector{}}; }
    static void store(double* to, avx2_doubles a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx2_doubles sub(avx2_doubles a, avx2_doubles b) { return {a.v - b.v}; }
    static avx2_doubles min(avx2_doubles a, avx2_doubles b) {
        vector least;
        asm("vminpd %2, %1, %0" : "=x"(least) : "x"(a.v), "xm"(b.v));
        return {least};
    }
    static avx2_doubles max(avx2_doubles a, avx2_doubles b) {
        vector most;
        asm("vmaxpd %2, %1, %0" : "=x"(most) : "x"(a.v), "xm"(b.v));
        return {most};
    }
    static avx2_doubles length2(avx2_doubles x, avx2_doubles y, avx2_doubles z) {
        return {rounded(square(x) + square(y)) + square(z)};
    }
    static std::uint32_t less(avx2_doubles a, avx2_doubles b) {
        vector is;
        asm("vcmpltpd %2, %1, %0" : "=x"(is) : "x"(a.v), "xm"(b.v));
        return bits(is);
    }
    static std::uint32_t equal(avx2_doubles a, avx2_doubles b) {
        vector is;
        asm("vcmpeqpd %2, %1, %0" : "=x"(is) : "x"(a.v), "xm"(b.v));
        return bits(is);
    }
    static avx2_doubles step(avx2_doubles a, avx2_doubles x, avx2_doubles y) {
        vector is;
        asm("vcmpltpd %2, %1, %0" : "=x"(is) : "x"(x.v), "xm"(y.v));
        return {(vector)((integers)a.v - (integers)is)};
    }
    static double smallest(avx2_doubles a) {
        a = min(a, {__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1)});
        return min(a, {__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2)}).v[0];
    }
    static double largest(avx2_doubles a) {
        a = max(a, {__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1)});
        return max(a, {__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2)}).v[0];
    }
    static avx2_doubles without(avx2_doubles a, std::uint32_t lane) {
        const integers here{0, 1, 2, 3};
        return {here == std::uint64_t{lane} - integers{} ? std::numeric_limits<double>::max() - vector{} : a.v};
    }
    static void compress(double* to, avx2_doubles a, std::uint32_t mask) {
        vector packed;
        asm("vpermps %2, %1, %0" : "=x"(packed) : "x"(numbers::places(both_halves[mask])), "xm"(a.v));
        *reinterpret_cast<unaligned*>(to) = packed;
    }

private:
    static std::uint32_t bits(vector is) {
        std::uint32_t mask;
        asm("vmovmskpd %1, %0" : "=r"(mask) : "x"(is));
        return mask;
    }
    static vector rounded(vector x) {
        asm("" : "+x"(x));
        return x;
    }
    static vector square(avx2_doubles a) { return rounded(a.v * a.v); }
};

using avx2 = pair<avx2_floats>;
using avx2d = pair<pair<avx2_doubles>>;

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
