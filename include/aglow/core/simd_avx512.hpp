// Sixteen floats in one AVX-512 register.
#pragma once

#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>

// Compiled for such machines whatever the flags; only what is compiled for them may call it.
#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx2,bmi,popcnt"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx2,bmi,popcnt")
#endif

namespace aglow::simd {

struct avx512 {
    using scalar = float;
    __m512 v;

    static avx512 load(const float* from) { return {_mm512_loadu_ps(from)}; }
    static avx512 all(float x) { return {_mm512_set1_ps(x)}; }
    static void store(float* to, avx512 a) { _mm512_storeu_ps(to, a.v); }
    static avx512 sub(avx512 a, avx512 b) { return {_mm512_sub_ps(a.v, b.v)}; }
    // The zero-masked forms with a full mask: g++ 12 warns of the plain ones' undefined source.
    static avx512 min(avx512 a, avx512 b) { return {_mm512_maskz_min_ps(0xffff, a.v, b.v)}; }
    static avx512 max(avx512 a, avx512 b) { return {_mm512_maskz_max_ps(0xffff, a.v, b.v)}; }
    static avx512 length2(avx512 x, avx512 y, avx512 z) {
        const __m512 xy = rounded(_mm512_add_ps(square(x), square(y)));
        return {_mm512_add_ps(xy, square(z))};
    }
    static std::uint32_t less(avx512 a, avx512 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
    static std::uint32_t equal(avx512 a, avx512 b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ); }
    static float smallest(avx512 a) {
        const __m256 m = _mm256_min_ps(half<0>(a), half<1>(a));
        __m128 n = _mm_min_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
        n = _mm_min_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_min_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static float largest(avx512 a) {
        const __m256 m = _mm256_max_ps(half<0>(a), half<1>(a));
        __m128 n = _mm_max_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
        n = _mm_max_ps(n, _mm_movehl_ps(n, n));
        return _mm_cvtss_f32(_mm_max_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static avx512 without(avx512 a, std::uint32_t lane) {
        const auto rest = static_cast<__mmask16>(~(1u << lane));
        return {_mm512_mask_mov_ps(_mm512_set1_ps(std::numeric_limits<float>::max()), rest, a.v)};
    }
    // Packs in a register and stores all of it: a compressing store is microcode on some machines.
    static void compress(float* to, avx512 a, std::uint32_t mask) {
        _mm512_storeu_ps(to, _mm512_maskz_compress_ps(static_cast<__mmask16>(mask), a.v));
    }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), _mm512_loadu_si512(from)));
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        const __m512i lane = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
        const __m512i number = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)), lane);
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), number));
    }

private:
    template <int I>
    static __m256 half(avx512 a) {
        return _mm256_castpd_ps(_mm512_maskz_extractf64x4_pd(0xf, _mm512_castps_pd(a.v), I));
    }
    static __m512 rounded(__m512 x) {
        asm("" : "+v"(x));
        return x;
    }
    static __m512 square(avx512 a) { return rounded(_mm512_mul_ps(a.v, a.v)); }
};

}  // namespace aglow::simd

#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif
