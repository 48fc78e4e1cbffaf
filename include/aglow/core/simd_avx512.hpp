// Sixteen floats in one AVX-512 register, sixteen doubles in two.
//
// The compilers' vectors do the arithmetic; what the language has no word for is one instruction each. (The header of
// all intrinsics takes as long to read as the rest of the library.)
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <aglow/core/simd_avx2.hpp>
#include <aglow/core/simd_pair.hpp>

// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx2,bmi,popcnt")
#endif

namespace aglow::simd {

// Packs in a register and stores all of it: a compressing store is microcode on some machines.
struct avx512_numbers {
    using vector [[gnu::vector_size(64)]] = std::uint32_t;
    using unaligned [[gnu::vector_size(64), gnu::aligned(4), gnu::may_alias]] = std::uint32_t;

    static std::uint32_t count(std::uint32_t mask) { return static_cast<std::uint32_t>(std::popcount(mask)); }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        const vector all = *reinterpret_cast<const unaligned*>(from);
        vector packed;
        asm("vpcompressd %1, %0%{%2%}%{z%}" : "=v"(packed) : "v"(all), "Yk"(static_cast<std::uint16_t>(mask)));
        *reinterpret_cast<unaligned*>(to) = packed;
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        const vector all = vector{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15} + first;
        vector packed;
        asm("vpcompressd %1, %0%{%2%}%{z%}" : "=v"(packed) : "v"(all), "Yk"(static_cast<std::uint16_t>(mask)));
        *reinterpret_cast<unaligned*>(to) = packed;
    }
};

struct avx512_floats {
    using scalar = float;
    using numbers = avx512_numbers;
    using vector [[gnu::vector_size(64)]] = float;
    using unaligned [[gnu::vector_size(64), gnu::aligned(4), gnu::may_alias]] = float;
    using integers [[gnu::vector_size(64)]] = std::uint32_t;
    static constexpr unsigned width = 16;
    vector v;

