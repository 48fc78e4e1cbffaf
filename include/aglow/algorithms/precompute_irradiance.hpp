// Irradiance at a share of the photons, direct light included: what gather rays read.
//
// Christensen 1999. Direct light is sampled by shadow rays instead of photons: fewer photons, no blur at its edges.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/algorithms/seen_irradiance.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/estimators/irradiance_points.hpp>

namespace aglow {

/// How irradiance is worked out ahead.
struct irradiance_options {
    std::size_t every{4};  ///< a point at one in so many photons; below 3 it counts its own photon too, and what
                           ///< points lose at edges is neither given back nor told
    std::uint32_t shadow_rays{8};  ///< looks at the lights per point; 0 takes direct light from the direct map
    density_options density{};     ///< for the caustic and the indirect map
    std::uint64_t seed{0};
    callback<double> progress{};  ///< told the share done, from any thread; false stops early
};

namespace detail {

/// A place on a surface, without a material.
template <std::floating_point T>
struct bare_place {
    vec3<T> position{};
    vec3<T> normal{};
};

}  // namespace detail

/// Direct irradiance on the side of unit `normal` at `point`, by `rays` stratified shadow rays, W/m².
template <Scene World, Illuminator Lights>
[[nodiscard]] spectrum_of<World> direct_irradiance(const World& scene, const Lights& lights,
                                                   const vec3<scalar_of<World>>& point,
                                                   const vec3<scalar_of<World>>& normal, scalar_of<World> error,
                                                   std::uint32_t rays, std::uint64_t seed) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    S sum{};
    for (std::uint32_t i = 0; i < rays; ++i) {
        sobol_sampler<T> random{seed, i};
        const auto light = lights.illuminate(point, random);
        if (!light) { continue; }
        const T cosine = glm::dot(normal, vec3<T>(light->towards));
        if (!(cosine > 0)) { continue; }
        const S radiance = light->radiance_over_pdf * band_of<S>(cosine);
        if (!is_radiance(radiance)) { continue; }
        const detail::bare_place<T> here{point, normal};
        if (sees(scene, here, vec3<T>(light->towards), T(light->distance), error)) { sum = sum + radiance; }
    }
    return sum * (1 / static_cast<band_of<S>>(std::max(1u, rays)));
}

namespace detail {

/// Which of `count` photons give their places to points: by chance, since photons of near indices lie near each other.
[[nodiscard]] inline std::vector<char> chosen_places(std::size_t count, const irradiance_options& options) {
    std::vector<char> chosen(count);
    for (std::size_t i = 0; i < count; ++i) { chosen[i] = mix(options.seed, i) % options.every == 0; }
    return chosen;
}

/// What one point adds to what all points are off by together. Photons lie densely where it is bright, so a point
/// stands for as much area as its disc has.
struct shared_part {
    double all{0};
    double direct{0};  // of photons
    double indirect{0};
    double caustic{0};
    double bias{0};         // of the indirect and the caustic light
    double direct_bias{0};  // of direct light of photons
};

/// `direct` is of photons where it counts some.
template <Spectrum S, std::floating_point T>
[[nodiscard]] shared_part shared_part_of(const density_estimate<S, T>& direct, const density_estimate<S, T>& indirect,
                                         const density_estimate<S, T>& caustic) {
    const T radius = indirect.count > 0 ? indirect.radius : direct.count > 0 ? direct.radius : T(0);
    const double area = square(static_cast<double>(radius));
    const auto level = [&](const S& s) { return area * static_cast<double>(max_component(s)); };
    return {level(direct.value) + level(indirect.value) + level(caustic.value),
            direct.count > 0 ? level(direct.value) : 0.0,
            level(indirect.value),
            level(caustic.value),
            area * static_cast<double>(indirect.bias + caustic.bias),
            area * static_cast<double>(direct.bias)};
}

[[nodiscard]] inline shared_part sum_of(const std::vector<shared_part>& parts) {
    shared_part sum;
    for (const shared_part& p : parts) {
        sum.all += p.all;
        sum.direct += p.direct;
        sum.indirect += p.indirect;
        sum.caustic += p.caustic;
        sum.bias += p.bias;
        sum.direct_bias += p.direct_bias;
    }
    return sum;
}

/// Fills all points, `fill(first, count)` a block and far apart from one block to the next, and drops those that were
/// not reached when `progress` said to stop.
template <typename Point, typename Fill, Executor Run>
void keep_filled(std::vector<Point>& points, const callback<double>& progress, const Fill& fill, const Run& run) {
    constexpr std::size_t block = 64;
    const std::size_t blocks = (points.size() + block - 1) / block;
    const std::size_t step = spread_step(blocks);
    std::vector<char> filled(blocks, 0);
    std::atomic<std::size_t> done{0};
    std::atomic<bool> stop{false};
    run(blocks, [&](std::size_t task) {
        if (stop) { return; }
        const std::size_t b = task * step % blocks;
        fill(b * block, std::min(block, points.size() - b * block));
        filled[b] = 1;
        const double share = static_cast<double>(++done) / static_cast<double>(blocks);
        if (progress && !progress(share)) { stop = true; }
    });
    if (!stop) { return; }
    std::vector<Point> kept;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (filled[i / block]) { kept.push_back(points[i]); }
    }
    points = std::move(kept);
}

