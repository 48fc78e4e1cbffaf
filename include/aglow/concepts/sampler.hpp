// Where decisions get their numbers from.
#pragma once

#include <concepts>
#include <cstdint>

#include <aglow/core/random.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A source of numbers in [0, 1) for one decision of one path.
/// Must be true: never 1, mean 1/2; `next_2d()` is uniform over the square.
template <typename R>
concept Sampler = requires(R& random) {
    { random.next_1d() } -> std::floating_point;
    { random.next_2d() } -> std::convertible_to<vec2<decltype(random.next_1d())>>;
    { random.next_2d().x } -> std::convertible_to<decltype(random.next_1d())>;
    { random.next_2d().y } -> std::convertible_to<decltype(random.next_1d())>;
};

/// All numbers of one path: `at(bounce, why)` gives the `Sampler` of one decision, the same one at every call, so a
/// path draws the same numbers whichever thread walks it; `fork(branch)` gives those of a path that branches off.
template <typename N>
concept Numbers = std::copy_constructible<N> && requires(const N& numbers) {
    { numbers.at(std::uint32_t{}, purpose::scatter) } -> Sampler;
    { numbers.fork(std::uint64_t{}) } -> std::convertible_to<N>;
};

}  // namespace aglow
