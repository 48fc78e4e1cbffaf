// Eight floats at a time with the operators of one: a formula is written once, and the machine works it out eight
// times.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <aglow/core/simd_best.hpp>
#include <aglow/core/simd_eight_avx2.hpp>

namespace aglow::simd {

/// What kernels of eight floats ask for: `run_best<eight, Kernel>(...)`.
struct eight;

/// Eight whole numbers, one by one. A comparison is -1 where it holds.
struct plain_words {
    static constexpr std::size_t count = 8;
    static constexpr std::size_t together = 4;  ///< how many `columns` are read
    std::int32_t v[count];

    template <typename Number>
    static plain_words each(const Number& number) {
        plain_words a;
        for (std::size_t i = 0; i < count; ++i) { a.v[i] = number(i); }
        return a;
    }
    static plain_words all(std::int32_t x) {
        return each([x](std::size_t) { return x; });
    }
    static plain_words load(const std::int32_t* from) {
        return each([from](std::size_t i) { return from[i]; });
    }
    static void store(std::int32_t* to, const plain_words& a) { std::memcpy(to, a.v, sizeof(a.v)); }
    friend plain_words operator&(const plain_words& a, const plain_words& b) {
        return each([&](std::size_t i) { return a.v[i] & b.v[i]; });
    }
    friend plain_words operator-(const plain_words& a, const plain_words& b) {
        return each([&](std::size_t i) { return a.v[i] - b.v[i]; });
    }
    friend plain_words operator>>(const plain_words& a, int bits) {
        return each([&](std::size_t i) { return a.v[i] >> bits; });
    }
    friend plain_words operator<<(const plain_words& a, int bits) {
        return each([&](std::size_t i) { return a.v[i] << bits; });
    }
    static plain_words pick(const plain_words& where, const plain_words& a, const plain_words& b) {
        return each([&](std::size_t i) { return where.v[i] ? a.v[i] : b.v[i]; });
    }
    /// The lanes below `some`.
    static plain_words below(std::size_t some) {
        return each([some](std::size_t i) { return i < some ? -1 : 0; });
    }
    static std::uint32_t count_of(const plain_words& where) {
        std::uint32_t sum = 0;
        for (const std::int32_t w : where.v) { sum += w != 0; }
        return sum;
    }
    /// The sixteen bits of each that come first in memory, and those that come last, as signed numbers times 65536.
    static plain_words first_half(const plain_words& a) { return half(a, 0); }
    static plain_words last_half(const plain_words& a) { return half(a, sizeof(std::int16_t)); }
    /// The word at `offset` of eight rows.
    static plain_words column(const char* const* rows, std::size_t offset) {
        plain_words a;
        for (std::size_t i = 0; i < count; ++i) { std::memcpy(&a.v[i], rows[i] + offset, sizeof(a.v[i])); }
        return a;
    }
    /// So many columns as are read `together`, from `offset` on.
    static void columns(const char* const* rows, std::size_t offset, plain_words* to) {
        for (std::size_t i = 0; i < together; ++i) { to[i] = column(rows, offset + i * sizeof(std::int32_t)); }
    }

private:
    static plain_words half(const plain_words& a, std::size_t offset) {
        return each([&](std::size_t i) {
            std::int16_t bits;
            std::memcpy(&bits, reinterpret_cast<const char*>(&a.v[i]) + offset, sizeof(bits));
            return std::int32_t{bits} * 65536;
        });
    }
};

/// Eight floats, one by one.
struct plain_eight {
    using scalar = eight;
    using words = plain_words;
    static constexpr std::size_t count = 8;
    float v[count];

    template <typename Number>
    static plain_eight each(const Number& number) {
        plain_eight a;
        for (std::size_t i = 0; i < count; ++i) { a.v[i] = number(i); }
        return a;
    }
    static plain_eight load(const float* from) {
        return each([from](std::size_t i) { return from[i]; });
    }
    static void store(float* to, const plain_eight& a) { std::memcpy(to, a.v, sizeof(a.v)); }
    static plain_eight all(float x) {
        return each([x](std::size_t) { return x; });
    }
    /// The numbers that these words are, and those whose bits they are.
    static plain_eight of(const words& a) {
        return each([&](std::size_t i) { return static_cast<float>(a.v[i]); });
    }
    static plain_eight from_bits(const words& a) {
        return each([&](std::size_t i) { return std::bit_cast<float>(a.v[i]); });
    }
    friend plain_eight operator+(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] + b.v[i]; });
    }
    friend plain_eight operator-(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] - b.v[i]; });
    }
    friend plain_eight operator*(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] * b.v[i]; });
    }
    friend plain_eight operator/(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] / b.v[i]; });
    }
    friend words operator<(const plain_eight& a, const plain_eight& b) {
        return words::each([&](std::size_t i) { return a.v[i] < b.v[i] ? -1 : 0; });
    }
    friend words operator<=(const plain_eight& a, const plain_eight& b) {
        return words::each([&](std::size_t i) { return a.v[i] <= b.v[i] ? -1 : 0; });
    }
    static plain_eight min(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
    }
    static plain_eight max(const plain_eight& a, const plain_eight& b) {
        return each([&](std::size_t i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
    }
    /// The numbers that lie at `places` from `table` on; of a place only what is below eight counts.
    static plain_eight picked(const float* table, const words& places) {
        return each([&](std::size_t i) { return table[static_cast<std::uint32_t>(places.v[i]) % count]; });
    }
    static plain_eight abs(const plain_eight& a) {
        return each([&](std::size_t i) { return std::abs(a.v[i]); });
    }
    static plain_eight root(const plain_eight& a) {
        return each([&](std::size_t i) { return std::sqrt(a.v[i]); });
    }
    /// `a` where that holds, else 0, whatever `a` is there.
    static plain_eight where(const words& holds, const plain_eight& a) {
        return each([&](std::size_t i) { return holds.v[i] ? a.v[i] : 0.0f; });
    }
    /// Adds the sum of all eight of each to what is there.
    template <std::size_t N>
    static void add_sums(const plain_eight (&of)[N], std::array<float, N>& to) {
        for (std::size_t i = 0; i < N; ++i) { to[i] += sum(of[i].v); }
    }
    /// As doubles: squares of small floats leave their range.
    static double sum_of_squares(const plain_eight& a) {
        double squares[count];
        for (std::size_t i = 0; i < count; ++i) { squares[i] = double{a.v[i]} * double{a.v[i]}; }
        return sum(squares);
    }

private:
    template <typename X>
    static X sum(const X (&a)[count]) {
        X half[4];
        for (std::size_t i = 0; i < 4; ++i) { half[i] = a[i] + a[i + 4]; }
        return (half[0] + half[2]) + (half[1] + half[3]);
    }
};

template <>
struct packs_of<eight> {
#if defined(__x86_64__) && defined(__GNUC__)
    using avx512 = avx2_eight;
    using avx2 = avx2_eight;
#endif
    using any = plain_eight;
};

}  // namespace aglow::simd
