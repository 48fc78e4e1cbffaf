// Owen-scrambled Sobol points for paths that know their place among a pixel's samples.
#pragma once

#include <concepts>
#include <cstdint>

#include <aglow/core/random.hpp>

namespace aglow {

[[nodiscard]] constexpr std::uint64_t reverse_bits(std::uint64_t x) {
    x = ((x >> 1) & 0x5555555555555555u) | ((x & 0x5555555555555555u) << 1);
    x = ((x >> 2) & 0x3333333333333333u) | ((x & 0x3333333333333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0f0f0f0f0fu) | ((x & 0x0f0f0f0f0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ff00ff00ffu) | ((x & 0x00ff00ff00ff00ffu) << 8);
    x = ((x >> 16) & 0x0000ffff0000ffffu) | ((x & 0x0000ffff0000ffffu) << 16);
    return (x >> 32) | (x << 32);
}
[[nodiscard]] constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

/// A hash in which each bit depends on lower bits only: Owen scrambling of the reversed word
/// (Laine & Karras 2011; constants by Vegdahl 2021).
[[nodiscard]] constexpr std::uint32_t owen_hash(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// `x` with its bits as nested uniform digits scrambled by `seed` (Owen 1995).
[[nodiscard]] constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(owen_hash(reverse_bits(x), seed));
}

/// The second Sobol dimension of `index`, bit-reversed: the Pascal matrix modulo 2, factored into five steps.
[[nodiscard]] constexpr std::uint32_t sobol_1_reversed(std::uint32_t index) {
    std::uint32_t x = index;
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    x ^= (x & 0xffff0000u) >> 16;
    return x;
}

/// Point `index` of a randomised (0,2)-sequence: each aligned block of 2^m points, the first 2^m among
/// them, has one in every elementary box of area 2^-m.
template <std::floating_point T>
[[nodiscard]] constexpr vec2<T> sobol_2d(std::uint32_t index, std::uint64_t seed) {
    const auto low = static_cast<std::uint32_t>(seed);
    const auto high = static_cast<std::uint32_t>(seed >> 32);
    // Shuffle the order too, so that points of different seeds pair up at random (Burley 2020, section 3).
    const std::uint32_t shuffled = owen_scramble(index, low ^ high);
    // Both turned round in one word.
    const std::uint64_t x = owen_hash(shuffled, low);
    const std::uint64_t y_x = reverse_bits(x << 32 | owen_hash(sobol_1_reversed(shuffled), high));
    return {unit_interval<T>(y_x << 32), unit_interval<T>(y_x & 0xffffffff00000000u)};
}

/// Stratified numbers of sample `index`; each pair of draws is a fresh scrambling keyed by `start`.
template <std::floating_point T>
class sobol_sampler {
public:
    constexpr sobol_sampler(std::uint64_t start, std::uint32_t index) : state_{start}, index_{index} {}

    constexpr T next_1d() { return next_2d().x; }
    constexpr vec2<T> next_2d() {
        state_ += 0x9e3779b97f4a7c15u;
        return sobol_2d<T>(index_, mix(state_));
    }

private:
    std::uint64_t state_;
    std::uint32_t index_;
};

/// The numbers of the `index`-th of many paths that estimate the same thing, such as one pixel's samples: stratified
/// over `index` for each decision, independent between decisions and between keys.
template <std::floating_point T>
class sobol_numbers {
public:
    using scalar = T;

    /// `key.path` names the group (the pixel), `index` counts the samples within it.
    constexpr sobol_numbers(const path_key& key, std::uint32_t index) : key_{key}, index_{index} {}

    [[nodiscard]] constexpr sobol_sampler<T> at(std::uint32_t bounce, purpose why) const {
        return {mix(key_, bounce, why), index_};
    }
    [[nodiscard]] constexpr sobol_numbers fork(std::uint64_t branch) const {
        return {{key_.seed, mix(key_.pass, ~branch), key_.path}, index_};
    }

private:
    path_key key_;
    std::uint32_t index_;
};

}  // namespace aglow
