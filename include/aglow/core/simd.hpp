// Sixteen numbers at a time: the few operations a kd-tree's inner loops need, with the same answers on every machine.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <aglow/core/vec.hpp>

namespace aglow::simd {

/// How many numbers every pack holds, whatever the instruction set.
inline constexpr unsigned lanes = 16;

/// The next number above `x`, which is not negative and below infinity; of the normal ones, for -ffast-math takes the
/// others for zero.
template <std::floating_point T>
[[nodiscard]] constexpr T next_above(T x) {
    using bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    constexpr T least = std::numeric_limits<T>::min();
    return x < least ? least : std::bit_cast<T>(static_cast<bits>(std::bit_cast<bits>(x) + 1));
}

/// What takes no more bytes than that is in the caches, or soon: to ask for it ahead is work for nothing.
inline constexpr std::size_t near_memory = std::size_t{1} << 20;

/// Asks for the memory at `address` before it is needed. The empty line tells g++ that a function with nothing else in
/// it has an effect: calls of it were left out.
inline void prefetch([[maybe_unused]] const void* address) {
#if defined(__GNUC__)
    __builtin_prefetch(address);
    asm volatile("");
#endif
}

/// The same for all of `what`.
template <typename U>
void prefetch_all(const U& what) {
    for (std::size_t i = 0; i < sizeof(U); i += 64) { prefetch(reinterpret_cast<const char*>(&what) + i); }
}

/// `x`, rounded to a `T` and hidden from the optimiser, which else may fuse a product with the sum it goes into or
/// reorder sums (-ffp-contract, -ffast-math): what stands in a `rounded` has the same bits under every flag.
template <typename T>
[[nodiscard]] inline T rounded(T x) {
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__))
    asm("" : "+x"(x));
#elif defined(__GNUC__)
    asm("" : "+m"(x));
#endif
    return x;
}

/// Squared length of (x, y, z) with the bits that every pack computes.
template <typename T>
[[nodiscard]] inline T length2(T x, T y, T z) {
    return rounded(rounded(rounded(x * x) + rounded(y * y)) + rounded(z * z));
}

/// Squared distance with the bits that every pack computes: what a search compares, for a host that checks it.
template <typename T>
[[nodiscard]] inline T distance2(const vec3<T>& a, const vec3<T>& b) {
    return length2(rounded(a.x - b.x), rounded(a.y - b.y), rounded(a.z - b.z));
}

/// Sixteen numbers for any scalar and machine, one by one: the reference for the others. A mask has bit i for lane i.
template <typename T>
struct plain {
    using scalar = T;
    T v[lanes];

    static plain load(const T* from) {
        plain a;
        for (unsigned i = 0; i < lanes; ++i) { a.v[i] = from[i]; }
        return a;
    }
    static plain all(T x) {
        plain a;
        for (unsigned i = 0; i < lanes; ++i) { a.v[i] = x; }
        return a;
    }
    static void store(T* to, const plain& a) {
        for (unsigned i = 0; i < lanes; ++i) { to[i] = a.v[i]; }
    }
    static plain sub(const plain& a, const plain& b) {
        plain c;
        for (unsigned i = 0; i < lanes; ++i) { c.v[i] = a.v[i] - b.v[i]; }
        return c;
    }
    static plain min(const plain& a, const plain& b) {
        plain c;
        for (unsigned i = 0; i < lanes; ++i) { c.v[i] = a.v[i] < b.v[i] ? a.v[i] : b.v[i]; }
        return c;
    }
    static plain max(const plain& a, const plain& b) {
        plain c;
        for (unsigned i = 0; i < lanes; ++i) { c.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i]; }
        return c;
    }
    static plain length2(const plain& x, const plain& y, const plain& z) {
        plain a;
        for (unsigned i = 0; i < lanes; ++i) { a.v[i] = simd::length2(x.v[i], y.v[i], z.v[i]); }
        return a;
    }
    static std::uint32_t less(const plain& a, const plain& b) {
        std::uint32_t mask = 0;
        for (unsigned i = 0; i < lanes; ++i) { mask |= std::uint32_t{a.v[i] < b.v[i]} << i; }
        return mask;
    }
    static std::uint32_t equal(const plain& a, const plain& b) {
        std::uint32_t mask = 0;
        for (unsigned i = 0; i < lanes; ++i) { mask |= std::uint32_t{a.v[i] == b.v[i]} << i; }
        return mask;
    }
    /// `a`, in the lanes where x is less than y moved to the next number above. Expects normal numbers.
    static plain step(plain a, const plain& x, const plain& y) {
        for (unsigned i = 0; i < lanes; ++i) { a.v[i] = x.v[i] < y.v[i] ? next_above(a.v[i]) : a.v[i]; }
        return a;
    }
    static T smallest(const plain& a) {
        T least = a.v[0];
        for (unsigned i = 1; i < lanes; ++i) { least = a.v[i] < least ? a.v[i] : least; }
        return least;
    }
    static T largest(const plain& a) {
        T most = a.v[0];
        for (unsigned i = 1; i < lanes; ++i) { most = most < a.v[i] ? a.v[i] : most; }
        return most;
    }
    /// `a` with the largest number there is in one lane.
    static plain without(plain a, std::uint32_t lane) {
        a.v[lane] = std::numeric_limits<T>::max();
        return a;
    }
    /// How many lanes a mask has.
    static std::uint32_t count(std::uint32_t mask) { return static_cast<std::uint32_t>(std::popcount(mask)); }
    /// Writes the lanes of `mask` one after another. All sixteen places from `to` may be overwritten.
    static void compress(T* to, const plain& a, std::uint32_t mask) { squeeze(to, a.v, mask); }
    /// As compress, for whole numbers.
    static void compress(std::uint32_t* to, const std::uint32_t* from, std::uint32_t mask) { squeeze(to, from, mask); }
    /// Writes `first + lane` for every lane of `mask`, as compress does.
    static void compress_numbers(std::uint32_t* to, std::uint32_t first, std::uint32_t mask) {
        for (unsigned i = 0, n = 0; i < lanes; ++i) {
            to[n] = first + i;
            n += (mask >> i) & 1u;
        }
    }

private:
    template <typename U>
    static void squeeze(U* to, const U* from, std::uint32_t mask) {
        for (unsigned i = 0, n = 0; i < lanes; ++i) {
            to[n] = from[i];
            n += (mask >> i) & 1u;
        }
    }
};

}  // namespace aglow::simd
