// Final gathering: the last diffuse bounce by rays, everything before it from the map.
//
// Jensen 1996; Reichert 1992. Smooth and sharp where the map itself is blotchy; costs its rays at every point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/core/sobol.hpp>

namespace aglow {

/// How a final gather samples.
struct final_gather_options {
    std::uint32_t rays{64};                           ///< gather rays per shading point
    emission_rule caustics{emission_rule::indirect};  ///< `no_caustics` beside a caustic map
};

/// Layer: indirect light on diffuse lobes from gather rays into `Source` (anything with `incoming(ray, numbers,
/// rule)`), of which it keeps a reference.
template <typename Source>
class gather_layer {
public:
    explicit gather_layer(lasting<Source> source, const final_gather_options& options = {})
        : source_{*source}, options_{options} {}

    template <Surface H, Numbers N>
    [[nodiscard]] estimate<surface_spectrum<H>> operator()(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                           hit_scalar<H> error, const N& numbers,
                                                           std::uint32_t bounce) const {
        using S = surface_spectrum<H>;
        using T = hit_scalar<H>;
        using B = band_of<S>;
        if (!any(hit.lobes(), lobe_set::diffuse) || options_.rays == 0) { return {}; }
        const std::uint64_t seed = seed_from(numbers.at(bounce, purpose::gather));
        S sum{};
        double sum2{0};  // squares of faint light leave the range of floats
        shared_error shared;
        for (std::uint32_t i = 0; i < options_.rays; ++i) {
            sobol_sampler<T> random{seed, i};
            const auto next = hit.sample(wo, random, lobe_set::diffuse & static_lobes<Source>);
            if (!next) { continue; }
            const ray<T> path{lift(vec3<T>(hit.position), vec3<T>(hit.normal), vec3<T>(next->wi), error), next->wi};
            const auto light = source_.incoming(path, numbers.fork(mix(bounce, i)), options_.caustics);
            const S radiance = next->weight * light.radiance;
            if (!is_radiance(radiance)) { continue; }
            sum = sum + radiance;
            sum2 += square(static_cast<double>(max_component(radiance)));
            const double weight = static_cast<double>(max_component(next->weight));
            shared.common += weight * static_cast<double>(light.common);
            shared.bias += weight * static_cast<double>(light.bias);
        }
        const B share = 1 / static_cast<B>(options_.rays);
        const double n = static_cast<double>(options_.rays);
        const double mean = static_cast<double>(max_component(sum)) / n;
        // One ray alone may be off by all of itself.
        const double variance = n > 1 ? std::max(0.0, sum2 / n - mean * mean) / (n - 1) : square(mean);
        // Many rays average the map's own noise out, as their spread tells; what they have in common stays.
        const double common = shared.common / n;
        const double bias = shared.bias / n;
        const double guess = std::abs(bias) + 2 * std::sqrt(variance + square(common));
        return {sum * share, static_cast<B>(guess), static_cast<B>(common), static_cast<B>(bias)};
    }

private:
    template <Sampler R>
    [[nodiscard]] static std::uint64_t seed_from(R random) {
        const auto u = random.next_2d();
        return mix(static_cast<std::uint64_t>(u.x * 0x1p24), static_cast<std::uint64_t>(u.y * 0x1p24));
    }

    const Source& source_;
    final_gather_options options_;
};

template <typename Source>
gather_layer(const Source&, const final_gather_options& = {}) -> gather_layer<Source>;

}  // namespace aglow