    static avx512_floats load(const float* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static avx512_floats all(float x) { return {x - vector{}}; }
    static void store(float* to, avx512_floats a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx512_floats sub(avx512_floats a, avx512_floats b) { return {a.v - b.v}; }
    static avx512_floats min(avx512_floats a, avx512_floats b) {
        vector least;
        asm("vminps %2, %1, %0" : "=v"(least) : "v"(a.v), "vm"(b.v));
        return {least};
    }
    static avx512_floats max(avx512_floats a, avx512_floats b) {
        vector most;
        asm("vmaxps %2, %1, %0" : "=v"(most) : "v"(a.v), "vm"(b.v));
        return {most};
    }
    static avx512_floats length2(avx512_floats x, avx512_floats y, avx512_floats z) {
        return {rounded(square(x) + square(y)) + square(z)};
    }
    static std::uint32_t less(avx512_floats a, avx512_floats b) {
        std::uint16_t mask;
        asm("vcmpps $0x11, %2, %1, %0" : "=Yk"(mask) : "v"(a.v), "vm"(b.v));
        return mask;
    }
    static std::uint32_t equal(avx512_floats a, avx512_floats b) {
        std::uint16_t mask;
        asm("vcmpps $0, %2, %1, %0" : "=Yk"(mask) : "v"(a.v), "vm"(b.v));
        return mask;
    }
    static avx512_floats step(avx512_floats a, avx512_floats x, avx512_floats y) {
        const auto mask = static_cast<std::uint16_t>(less(x, y));
        const integers one = 1 - integers{};
        asm("vpaddd %2, %0, %0%{%1%}" : "+v"(a.v) : "Yk"(mask), "v"(one));
        return a;
    }
    static float smallest(avx512_floats a) { return avx2_floats::smallest(avx2_floats::min(low(a), high(a))); }
    static float largest(avx512_floats a) { return avx2_floats::largest(avx2_floats::max(low(a), high(a))); }
    static avx512_floats without(avx512_floats a, std::uint32_t lane) {
        const integers here{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
        return {here == lane - integers{} ? std::numeric_limits<float>::max() - vector{} : a.v};
    }
    static std::uint32_t count(std::uint32_t mask) { return numbers::count(mask); }
    static void compress(float* to, avx512_floats a, std::uint32_t mask) {
        vector packed;
        asm("vcompressps %1, %0%{%2%}%{z%}" : "=v"(packed) : "v"(a.v), "Yk"(static_cast<std::uint16_t>(mask)));
        *reinterpret_cast<unaligned*>(to) = packed;
    }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        numbers::compress(to, from, mask);
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        numbers::compress_numbers(to, first, mask);
    }

private:
    static avx2_floats low(avx512_floats a) { return {__builtin_shufflevector(a.v, a.v, 0, 1, 2, 3, 4, 5, 6, 7)}; }
    static avx2_floats high(avx512_floats a) {
        return {__builtin_shufflevector(a.v, a.v, 8, 9, 10, 11, 12, 13, 14, 15)};
    }
    static vector rounded(vector x) {
        asm("" : "+v"(x));
        return x;
    }
    static vector square(avx512_floats a) { return rounded(a.v * a.v); }
};

struct avx512_doubles {
    using scalar = double;
    using numbers = avx512_numbers;
    using vector [[gnu::vector_size(64)]] = double;
    using unaligned [[gnu::vector_size(64), gnu::aligned(8), gnu::may_alias]] = double;
    using integers [[gnu::vector_size(64)]] = std::uint64_t;
    static constexpr unsigned width = 8;
    vector v;

    static avx512_doubles load(const double* from) { return {*reinterpret_cast<const unaligned*>(from)}; }
    static avx512_doubles all(double x) { return {x - vector{}}; }
    static void store(double* to, avx512_doubles a) { *reinterpret_cast<unaligned*>(to) = a.v; }
    static avx512_doubles sub(avx512_doubles a, avx512_doubles b) { return {a.v - b.v}; }
    static avx512_doubles min(avx512_doubles a, avx512_doubles b) {
        vector least;
        asm("vminpd %2, %1, %0" : "=v"(least) : "v"(a.v), "vm"(b.v));
        return {least};
    }
    static avx512_doubles max(avx512_doubles a, avx512_doubles b) {
        vector most;
        asm("vmaxpd %2, %1, %0" : "=v"(most) : "v"(a.v), "vm"(b.v));
        return {most};
    }
    static avx512_doubles length2(avx512_doubles x, avx512_doubles y, avx512_doubles z) {
        return {rounded(square(x) + square(y)) + square(z)};
    }
    static std::uint32_t less(avx512_doubles a, avx512_doubles b) {
        std::uint16_t mask;
        asm("vcmppd $0x11, %2, %1, %0" : "=Yk"(mask) : "v"(a.v), "vm"(b.v));
        return mask;
    }
    static std::uint32_t equal(avx512_doubles a, avx512_doubles b) {
        std::uint16_t mask;
        asm("vcmppd $0, %2, %1, %0" : "=Yk"(mask) : "v"(a.v), "vm"(b.v));
        return mask;
    }
    static avx512_doubles step(avx512_doubles a, avx512_doubles x, avx512_doubles y) {
        const auto mask = static_cast<std::uint16_t>(less(x, y));
        const integers one = 1 - integers{};
        asm("vpaddq %2, %0, %0%{%1%}" : "+v"(a.v) : "Yk"(mask), "v"(one));
        return a;
    }
    static double smallest(avx512_doubles a) { return avx2_doubles::smallest(avx2_doubles::min(low(a), high(a))); }
    static double largest(avx512_doubles a) { return avx2_doubles::largest(avx2_doubles::max(low(a), high(a))); }
    static avx512_doubles without(avx512_doubles a, std::uint32_t lane) {
        const integers here{0, 1, 2, 3, 4, 5, 6, 7};
        return {here == lane - integers{} ? std::numeric_limits<double>::max() - vector{} : a.v};
    }
    static void compress(double* to, avx512_doubles a, std::uint32_t mask) {
        vector packed;
        asm("vcompresspd %1, %0%{%2%}%{z%}" : "=v"(packed) : "v"(a.v), "Yk"(static_cast<std::uint16_t>(mask)));
        *reinterpret_cast<unaligned*>(to) = packed;
    }

private:
    static avx2_doubles low(avx512_doubles a) { return {__builtin_shufflevector(a.v, a.v, 0, 1, 2, 3)}; }
    static avx2_doubles high(avx512_doubles a) { return {__builtin_shufflevector(a.v, a.v, 4, 5, 6, 7)}; }
    static vector rounded(vector x) {
        asm("" : "+v"(x));
        return x;
    }
    static vector square(avx512_doubles a) { return rounded(a.v * a.v); }
};

using avx512 = avx512_floats;
using avx512d = pair<avx512_doubles>;

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
