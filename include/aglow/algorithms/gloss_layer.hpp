// Indirect light on glossy lobes read from an irradiance cache: no rays, and an error that says what that costs.
//
// A record's irradiance and mean direction make light that is linear in direction (`linear_light`); the lobe is
// integrated against it by directions drawn from the lobe. Good for broad lobes, wrong for narrow ones, whose error
// grows as one over the root of their solid angle: those are left to rays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/estimators/estimate.hpp>
#include <aglow/estimators/linear_light.hpp>

namespace aglow {

/// Which glossy lobes are read from the cache.
struct gloss_options {
    /// The least spread: 1 minus the length of the mean direction of what the lobe scatters. A mirror has 0, a diffuse
    /// lobe 1/3, GGX of alpha 0.3 seen from above about 0.1. Narrower lobes are followed by rays.
    double least_spread{0.1};
    std::uint32_t samples{16};  ///< directions drawn from a lobe; one at least
};

/// A lobe met with light: both known by a few directions drawn from it.
template <Spectrum S, std::floating_point T>
struct lobe_in_light {
    S radiance{};            ///< what it makes of light of irradiance 1, linear in direction
    band_of<S> norm{};       ///< root of the integral of f² under the cosine
    band_of<S> deviation{};  ///< the same of f minus its mean
    T spread{};              ///< as of `gloss_options`
};

/// The glossy reflection of `hit` towards `wo` in `light`.
template <Surface H, std::floating_point T = hit_scalar<H>>
[[nodiscard]] lobe_in_light<surface_spectrum<H>, T> lobe_in(const linear_light<T>& light, const H& hit,
                                                            const vec3<T>& wo, std::uint64_t seed,
                                                            std::uint32_t samples) {
    using S = surface_spectrum<H>;
    using B = band_of<S>;
    S radiance{};
    S albedo{};
    S squares{};
    vec3<T> towards{0};
    T total{0};
    samples = std::max(1u, samples);
    for (std::uint32_t i = 0; i < samples; ++i) {
        sobol_sampler<T> random{seed, i};
        const auto next = hit.sample(wo, random, lobe_set::glossy_reflection);
        if (!next || !is_radiance(S(next->weight))) { continue; }
        const vec3<T> wi = next->wi;
        radiance = radiance + next->weight * static_cast<B>(light(wi));
        albedo = albedo + next->weight;
        squares = squares + next->weight * hit.evaluate(wo, wi, lobe_set::glossy_reflection);
        const T weight = static_cast<T>(max_component(S(next->weight)));
        towards += wi * weight;
        total += weight;
    }
    const B share = 1 / static_cast<B>(samples);
    const S mean = albedo * share;
    const B norm2 = max_component(S(squares * share));
    const B deviation2 = max_component(S(squares * share + mean * mean * (-1 / pi<B>)));
    return {radiance * (share / pi<B>), std::sqrt(std::max(B(0), norm2)), std::sqrt(std::max(B(0), deviation2)),
            total > 0 ? 1 - glm::length(towards) / total : T(0)};
}

/// The light of layers, and the lobes that they leave to rays.
template <Spectrum S>
struct shaded : estimate<S> {
    lobe_set left{lobe_set::none};
};

/// Layers of a cached picture that reads broad glossy reflection from the cache as well: `Diffuse` is the layer of the
/// diffuse lobes, `Cache` keeps where light comes from.
template <Scene World, Illuminator Lights, typename Cache, typename Diffuse>
class glossy_cache_layers {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using B = band_of<S>;

public:
    /// `shared`: what all that is read from `cache` is off by together.
    glossy_cache_layers(const World& scene, const Lights& lights, const Cache& cache, Diffuse diffuse,
                        const gloss_options& options, const shared_error& shared, host_faults* faults)
        : scene_{scene},
          lights_{lights},
          cache_{cache},
          diffuse_{diffuse},
          options_{options},
          shared_{shared},
          faults_{faults} {}

    template <typename N>
    [[nodiscard]] shaded<S> operator()(const hit_of<World>& hit, const vec3<T>& wo, T error, const N& numbers,
                                       std::uint32_t bounce) const {
        const std::optional<estimate<S>> gloss = read(hit, wo, numbers, bounce);
        const lobe_set cached = gloss ? lobe_set::glossy_reflection : lobe_set::none;
        const direct_layer direct{scene_, lights_, lobe_set::smooth, faults_, cached};
        const estimate<S> rest = direct(hit, wo, error, numbers, bounce) + diffuse_(hit, wo, error, numbers, bounce);
        return {gloss ? rest + *gloss : rest, hit.lobes() & ~lobe_set::diffuse & ~cached};
    }

private:
    /// Radiance of the glossy reflection; empty where it is for rays.
    template <typename N>
    [[nodiscard]] std::optional<estimate<S>> read(const hit_of<World>& hit, const vec3<T>& wo, const N& numbers,
                                                  std::uint32_t bounce) const {
        if (!any(hit.lobes(), lobe_set::glossy_reflection)) { return std::nullopt; }
        // Always by the same directions, so that what is read and what is followed is not chance.
        if (lobe_in(linear_light<T>{}, hit, wo, 0, options_.samples).spread < static_cast<T>(options_.least_spread)) {
            return std::nullopt;
        }
        const vec3<T> normal = side_of(hit, wo);
        const auto found = cache_.light(vec3<T>(hit.position), normal);
        if (!found) { return std::nullopt; }
        const auto u = numbers.at(bounce, purpose::gather).next_2d();
        const std::uint64_t seed =
            mix(static_cast<std::uint64_t>(u.x * 0x1p24), static_cast<std::uint64_t>(u.y * 0x1p24));
        const auto lobe = lobe_in(linear_light<T>{found.incident, normal}, hit, wo, seed, options_.samples);
        return of(lobe, found);
    }

    /// Cauchy-Schwarz: what the light is beside the linear fit is of mean zero, so it meets only what the lobe is
    /// beside its mean; what the irradiance is off by meets all of it.
    template <typename Found>
    [[nodiscard]] estimate<S> of(const lobe_in_light<S, T>& lobe, const Found& found) const {
        const B irradiance = max_component(found.irradiance);
        const B guess =
            (static_cast<B>(found.misfit) * irradiance * lobe.deviation + static_cast<B>(found.error) * lobe.norm) /
            std::sqrt(pi<B>);
        const S radiance = found.irradiance * lobe.radiance;
        return shared_.on(is_radiance(radiance) ? radiance : S{}, guess);
    }

    const World& scene_;
    const Lights& lights_;
    const Cache& cache_;
    Diffuse diffuse_;
    gloss_options options_;
    shared_error shared_;
    host_faults* faults_;
};

}  // namespace aglow
