// Light that comes straight from the lights: one look at them per call.
//
// Next-event estimation, weighed against scattering where scattered rays look for lights too (multiple importance
// sampling, Veach & Guibas 1995, balance heuristic).
#pragma once

#include <algorithm>

#include <aglow/algorithms/host_faults.hpp>
#include <aglow/concepts/light.hpp>

namespace aglow {

/// The share of the technique with density `mine` beside one with density `other` (balance heuristic).
template <std::floating_point T>
[[nodiscard]] constexpr T balance(T mine, T other) {
    if (!(mine > 0)) { return T(0); }
    return other > 0 ? 1 / (1 + other / mine) : T(1);
}

/// Whether nothing lies between `hit` and what is `distance` away `towards` there (infinite: the sky).
/// Both ends are lifted off their surfaces: the near one along the normal, the far one back along the way, so that it
/// stays before a light that is looked at from aside.
template <Intersector World, Hit H, std::floating_point T>
[[nodiscard]] bool sees(const World& scene, const H& hit, const vec3<T>& towards, T distance, T error) {
    const vec3<T> from = lift(vec3<T>(hit.position), vec3<T>(hit.normal), towards, error);
    if (!is_finite(distance)) { return !scene.intersect(ray<T>{from, towards}); }
    // It steps back by as much as the light's own surface may be off.
    const T step = 4 * std::max(error, position_error(distance));
    return !scene.occluded(from, vec3<T>(hit.position) + towards * std::max(distance / 2, distance - step));
}

/// The density with which `lights` look from `point` along `towards` at `hit`; 0 where they cannot tell.
template <typename Lights, Hit H, std::floating_point T>
[[nodiscard]] T light_pdf(const Lights& lights, const vec3<T>& point, const vec3<T>& towards, const H& hit) {
    if constexpr (requires { lights.pdf(point, towards, hit); }) {
        return lights.pdf(point, towards, hit);
    } else {
        return 0;
    }
}

/// Whether `lights` can tell the density of what a scattered ray meets: what multiple importance sampling needs.
template <typename Lights, typename H>
concept TellsPdf = requires(const Lights& lights, const vec3<hit_scalar<H>>& v, const H& hit) {
    lights.pdf(v, v, hit);
};

/// Whether `lights` can tell the density with which they look beyond the scene.
template <typename Lights, typename T>
concept TellsEscapedPdf = requires(const Lights& lights, const vec3<T>& v) {
    lights.escaped_pdf(v, v);
};

/// Which lobes look for lights by a scattered ray as well, so that both ways share the work.
struct light_sharing {
    lobe_set lit{lobe_set::smooth};        ///< lobes that are lit here
    lobe_set scattered{lobe_set::smooth};  ///< of these, lobes from which a scattered ray will look too; exactly what
                                           ///< is asked of `sample`, specular lobes included (name them in both)
    host_faults* faults{nullptr};          ///< where broken light is noted; null for nowhere
    double carried{1};                     ///< what the asking path carries of it
};

/// Radiance that leaves `hit` towards `wo`, having come straight from `lights`: an unbiased estimate of one shadow ray,
/// of the part that `sharing.scattered` leaves over.
/// Black where the light is hidden or its radiance is no finite number.
template <Scene World, Illuminator Lights, Sampler R>
[[nodiscard]] spectrum_of<World> direct_light(const World& scene, const Lights& lights, const hit_of<World>& hit,
                                              const vec3<scalar_of<World>>& wo, scalar_of<World> error, R&& random,
                                              light_sharing sharing = {}) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    const vec3<T> point = hit.position;
    const auto light = lights.illuminate(point, random);
    if (!light) { return S{}; }
    const vec3<T> wi = light->towards;
    const T cosine = std::abs(glm::dot(vec3<T>(hit.normal), wi));
    // What the scene cannot have by its type is no code either.
    const lobe_set lit = sharing.lit & static_lobes<World>;
    const lobe_set alone = lit & ~sharing.scattered;
    S reflected = any(alone) ? S(hit.evaluate(wo, wi, alone)) : S{};
    const lobe_set shared = lit & sharing.scattered;
    if (any(shared, lobe_set::smooth)) {
        const bool told = is_finite(T(light->distance)) ? TellsPdf<Lights, hit_of<World>> : TellsEscapedPdf<Lights, T>;
        const bool met = told && light->pdf > 0;
        const T share = met ? balance(T(light->pdf), T(hit.pdf(wo, wi, shared))) : T(1);
        reflected = reflected + hit.evaluate(wo, wi, shared) * band_of<S>(share);
    }
    const S radiance = light->radiance_over_pdf * reflected * band_of<S>(cosine);
    if (!is_radiance(radiance)) {
        if (sharing.faults) { sharing.faults->note(host_fault::radiance, sharing.carried); }
        return S{};
    }
    if (is_black(radiance)) { return S{}; }
    return sees(scene, hit, wi, T(light->distance), error) ? radiance : S{};
}

}  // namespace aglow
