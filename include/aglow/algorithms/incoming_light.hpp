// What a gather ray brings home.
#pragma once

#include <concepts>
#include <limits>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// Radiance that comes along a ray, how far away it comes from (infinite where nothing was met), a guess of its error,
/// and the normal of what was met, on either side; zero where it is not known.
template <Spectrum S, std::floating_point T>
struct incoming_light {
    S radiance{};
    T distance{std::numeric_limits<T>::infinity()};
    band_of<S> error{};
    band_of<S> common{};  ///< as of `estimate`
    band_of<S> bias{};
    vec3<T> normal{};
};

}  // namespace aglow
