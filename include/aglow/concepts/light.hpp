// What a host's lights must be able to do: send photons out, and be seen from a point.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>

namespace aglow {

/// One particle on its way: it carries `power`, in watts, along `path`.
template <Spectrum S, std::floating_point T>
struct emission {
    ray<T> path{};
    S power{};
};

/// One look from a point at a light: unit direction `towards` it, `distance` to it (infinite for the sky), the radiance
/// that comes along it over the density of the choice, and that density per steradian (0 for a delta light, which no
/// scattered ray can meet).
template <Spectrum S, std::floating_point T>
struct illumination {
    vec3<T> towards{};
    T distance{std::numeric_limits<T>::infinity()};
    S radiance_over_pdf{};
    T pdf{};
};

/// A light that sends out particles: what photon tracing asks. `random` is any `Sampler`: take it as a template. Member
/// type `scalar` where it is not float, for rays and points.
/// Must be true: the mean of `power` is the light's power in watts; particles leave by place and direction as radiance
/// times cosine does, so that what arrives anywhere is what `illuminate` finds there.
template <typename L>
concept Emitter = requires(const L& light, random_sampler<scalar_of<L>>& random) {
    requires Spectrum<std::remove_cvref_t<decltype(light.emit(random).power)>>;
    { light.emit(random).path } -> std::convertible_to<ray<scalar_of<L>>>;
};

/// A light that can be looked at: what direct light asks, with any `Sampler`. `illuminate(point, random)` is an
/// optional-like `illumination`, empty where the light cannot shine on the point.
/// - optional `pdf(point, towards, hit)`: the density per steradian with which `illuminate(point)` looks at `hit`, met
///   from `point` along `towards`; 0 for what is no light. With it, emission that scattered rays meet is weighed in
///   (multiple importance sampling); without it, only what `illuminate` cannot find (seen by the eye or in a mirror)
///   counts.
/// - optional `escaped(direction)`: radiance that comes from beyond the scene, from `direction`; and
///   `escaped_pdf(point, direction)`: the density with which `illuminate` looks there.
///
/// Must be true: the mean of radiance_over_pdf cos, where not occluded, is the direct irradiance. Light that
/// `illuminate` never finds, such as a sky without `escaped_pdf`, is whole under path tracing alone: photon maps and
/// caches leave parts of it out.
template <typename L>
concept Illuminator = requires(const L& light, vec3<scalar_of<L>> point, random_sampler<scalar_of<L>>& random) {
    static_cast<bool>(light.illuminate(point, random));
    { light.illuminate(point, random)->towards } -> std::convertible_to<vec3<scalar_of<L>>>;
    { light.illuminate(point, random)->distance } -> std::convertible_to<scalar_of<L>>;
    requires Spectrum<std::remove_cvref_t<decltype(light.illuminate(point, random)->radiance_over_pdf)>>;
    { light.illuminate(point, random)->pdf } -> std::convertible_to<scalar_of<L>>;
};

/// Whether `lights` can shine from beyond the scene.
template <typename L, typename T>
concept ShinesFromBeyond = requires(const L& lights, const vec3<T>& direction) {
    lights.escaped(direction);
};

/// Radiance from beyond the scene, from `direction`; black where the lights have no `escaped`.
template <Spectrum S, typename L, std::floating_point T>
[[nodiscard]] S escaped_radiance(const L& lights, const vec3<T>& direction) {
    if constexpr (ShinesFromBeyond<L, T>) {
        return lights.escaped(direction);
    } else {
        return {};
    }
}

}  // namespace aglow
