// Ready integrators on an irradiance cache: gather rays carried on by path tracing, or by a photon map.
//
// Ward et al. 1988; the classical combination of Jensen 1996: photon map, seen through a final gather, remembered in an
// irradiance cache, caustics from a map of their own.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <aglow/algorithms/cache_candidates.hpp>
#include <aglow/algorithms/cache_layer.hpp>
#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/algorithms/gloss_layer.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/preparation.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/estimators/irradiance_cache.hpp>

namespace aglow {

namespace detail {

/// What light at `places` is off by together that came to the records of `finished` by no ray of `reader`.
template <typename Frozen, typename Reader, std::floating_point T>
[[nodiscard]] shared_error unseen_at(const Frozen& finished, const Reader& reader,
                                     const std::vector<gather_point<T>>& places) {
    if constexpr (KnowsUnseen<Reader, T>) {
        double light = 0;
        double common = 0;
        double bias = 0;
        for (const gather_point<T>& place : places) {
            const auto answer = finished.lookup(place.position, place.normal);
            if (!answer) { continue; }
            const auto unseen = reader.unseen(place);
            light += static_cast<double>(max_component(answer.irradiance));
            common += static_cast<double>(unseen.common);
            bias += static_cast<double>(unseen.bias);
        }
        if (light > 0) { return {common / light, bias / light}; }
    }
    return {};
}

/// What a picture from `cache` is off by everywhere, told from a thousand of the places that it was made for.
template <typename Cache, typename Reader, std::floating_point T>
[[nodiscard]] shared_error shared_at(const Cache& cache, const typename Cache::frozen& finished, const Reader& reader,
                                     const std::vector<cache_candidate<T>>& places) {
    constexpr std::size_t enough = 1024;
    std::vector<gather_point<T>> some;
    const std::size_t step = 1 + places.size() / enough;
    for (std::size_t i = step / 2; i < places.size(); i += step) { some.push_back(places[i].place); }
    return cache.shared(finished, some) + unseen_at(finished, reader, some);
}

}  // namespace detail

/// Caustics beside path-traced gather rays, which meet them only by chance: from maps of their own.
struct caustic_options {
    photon_options photons{.caustic = 200'000};       ///< 0 reflected: half the caustic; 0 caustic: left to chance
    density_options density{};                        ///< of the caustic map as it is seen
    density_options reflected_density{.count = 400};  ///< of the map of reflected caustics, read once a record
};

/// What a cached picture is made of, whatever answers the gather rays.
struct caching_options {
    irradiance_cache_options cache{};
    fill_cache_options fill{};
    view_options view{};
    path_options paths{};        ///< through mirrors and gloss
    caustic_options caustics{};  ///< of `irradiance_caching`; `gather_caching` tells of all its photons by itself
    gloss_options gloss{};       ///< of `glossy_caching_options`
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
        const double covered = 1 - static_cast<double>(now.uncovered) / static_cast<double>(now.candidates);
        return !tell || tell(0.9 * covered + 0.1 * now.sharpened);  // not 1 while rays are still sent
    });
    if (tell && !filled.cancelled) { (void)tell(1); }
    frozen = cache.freeze(run);
    return shared_at(cache, frozen, reader, places);
}

}  // namespace detail

/// The same for a picture that reads broad glossy reflection from the cache too, instead of following it by rays:
/// records keep where light comes from, 8 bytes more each.
struct glossy_caching_options : caching_options {};

namespace detail {

/// Whether a scene with such lights may need a caustic map: something mirrors, and the lights can send photons out.
template <typename World, typename Lights>
inline constexpr bool may_have_caustics = any(static_lobes<World>, lobe_set::specular) && Emitter<Lights>;

/// Where no caustic map can be, this stands for it.
struct no_maps {};

}  // namespace detail

/// An integrator: direct light by shadow rays, indirect light from an irradiance cache whose gather rays are
/// path-traced, and caustics from their own photon map where something mirrors and the lights are an `Emitter` too.
/// Makes all of it for the picture of `eye`. Handed `glossy_caching_options`, it reads glossy lobes from the cache as
/// well, caustics too. Keeps references to scene and lights; `const`, safe from many threads.
template <Scene World, Illuminator Lights, record_features Features = record_features{}>
class irradiance_caching {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;
    using cache_type = frozen_irradiance_cache<spectrum, scalar, Features>;
    /// Whether caustics can have maps of their own here; not where gloss is read from the cache, which then needs them.
    static constexpr bool has_maps = detail::may_have_caustics<World, Lights> && !Features.incident;

