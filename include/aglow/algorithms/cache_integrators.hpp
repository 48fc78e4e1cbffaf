// Ready integrators on an irradiance cache: gather rays carried on by path tracing, or by a photon map.
//
// Ward et al. 1988; the classical combination of Jensen 1996: photon map, seen through a final gather, remembered in an
// irradiance cache, caustics from a map of their own.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <aglow/algorithms/cache_candidates.hpp>
#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/algorithms/gloss_layer.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/preparation.hpp>
#include <aglow/estimators/irradiance_cache.hpp>

namespace aglow {

/// What gather rays for records bring by path tracing: mirrors are for them to find.
template <Scene World, Illuminator Lights>
struct path_reader {
    const path_tracer<World, Lights>& tracer;

    template <Numbers N>
    [[nodiscard]] auto operator()(const ray<scalar_of<World>>& r, const N& numbers) const {
        return tracer.incoming(r, numbers, emission_rule::indirect);
    }
};

/// What gather rays for records read from photon maps. Caustics that were reflected once are left out of the rays,
/// which would find the small bright spots by chance, and added from their own map: evenly, from many photons.
template <Scene World, Illuminator Lights>
struct map_reader {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;

    photon_source<World, Lights> source;
    emission_rule caustics;
    const photon_map<S, T>& reflected;
    density_options density;

    template <Numbers N>
    [[nodiscard]] auto operator()(const ray<T>& r, const N& numbers) const {
        return source.incoming(r, numbers, caustics);
    }
    [[nodiscard]] S unseen(const gather_point<T>& at) const {
        return reflected.irradiance(at.position, at.normal, density).value;
    }
};

/// Layer: indirect light on diffuse lobes from a cache; where it has no record, from a small gather of its own into
/// `Reader` (see `IncomingLight`, `KnowsUnseen`).
template <typename Cache, typename Reader>
class cache_layer {
public:
    /// `shared`: what all that `reader` brings is off by together.
    cache_layer(const Cache& cache, Reader reader, const shared_error& shared = {},
                const hemisphere_shape& fallback = {2, 8})
        : cache_{cache}, reader_{reader}, shared_{shared}, fallback_{fallback} {}

    template <Surface H, Numbers N>
    [[nodiscard]] estimate<surface_spectrum<H>> operator()(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                           hit_scalar<H> error, const N& numbers,
                                                           std::uint32_t bounce) const {
        using S = surface_spectrum<H>;
        using T = hit_scalar<H>;
        return diffuse_radiance(hit, wo, [&](const vec3<T>& side) -> estimate<S> {
            const auto answer = cache_.lookup(vec3<T>(hit.position), side);
            if (answer) { return shared_.on(answer.irradiance, static_cast<band_of<S>>(answer.error)); }
            const gather_point<T> here{vec3<T>(hit.position), side, error};
            S gathered = gather_once(reader_, here, N{numbers.fork(bounce)}, fallback_);
            if constexpr (KnowsUnseen<Reader, T>) { gathered = gathered + reader_.unseen(here); }
            return shared_.on(gathered,
                              max_component(gathered) / std::sqrt(static_cast<band_of<S>>(fallback_.count())));
        });
    }

private:
    const Cache& cache_;
    Reader reader_;
    shared_error shared_;
    hemisphere_shape fallback_;
};

namespace detail {

/// What a picture from `cache` is off by everywhere, told from a thousand of the places that it was made for.
template <typename Cache, std::floating_point T>
[[nodiscard]] shared_error shared_at(const Cache& cache, const typename Cache::frozen& finished,
                                     const std::vector<cache_candidate<T>>& places) {
    constexpr std::size_t enough = 1024;
    std::vector<gather_point<T>> some;
    const std::size_t step = 1 + places.size() / enough;
    for (std::size_t i = step / 2; i < places.size(); i += step) { some.push_back(places[i].place); }
    return cache.shared(finished, some);
}

}  // namespace detail

/// What a cached picture is made of, whatever answers the gather rays.
struct caching_options {
    irradiance_cache_options cache{};
    fill_cache_options fill{};
    view_options view{};
    path_options paths{};   ///< through mirrors and gloss
    gloss_options gloss{};  ///< of `glossy_caching_options`
};

namespace detail {

/// Looks a picture over and fills a cache for it, two phases of a preparation. Returns what all its records are off by
/// together.
template <Scene World, typename Eye, typename Reader, Executor Run, typename Frozen>
[[nodiscard]] auto cache_for(const World& scene, const bounds<scalar_of<World>>& box, const Eye& eye,
                             const Reader& reader, const caching_options& options, const Run& run,
                             const preparation_progress& progress, Frozen& frozen, fill_result& filled) {
    preparation_report report{progress};
    view_options view = options.view;
    view.progress = report.phase(preparation_phase::places, view.progress);
    const auto places = cache_candidates(scene, eye, view, run);
    const auto tell = report.phase(preparation_phase::records);
    irradiance_cache<spectrum_of<World>, scalar_of<World>, Frozen::record::features> cache{box, options.cache};
    filled = fill_cache(cache, places, reader, options.fill, run, [&](const fill_progress& now) {
        const double left = static_cast<double>(now.uncovered) / static_cast<double>(now.candidates);
        return !tell || tell(1 - left);
    });
    if (tell && !filled.cancelled) { (void)tell(1); }
    frozen = cache.freeze(run);
    return shared_at(cache, frozen, places);
}

}  // namespace detail

/// The same for a picture that reads broad glossy reflection from the cache too, instead of following it by rays:
/// records keep where light comes from, 8 bytes more each.
struct glossy_caching_options : caching_options {};

/// An integrator: direct light by shadow rays, indirect light from an irradiance cache whose gather rays are
/// path-traced. Fills the cache for the picture of `eye` when made. Handed `glossy_caching_options`, it reads glossy
/// lobes from the cache as well. `const`, safe from many threads.
template <Scene World, Illuminator Lights, record_features Features = record_features{}>
class irradiance_caching {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;
    using cache_type = frozen_irradiance_cache<spectrum, scalar, Features>;

