// How far a record of irradiance may be used: from what was seen, within limits that know no unit.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>

namespace aglow {

/// What sets the reach of a record, and how records are weighed at lookup.
enum class error_metric {
    split_sphere,      ///< accuracy times the harmonic mean distance (Ward et al. 1988)
    nearest_distance,  ///< accuracy times the distance to the nearest thing (Tabellion & Lamorlette 2004); take 0.5
    hessian            ///< an ellipse of equal error from the occlusion-aware Hessian (Schwarzhaupt et al. 2012)
};

/// All lengths are relative to the scene's radius or to the pixel's footprint.
struct record_reach_options {
    error_metric metric{error_metric::hessian};

    /// Smaller is finer: twice as small makes about four times as many records.
    double accuracy{0.08};

    /// Bounds of the reach, in radii of the scene. The lower one keeps crevices from swallowing the fill pass.
    double minimum_radius{0.002};
    double maximum_radius{0.25};

    /// No reach shall be below so many pixels' footprints; where surroundings are nearer than that they win, so a large
    /// footprint, as after several mirrors, cannot spread one record over everything.
    double minimum_footprints{1.5};

    /// The reach never exceeds so many harmonic mean distances: no derivative sees what lies behind the next corner.
    double geometric_limit{1};

    /// How much longer than the other one axis of the ellipse may be; 1 makes circles, and more than 9.9 is no more
    /// than that.
    double maximum_ratio{2};
};

/// An ellipse in the tangent plane, shorter semi-axis first, in the axes of its estimate.
template <std::floating_point T>
struct record_reach {
    T radius{};          ///< shorter semi-axis, within the limits
    T own_radius{};      ///< the same before the lower limits: what clamps the neighbours
    T lowest{};          ///< the lower limit that applies here
    T ratio{1};          ///< longer over shorter semi-axis
    vec2<T> axis{1, 0};  ///< unit direction of the shorter one
};

namespace detail {

/// Largest magnitude of any band of the derivative along `axis`, relative to irradiance; 0 where it is black.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T relative_slope(const irradiance_estimate<S, T>& e, const vec2<T>& axis) {
    const S slope = e.gradients.translation.x * axis.x + e.gradients.translation.y * axis.y;
    const T high = static_cast<T>(std::max(max_component(slope), max_component(S(slope * band_of<S>(-1)))));
    const T irradiance = static_cast<T>(max_component(e.irradiance));
    return irradiance > 0 ? high / irradiance : T(0);
}

/// The reciprocal reach along one principal axis: from curvature, and no farther than where the gradient ends at zero.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T inverse_reach(const irradiance_estimate<S, T>& e, T curvature, const vec2<T>& axis, T accuracy,
                              T scene) {
    // Schwarzhaupt et al. 2012: (4 eps E / (pi lambda))^(1/4), with the tolerance pi accuracy⁴ scene² to know no unit.
    const T bend = std::sqrt(std::sqrt(std::abs(curvature) * scene * scene / 4)) / (accuracy * scene);
    return std::max(bend, relative_slope(e, axis));
}

}  // namespace detail

/// The reach of `e` in a scene whose bounds have radius `scene_radius`. `footprint` is the diameter of a pixel at the
/// point, 0 where no picture is meant. Expects positive, finite `scene_radius`.
template <Spectrum S, std::floating_point T>
[[nodiscard]] record_reach<T> reach_of(const irradiance_estimate<S, T>& e, const record_reach_options& options,
                                       T scene_radius, T footprint) {
    const T accuracy = static_cast<T>(options.accuracy);
    const T longest = static_cast<T>(options.maximum_radius) * scene_radius;
    record_reach<T> result;
    T inverse = 1 / longest;
    if (options.metric == error_metric::split_sphere) {
        inverse = std::max({inverse, e.mean_inverse_distance / accuracy, detail::relative_slope(e, {1, 0}),
                            detail::relative_slope(e, {0, 1})});
    } else if (options.metric == error_metric::nearest_distance) {
        inverse = std::max(inverse, e.nearest_inverse_distance / accuracy);
    } else {
        const principal_curvatures<T> c = principal(e.curvature);
        const vec2<T> across{-c.axis.y, c.axis.x};
        const T geometric = e.mean_inverse_distance / static_cast<T>(options.geometric_limit);
        const T floor = std::max(inverse, geometric);
        const T first = std::max(floor, detail::inverse_reach(e, c.major, c.axis, accuracy, scene_radius));
        const T second = std::max(floor, detail::inverse_reach(e, c.minor, across, accuracy, scene_radius));
        inverse = std::max(first, second);
        result.axis = first < second ? across : c.axis;
        result.ratio = std::min(inverse / std::min(first, second), static_cast<T>(options.maximum_ratio));
    }
    result.own_radius = 1 / inverse;
    const T pixels = static_cast<T>(options.minimum_footprints) * footprint;
    const T spacing =
        e.mean_inverse_distance > 0 ? std::min(pixels, 1 / e.mean_inverse_distance) : std::min(pixels, longest);
    result.lowest = std::min(longest, std::max(spacing, static_cast<T>(options.minimum_radius) * scene_radius));
    result.radius = std::max(result.own_radius, result.lowest);
    // The limit raises the axes that are below it, not the other with them.
    result.ratio = std::max(T(1), result.ratio * (result.own_radius / result.radius));
    return result;
}

}  // namespace aglow