/// A point at each of the photons that give their places, map by map, in the order of the maps.
template <Spectrum S, std::floating_point T>
[[nodiscard]] std::vector<irradiance_point<S, T>> points_at(const photon_maps<S, T>& maps,
                                                            const std::vector<char>& chosen) {
    std::vector<irradiance_point<S, T>> points;
    for (const photon_map<S, T>* map : {&maps.direct, &maps.caustic, &maps.indirect}) {
        for (std::size_t i = 0; i < map->size(); ++i) {
            if (!chosen[i]) { continue; }
            points.push_back({.position = map->position(i),
                              .normal = glm::normalize(map->photons()[i].normal.template direction<T>())});
        }
    }
    return points;
}

/// How far rays are lifted off the surfaces that photons landed on.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T lift_of(const photon_maps<S, T>& maps) {
    bounds<T> all = maps.direct.box();
    all.add(maps.caustic.box());
    all.add(maps.indirect.box());
    return 4 * position_error(all.empty() ? T(0) : std::max(max_abs(all.low), max_abs(all.high)));
}

/// Works out the light at points, some neighbours at a time. Keeps references; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
class point_light {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using point = irradiance_point<S, T>;
    using seen = seen_estimate<S, T>;

public:
    /// Photons that were `chosen` for places are left out, where at least every third is. They would make it too
    /// bright, or, each left out at its own place alone, too dark: a point stands for more of the surface where photons
    /// happen to lie farther apart. Places that the photons counted know nothing of make neither.
    point_light(const World& scene, const Lights& lights, const photon_maps<S, T>& maps,
                const irradiance_options& options, const std::vector<char>& chosen)
        : scene_{scene}, lights_{lights}, maps_{maps}, options_{options}, error_{lift_of(maps)} {
        if (options.every < 3) { return; }
        left_out_ = chosen;
        factor_ = static_cast<band_of<S>>(options.every) / static_cast<band_of<S>>(options.every - 1);
    }

    /// Lights `points`, the first of which is `first` among all, and tells their `parts`. Expects as many of these.
    void operator()(std::span<point> points, std::size_t first, std::span<shared_part> parts) const {
        const std::vector<seen> indirect = from(maps_.indirect, points);
        const std::vector<seen> caustic = from(maps_.caustic, points);
        const std::vector<seen> direct =
            options_.shadow_rays == 0 ? from(maps_.direct, points) : sampled(points, first);
        for (std::size_t i = 0; i < points.size(); ++i) {
            point& p = points[i];
            p.irradiance = direct[i].value + indirect[i].value;
            p.caustic = caustic[i].value;
            p.error = direct[i].error + caustic[i].error + indirect[i].error;
            p.radius = indirect[i].count > 0 ? indirect[i].radius : T(0);
            p.cut = cut(p, indirect[i], caustic[i]);
            parts[i] = shared_part_of<S, T>(direct[i], indirect[i], caustic[i]);
        }
    }

