// The records around a point, weighed, tested and blended into one irradiance with an honest guess of its error.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_lanes.hpp>
#include <aglow/estimators/record_view.hpp>

namespace aglow {

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

/// What a blend sums up, and the answer that it comes to.
template <Spectrum S, std::floating_point T>
struct blend_sums {
    S light{};
    T weight{};
    T error{};
    double variance{};  ///< squares of faint light leave the range of floats
    std::uint32_t records{0};

    template <std::size_t Bands>
    blend_sums& add(const lane_sums<Bands>& lanes) {
        light = light + light_of<S>(lanes);
        weight += lanes.parts[Bands];
        error += lanes.parts[Bands + 1];
        variance += lanes.variance;
        records += lanes.records;
        return *this;
    }

    [[nodiscard]] irradiance_answer<S, T> answer(T least_weight) const {
        if (!(weight > least_weight)) { return {}; }
        const T scale = 1 / weight;
        return {light * static_cast<band_of<S>>(scale), (error + static_cast<T>(std::sqrt(variance))) * scale, weight,
                records};
    }
};

}  // namespace detail

/// Gathers the answer for one point. Add records in a fixed order, and the answer is the same to the last bit.
template <Spectrum S, std::floating_point T>
class record_blend {
public:
    /// Expects unit `normal`.
    record_blend(const vec3<T>& point, const vec3<T>& normal, const detail::lookup_limits<T>& limits)
        : point_{point}, normal_{normal}, limits_{limits} {}

    /// Adds the items that `item_at(i)` tells, for i below `count`: each with a `record` and a `bend`, which is how
    /// much the record errs by at its own radius, relative to its irradiance. `judged(verdict)` hears of each.
    template <typename ItemAt, typename Judged>
    void add(std::size_t count, const ItemAt& item_at, const Judged& judged) {
        if constexpr (detail::has_lanes<S, T>) {
            for (std::size_t first = 0; first < count; first += eight) {
                add_eight(first, std::min(eight, count - first), item_at, judged);
            }
        } else {
            for (std::size_t i = 0; i < count; ++i) { judged(add(item_at(i).record, item_at(i).bend)); }
        }
    }

    /// Adds one.
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
        detail::blend_sums<S, T> all = sums_;
        if constexpr (detail::has_lanes<S, T>) { all.add(lanes_); }
        return all.answer(limits_.weight);
    }

protected:
    /// The sum of the weights of what was added one by one.
    [[nodiscard]] T weight() const { return sums_.weight; }

private:
    static constexpr std::size_t eight = 8;
    struct none {};
    using lane_sums = detail::lanes_or<S, T, none>;

    template <typename ItemAt, typename Judged>
    void add_eight(std::size_t first, std::size_t some, const ItemAt& item_at, const Judged& judged) {
        using record = std::remove_cvref_t<decltype(item_at(first).record)>;
        const char* records[eight];
        T bends[eight];
        std::int32_t verdicts[eight];
        for (std::size_t i = 0; i < eight; ++i) {
            decltype(auto) item = item_at(first + (i < some ? i : 0));
            records[i] = reinterpret_cast<const char*>(&item.record);
            bends[i] = item.bend;
        }
        simd::run_best<simd::eight, detail::add_eight<S, record::features>>(&records[0], &bends[0], some, point_,
                                                                            normal_, limits_, lanes_, &verdicts[0]);
        for (std::size_t i = 0; i < some; ++i) { judged(static_cast<detail::verdict>(verdicts[i])); }
    }

    template <record_features F>
    void take(const irradiance_record<S, T, F>& record, T weight, T relative_error, const S& irradiance) {
        sums_.light = sums_.light + irradiance * static_cast<band_of<S>>(weight);
        sums_.weight += weight;
        ++sums_.records;
        const T scale = weight * static_cast<T>(max_component(record.irradiance()));
        sums_.error += scale * relative_error;
        if constexpr (F.noise) {
            const T noise = scale * record.relative_noise();
            const T together = limits_.together * noise;
            sums_.error += together;
            sums_.variance += square(static_cast<double>(noise - together));
        }
    }

    vec3<T> point_;
    vec3<T> normal_;
    const detail::lookup_limits<T>& limits_;
    detail::blend_sums<S, T> sums_{};
    [[no_unique_address]] lane_sums lanes_{};
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
        record_blend<S, T>::add(item.record, item.bend);
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
