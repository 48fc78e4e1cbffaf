// Where caustics fall in a picture, whoever makes it: an audit gives such pixels error bars of their own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/algorithms/plan.hpp>
#include <aglow/algorithms/trace_photons.hpp>

namespace aglow {

/// How well caustics are looked for: a sign is enough to tell classes of pixels apart.
struct caustic_light_options {
    std::size_t photons{100'000};
    std::uint32_t samples{2};    ///< per block of pixels
    std::size_t blocks{16'384};  ///< square ones, of whole pixels: a picture is looked at in about so many at most, so
                                 ///< that large ones cost no more, but for ribbons; 0 for every pixel
    std::uint64_t seed{0};
    density_options density{};
};

namespace detail {

/// Neither lights nor a sky.
template <Spectrum S, std::floating_point T>
struct darkness {
    using scalar = T;
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<S, T>> illuminate(const vec3<T>&, R&) const {
        return std::nullopt;
    }
};

/// An integrator that sees nothing but one photon map, over mirrors and through glass too.
template <Scene World>
class map_view {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    map_view(const World& scene, const map_layer<spectrum, scalar>& layer) : scene_{scene}, layer_{layer} {}

    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const auto shade = [&](auto& walk, const walk_stop<World>& stop) {
            walk.add(layer_(stop.hit, stop.wo, stop.error, walk.numbers(), stop.bounce));
            return stop.hit.lobes() & lobe_set::specular;
        };
        // A walk of mirrors alone, by a rule under which it takes no light of surfaces for itself.
        path_walk<World, dark, N, true> walk{scene_, dark_, numbers, emission_rule::no_caustics, options_, eye};
        return {walk.run(shade, options_.split).radiance, 0};
    }

private:
    using dark = darkness<spectrum, scalar>;

    const World& scene_;
    dark dark_{};
    const map_layer<spectrum, scalar>& layer_;
    path_options options_{};
};

/// Pixels along the side of the least square blocks of which a picture holds no more than about `most`; 0 for no bound.
[[nodiscard]] inline std::size_t block_side(std::size_t pixels, std::size_t most) {
    if (most == 0 || pixels <= most) { return 1; }
    return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(pixels) / static_cast<double>(most))));
}

}  // namespace detail

/// Radiance that caustics add to each pixel of the picture of `eye`, W/(m² sr), the largest band, row by row from the
/// top; in large pictures to each block of pixels. Empty, and without cost, where the scene's plan says that it can
/// have none. The same for any threads of `run`.
template <Scene World, Illuminator Lights, typename Eye, Executor Run = in_sequence>
    requires Emitter<Lights>
[[nodiscard]] std::vector<band_of<spectrum_of<World>>> caustic_light(const World& scene, const Lights& lights,
                                                                     const Eye& eye, std::size_t width,
                                                                     std::size_t height,
                                                                     const caustic_light_options& options = {},
                                                                     const Run& run = {}) {
    using S = spectrum_of<World>;
    std::vector<band_of<S>> light;
    if (!plan_for(scene).caustic_map) { return light; }
    const auto maps = trace_photons(scene, lights, {.caustic = options.photons, .seed = options.seed}, run);
    const map_layer<S, scalar_of<World>> layer{maps.caustic, options.density};
    using T = scalar_of<World>;
    const std::size_t block = detail::block_side(width * height, options.blocks);
    film<S> seen{(width + block - 1) / block, (height + block - 1) / block};
    const auto through = [&](const vec2<T>& at) {
        const vec2<T> whole = at * static_cast<T>(block);
        return eye(vec2<T>{std::min(whole.x, static_cast<T>(width)), std::min(whole.y, static_cast<T>(height))});
    };
    seen.expose(through, detail::map_view<World>{scene, layer}, {.samples = options.samples, .seed = options.seed},
                run);
    for (std::size_t i = 0; i < width * height; ++i) {
        light.push_back(max_component(seen.radiance(i % width / block, i / width / block)));
    }
    return light;
}

}  // namespace aglow