    /// Whether photons that gave their places are left out.
    [[nodiscard]] bool leaves_out() const { return !left_out_.empty(); }

private:
    [[nodiscard]] std::vector<seen> from(const photon_map<S, T>& map, std::span<const point> points) const {
        return seen_irradiance<World, S>{scene_, map, options_.density, error_, left_out_, factor_}(points);
    }
    [[nodiscard]] std::vector<seen> sampled(std::span<const point> points, std::size_t first) const {
        std::vector<seen> direct(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const point& p = points[i];
            direct[i].value = direct_irradiance(scene_, lights_, p.position, p.normal, error_, options_.shadow_rays,
                                                mix(options_.seed, first + i));
        }
        return direct;
    }

    /// Whether anything cuts through the wider of both discs.
    [[nodiscard]] bool cut(const point& p, const seen& indirect, const seen& caustic) const {
        const seen& wider = p.radius < caustic.radius ? caustic : indirect;
        if (wider.count > 0) { return wider.cut; }
        const T radius = std::max(p.radius, caustic.radius);
        return static_cast<bool>(disc_cut<T>{scene_, p.position + p.normal * error_, p.normal, radius});
    }

    const World& scene_;
    const Lights& lights_;
    const photon_maps<S, T>& maps_;
    const irradiance_options& options_;
    T error_;
    std::vector<char> left_out_{};
    band_of<S> factor_{1};
};

}  // namespace detail

/// Irradiance from all light at one in `options.every` photons of each map, on the photons' side. Points keep the
/// radius of their indirect estimate. The same for any executor. Stopped early, there are fewer points, spread over
/// all places, and gather rays that find none near go on instead. O(points (k + shadow rays)).
template <Scene World, Illuminator Lights, Executor Run = in_sequence>
[[nodiscard]] auto precompute_irradiance(const World& scene, const Lights& lights,
                                         const photon_maps<spectrum_of<World>, scalar_of<World>>& maps,
                                         irradiance_options options = {}, const Run& run = {}) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    options.every = std::max<std::size_t>(1, options.every);
    const std::size_t most = std::max({maps.direct.size(), maps.caustic.size(), maps.indirect.size()});
    const std::vector<char> chosen = detail::chosen_places(most, options);
    std::vector<irradiance_point<S, T>> points = detail::points_at(maps, chosen);
    std::vector<detail::shared_part> parts(points.size());
    const detail::point_light<World, Lights> light{scene, lights, maps, options, chosen};
    const auto fill = [&](std::size_t first, std::size_t count) {
        light(std::span{points}.subspan(first, count), first, std::span{parts}.subspan(first, count));
    };
    detail::keep_filled(points, options.progress, fill, run);
    const detail::shared_part sum = detail::sum_of(parts);
    shared_error shared;
    if (sum.all > 0) {
        const double common =
            sum.direct * maps.direct.common + sum.indirect * maps.indirect.common + sum.caustic * maps.caustic.common;
        shared.common = common / sum.all;
    }
    // A gather averages over many points, so what they lose in the mean can be given back to each. How well that is
    // known, by half, stays. Of direct light of photons, whose discs are wide, it is too much of a guess: told only. Of
    // points that count their own photons it is not known: of half the radius, by which bias is told, such a photon
    // makes four times as large a part.
    if (sum.all > 0 && light.leaves_out()) {
        const double bias = sum.bias / sum.all;
        const double lost = std::clamp(bias, -0.5, 0.5);  // more is the noise of few photons
        for (irradiance_point<S, T>& p : points) { p = p.times(static_cast<band_of<S>>(1 - lost)); }
        shared.bias = bias - lost / 2 + sum.direct_bias / sum.all;
    }
    return irradiance_points<S, T>{points, run, shared};
}

}  // namespace aglow
