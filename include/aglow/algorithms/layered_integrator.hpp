// Pictures from layers of light: mirrors and gloss by recursion, the rest read off at the first diffuse surface.
//
// Jensen 1996: perfect specular by ray tracing, everything else from the maps, the cache or sampling.
#pragma once

#include <utility>

#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/core/lasting.hpp>

namespace aglow {

/// An integrator: radiance along a ray, the smooth light at each surface from `Layers`, glossy and specular lobes
/// followed by sampling; the first mirrors that refract too (`path_options::split`) both ways. `const`, safe from many
/// threads where the layers are.
template <Scene World, Illuminator Lights, typename Layers>
class layered_integrator {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    layered_integrator(lasting<World> scene, lasting<Lights> lights, Layers layers, const path_options& options = {})
        : scene_{*scene}, lights_{*lights}, layers_{std::move(layers)}, options_{options} {}

    /// Radiance that comes back along `eye`, W/(m² sr), and the layers' guess of its error.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const auto shade = [&](auto& walk, const detail::walk_stop<World>& stop) {
            const lobe_set lobes = stop.hit.lobes();
            if (any(lobes, lobe_set::smooth)) {
                const auto seen = layers_(stop.hit, stop.wo, stop.error, walk.numbers(), stop.bounce);
                walk.add(seen);
                if constexpr (requires { seen.left; }) { return seen.left; }
            }
            return lobes & ~lobe_set::diffuse;
        };
        detail::path_walk<World, Lights, N, true> walk{scene_, lights_, numbers, emission_rule::all, options_, eye};
        const auto light = walk.run(shade, options_.split);
        return {light.radiance, light.error, light.common, light.bias};
    }

    [[nodiscard]] const Layers& layers() const { return layers_; }

private:
    const World& scene_;
    const Lights& lights_;
    Layers layers_;
    path_options options_;
};

template <Scene World, Illuminator Lights, typename Layers>
layered_integrator(const World&, const Lights&, Layers, const path_options& = {})
    -> layered_integrator<World, Lights, Layers>;

}  // namespace aglow