    /// `scene_bounds` is what the cache's lengths are measured by. `progress` may cut the filling short: the picture
    /// then gathers afresh where it finds no record.
    template <typename Eye, Executor Run = in_sequence>
    irradiance_caching(const World& scene, const Lights& lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                       const caching_options& options = {}, const Run& run = {},
                       const preparation_progress& progress = {})
        : scene_{scene}, lights_{lights}, options_{options}, source_{scene, lights, options.paths} {
        const path_reader<World, Lights> reader{source_};
        shared_ = detail::cache_for(scene, scene_bounds, eye, reader, options, run, progress, cache_, filled_);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const cache_layer diffuse{cache_, path_reader<World, Lights>{source_}, shared_};
        if constexpr (Features.incident) {
            const glossy_cache_layers layers{scene_, lights_, cache_, diffuse, options_.gloss, options_.paths.faults};
            return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
        } else {
            const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.paths.faults}, diffuse};
            return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
        }
    }

    [[nodiscard]] const cache_type& cache() const { return cache_; }
    [[nodiscard]] const fill_result& filled() const { return filled_; }
    /// What all that is read from the cache is off by together.
    [[nodiscard]] const shared_error& shared() const { return shared_; }

private:
    const World& scene_;
    const Lights& lights_;
    caching_options options_;
    path_tracer<World, Lights> source_;
    cache_type cache_{};
    fill_result filled_{};
    shared_error shared_{};
};

template <Scene World, Illuminator Lights, std::floating_point T, typename Eye, Executor Run = in_sequence>
irradiance_caching(const World&, const Lights&, const bounds<T>&, const Eye&, const glossy_caching_options&,
                   const Run& = {}, const preparation_progress& = {})
    -> irradiance_caching<World, Lights, record_features{.incident = true}>;

/// What the classical combination is made of.
struct gather_caching_options {
    photon_options photons{
        .direct = 20'000, .caustic = 200'000, .indirect = 100'000};  ///< 0 reflected: half the caustic
    density_options density{};                                       ///< of the caustic map as it is seen
    density_options reflected_density{.count = 400};  ///< of the map of reflected caustics, read once a record
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

    /// `scene_bounds` is what the cache's lengths are measured by. `progress` may cut each phase short.
    template <typename Eye, Executor Run = in_sequence>
    gather_caching(const World& scene, const Lights& lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                   const gather_caching_options& options = {}, const Run& run = {},
                   const preparation_progress& progress = {})
        : scene_{scene}, lights_{lights}, options_{options}, base_{scene, lights,  options.photons, options.irradiance,
                                                                   run,   progress} {
        shared_ = base_.points().shared() + detail::cache_for(scene, scene_bounds, eye, reader(), options.caching, run,
                                                              progress, cache_, filled_);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.caching.paths.faults},
                               map_layer<spectrum, scalar>{base_.maps().caustic, options_.density},
                               cache_layer{cache_, reader(), shared_}};
        return layered_integrator{scene_, lights_, layers, options_.caching.paths}(eye, numbers);
    }

    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const { return base_.maps(); }
    [[nodiscard]] const irradiance_points<spectrum, scalar>& points() const { return base_.points(); }
    [[nodiscard]] const cache_type& cache() const { return cache_; }
    [[nodiscard]] const fill_result& filled() const { return filled_; }
    /// What all that is read from the cache is off by together.
    [[nodiscard]] const shared_error& shared() const { return shared_; }

private:
    [[nodiscard]] map_reader<World, Lights> reader() const {
        return {{scene_, lights_, base_.points(), options_.source},
                base_.caustics(),
                base_.maps().reflected,
                options_.reflected_density};
    }

    const World& scene_;
    const Lights& lights_;
    gather_caching_options options_;
    gather_base<World, Lights> base_;
    cache_type cache_{};
    fill_result filled_{};
    shared_error shared_{};
};

}  // namespace aglow
