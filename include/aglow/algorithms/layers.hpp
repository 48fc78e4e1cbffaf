// The light of a picture in layers: what is looked up or sampled at a surface, each layer one kind of light.
//
// A layer is a callable `layer(hit, wo, error, numbers, bounce)` that returns an `estimate` of the radiance that `hit`
// sends towards `wo`. Layers never overlap: direct (L D), caustic (L S+ D) and indirect (everything else that ends D).
#pragma once

#include <tuple>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/estimators/estimate.hpp>
#include <aglow/estimators/photon_map.hpp>

namespace aglow {

/// The unit normal of `hit` on the side that `w` points to.
template <Hit H>
[[nodiscard]] vec3<hit_scalar<H>> side_of(const H& hit, const vec3<hit_scalar<H>>& w) {
    const vec3<hit_scalar<H>> n = hit.normal;
    return glm::dot(n, w) < 0 ? -n : n;
}

/// Radiance towards `wo` that the diffuse lobes of `hit` make of irradiance: `irradiance(side)` is asked for the side
/// of `wo` and, only where something transmits, for the far side. A diffuse lobe is one whose f does not depend on
/// `wi`. A surface type may state `possible_lobes` as a scene's may.
template <lobe_set Possible = lobe_set::all, Surface H, typename Irradiance>
[[nodiscard]] estimate<surface_spectrum<H>> diffuse_radiance(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                             Irradiance&& irradiance) {
    using S = surface_spectrum<H>;
    estimate<S> result;
    const auto add = [&](const vec3<hit_scalar<H>>& side, lobe_set lobe) {
        const estimate<S> e = irradiance(side);
        const S f = hit.evaluate(wo, side, lobe);
        const band_of<S> most = max_component(f);
        result = result + estimate<S>{f * e.value, most * e.error, most * e.common, most * e.bias};
    };
    const vec3<hit_scalar<H>> near = side_of(hit, wo);
    if (any(hit.lobes(), lobe_set::diffuse_reflection)) { add(near, lobe_set::diffuse_reflection); }
    if constexpr (any(Possible & static_lobes<H>, lobe_set::diffuse_transmission)) {
        if (any(hit.lobes(), lobe_set::diffuse_transmission)) { add(-near, lobe_set::diffuse_transmission); }
    }
    return result;
}

/// What a map tells of irradiance, and what all that it tells is off by together.
template <Spectrum S, std::floating_point T, typename Item>
[[nodiscard]] estimate<S> told_by(const photon_map<S, T, Item>& map, const shared_error& shared, const vec3<T>& point,
                                  const vec3<T>& normal, const density_options& options) {
    const auto e = map.irradiance(point, normal, options);
    estimate<S> result = shared.on(e.value, e.error);
    result.bias = e.bias;
    return result;
}

/// Layer: a photon map looked at directly, on diffuse lobes.
template <Spectrum S, std::floating_point T, typename Item = photon<S>>
class map_layer {
public:
    explicit map_layer(const photon_map<S, T, Item>& map, const density_options& options = {})
        : map_{map}, options_{options} {}
    explicit map_layer(const photon_map<S, T, Item>&&, const density_options& = {}) = delete;
    /// A map that knows how sure its flux is.
    explicit map_layer(const traced_map<S, T>& map, const density_options& options = {})
        : map_{map}, options_{options}, shared_{.common = map.common} {}
    explicit map_layer(const traced_map<S, T>&&, const density_options& = {}) = delete;

    template <Surface H, typename N>
    [[nodiscard]] estimate<S> operator()(const H& hit, const vec3<T>& wo, T, const N&, std::uint32_t) const {
        if (map_.empty()) { return {}; }
        return diffuse_radiance(hit, wo, [&](const vec3<T>& side) {
            return told_by(map_, shared_, vec3<T>(hit.position), side, options_);
        });
    }

private:
    const photon_map<S, T, Item>& map_;
    density_options options_;
    shared_error shared_{};
};

/// Layer: light straight from the lights by one shadow ray, on the lobes `lit`. Glossy lobes share it with the rays
/// that `layered_integrator` scatters. `faults` hears of light that broken answers cost as if the path carried 1.
template <Scene World, Illuminator Lights>
class direct_layer {
public:
    direct_layer(lasting<World> scene, lasting<Lights> lights, lobe_set lit = lobe_set::smooth,
                 host_faults* faults = nullptr, lobe_set unscattered = lobe_set::none)
        : scene_{*scene}, lights_{*lights}, lit_{lit}, faults_{faults}, unscattered_{lobe_set::diffuse | unscattered} {}

    template <typename N>
    [[nodiscard]] estimate<spectrum_of<World>> operator()(const hit_of<World>& hit, const vec3<scalar_of<World>>& wo,
                                                          scalar_of<World> error, const N& numbers,
                                                          std::uint32_t bounce) const {
        // Specular lobes take their share of the scattered rays: what is scattered here must be named as it is there.
        const lobe_set scattered = hit.lobes() & ~unscattered_;
        if (!any(hit.lobes(), lit_ & lobe_set::smooth)) { return {}; }
        return {direct_light(scene_, lights_, hit, wo, error, numbers.at(bounce, purpose::light),
                             {.lit = lit_ | lobe_set::specular, .scattered = scattered, .faults = faults_}),
                0};
    }

private:
    const World& scene_;
    const Lights& lights_;
    lobe_set lit_;
    host_faults* faults_;
    lobe_set unscattered_;  ///< lobes that no ray will look for lights from
};

template <Scene World, Illuminator Lights>
direct_layer(const World&, const Lights&, lobe_set = lobe_set::smooth, host_faults* = nullptr,
             lobe_set = lobe_set::none) -> direct_layer<World, Lights>;

/// Several layers, added up.
template <typename... Layers>
class layer_sum {
public:
    explicit layer_sum(Layers... layers) : layers_{std::move(layers)...} {}

    template <Surface H, typename N>
    [[nodiscard]] estimate<surface_spectrum<H>> operator()(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                           hit_scalar<H> error, const N& numbers,
                                                           std::uint32_t bounce) const {
        return std::apply([&](const auto&... layer) { return (layer(hit, wo, error, numbers, bounce) + ...); },
                          layers_);
    }

private:
    std::tuple<Layers...> layers_;
};

}  // namespace aglow
