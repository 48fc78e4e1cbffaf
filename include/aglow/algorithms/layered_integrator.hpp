// Pictures from layers of light: mirrors and gloss by recursion, the rest read off at the first diffuse surface.
//
// Jensen 1996: perfect specular by ray tracing, everything else from the maps, the cache or sampling.
#pragma once

#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>

namespace aglow {

/// An integrator: radiance along a ray, the smooth light at each surface from `Layers`, glossy and specular lobes
/// followed by sampling. `const`, safe from many threads where the layers are.
template <Scene World, Illuminator Lights, typename Layers>
class layered_integrator {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    layered_integrator(const World& scene, const Lights& lights, Layers layers, const path_options& options = {})
        : scene_{scene}, lights_{lights}, layers_{std::move(layers)}, options_{options} {}

    /// Radiance that comes back along `eye`, W/(m² sr), and the layers' guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        estimate<spectrum> result;
        detail::walk_state<World> at{.path = eye};
        for (std::uint32_t bounce = 1; step(at, numbers, bounce, result); ++bounce) {}
        return result;
    }

    [[nodiscard]] const Layers& layers() const { return layers_; }

private:
    using B = band_of<spectrum>;

    /// One surface on the way; false at the end of the path.
    template <Numbers N>
    bool step(detail::walk_state<World>& at, const N& numbers, std::uint32_t bounce, estimate<spectrum>& result) const {
        const auto hit = scene_.intersect(at.path);
        if (!hit) {
            const B share(detail::escape_share(at, lights_, emission_rule::all, bounce));
            add(result, at.throughput, {escaped_radiance<spectrum>(lights_, at.path.direction) * share, 0});
            return false;
        }
        if (!is_sound(*hit, at.path)) { return false; }
        const vec3<scalar> wo = -at.path.direction;
        const scalar error = error_of(*hit, at.path.origin);
        const spectrum glow = emitted(*hit, wo);
        if (!is_black(glow)) {
            const B share(detail::emission_share(at, lights_, *hit, emission_rule::all, bounce));
            add(result, at.throughput, {glow * share, 0});
        }
        if (any(hit->lobes(), lobe_set::smooth)) {
            add(result, at.throughput, layers_(*hit, wo, error, numbers, bounce));
        }
        if (options_.most_bounces != 0 && bounce > options_.most_bounces) { return false; }
        return detail::scatter(at, *hit, wo, error, numbers, bounce, hit->lobes() & ~lobe_set::diffuse, options_);
    }

    static void add(estimate<spectrum>& result, const spectrum& throughput, const estimate<spectrum>& light) {
        const spectrum arriving = throughput * light.value;
        if (!is_radiance(arriving)) { return; }
        result.value = result.value + arriving;
        result.error += max_component(throughput) * light.error;
    }

    const World& scene_;
    const Lights& lights_;
    Layers layers_;
    path_options options_;
};

}  // namespace aglow
