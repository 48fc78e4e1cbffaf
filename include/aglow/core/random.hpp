// Random numbers that are a function of what they are for: (seed, pass, path, bounce, purpose) and nothing else.
#pragma once

#include <concepts>
#include <cstdint>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// What a draw is for. Two purposes of the same path and bounce never share a number.
enum class purpose : std::uint32_t { camera, emission, light, scatter, roulette, gather, continuation, audit, host };

/// Names one path of one pass of one rendering.
struct path_key {
    std::uint64_t seed{0};
    std::uint64_t pass{0};
    std::uint64_t path{0};
};

/// A bijection of 64-bit words that leaves no visible pattern (Steele et al. 2014, SplitMix64; variant 13 of Stafford).
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// `a` and `b` as one well-mixed word; order matters.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
    return mix((a ^ 0x9e3779b97f4a7c15u) * 0xd1342543de82ef95u + b);
}

[[nodiscard]] constexpr std::uint64_t mix(const path_key& key) { return mix(mix(key.seed, key.pass), key.path); }

/// The word of one decision of the path whose own word is `path`.
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t path, std::uint32_t bounce, purpose why) {
    return mix(path, (std::uint64_t{bounce} << 32) | static_cast<std::uint32_t>(why));
}
[[nodiscard]] constexpr std::uint64_t mix(const path_key& key, std::uint32_t bounce, purpose why) {
    return mix(mix(key), bounce, why);
}

/// The upper bits of `word` as a number in [0, 1), never 1.
template <std::floating_point T>
[[nodiscard]] constexpr T unit_interval(std::uint64_t word) {
    if constexpr (sizeof(T) == 4) {
        return static_cast<T>(word >> 40) * T(0x1p-24);
    } else {
        return static_cast<T>(word >> 11) * T(0x1p-53);
    }
}

/// Independent uniform numbers in [0, 1). A regular value: copies repeat the same numbers.
template <std::floating_point T>
class random_sampler {
public:
    explicit constexpr random_sampler(std::uint64_t start) : state_{start} {}

    constexpr T next_1d() {
        state_ += 0x9e3779b97f4a7c15u;
        return unit_interval<T>(mix(state_));
    }
    constexpr vec2<T> next_2d() {
        const T x = next_1d();
        return {x, next_1d()};
    }

private:
    std::uint64_t state_;
};

/// The independent random numbers of one path; `at(bounce, why)` hands out those of one decision.
template <std::floating_point T>
class random_numbers {
public:
    using scalar = T;
    explicit constexpr random_numbers(const path_key& key) : key_{key}, word_{mix(key)} {}

    [[nodiscard]] constexpr random_sampler<T> at(std::uint32_t bounce, purpose why) const {
        return random_sampler<T>{mix(word_, bounce, why)};
    }

    /// The numbers of a path that branches off this one, such as gather ray `branch`.
    [[nodiscard]] constexpr random_numbers fork(std::uint64_t branch) const {
        return random_numbers{{key_.seed, mix(key_.pass, ~branch), key_.path}};
    }

private:
    path_key key_;
    std::uint64_t word_;  ///< of the path: mixed once, however many decisions it comes to
};

}  // namespace aglow
