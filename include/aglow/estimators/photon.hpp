// What is remembered of a particle that landed: how much power it brought, and from where.
#pragma once

#include <cstdint>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/packed_direction.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A stored particle, without its position (which the index keeps). 24 bytes for RGB, 16 for gray.
template <Spectrum S>
struct photon {
    S power{};                                ///< flux through the surface, W
    packed_direction<std::int16_t> wi{};      ///< towards where it came from
    packed_direction<std::int16_t> normal{};  ///< of the surface, on the side that it arrived on

    /// Whether it arrived on the side of a surface that `n` (unit) points out of.
    template <typename T>
    [[nodiscard]] bool arrived_on(const vec3<T>& n) const {
        return glm::dot(wi.template direction<T>(), n) > 0;
    }
};

/// A photon and the place where it landed, as tracing hands it over.
template <Spectrum S, std::floating_point T>
struct landed_photon {
    vec3<T> position{};
    photon<S> what{};
};

}  // namespace aglow
