// What is remembered of a particle that landed: how much power it brought, and from where.
#pragma once

#include <concepts>
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
        return glm::dot(wi.template along<T>(), n) > 0;
    }
    /// Whether its surface's normal is within `cosine` of unit `n`.
    template <typename T>
    [[nodiscard]] bool faces(const vec3<T>& n, T cosine) const {
        return glm::dot(normal.template along<T>(), n) >= cosine * normal.template length<T>();
    }

    // What a `PhotonItem` answers.
    [[nodiscard]] const S& flux() const { return power; }
    template <typename T>
    [[nodiscard]] vec3<T> towards() const {
        return wi.template direction<T>();
    }
    template <typename T>
    [[nodiscard]] vec3<T> facing() const {
        return normal.template direction<T>();
    }
};

/// A photon and the place where it landed, as tracing hands it over.
template <Spectrum S, std::floating_point T>
struct landed_photon {
    vec3<T> position{};
    photon<S> what{};
};

/// What a map may keep of a photon: its flux, where it came from and which way its surface faces.
template <typename Item, typename S, typename T>
concept PhotonItem = std::copyable<Item> && requires(const Item& item, const vec3<T>& n, T cosine) {
    { item.flux() } -> std::convertible_to<S>;
    { item.template towards<T>() } -> std::same_as<vec3<T>>;
    { item.template facing<T>() } -> std::same_as<vec3<T>>;
    { item.arrived_on(n) } -> std::same_as<bool>;
    { item.faces(n, cosine) } -> std::same_as<bool>;
};

}  // namespace aglow
