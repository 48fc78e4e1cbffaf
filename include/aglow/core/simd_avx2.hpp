// Sixteen floats in two AVX2 registers.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

#include <aglow/core/simd_tables.hpp>

// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,bmi,popcnt")
#endif

namespace aglow::simd {

struct avx2 {
    using scalar = float;
    __m256 a, b;

    static avx2 load(const float* from) { return {_mm256_loadu_ps(from), _mm256_loadu_ps(from + 8)}; }
    static avx2 all(float x) { return {_mm256_set1_ps(x), _mm256_set1_ps(x)}; }
    static void store(float* to, avx2 p) {
        _mm256_storeu_ps(to, p.a);
        _mm256_storeu_ps(to + 8, p.b);
    }
    static avx2 sub(avx2 p, avx2 q) { return {_mm256_sub_ps(p.a, q.a), _mm256_sub_ps(p.b, q.b)}; }
    static avx2 min(avx2 p, avx2 q) { return {_mm256_min_ps(p.a, q.a), _mm256_min_ps(p.b, q.b)}; }
    static avx2 max(avx2 p, avx2 q) { return {_mm256_max_ps(p.a, q.a), _mm256_max_ps(p.b, q.b)}; }
    static avx2 length2(avx2 x, avx2 y, avx2 z) { return {length2(x.a, y.a, z.a), length2(x.b, y.b, z.b)}; }
    static std::uint32_t less(avx2 p, avx2 q) {
        return bits(_mm256_cmp_ps(p.a, q.a, _CMP_LT_OQ), _mm256_cmp_ps(p.b, q.b, _CMP_LT_OQ));
    }
    static std::uint32_t equal(avx2 p, avx2 q) {
        return bits(_mm256_cmp_ps(p.a, q.a, _CMP_EQ_OQ), _mm256_cmp_ps(p.b, q.b, _CMP_EQ_OQ));
    }
    static float smallest(avx2 p) {
        const __m256 m = _mm256_min_ps(p.a, p.b);
        __m128 n = _mm_min_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
        n = _mm_min_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_min_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static float largest(avx2 p) {
        const __m256 m = _mm256_max_ps(p.a, p.b);
        __m128 n = _mm_max_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
        n = _mm_max_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_max_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static avx2 without(avx2 p, std::uint32_t lane) {
        alignas(32) float numbers[16];
        store(numbers, p);
        numbers[lane] = std::numeric_limits<float>::max();
        return load(numbers);
    }
    static void compress(float* to, avx2 p, std::uint32_t mask) {
        const std::uint32_t low = mask & 0xffu;
        _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(p.a, places(low)));
        _mm256_storeu_ps(to + std::popcount(low), _mm256_permutevar8x32_ps(p.b, places(mask >> 8)));
    }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        compress(to, load_numbers(from), load_numbers(from + 8), mask);
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        const __m256i start = _mm256_set1_epi32(static_cast<int>(first));
        compress(to, _mm256_add_epi32(start, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)),
                 _mm256_add_epi32(start, _mm256_setr_epi32(8, 9, 10, 11, 12, 13, 14, 15)), mask);
    }

private:
    static __m256i load_numbers(const std::uint32_t* from) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    }
    static void compress(std::uint32_t* to, __m256i p, __m256i q, std::uint32_t mask) {
        const std::uint32_t low = mask & 0xffu;
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(p, places(low)));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to + std::popcount(low)),
                            _mm256_permutevar8x32_epi32(q, places(mask >> 8)));
    }
    static std::uint32_t bits(__m256 p, __m256 q) {
        return static_cast<std::uint32_t>(_mm256_movemask_ps(p)) | static_cast<std::uint32_t>(_mm256_movemask_ps(q))
                                                                       << 8;
    }
    /// Where the lanes of an eight-bit mask lie, one after another.
    static __m256i places(std::uint32_t mask) {
        return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&lanes_of_8[mask])));
    }
    static __m256 rounded(__m256 x) {
        asm("" : "+x"(x));
        return x;
    }
    static __m256 square(__m256 x) { return rounded(_mm256_mul_ps(x, x)); }
    static __m256 length2(__m256 x, __m256 y, __m256 z) {
        return _mm256_add_ps(rounded(_mm256_add_ps(square(x), square(y))), square(z));
    }
};

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
