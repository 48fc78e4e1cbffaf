// Irradiance at a share of the photons, direct light included: what gather rays read.
//
// Christensen 1999. Direct light is sampled by shadow rays instead of photons: fewer photons, no blur at its edges.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <vector>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/estimators/irradiance_points.hpp>
#include <aglow/estimators/kernel.hpp>

namespace aglow {

/// How irradiance is worked out ahead.
struct irradiance_options {
    std::size_t every{4};          ///< a point at one in so many photons
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

/// What cuts through discs around a point on a surface: how far twelve spokes in its plane are free.
template <std::floating_point T>
class disc_cut {
public:
    static constexpr int spokes = 12;

    /// Looks as far as `radius`. What is met with a normal within `alike` (a cosine) is the surface itself, hollow.
    template <Intersector World>
    disc_cut(const World& scene, const vec3<T>& from, const vec3<T>& normal, T radius, T alike = 1) {
        free_.fill(radius);
        const frame<T> axes{normal};
        // Every other one at first: most discs are whole.
        for (int i = 0; i < spokes; i += 2) { cut_ = cut_ || scene.occluded(from, from + spoke(axes, i) * radius); }
        for (int i = 0; cut_ && i < spokes; ++i) {
            const vec3<T> towards = spoke(axes, i);
            const auto hit = scene.intersect(ray<T>{from, towards, radius});
            if (!hit || std::abs(glm::dot(vec3<T>(hit->normal), normal)) > alike) { continue; }
            const T distance = glm::dot(vec3<T>(hit->position) - from, towards);
            if (distance < radius) { free_[static_cast<std::size_t>(i)] = std::max(T(0), distance); }
        }
    }

    /// Whether anything does.
    explicit operator bool() const { return cut_; }

    /// The share of a kernel of `radius` that lies where its middle can see; never below a tenth, so that the noise
    /// of few photons in a crevice is not blown up.
    template <typename Kernel>
    [[nodiscard]] T share(T radius, const Kernel& kernel) const {
        if (!cut_ || !(radius > 0)) { return 1; }
        T sum{};
        for (const T f : free_) { sum += f < radius ? mass(kernel, square(f / radius)) : T(1); }
        return std::max(T(0.1), sum / spokes);
    }

private:
    /// Of the kernel within `rho2`, by Simpson's rule, which is exact for the polynomials among them.
    template <typename Kernel>
    static T mass(const Kernel& kernel, T rho2) {
        return std::min(T(1), pi<T> * rho2 / 6 * (kernel(T(0)) + 4 * kernel(rho2 / 2) + kernel(rho2)));
    }

    /// Off the axes, along which walls are built.
    static vec3<T> spoke(const frame<T>& axes, int i) {
        const T angle = 2 * pi<T> / spokes * (static_cast<T>(i) + T(0.5));
        return axes.x * std::cos(angle) + axes.y * std::sin(angle);
    }

