// Irradiance at a share of the photons, direct light included: what gather rays read.
//
// Christensen 1999. Direct light is sampled by shadow rays instead of photons: fewer photons, no blur at its edges.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/estimators/irradiance_points.hpp>

namespace aglow {

/// How irradiance is worked out ahead.
struct irradiance_options {
    std::size_t every{4};          ///< a point at every so many photons
    std::uint32_t shadow_rays{8};  ///< looks at the lights per point; 0 takes direct light from the direct map
    density_options density{};     ///< for the caustic and the indirect map
    std::uint64_t seed{0};
};

namespace detail {

/// A place on a surface, without a material.
template <std::floating_point T>
struct bare_place {
    vec3<T> position{};
    vec3<T> normal{};
};

}  // namespace detail

/// Direct irradiance on the side of unit `normal` at `point`, by `rays` stratified shadow rays, W/m².
template <Scene World, Illuminator Lights>
[[nodiscard]] spectrum_of<World> direct_irradiance(const World& scene, const Lights& lights,
                                                   const vec3<scalar_of<World>>& point,
                                                   const vec3<scalar_of<World>>& normal, scalar_of<World> error,
                                                   std::uint32_t rays, std::uint64_t seed) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    S sum{};
    for (std::uint32_t i = 0; i < rays; ++i) {
        sobol_sampler<T> random{seed, i};
        const auto light = lights.illuminate(point, random);
        if (!light) { continue; }
        const T cosine = glm::dot(normal, vec3<T>(light->towards));
        if (!(cosine > 0)) { continue; }
        const S radiance = light->radiance_over_pdf * band_of<S>(cosine);
        if (!is_radiance(radiance)) { continue; }
        const detail::bare_place<T> here{point, normal};
        if (sees(scene, here, vec3<T>(light->towards), T(light->distance), error)) { sum = sum + radiance; }
    }
    return sum * (1 / static_cast<band_of<S>>(std::max(1u, rays)));
}

namespace detail {

/// Whether anything cuts through the disc of `radius` around a point on a surface: six spokes tell.
template <Intersector World>
[[nodiscard]] bool is_cut(const World& scene, const vec3<scalar_of<World>>& from, const frame<scalar_of<World>>& axes,
                          scalar_of<World> radius) {
    using T = scalar_of<World>;
    for (int i = 0; i < 6; ++i) {
        const T angle = pi<T> / 3 * static_cast<T>(i);
        if (scene.occluded(from, from + (axes.x * std::cos(angle) + axes.y * std::sin(angle)) * radius)) {
            return true;
        }
    }
    return false;
}

/// Irradiance from photons that can be seen from the point: behind a thin wall in the middle of their disc lie photons
/// of the same plane, side and normal, which no test of these can tell apart.
template <Intersector World, Spectrum S>
[[nodiscard]] density_estimate<S, scalar_of<World>> seen_irradiance(
    const World& scene, const photon_map<S, scalar_of<World>>& map, const vec3<scalar_of<World>>& point,
    const vec3<scalar_of<World>>& normal, scalar_of<World> error, const density_options& options) {
    using T = scalar_of<World>;
    const auto plain = map.irradiance(point, normal, options);
    const vec3<T> from = point + normal * error;
    if (plain.count == 0 || !is_cut(scene, from, frame<T>{normal}, plain.radius)) { return plain; }
    return map.irradiance(point, normal, options,
                          [&](const vec3<T>& photon) { return !scene.occluded(from, photon + normal * error); });
}

}  // namespace detail

/// Irradiance from all light at every `options.every`-th photon of each map, the photons' side. Points keep the radius
/// of their indirect estimate. The same for any executor. O(points (k + shadow rays)).
template <Scene World, Illuminator Lights, Executor Run = in_sequence>
[[nodiscard]] auto precompute_irradiance(const World& scene, const Lights& lights,
                                         const photon_maps<spectrum_of<World>, scalar_of<World>>& maps,
                                         const irradiance_options& options = {}, const Run& run = {}) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    std::vector<irradiance_point<S, T>> points;
    const auto choose = [&](const photon_map<S, T>& map) {
        for (std::size_t i = 0; i < map.size(); i += std::max<std::size_t>(1, options.every)) {
            points.push_back({.position = map.position(i),
                              .normal = glm::normalize(map.photons()[i].normal.template direction<T>())});
        }
    };
    choose(maps.direct);
    choose(maps.caustic);
    choose(maps.indirect);
    const T error = 4 * position_error([&] {
                        bounds<T> all = maps.direct.box();
                        all.add(maps.caustic.box());
                        all.add(maps.indirect.box());
                        return all.empty() ? T(0) : std::max(max_abs(all.low), max_abs(all.high));
                    }());
    for_each_block(run, points.size(), 256, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            irradiance_point<S, T>& p = points[i];
            const auto seen = [&](const photon_map<S, T>& map) {
                return detail::seen_irradiance<World, S>(scene, map, p.position, p.normal, error, options.density);
            };
            const auto indirect = seen(maps.indirect);
            const auto caustic = seen(maps.caustic);
            const S direct = options.shadow_rays == 0 ? seen(maps.direct).value
                                                      : direct_irradiance(scene, lights, p.position, p.normal, error,
                                                                          options.shadow_rays, mix(options.seed, i));
            p.irradiance = direct + indirect.value;
            p.caustic = caustic.value;
            p.error = caustic.error + indirect.error;
            p.radius = indirect.count > 0 ? indirect.radius : T(0);
            p.cut = detail::is_cut(scene, p.position + p.normal * error, frame<T>{p.normal},
                                   std::max(p.radius, caustic.radius));
        }
    });
    return irradiance_points<S, T>{points, run};
}

}  // namespace aglow
