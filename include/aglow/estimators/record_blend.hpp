// The records around a point, weighed, tested and blended into one irradiance with an honest guess of its error.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

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

/// Takes no branch, so that several can be worked out side by side.
template <std::floating_point T>
[[nodiscard, gnu::always_inline]] inline record_view<T> look(const record_shape<T>& record, const vec3<T>& point,
                                                             const vec3<T>& normal, const lookup_limits<T>& limits) {
    record_view<T> view;
    const frame<T> axes = record.axes();
    view.turn = length2(normal - axes.z) / 2;
    const T height = glm::dot(point - record.position, normal + axes.z) / 2;
    view.local = record.local(point, axes);
    view.t2 = record.distance2(view.local);
    view.normal = axes.to_local(normal);
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

/// Eight shapes by number, as vector instructions like them, and the same for views.
template <std::floating_point T>
struct eight_shapes {
    static constexpr std::size_t count = 8;
    T x[count], y[count], z[count], radius[count], normal_x[count], normal_y[count], ellipse_x[count], ellipse_y[count];

    void set(std::size_t i, const record_shape<T>& s) {
        x[i] = s.position.x, y[i] = s.position.y, z[i] = s.position.z;
        radius[i] = s.radius;
        normal_x[i] = s.normal.x, normal_y[i] = s.normal.y;
        ellipse_x[i] = s.ellipse.x, ellipse_y[i] = s.ellipse.y;
    }
    [[nodiscard]] record_shape<T> at(std::size_t i) const {
        return {{x[i], y[i], z[i]}, radius[i], {normal_x[i], normal_y[i]}, {ellipse_x[i], ellipse_y[i]}};
    }
};
template <std::floating_point T>
struct eight_views {
    static constexpr std::size_t count = 8;
    verdict judged[count];
    T t2[count], turn[count], x[count], y[count], normal_x[count], normal_y[count];

    void set(std::size_t i, const record_view<T>& v) {
        judged[i] = v.judged, t2[i] = v.t2, turn[i] = v.turn;
        x[i] = v.local.x, y[i] = v.local.y, normal_x[i] = v.normal.x, normal_y[i] = v.normal.y;
    }
    [[nodiscard]] record_view<T> at(std::size_t i) const {
        return {judged[i], t2[i], turn[i], {x[i], y[i], 0}, {normal_x[i], normal_y[i], 0}};
    }
};

template <std::floating_point T>
[[gnu::always_inline]] inline eight_views<T> look_at(const eight_shapes<T>& shapes, std::size_t count,
                                                     const vec3<T>& point, const vec3<T>& normal,
                                                     const lookup_limits<T>& limits) {
    // Copies, which nothing that is written can be.
    const eight_shapes<T> these = shapes;
    const vec3<T> p = point, n = normal;
    const lookup_limits<T> within = limits;
    eight_views<T> views;
    for (std::size_t i = 0; i < count; ++i) { views.set(i, look(these.at(i), p, n, within)); }
    return views;
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__AVX2__)
template <std::floating_point T>
[[gnu::target("avx2"), gnu::flatten, gnu::noinline]] eight_views<T> look_at_eight(const eight_shapes<T>& shapes,
                                                                                  const vec3<T>& point,
                                                                                  const vec3<T>& normal,
                                                                                  const lookup_limits<T>& limits) {
    return look_at(shapes, eight_shapes<T>::count, point, normal, limits);
}
#endif

/// What the first `count` shapes look like; all eight at once where the machine has the registers for it.
template <std::floating_point T>
[[nodiscard]] eight_views<T> look_at_some(const eight_shapes<T>& shapes, [[maybe_unused]] std::size_t count,
                                          const vec3<T>& point, const vec3<T>& normal, const lookup_limits<T>& limits) {
#if defined(__AVX2__)
    return look_at(shapes, eight_shapes<T>::count, point, normal, limits);
#else
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx2")) { return look_at_eight(shapes, point, normal, limits); }
#endif
    return look_at(shapes, count, point, normal, limits);
#endif
}

}  // namespace detail

