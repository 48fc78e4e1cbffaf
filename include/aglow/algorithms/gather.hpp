// Irradiance at a point from a hemisphere of rays, whatever it is that answers them.
//
// One ray per stratum of a cosine-weighted hemisphere, so that the same rays also tell the gradients (Ward & Heckbert
// 1992) and the Hessian (Schwarzhaupt et al. 2012). The rays are answered by a callable: path tracing, a photon map, a
// final gather, anything.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include <aglow/algorithms/incoming_light.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/hemisphere.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>

namespace aglow {

/// Answers gather rays: `incoming(ray, numbers)` gives something like `incoming_light`; without its `normal`, gradients
/// near corners are too steep. `numbers` are the ray's own, for bounces from 1 on. Callable from many threads.
template <typename F, typename T, typename N>
concept IncomingLight = std::floating_point<T> && Numbers<N> &&
    requires(const F& incoming, const ray<T>& r, const N& numbers) {
    requires Spectrum<std::remove_cvref_t<decltype(incoming(r, numbers).radiance)>>;
    { incoming(r, numbers).distance } -> std::convertible_to<T>;
};

/// A place on a surface, on one of its sides.
template <std::floating_point T>
struct gather_point {
    vec3<T> position{};
    vec3<T> normal{0, 0, 1};  ///< unit, geometric, towards the side to be gathered
    T position_error{};       ///< see `position_error()`: how far rays are lifted off the surface
};

/// A thread's own memory between gathers.
template <Spectrum S, std::floating_point T>
struct gather_workspace {
    hemisphere_grid<S, T> grid{hemisphere_shape{2, 3}};  // cut anew by each gather
};

namespace detail {

/// `normal` with axes turned by an angle, so that no direction of the world is favoured.
template <typename T>
[[nodiscard]] frame<T> turned_frame(const vec3<T>& normal, T turns) {
    frame<T> axes{normal};
    const T c = std::cos(2 * pi<T> * turns);
    const T s = std::sin(2 * pi<T> * turns);
    const vec3<T> x = axes.x * c + axes.y * s;
    axes.y = axes.y * c - axes.x * s;
    axes.x = x;
    return axes;
}

}  // namespace detail

/// Fills `grid` with one ray through each of its strata, and returns the axes it is to be read in.
template <Spectrum S, std::floating_point T, Numbers N, IncomingLight<T, N> Incoming>
frame<T> gather_hemisphere(const Incoming& incoming, const gather_point<T>& at, const N& numbers,
                           const hemisphere_shape& shape, hemisphere_grid<S, T>& grid) {
    grid.reshape(shape);
    auto random = numbers.at(0, purpose::gather);
    const frame<T> axes = detail::turned_frame<T>(at.normal, static_cast<T>(random.next_1d()));
    std::uint64_t branch = 0;
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const vec2<T> u{random.next_2d()};
            const vec3<T> local = hemisphere_direction<T>(shape, j, k, u);
            const vec3<T> towards = axes.to_world(local);
            const ray<T> r{lift(at.position, at.normal, towards, at.position_error), towards};
            const auto seen = incoming(r, N{numbers.fork(branch++)});
            if constexpr (requires { seen.normal; }) {
                const vec3<T> normal = axes.to_local(vec3<T>(seen.normal));
                grid.set(j, k, seen.radiance, static_cast<T>(seen.distance), local, normal);
            } else {
                grid.set(j, k, seen.radiance, static_cast<T>(seen.distance));
            }
        }
    }
    return axes;
}

/// All that one hemisphere of rays tells about the irradiance at a point. The same numbers give the same estimate.
template <Spectrum S, std::floating_point T, Numbers N, IncomingLight<T, N> Incoming>
[[nodiscard]] irradiance_estimate<S, T> gather_irradiance(const Incoming& incoming, const gather_point<T>& at,
                                                          const N& numbers, const irradiance_estimator<T>& estimator,
                                                          gather_workspace<S, T>& workspace) {
    const frame<T> axes = gather_hemisphere(incoming, at, numbers, estimator.shape(), workspace.grid);
    return estimator(workspace.grid, at.position, axes);
}

/// Irradiance alone, from as few rays as you like: one ray per stratum, nothing allocated, bad rays left out.
template <std::floating_point T, Numbers N, IncomingLight<T, N> Incoming>
[[nodiscard]] auto gather_once(const Incoming& incoming, const gather_point<T>& at, const N& numbers,
                               const hemisphere_shape& shape) {
    using spectrum = std::remove_cvref_t<decltype(incoming(std::declval<ray<T>>(), numbers).radiance)>;
    auto random = numbers.at(0, purpose::gather);
    const frame<T> axes = detail::turned_frame<T>(at.normal, static_cast<T>(random.next_1d()));
    spectrum sum{};
    std::uint32_t accepted = 0;
    for (std::uint32_t i = 0; i < shape.count(); ++i) {
        const vec2<T> u{random.next_2d()};
        const vec3<T> towards = axes.to_world(hemisphere_direction<T>(shape, i % shape.rings, i / shape.rings, u));
        const ray<T> r{lift(at.position, at.normal, towards, at.position_error), towards};
        const spectrum radiance = incoming(r, N{numbers.fork(i)}).radiance;
        if (!is_radiance(radiance)) { continue; }
        sum = sum + radiance;
        ++accepted;
    }
    return spectrum(sum * static_cast<band_of<spectrum>>(accepted > 0 ? pi<T> / static_cast<T>(accepted) : T(0)));
}

/// Irradiance from the cache, or where it has no record from `fallback()`: a gather of its own (`gather_once`), whose
/// numbers are the path's, so that the picture stays the same for any number of threads.
template <typename Cache, typename T, typename Fallback>
[[nodiscard]] typename Cache::spectrum irradiance_or(const Cache& cache, const vec3<T>& point, const vec3<T>& normal,
                                                     Fallback&& fallback) {
    const auto answer = cache.lookup(point, normal);
    return answer ? answer.irradiance : typename Cache::spectrum(fallback());
}

}  // namespace aglow
