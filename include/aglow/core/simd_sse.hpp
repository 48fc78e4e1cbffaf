// Sixteen floats in four SSE registers, for machines with SSE4.1.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#include <aglow/core/simd_tables.hpp>

// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("sse4.2,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("sse4.2,popcnt")
#endif

namespace aglow::simd {

struct sse {
    using scalar = float;
    __m128 a, b, c, d;

    static sse load(const float* from) {
        return {_mm_loadu_ps(from), _mm_loadu_ps(from + 4), _mm_loadu_ps(from + 8), _mm_loadu_ps(from + 12)};
    }
    static sse all(float x) {
        const __m128 v = _mm_set1_ps(x);
        return {v, v, v, v};
    }
    static void store(float* to, const sse& p) {
        _mm_storeu_ps(to, p.a);
        _mm_storeu_ps(to + 4, p.b);
        _mm_storeu_ps(to + 8, p.c);
        _mm_storeu_ps(to + 12, p.d);
    }
    static sse sub(const sse& p, const sse& q) {
        return {_mm_sub_ps(p.a, q.a), _mm_sub_ps(p.b, q.b), _mm_sub_ps(p.c, q.c), _mm_sub_ps(p.d, q.d)};
    }
    static sse min(const sse& p, const sse& q) {
        return {_mm_min_ps(p.a, q.a), _mm_min_ps(p.b, q.b), _mm_min_ps(p.c, q.c), _mm_min_ps(p.d, q.d)};
    }
    static sse max(const sse& p, const sse& q) {
        return {_mm_max_ps(p.a, q.a), _mm_max_ps(p.b, q.b), _mm_max_ps(p.c, q.c), _mm_max_ps(p.d, q.d)};
    }
    static sse length2(const sse& x, const sse& y, const sse& z) {
        return {length2(x.a, y.a, z.a), length2(x.b, y.b, z.b), length2(x.c, y.c, z.c), length2(x.d, y.d, z.d)};
    }
    static std::uint32_t less(const sse& p, const sse& q) {
        return bits(_mm_cmplt_ps(p.a, q.a), 0) | bits(_mm_cmplt_ps(p.b, q.b), 4) | bits(_mm_cmplt_ps(p.c, q.c), 8) |
               bits(_mm_cmplt_ps(p.d, q.d), 12);
    }
    static std::uint32_t equal(const sse& p, const sse& q) {
        return bits(_mm_cmpeq_ps(p.a, q.a), 0) | bits(_mm_cmpeq_ps(p.b, q.b), 4) | bits(_mm_cmpeq_ps(p.c, q.c), 8) |
               bits(_mm_cmpeq_ps(p.d, q.d), 12);
    }
    static float smallest(const sse& p) {
        __m128 n = _mm_min_ps(_mm_min_ps(p.a, p.b), _mm_min_ps(p.c, p.d));
        n = _mm_min_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_min_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static float largest(const sse& p) {
        __m128 n = _mm_max_ps(_mm_max_ps(p.a, p.b), _mm_max_ps(p.c, p.d));
        n = _mm_max_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_max_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static sse without(const sse& p, std::uint32_t lane) {
        alignas(32) float numbers[16];
        store(numbers, p);
        numbers[lane] = std::numeric_limits<float>::max();
        return load(numbers);
    }
    static void compress(float* to, const sse& p, std::uint32_t mask) {
        compress(to, _mm_castps_si128(p.a), _mm_castps_si128(p.b), _mm_castps_si128(p.c), _mm_castps_si128(p.d), mask);
    }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        const auto* v = reinterpret_cast<const __m128i*>(from);
        compress(to, _mm_loadu_si128(v), _mm_loadu_si128(v + 1), _mm_loadu_si128(v + 2), _mm_loadu_si128(v + 3), mask);
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        const __m128i a = _mm_add_epi32(_mm_set1_epi32(static_cast<int>(first)), _mm_setr_epi32(0, 1, 2, 3));
        const __m128i four = _mm_set1_epi32(4);
        const __m128i b = _mm_add_epi32(a, four);
        const __m128i c = _mm_add_epi32(b, four);
        compress(to, a, b, c, _mm_add_epi32(c, four), mask);
    }

private:
    static std::uint32_t bits(__m128 p, int at) { return static_cast<std::uint32_t>(_mm_movemask_ps(p)) << at; }

    template <typename U>
    static U* pack_four(U* to, __m128i p, std::uint32_t mask) {
        const __m128i places = _mm_loadu_si128(reinterpret_cast<const __m128i*>(bytes_of_4[mask].data()));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm_shuffle_epi8(p, places));
        return to + std::popcount(mask);
    }
    template <typename U>
    static void compress(U* to, __m128i a, __m128i b, __m128i c, __m128i d, std::uint32_t mask) {
        to = pack_four(to, a, mask & 15u);
        to = pack_four(to, b, mask >> 4 & 15u);
        to = pack_four(to, c, mask >> 8 & 15u);
        pack_four(to, d, mask >> 12);
    }
    static __m128 rounded(__m128 x) {
        asm("" : "+x"(x));
        return x;
    }
    static __m128 square(__m128 x) { return rounded(_mm_mul_ps(x, x)); }
    static __m128 length2(__m128 x, __m128 y, __m128 z) {
        return _mm_add_ps(rounded(_mm_add_ps(square(x), square(y))), square(z));
    }
};

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
