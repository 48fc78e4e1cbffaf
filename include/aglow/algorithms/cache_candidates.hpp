// Places where a picture will ask for irradiance: what a fill pass works on.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/algorithms/fill_options.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/sobol.hpp>

namespace aglow {

/// How a picture is looked over. The size is that of the film whose points `eye` takes: of a larger film, what lies
/// beyond finds no records, and each of its samples gathers afresh, slowly.
struct view_options {
    std::size_t width{256};
    std::size_t height{256};
    std::uint32_t looks{1};         ///< rays per pixel; more find more of what mirrors and glass show
    std::uint32_t most_bounces{8};  ///< surfaces followed through mirrors and gloss; the picture itself goes on further
    std::uint64_t seed{0};
    callback<double> progress{};  ///< told the share done, from any thread; false stops early
};

namespace detail {

/// Adds what one ray from the eye finds on diffuse surfaces, both hemispheres where something transmits.
template <Scene World, Numbers N>
void look(const World& scene, const ray<scalar_of<World>>& eye, scalar_of<World> footprint_share, const N& numbers,
          const view_options& options, std::uint64_t key, std::vector<cache_candidate<scalar_of<World>>>& found) {
    using T = scalar_of<World>;
    walk_state<World> at{.path = eye};
    T travelled = 0;
    for (std::uint32_t bounce = 1; bounce <= options.most_bounces; ++bounce) {
        const auto hit = scene.intersect(at.path);
        if (!hit || !is_sound(*hit, at.path)) { return; }
        const vec3<T> position = hit->position;
        const vec3<T> wo = -at.path.direction;
        const T error = error_of(*hit, at.path.origin);
        travelled += glm::distance(position, at.path.origin);
        const vec3<T> near = aglow::side_of(*hit, wo);
        const auto add = [&](const vec3<T>& side) {
            found.push_back({{position, side, error}, travelled * footprint_share, mix(key, found.size())});
        };
        if (any(hit->lobes(), lobe_set::diffuse_reflection)) { add(near); }
        if constexpr (any(static_lobes<World>, lobe_set::diffuse_transmission)) {
            if (any(hit->lobes(), lobe_set::diffuse_transmission)) { add(-near); }
        }
        const lobe_set on = hit->lobes() & ~lobe_set::diffuse;
        if (!scatter(at, *hit, wo, error, numbers, bounce, on, path_options{})) { return; }
    }
}

}  // namespace detail

/// The diffuse places that the rays `eye(film_point)` of a picture meet, row by row, each side of a surface that lets
/// light through a candidate of its own. The same for any executor. Stopped early, rows far apart were looked at.
template <Scene World, typename Eye, Executor Run = in_sequence>
[[nodiscard]] auto cache_candidates(const World& scene, const Eye& eye, const view_options& options,
                                    const Run& run = {}) {
    using T = scalar_of<World>;
    using candidates = std::vector<cache_candidate<T>>;
    std::vector<candidates> rows(options.height);
    const std::size_t step = spread_step(options.height);
    std::atomic<std::size_t> done{0};
    std::atomic<bool> stop{false};
    run(options.height, [&](std::size_t row) {
        if (stop) { return; }
        const std::size_t y = row * step % options.height;
        for (std::size_t x = 0; x < options.width; ++x) {
            const std::uint64_t pixel = y * options.width + x;
            for (std::uint32_t i = 0; i < options.looks; ++i) {
                const sobol_numbers<T> numbers{{options.seed, ~std::uint64_t{0}, pixel}, i};
                // Off the pixel's centre: rays through centres may run along edges, where a record sees both sides.
                const vec2<T> u = numbers.at(0, purpose::camera).next_2d();
                const vec2<T> film{static_cast<T>(x) + u.x, static_cast<T>(y) + u.y};
                const ray<T> here = eye(film);
                const T share = glm::length(eye(film + vec2<T>{1, 0}).direction - here.direction);
                detail::look(scene, here, share, numbers, options, mix(options.seed, pixel * options.looks + i),
                             rows[y]);
            }
        }
        const double share = static_cast<double>(++done) / static_cast<double>(options.height);
        if (options.progress && !options.progress(share)) { stop = true; }
    });
    candidates all;
    std::size_t count = 0;
    for (const candidates& row : rows) { count += row.size(); }
    all.reserve(count);
    for (const candidates& row : rows) { all.insert(all.end(), row.begin(), row.end()); }
    return all;
}

}  // namespace aglow