    /// `scene_bounds` is what the cache's lengths are measured by. `progress` may cut each phase short: where the
    /// picture finds no record, it gathers afresh.
    template <typename Eye, Executor Run = in_sequence>
    irradiance_caching(lasting<World> scene, lasting<Lights> lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                       const caching_options& options = {}, const Run& run = {},
                       const preparation_progress& progress = {})
        : scene_{*scene}, lights_{*lights}, options_{options}, source_{scene_, lights_, options.paths} {
        if constexpr (has_maps) {
            detail::preparation_report report{progress};
            maps_ =
                detail::trace_photons(scene_, lights_, detail::with_reflected(options.caustics.photons), run, report);
        }
        shared_ = detail::cache_for(scene_, scene_bounds, eye, reader(), options, run, progress, cache_, filled_);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const auto diffuse = indirect();
        if constexpr (Features.incident) {
            const glossy_cache_layers layers{
                scene_, lights_, cache_, diffuse, options_.gloss, shared_, options_.paths.faults};
            return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
        } else {
            const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.paths.faults}, diffuse};
            return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
        }
    }

    /// The caustic photons and those reflected once.
    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const requires has_maps { return maps_; }

    [[nodiscard]] const cache_type& cache() const { return cache_; }
    [[nodiscard]] const fill_result& filled() const { return filled_; }
    /// What all that is read from the cache is off by together.
    [[nodiscard]] const shared_error& shared() const { return shared_; }

private:
    [[nodiscard]] auto reader() const {
        if constexpr (has_maps) {
            return caustic_reader<path_tracer<World, Lights>, spectrum, scalar>{
                source_, detail::left_to_rays(maps_), maps_.reflected, options_.caustics.reflected_density};
        } else {
            return ray_reader<path_tracer<World, Lights>>{source_};
        }
    }
    /// The light on diffuse lobes that comes over other surfaces.
    [[nodiscard]] auto indirect() const {
        cache_layer cached{cache_, reader(), shared_};
        if constexpr (has_maps) {
            return layer_sum{map_layer<spectrum, scalar>{maps_.caustic, options_.caustics.density}, std::move(cached)};
        } else {
            return cached;
        }
    }

    const World& scene_;
    const Lights& lights_;
    caching_options options_;
    path_tracer<World, Lights> source_;
    std::conditional_t<has_maps, photon_maps<spectrum, scalar>, detail::no_maps> maps_{};
    cache_type cache_{};
    fill_result filled_{};
    shared_error shared_{};
};

template <Scene World, Illuminator Lights, typename Eye, Executor Run = in_sequence>
irradiance_caching(const World&, const Lights&, const bounds<scalar_of<World>>&, const Eye&,
                   const caching_options& = {}, const Run& = {}, const preparation_progress& = {})
    -> irradiance_caching<World, Lights>;
template <Scene World, Illuminator Lights, typename Eye, std::same_as<glossy_caching_options> Options,
          Executor Run = in_sequence>
irradiance_caching(const World&, const Lights&, const bounds<scalar_of<World>>&, const Eye&, const Options&,
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
/// few points and remembered in an irradiance cache. All is made for the picture of `eye`. Keeps references to scene
/// and lights; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class gather_caching {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;
    using cache_type = frozen_irradiance_cache<spectrum, scalar>;

    /// `scene_bounds` is what the cache's lengths are measured by. `progress` may cut each phase short.
    template <typename Eye, Executor Run = in_sequence>
    gather_caching(lasting<World> scene, lasting<Lights> lights, const bounds<scalar>& scene_bounds, const Eye& eye,
                   const gather_caching_options& options = {}, const Run& run = {},
                   const preparation_progress& progress = {})
        : scene_{*scene}, lights_{*lights}, options_{options}, base_{scene_,
                                                                     lights_,
                                                                     options.photons,
                                                                     options.irradiance,
                                                                     run,
                                                                     progress} {
        detail::note_with(options_.caching.paths, options_.source);
        shared_ = base_.points().shared() + detail::cache_for(scene_, scene_bounds, eye, reader(), options.caching, run,
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
    [[nodiscard]] caustic_reader<photon_source<World, Lights>, spectrum, scalar> reader() const {
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

template <Scene World, Illuminator Lights, typename Eye, Executor Run = in_sequence>
gather_caching(const World&, const Lights&, const bounds<scalar_of<World>>&, const Eye&,
               const gather_caching_options& = {}, const Run& = {}, const preparation_progress& = {})
    -> gather_caching<World, Lights>;

}  // namespace aglow
