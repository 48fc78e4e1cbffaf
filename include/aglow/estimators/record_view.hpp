// How a point looks from a record near it: where it lies, how its surface is turned, whether the record may speak for
// it.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_reach.hpp>

namespace aglow {

/// When a record near a point is good enough to speak for it.
struct record_lookup_options {
    /// How far normals may differ, in radians.
    double normal_limit{0.2};

    /// How far the point may lie off the record's plane, measured along the mean of both normals, in reaches: what lies
    /// in front of the record or behind it sees other things.
    double plane_tolerance{0.05};

    /// The sum of weights below which a point counts as not covered.
    double minimum_weight{0.001};
};

namespace detail {

enum class verdict { used, normal, plane, distance };

/// `record_lookup_options` made ready.
template <std::floating_point T>
struct lookup_limits {
    /// `smoothed`: whether records hold the mean of those around them.
    explicit lookup_limits(const record_lookup_options& options, error_metric rule, bool smoothed = false)
        : metric{rule},
          // 1 - cos, without cancellation.
          turn{static_cast<T>(2 * square(std::sin(options.normal_limit / 2)))},
          plane{static_cast<T>(options.plane_tolerance)},
          weight{static_cast<T>(options.minimum_weight)},
          together{smoothed ? T(1) : T(0)} {}

    error_metric metric;
    T turn;
    T plane;
    T weight;
    T together;  ///< 1 where records were made of the same rays, so that their noise adds up; 0 where each has its own
};

/// The weight of a record at relative squared distance `t2` and with normals apart by `turn` = (1 - cos) / (1 - cos
/// limit), both below 1 inside: zero at the border, and so nowhere a step.
template <error_metric Metric, typename T>
[[nodiscard, gnu::always_inline]] inline T record_weight(T t2, T turn) {
    const T t = root(t2);
    if constexpr (Metric == error_metric::hessian) { return (1 - t) * (1 - turn); }  // Schwarzhaupt et al. 2012
    const T bend = root(turn);
    if constexpr (Metric == error_metric::nearest_distance) {
        return 1 - (t > bend ? t : bend);  // Tabellion & Lamorlette 2004
    }
    const T weight = 1 - t - bend;  // Ward et al. 1988
    return weight > 0 ? weight : T(0);
}
template <typename T>
[[nodiscard]] T record_weight(error_metric metric, T t2, T turn) {
    switch (metric) {
        case error_metric::hessian: return record_weight<error_metric::hessian>(t2, turn);
        case error_metric::nearest_distance: return record_weight<error_metric::nearest_distance>(t2, turn);
        case error_metric::split_sphere: break;
    }
    return record_weight<error_metric::split_sphere>(t2, turn);
}

/// A point as a record sees it, and whether the record may speak for it.
template <std::floating_point T>
struct record_view {
    verdict judged{verdict::normal};
    T t2{};            ///< squared distance over the reach's
    T turn{};          ///< 1 - cos of the angle between the normals
    vec3<T> local{};   ///< where the point lies
    vec3<T> normal{};  ///< and its normal, along the record's axes
};

/// Takes no branch, so that several can be worked out side by side.
template <std::floating_point T>
[[nodiscard, gnu::always_inline]] inline record_view<T> look(const record_shape<T>& record, const vec3<T>& point,
                                                             const vec3<T>& normal, const lookup_limits<T>& limits) {
    record_view<T> view;
    const vec3<T> way = record.facing.to_local(point - record.position);
    view.turn = length2(normal - record.facing.normal) / 2;
    const T height = (glm::dot(point - record.position, normal) + way.z) / 2;
    view.local = way * (1 / record.radius);
    view.t2 = record.distance2(view.local);
    view.normal = record.facing.to_local(normal);
    // Written so that NaN is refused.
    view.judged = view.t2 < 1 ? verdict::used : verdict::distance;
    view.judged = std::abs(height) <= limits.plane * record.radius ? view.judged : verdict::plane;
    view.judged = view.turn < limits.turn ? view.judged : verdict::normal;
    return view;
}

template <Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] record_view<T> look(const irradiance_record<S, T, F>& record, const vec3<T>& point, const vec3<T>& normal,
                                  const lookup_limits<T>& limits) {
    return look(record.shape(), point, normal, limits);
}

}  // namespace detail

}  // namespace aglow
