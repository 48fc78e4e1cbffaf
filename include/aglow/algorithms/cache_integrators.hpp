// Ready integrators on an irradiance cache: gather rays carried on by path tracing, or by a photon map.
//
// Ward et al. 1988; the classical combination of Jensen 1996: photon map, seen through a final gather, remembered in an
// irradiance cache, caustics from a map of their own.
#pragma once

#include <cstdint>
#include <utility>

#include <aglow/algorithms/cache_candidates.hpp>
#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/estimators/irradiance_cache.hpp>

namespace aglow {

/// Layer: indirect light on diffuse lobes from a cache; where it has no record, from a small gather of its own into
/// `Source`.
template <typename Cache, typename Source>
class cache_layer {
public:
    cache_layer(const Cache& cache, const Source& source, emission_rule caustics,
                const hemisphere_shape& fallback = {2, 8})
        : cache_{cache}, source_{source}, caustics_{caustics}, fallback_{fallback} {}

    template <Surface H, Numbers N>
    [[nodiscard]] estimate<surface_spectrum<H>> operator()(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                           hit_scalar<H> error, const N& numbers,
                                                           std::uint32_t bounce) const {
        using S = surface_spectrum<H>;
        using T = hit_scalar<H>;
        return diffuse_radiance(hit, wo, [&](const vec3<T>& side) -> estimate<S> {
            const auto answer = cache_.lookup(vec3<T>(hit.position), side);
            if (answer) { return {answer.irradiance, static_cast<band_of<S>>(answer.error)}; }
            const auto incoming = [&](const ray<T>& r, const N& n) { return source_.incoming(r, n, caustics_); };
            const S gathered = gather_once(incoming, gather_point<T>{vec3<T>(hit.position), side, error},
                                           N{numbers.fork(bounce)}, fallback_);
            return {gathered, max_component(gathered) / std::sqrt(static_cast<band_of<S>>(fallback_.count()))};
        });
    }

private:
    const Cache& cache_;
    const Source& source_;
    emission_rule caustics_;
    hemisphere_shape fallback_;
};

/// What a cached picture is made of, whatever answers the gather rays.
struct caching_options {
    irradiance_cache_options cache{};
    fill_cache_options fill{};
    view_options view{};
    path_options paths{};  ///< through mirrors and gloss
};

/// An integrator: direct light by shadow rays, indirect light from an irradiance cache whose gather rays are
/// path-traced. Fills the cache for the picture of `eye` when made. `const`, safe from many threads.
template <Scene World, Illuminator Lights>
class irradiance_caching {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;
    using cache_type = frozen_irradiance_cache<spectrum, scalar>;

    /// `scene_bounds` is what the cache's lengths are measured by.
    template <typename Eye, Executor Run = in_sequence>
    irradiance_caching(const World& scene, const Lights& lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                       const caching_options& options = {}, const Run& run = {})
        : scene_{scene}, lights_{lights}, options_{options}, source_{scene, lights, options.paths} {
        irradiance_cache<spectrum, scalar> cache{scene_bounds, options.cache};
        const auto places = cache_candidates(scene, eye, options.view, run);
        const auto incoming = [this](const ray<scalar>& r, const random_numbers<scalar>& n) {
            return source_.incoming(r, n, emission_rule::indirect);
        };
        filled_ = fill_cache(cache, places, incoming, options.fill, run);
        cache_ = cache.freeze(run);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.paths.faults},
                               cache_layer{cache_, source_, emission_rule::indirect}};
        return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
    }

    [[nodiscard]] const cache_type& cache() const { return cache_; }
    [[nodiscard]] const fill_result& filled() const { return filled_; }

private:
    const World& scene_;
    const Lights& lights_;
    caching_options options_;
    path_tracer<World, Lights> source_;
    cache_type cache_{};
    fill_result filled_{};
};

/// What the classical combination is made of.
struct gather_caching_options {
    photon_options photons{.direct = 20'000, .caustic = 200'000, .indirect = 100'000};
    density_options density{};  ///< of the caustic map as it is seen
    irradiance_options irradiance{};
    photon_source_options source{};
    caching_options caching{};
};

/// An integrator: direct light by shadow rays, caustics from their map, indirect light gathered from the photon map at
/// few points and remembered in an irradiance cache. All is made for the picture of `eye`. `const`, safe from many
/// threads.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class gather_caching {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;
    using cache_type = frozen_irradiance_cache<spectrum, scalar>;

    /// `scene_bounds` is what the cache's lengths are measured by.
    template <typename Eye, Executor Run = in_sequence>
    gather_caching(const World& scene, const Lights& lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                   const gather_caching_options& options = {}, const Run& run = {})
        : scene_{scene},
          lights_{lights},
          options_{options},
          base_{scene, lights, options.photons, options.irradiance, run} {
        irradiance_cache<spectrum, scalar> cache{scene_bounds, options.caching.cache};
        const auto places = cache_candidates(scene, eye, options.caching.view, run);
        const auto reading = source();
        const auto incoming = [&](const ray<scalar>& r, const random_numbers<scalar>& n) {
            return reading.incoming(r, n, base_.caustics());
        };
        filled_ = fill_cache(cache, places, incoming, options.caching.fill, run);
        cache_ = cache.freeze(run);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const auto reading = source();
        const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.caching.paths.faults},
                               map_layer<spectrum, scalar>{base_.maps().caustic, options_.density},
                               cache_layer{cache_, reading, base_.caustics()}};
        return layered_integrator{scene_, lights_, layers, options_.caching.paths}(eye, numbers);
    }

    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const { return base_.maps(); }
    [[nodiscard]] const irradiance_points<spectrum, scalar>& points() const { return base_.points(); }
    [[nodiscard]] const cache_type& cache() const { return cache_; }
    [[nodiscard]] const fill_result& filled() const { return filled_; }

private:
    [[nodiscard]] photon_source<World, Lights> source() const {
        return {scene_, lights_, base_.points(), options_.source};
    }

    const World& scene_;
    const Lights& lights_;
    gather_caching_options options_;
    gather_base<World, Lights> base_;
    cache_type cache_{};
    fill_result filled_{};
};

}  // namespace aglow
