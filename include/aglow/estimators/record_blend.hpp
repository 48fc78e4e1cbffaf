// The records around a point, weighed, tested and blended into one irradiance with an honest guess of its error.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>

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

/// What became of the records whose sphere covers a point. Owned by the caller, one per thread; add them up afterwards.
struct lookup_counters {
    std::uint64_t lookups{0};
    std::uint64_t missed{0};    ///< lookups without any acceptable record
    std::uint64_t used{0};      ///< records that counted
    std::uint64_t normal{0};    ///< records rejected because normals differ too much
    std::uint64_t plane{0};     ///< rejected because the point lies in front of the record or behind it
    std::uint64_t distance{0};  ///< rejected because the point lies beyond the ellipse or the metric's border

    lookup_counters& operator+=(const lookup_counters& other) {
        lookups += other.lookups;
        missed += other.missed;
        used += other.used;
        normal += other.normal;
        plane += other.plane;
        distance += other.distance;
        return *this;
    }
};

/// Counts nothing and costs nothing.
struct no_counters {};

/// What the records around a point say. False if they say nothing.
template <Spectrum S, std::floating_point T>
struct irradiance_answer {
    S irradiance{};           ///< W/m²; black where no record is acceptable
    T error{};                ///< a guess of its error, of the largest band: curvature between records and their noise
    T weight{};               ///< sum of the weights; each record adds at most 1
    std::uint32_t records{};  ///< how many were blended

    explicit operator bool() const { return records > 0; }
};

namespace detail {

enum class verdict { used, normal, plane, distance };

inline void count(no_counters&, verdict) {}
inline void count(lookup_counters& counters, verdict v) {
    switch (v) {
        case verdict::used: ++counters.used; break;
        case verdict::normal: ++counters.normal; break;
        case verdict::plane: ++counters.plane; break;
        case verdict::distance: ++counters.distance; break;
    }
}
inline void count_lookup(no_counters&, bool) {}
inline void count_lookup(lookup_counters& counters, bool found) {
    ++counters.lookups;
    if (!found) { ++counters.missed; }
}

/// `record_lookup_options` made ready.
template <std::floating_point T>
struct lookup_limits {
    explicit lookup_limits(const record_lookup_options& options, error_metric rule)
        : metric{rule},
          // 1 - cos, without cancellation.
          turn{static_cast<T>(2 * square(std::sin(options.normal_limit / 2)))},
          plane{static_cast<T>(options.plane_tolerance)},
          weight{static_cast<T>(options.minimum_weight)} {}

    error_metric metric;
    T turn;
    T plane;
    T weight;
};

/// The weight of a record at relative squared distance `t2` and with normals apart by `turn` = (1 - cos) / (1 - cos
/// limit), both below 1 inside: zero at the border, and so nowhere a step.
template <typename T>
[[nodiscard]] T record_weight(error_metric metric, T t2, T turn) {
    const T t = std::sqrt(t2);
    if (metric == error_metric::hessian) { return (1 - t) * (1 - turn); }  // Schwarzhaupt et al. 2012
    const T bend = std::sqrt(turn);
    if (metric == error_metric::nearest_distance) { return 1 - std::max(t, bend); }  // Tabellion & Lamorlette 2004
    return std::max(T(0), 1 - t - bend);                                             // Ward et al. 1988
}

}  // namespace detail

namespace detail {

/// A point as a record sees it, and whether the record may speak for it.
template <std::floating_point T>
struct record_view {
    verdict judged{verdict::normal};
    T t2{};            ///< squared distance over the reach's
    T turn{};          ///< 1 - cos of the angle between the normals
    vec3<T> local{};   ///< where the point lies
    vec3<T> normal{};  ///< and its normal, along the record's axes
};

template <Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] record_view<T> look(const irradiance_record<S, T, F>& record, const vec3<T>& point, const vec3<T>& normal,
                                  const lookup_limits<T>& limits) {
    record_view<T> view;
    const frame<T> axes = record.axes();
    view.turn = length2(normal - axes.z) / 2;
    // Written so that NaN is refused.
    if (!(view.turn < limits.turn)) { return view; }
    const T height = glm::dot(point - record.position(), normal + axes.z) / 2;
    view.judged = verdict::plane;
    if (!(std::abs(height) <= limits.plane * record.radius())) { return view; }
    view.local = record.local(point, axes);
    view.t2 = record.distance2(view.local);
    view.judged = view.t2 < 1 ? verdict::used : verdict::distance;
    view.normal = axes.to_local(normal);
    return view;
}

}  // namespace detail

/// Gathers the answer for one point. Add records in a fixed order, and the answer is the same to the last bit.
template <Spectrum S, std::floating_point T>
class record_blend {
public:
    /// Expects unit `normal`.
    record_blend(const vec3<T>& point, const vec3<T>& normal, const detail::lookup_limits<T>& limits)
        : point_{point}, normal_{normal}, limits_{limits} {}

    /// `bend`: how much the record errs by at its own radius, relative to its irradiance.
    template <record_features F>
    detail::verdict add(const irradiance_record<S, T, F>& record, T bend) {
        const detail::record_view<T> view = detail::look(record, point_, normal_, limits_);
        if (view.judged != detail::verdict::used) { return view.judged; }
        const T weight = detail::record_weight(limits_.metric, view.t2, view.turn / limits_.turn);
        if (!(weight > 0)) { return detail::verdict::distance; }
        take(record, weight, view.t2 * bend, record.extrapolate(view.local, view.normal));
        return detail::verdict::used;
    }

    [[nodiscard]] irradiance_answer<S, T> answer() const {
        if (!(weight_ > limits_.weight)) { return {}; }
        const T scale = 1 / weight_;
        return {sum_ * static_cast<band_of<S>>(scale), (error_ + static_cast<T>(std::sqrt(variance_))) * scale, weight_,
                records_};
    }

private:
    template <record_features F>
    void take(const irradiance_record<S, T, F>& record, T weight, T relative_error, const S& irradiance) {
        sum_ = sum_ + irradiance * static_cast<band_of<S>>(weight);
        weight_ += weight;
        ++records_;
        const T scale = weight * static_cast<T>(max_component(record.irradiance()));
        error_ += scale * relative_error;
        if constexpr (F.noise) { variance_ += square(static_cast<double>(scale * record.relative_noise())); }
    }

    vec3<T> point_;
    vec3<T> normal_;
    const detail::lookup_limits<T>& limits_;
    S sum_{};
    T weight_{};
    T error_{};
    double variance_{};  ///< squares of faint light leave the range of floats
    std::uint32_t records_{0};
};

}  // namespace aglow
