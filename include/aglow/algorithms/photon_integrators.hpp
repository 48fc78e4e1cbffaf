// Ready integrators on photon maps: looked at directly, and seen through a final gather.
//
// Jensen 1996. Direct visualisation is quick and blotchy; the gather is smooth and costs its rays at every point.
#pragma once

#include <optional>
#include <stdexcept>
#include <utility>

#include <aglow/algorithms/final_gather.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/photon_source.hpp>
#include <aglow/algorithms/precompute_irradiance.hpp>
#include <aglow/algorithms/preparation.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/lasting.hpp>

namespace aglow {

/// What a photon-mapped picture is made of.
struct photon_mapping_options {
    photon_options photons{.caustic = 200'000, .indirect = 200'000};
    density_options density{};
    bool direct_from_map{false};  ///< direct light from the direct map (ask for its photons) instead of shadow rays
    path_options paths{};         ///< through mirrors and gloss
};

namespace detail {

/// Whether any of the photons that are wanted can land in `scene`.
template <typename World>
[[nodiscard]] bool can_have(const World& scene, const photon_options& wanted) {
    const lobe_set lobes = possible_lobes(scene);
    const bool caustic = wanted.caustic > 0 && any(lobes, lobe_set::specular);
    return any(lobes, lobe_set::smooth) && (caustic || wanted.direct > 0 || wanted.indirect > 0);
}

/// Traces photons as a phase of a preparation, where there is anything to trace.
template <typename World, typename Lights, typename Run>
[[nodiscard]] auto trace_photons(const World& scene, const Lights& lights, photon_options options, const Run& run,
                                 preparation_report& report) {
    if (can_have(scene, options)) { options.progress = report.phase(preparation_phase::photons, options.progress); }
    return aglow::trace_photons(scene, lights, options, run);
}

}  // namespace detail

/// An integrator: direct light by shadow rays or from its map, caustics and indirect light straight from theirs. Traces
/// its photons when made. Keeps references to scene and lights; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class photon_mapping {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    /// `progress` may cut the photons short.
    template <Executor Run = in_sequence>
    photon_mapping(lasting<World> scene, lasting<Lights> lights, const photon_mapping_options& options = {},
                   const Run& run = {}, const preparation_progress& progress = {})
        : scene_{*scene}, lights_{*lights}, options_{options} {
        detail::preparation_report report{progress};
        maps_ = detail::trace_photons(scene_, lights_, options.photons, run, report);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const map_layer<spectrum, scalar> caustic{maps_.caustic, options_.density};
        const map_layer<spectrum, scalar> indirect{maps_.indirect, options_.density};
        if (options_.direct_from_map) {
            const map_layer<spectrum, scalar> direct{maps_.direct, options_.density};
            const direct_layer gloss{scene_, lights_, lobe_set::glossy, options_.paths.faults};
            return trace(eye, numbers, layer_sum{direct, gloss, caustic, indirect});
        }
        return trace(
            eye, numbers,
            layer_sum{direct_layer{scene_, lights_, lobe_set::smooth, options_.paths.faults}, caustic, indirect});
    }

    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const { return maps_; }

private:
    template <typename N, typename Layers>
    [[nodiscard]] estimate<spectrum> trace(const ray<scalar>& eye, const N& numbers, Layers layers) const {
        return layered_integrator<World, Lights, Layers>{scene_, lights_, layers, options_.paths}(eye, numbers);
    }

    const World& scene_;
    const Lights& lights_;
    photon_mapping_options options_;
    photon_maps<spectrum, scalar> maps_;
};

template <Scene World, Illuminator Lights, Executor Run = in_sequence>
photon_mapping(const World&, const Lights&, const photon_mapping_options& = {}, const Run& = {},
               const preparation_progress& = {}) -> photon_mapping<World, Lights>;