/// Gathers the answer for one point. Add records in a fixed order, and the answer is the same to the last bit.
template <Spectrum S, std::floating_point T>
class record_blend {
public:
    /// Expects unit `normal`.
    record_blend(const vec3<T>& point, const vec3<T>& normal, const detail::lookup_limits<T>& limits)
        : point_{point}, normal_{normal}, limits_{limits} {}

    /// Adds the items that `item_at(i)` refers to, for i below `count`: each with a `record` and a `bend`, which is how
    /// much the record errs by at its own radius, relative to its irradiance. `judged(verdict)` hears of each.
    template <typename ItemAt, typename Judged>
    void add(std::size_t count, const ItemAt& item_at, const Judged& judged) {
        for (std::size_t first = 0; first < count; first += eight) {
            const std::size_t some = std::min(eight, count - first);
            detail::eight_shapes<T> shapes;
            for (std::size_t i = 0; i < eight; ++i) {
                shapes.set(i, item_at(first + (i < some ? i : 0)).record.shape());
            }
            const detail::eight_views<T> views = detail::look_at_some(shapes, some, point_, normal_, limits_);
            for (std::size_t i = 0; i < some; ++i) {
                const auto& item = item_at(first + i);
                judged(add(views.at(i), item.record, item.bend));
            }
        }
    }

    [[nodiscard]] irradiance_answer<S, T> answer() const {
        if (!(weight_ > limits_.weight)) { return {}; }
        const T scale = 1 / weight_;
        return {sum_ * static_cast<band_of<S>>(scale), (error_ + static_cast<T>(std::sqrt(variance_))) * scale, weight_,
                records_};
    }

protected:
    [[nodiscard]] T weight() const { return weight_; }

private:
    static constexpr std::size_t eight = detail::eight_shapes<T>::count;

    template <record_features F>
    detail::verdict add(const detail::record_view<T>& view, const irradiance_record<S, T, F>& record, T bend) {
        if (view.judged != detail::verdict::used) { return view.judged; }
        const T weight = detail::record_weight(limits_.metric, view.t2, view.turn / limits_.turn);
        if (!(weight > 0)) { return detail::verdict::distance; }
        take(record, weight, view.t2 * bend, record.extrapolate(view.local, view.normal));
        return detail::verdict::used;
    }

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

/// What records say that also keep where light comes from.
template <Spectrum S, std::floating_point T>
struct light_answer : irradiance_answer<S, T> {
    vec3<T> incident{};  ///< mean direction to the light
    T misfit{};          ///< what light linear in direction leaves out, of each record and from one to the next
};

/// Gathers the answer for one point from records that keep `incident`.
template <Spectrum S, std::floating_point T>
class light_blend : public record_blend<S, T> {
public:
    using record_blend<S, T>::record_blend;

    /// Adds one item, as of `record_blend::add`.
    template <typename Item>
    void add(const Item& item) {
        const T before = this->weight();
        record_blend<S, T>::add(
            1, [&](std::size_t) -> const Item& { return item; }, [](detail::verdict) {});
        const T share = (this->weight() - before) * static_cast<T>(max_component(item.record.irradiance()));
        const vec3<T> incident = item.record.incident();
        incident_ += incident * share;
        squares_ += length2(incident) * share;
        misfit_ += item.record.misfit() * share;
        total_ += share;
    }

    [[nodiscard]] light_answer<S, T> answer() const {
        light_answer<S, T> result{record_blend<S, T>::answer()};
        if (!(total_ > 0)) { return result; }
        result.incident = incident_ / total_;
        // A mean direction that is off by d makes the linear light wrong by sqrt(18) d at the most.
        const T spread2 = std::max(T(0), squares_ / total_ - length2(result.incident));
        result.misfit = std::sqrt(square(misfit_ / total_) + 18 * spread2);
        return result;
    }

private:
    vec3<T> incident_{0};
    T squares_{0};
    T misfit_{0};
    T total_{0};
};

}  // namespace aglow