    std::array<T, spokes> free_{};
    bool cut_{false};
};

/// Whether photon `i` gives its place to a point: by chance, since photons of near indices lie near each other.
[[nodiscard]] inline bool is_place(std::size_t i, const irradiance_options& options) {
    return mix(options.seed, i) % options.every == 0;
}

/// Whether photons that give their places are left out of the irradiance there. They would make it too bright, or,
/// each left out at its own place alone, too dark: a point stands for more of the surface where photons happen to
/// lie farther apart. Places that the photons counted know nothing of make neither.
[[nodiscard]] inline bool places_apart(const irradiance_options& options) { return options.every >= 3; }

/// Irradiance from photons that can be seen from the point, over the part of their disc that can: behind a thin
/// wall in the middle of it lie photons of the same plane, side and normal, which no test of these can tell apart,
/// and in the corner of a room half of it lies beyond the wall, where no photon can be.
template <Intersector World, Spectrum S>
[[nodiscard]] density_estimate<S, scalar_of<World>> seen_irradiance(
    const World& scene, const photon_map<S, scalar_of<World>>& map, const vec3<scalar_of<World>>& point,
    const vec3<scalar_of<World>>& normal, scalar_of<World> error, const irradiance_options& options) {
    using T = scalar_of<World>;
    const auto counts = [&](std::size_t i) { return !places_apart(options) || !is_place(i, options); };
    const band_of<S> apart =
        places_apart(options) ? static_cast<band_of<S>>(options.every) / static_cast<band_of<S>>(options.every - 1) : 1;
    auto seen = map.irradiance(point, normal, options.density, counts);
    const vec3<T> from = point + normal * error;
    if (seen.count == 0) { return seen.times(apart); }
    const T alike = static_cast<T>(options.density.normal_cosine);
    disc_cut<T> cut{scene, from, normal, seen.radius, alike};
    if (!cut) { return seen.times(apart); }
    const T before = seen.radius;
    seen = map.irradiance(point, normal, options.density, [&](std::size_t i) {
        return counts(i) && !scene.occluded(from, map.position(i) + normal * error);
    });
    if (seen.radius > before) { cut = disc_cut<T>{scene, from, normal, seen.radius, alike}; }
    const auto share = [&](T radius) {
        return with_kernel(options.density.kernel, [&](const auto& k) { return band_of<S>(cut.share(radius, k)); });
    };
    const band_of<S> wide = 1 / share(seen.radius);
    const band_of<S> level = max_component(seen.value);
    // The bias is told by what half the radius gives, of which less is cut off.
    const band_of<S> half = (level - seen.bias / 2) / share(seen.radius / 2);
    auto made = seen.times(apart * wide);
    made.bias = 2 * (level * wide - half) * apart;
    return made;
}

/// What one point adds to what all points are off by together. Photons lie densely where it is bright, so a point
/// stands for as much area as its disc has.
struct shared_part {
    double all{0};
    double indirect{0};
    double caustic{0};
    double bias{0};
};

template <Spectrum S, std::floating_point T>
[[nodiscard]] shared_part shared_part_of(const S& direct, const density_estimate<S, T>& indirect,
                                         const density_estimate<S, T>& caustic) {
    const double area = indirect.count > 0 ? square(static_cast<double>(indirect.radius)) : 0.0;
    const auto level = [&](const S& s) { return area * static_cast<double>(max_component(s)); };
    return {level(direct) + level(indirect.value) + level(caustic.value), level(indirect.value), level(caustic.value),
            area * static_cast<double>(indirect.bias + caustic.bias)};
}

/// All parts together, relative to all light.
[[nodiscard]] inline shared_error shared_by(const std::vector<shared_part>& parts, double indirect, double caustic) {
    shared_part sum;
    for (const shared_part& p : parts) {
        sum.all += p.all;
        sum.indirect += p.indirect;
        sum.caustic += p.caustic;
        sum.bias += p.bias;
    }
    if (!(sum.all > 0)) { return {}; }
    return {(sum.indirect * indirect + sum.caustic * caustic) / sum.all, sum.bias / sum.all};
}

/// Fills all points, block by block and far apart from one block to the next, and drops those that were not reached
/// when `progress` said to stop.
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
        const std::size_t last = std::min(points.size(), (b + 1) * block);
        for (std::size_t i = b * block; i < last; ++i) { fill(i); }
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
    std::vector<irradiance_point<S, T>> points;
    const auto choose = [&](const photon_map<S, T>& map) {
        for (std::size_t i = 0; i < map.size(); ++i) {
            if (!detail::is_place(i, options)) { continue; }
            points.push_back({.position = map.position(i),
                              .normal = glm::normalize(map.photons()[i].normal.template direction<T>())});
        }
    };
    choose(maps.direct);
    choose(maps.caustic);
    choose(maps.indirect);
    const T error = 4 * position_error([&] {
                        bounds<T> all = maps.direct.box();
                        all.add(maps.caustic.box());
                        all.add(maps.indirect.box());
                        return all.empty() ? T(0) : std::max(max_abs(all.low), max_abs(all.high));
                    }());
    std::vector<detail::shared_part> parts(points.size());
    const auto fill = [&](std::size_t i) {
        irradiance_point<S, T>& p = points[i];
        const auto seen = [&](const photon_map<S, T>& map) {
            return detail::seen_irradiance<World, S>(scene, map, p.position, p.normal, error, options);
        };
        const auto indirect = seen(maps.indirect);
        const auto caustic = seen(maps.caustic);
        const S direct = options.shadow_rays == 0 ? seen(maps.direct).value
                                                  : direct_irradiance(scene, lights, p.position, p.normal, error,
                                                                      options.shadow_rays, mix(options.seed, i));
        p.irradiance = direct + indirect.value;
        p.caustic = caustic.value;
        p.error = caustic.error + indirect.error;
        p.radius = indirect.count > 0 ? indirect.radius : T(0);
        parts[i] = detail::shared_part_of<S, T>(direct, indirect, caustic);
        p.cut = static_cast<bool>(
            detail::disc_cut<T>{scene, p.position + p.normal * error, p.normal, std::max(p.radius, caustic.radius)});
    };
    detail::keep_filled(points, options.progress, fill, run);
    shared_error shared = detail::shared_by(parts, maps.indirect.common, maps.caustic.common);
    // A gather averages over many points, so what they lose in the mean can be given back to each. How well that is
    // known, by half, stays.
    for (irradiance_point<S, T>& p : points) { p = p.times(static_cast<band_of<S>>(1 - shared.bias)); }
    shared.bias /= 2;
    return irradiance_points<S, T>{points, run, shared};
}

}  // namespace aglow