/// What a final-gathered picture is made of.
struct final_gathering_options {
    photon_options photons{
        .direct = 20'000, .caustic = 200'000, .indirect = 100'000};  ///< 0 reflected: half the caustic
    density_options density{};                                       ///< of the caustic map as it is seen
    density_options reflected_density{.count = 200};                 ///< of the map of reflected caustics
    irradiance_options irradiance{};
    photon_source_options source{};
    std::uint32_t rays{64};  ///< gather rays per shading point
    path_options paths{};    ///< through mirrors and gloss
};

namespace detail {

/// A gather beside a caustic map needs the caustics' reflection too, or small bright spots speckle it.
[[nodiscard]] inline photon_options with_reflected(photon_options photons) {
    if (photons.reflected == 0) { photons.reflected = photons.caustic / 2; }
    return photons;
}

/// What gather rays may take for themselves: light over mirrors only where no caustic map shows it.
template <Spectrum S, std::floating_point T>
[[nodiscard]] emission_rule left_to_rays(const photon_maps<S, T>& maps) {
    if (maps.caustic.paths == 0) { return emission_rule::indirect; }
    return maps.reflected.paths > 0 ? emission_rule::no_reflected : emission_rule::no_caustics;
}

}  // namespace detail

/// Photon maps and the irradiance that gather rays read: what every gathering integrator stands on.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class gather_base {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    template <Executor Run = in_sequence>
    gather_base(const World& scene, const Lights& lights, const photon_options& photons,
                const irradiance_options& irradiance, const Run& run = {}, const preparation_progress& progress = {}) {
        detail::preparation_report report{progress};
        maps_ = detail::trace_photons(scene, lights, detail::with_reflected(photons), run, report);
        irradiance_options told = irradiance;
        told.progress = report.phase(preparation_phase::irradiance, irradiance.progress);
        points_ = precompute_irradiance(scene, lights, maps_, told, run);
    }

    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const { return maps_; }
    [[nodiscard]] const irradiance_points<spectrum, scalar>& points() const { return points_; }

    /// What gather rays may take for themselves: light over mirrors only where no caustic map shows it.
    [[nodiscard]] emission_rule caustics() const { return detail::left_to_rays(maps_); }

private:
    photon_maps<spectrum, scalar> maps_;
    irradiance_points<spectrum, scalar> points_;
};

/// An integrator: direct light by shadow rays, caustics from their map, indirect light by a final gather at every
/// shading point. Traces its photons when made. Keeps references to scene and lights; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class final_gathering {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    /// `progress` may cut the photons and their irradiance short. Throws `std::invalid_argument` for no rays.
    template <Executor Run = in_sequence>
    final_gathering(lasting<World> scene, lasting<Lights> lights, const final_gathering_options& options = {},
                    const Run& run = {}, const preparation_progress& progress = {})
        : scene_{*scene}, lights_{*lights}, options_{options}, base_{scene_,
                                                                     lights_,
                                                                     options.photons,
                                                                     options.irradiance,
                                                                     run,
                                                                     progress} {
        if (options.rays == 0) { throw std::invalid_argument("aglow: rays is 0; a final gather needs 1 at least"); }
        detail::note_with(options_.paths, options_.source);
    }

    /// Radiance that comes back along `eye`, W/(m² sr), and a guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const photon_source<World, Lights> source{scene_, lights_, base_.points(), options_.source};
        const layer_sum layers{direct_layer{scene_, lights_, lobe_set::smooth, options_.paths.faults},
                               map_layer<spectrum, scalar>{base_.maps().caustic, options_.density},
                               map_layer<spectrum, scalar>{base_.maps().reflected, options_.reflected_density},
                               gather_layer{source, {.rays = options_.rays, .caustics = base_.caustics()}}};
        return layered_integrator{scene_, lights_, layers, options_.paths}(eye, numbers);
    }

    [[nodiscard]] const photon_maps<spectrum, scalar>& maps() const { return base_.maps(); }

private:
    const World& scene_;
    const Lights& lights_;
    final_gathering_options options_;
    gather_base<World, Lights> base_;
};

template <Scene World, Illuminator Lights, Executor Run = in_sequence>
final_gathering(const World&, const Lights&, const final_gathering_options& = {}, const Run& = {},
                const preparation_progress& = {}) -> final_gathering<World, Lights>;

}  // namespace aglow
