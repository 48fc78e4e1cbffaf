// Sixteen floats in four SSE registers: for every machine of 64 bits, faster where it can shuffle bytes (SSSE3).
#pragma once

#include <cstdint>
#include <limits>

#if defined(__x86_64__) && defined(__GNUC__)
#include <emmintrin.h>

#include <aglow/core/simd_pair.hpp>
#include <aglow/core/simd_tables.hpp>

namespace aglow::simd {

struct sse_numbers {
    static std::uint32_t count(std::uint32_t mask) { return counts_of_8[mask & 0xffu] + counts_of_8[mask >> 8]; }
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) {
        const auto* v = reinterpret_cast<const __m128i*>(from);
        compress(to, _mm_loadu_si128(v), mask & 15u);
        compress(to += counts_of_8[mask & 15u], _mm_loadu_si128(v + 1), mask >> 4 & 15u);
        compress(to += counts_of_8[mask >> 4 & 15u], _mm_loadu_si128(v + 2), mask >> 8 & 15u);
        compress(to + counts_of_8[mask >> 8 & 15u], _mm_loadu_si128(v + 3), mask >> 12);
    }
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        __m128i some = _mm_add_epi32(_mm_set1_epi32(static_cast<int>(first)), _mm_setr_epi32(0, 1, 2, 3));
        for (std::uint32_t shift = 0; shift < 16; shift += 4) {
            compress(to, some, mask >> shift & 15u);
            to += counts_of_8[mask >> shift & 15u];
            some = _mm_add_epi32(some, _mm_set1_epi32(4));
        }
    }
    /// Writes the lanes of a four-bit mask one after another; four places may be overwritten.
    template <typename U>
    static void compress(U* to, __m128i p, std::uint32_t mask) {
        if (__builtin_cpu_supports("ssse3")) {
            asm("pshufb %1, %0" : "+x"(p) : "x"(_mm_load_si128(reinterpret_cast<const __m128i*>(&bytes_of_4[mask]))));
            _mm_storeu_si128(reinterpret_cast<__m128i*>(to), p);
            return;
        }
        alignas(16) U four[4];
        _mm_store_si128(reinterpret_cast<__m128i*>(four), p);
        for (unsigned i = 0; i < 4; ++i) { to[i] = four[bytes_of_4[mask][4 * i] / 4]; }
    }
};

struct sse_floats {
    using scalar = float;
    using numbers = sse_numbers;
    static constexpr unsigned width = 4;
    __m128 v;

    static sse_floats load(const float* from) { return {_mm_loadu_ps(from)}; }
    static sse_floats all(float x) { return {_mm_set1_ps(x)}; }
    static void store(float* to, sse_floats p) { _mm_storeu_ps(to, p.v); }
    static sse_floats sub(sse_floats p, sse_floats q) { return {_mm_sub_ps(p.v, q.v)}; }
    static sse_floats min(sse_floats p, sse_floats q) { return {_mm_min_ps(p.v, q.v)}; }
    static sse_floats max(sse_floats p, sse_floats q) { return {_mm_max_ps(p.v, q.v)}; }
    static sse_floats length2(sse_floats x, sse_floats y, sse_floats z) {
        return {_mm_add_ps(rounded(_mm_add_ps(square(x), square(y))), square(z))};
    }
    static std::uint32_t less(sse_floats p, sse_floats q) { return bits(_mm_cmplt_ps(p.v, q.v)); }
    static std::uint32_t equal(sse_floats p, sse_floats q) { return bits(_mm_cmpeq_ps(p.v, q.v)); }
    static sse_floats step(sse_floats p, sse_floats x, sse_floats y) {
        return {_mm_castsi128_ps(_mm_sub_epi32(_mm_castps_si128(p.v), _mm_castps_si128(_mm_cmplt_ps(x.v, y.v))))};
    }
    static float smallest(sse_floats p) {
        const __m128 n = _mm_min_ps(p.v, _mm_movehl_ps(p.v, p.v));
        return _mm_cvtss_f32(_mm_min_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static float largest(sse_floats p) {
        const __m128 n = _mm_max_ps(p.v, _mm_movehl_ps(p.v, p.v));
        return _mm_cvtss_f32(_mm_max_ss(n, _mm_shuffle_ps(n, n, 1)));
    }
    static sse_floats without(sse_floats p, std::uint32_t lane) {
        const __m128i here = _mm_cmpeq_epi32(_mm_setr_epi32(0, 1, 2, 3), _mm_set1_epi32(static_cast<int>(lane)));
        const __m128 mask = _mm_castsi128_ps(here);
        const __m128 most = _mm_set1_ps(std::numeric_limits<float>::max());
        return {_mm_or_ps(_mm_and_ps(mask, most), _mm_andnot_ps(mask, p.v))};
    }
    static void compress(float* to, sse_floats p, std::uint32_t mask) {
        numbers::compress(to, _mm_castps_si128(p.v), mask);
    }

private:
    static std::uint32_t bits(__m128 p) { return static_cast<std::uint32_t>(_mm_movemask_ps(p)); }
    static __m128 rounded(__m128 x) {
        asm("" : "+x"(x));
        return x;
    }
    static __m128 square(sse_floats p) { return rounded(_mm_mul_ps(p.v, p.v)); }
};

using sse = pair<pair<sse_floats>>;

}  // namespace aglow::simd
#endif
