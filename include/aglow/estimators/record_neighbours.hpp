// What records learn from the records around them, once all are there.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>

namespace aglow::detail {

/// Squared standard error of the largest band; 0 where records do not keep it.
template <Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] double variance_of(const irradiance_record<S, T, F>& r) {
    if constexpr (F.noise) {
        // Squares of faint light leave the range of floats.
        return square(static_cast<double>(r.relative_noise()) * static_cast<double>(max_component(r.irradiance())));
    } else {
        return 0;
    }
}

/// By how much the band that differs most does.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T largest_difference(const S& a, const S& b) {
    const S difference = a + b * band_of<S>(-1);
    return static_cast<T>(std::max(max_component(difference), max_component(S(difference * band_of<S>(-1)))));
}

/// How much a record errs by at its own radius, relative to its irradiance, as its neighbours show: each is a test of
/// the extrapolation. The upper quartile of |E_i + grad d - E_j| / d², the noise of both left out. Nothing where there
/// is no test. `tree` visits items with `.record`.
template <typename Tree, Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] std::optional<T> learnt_bend(const Tree& tree, const irradiance_record<S, T, F>& r,
                                           const lookup_limits<T>& limits) {
    std::vector<T> errors;
    tree.visit_within(r.position(), r.longest_radius(), [&](const auto& item) {
        const irradiance_record<S, T, F>& other = item.record;
        const record_view<T> view = look(r, other.position(), other.normal(), limits);
        // Too near to tell curvature from noise; the record itself among them.
        if (view.judged != verdict::used || !(view.t2 > T(0.01))) { return; }
        const T high = largest_difference<S, T>(r.extrapolate(view.local, view.normal), other.irradiance());
        const double own2 = square(static_cast<double>(high)) - variance_of(r) - variance_of(other);
        errors.push_back(static_cast<T>(std::sqrt(std::max(0.0, own2))) / view.t2);
    });
    const T irradiance = static_cast<T>(max_component(r.irradiance()));
    if (errors.empty() || !(irradiance > 0)) { return std::nullopt; }
    const auto quartile = errors.begin() + static_cast<std::ptrdiff_t>((errors.size() * 3) / 4);
    std::nth_element(errors.begin(), quartile, errors.end());
    return std::min(*quartile / irradiance, std::numeric_limits<T>::max());
}

/// What is told relative to the irradiance of `before`, relative to that of `after`.
template <Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] T relative_to(T told, const irradiance_record<S, T, F>& before, const irradiance_record<S, T, F>& after) {
    const T old_level = static_cast<T>(max_component(before.irradiance()));
    const T level = static_cast<T>(max_component(after.irradiance()));
    if (!(told > 0) || !(level > 0)) { return told; }
    return std::min(told * (old_level / level), std::numeric_limits<T>::max());
}

/// Relative standard deviation of one gather ray, in the mean of squares over the records within two reaches of record
/// `index` that face the same way, itself left out. `tree` visits items with `.record`, and tells their number.
template <typename Tree, std::floating_point T>
[[nodiscard]] T scatter_around(const Tree& tree, std::uint32_t index, const lookup_limits<T>& limits) {
    const auto& here = tree[index].record;
    double sum{};
    std::uint32_t count{};
    tree.visit_within(here.position(), 2 * here.longest_radius(), [&](const auto& item, std::uint32_t number) {
        const verdict judged = look(here, item.record.position(), item.record.normal(), limits).judged;
        const bool alike = judged == verdict::used || judged == verdict::distance;
        if (number == index || !alike) { return; }
        sum += square(static_cast<double>(item.record.relative_noise())) * item.record.rays();
        ++count;
    });
    return count > 0 ? static_cast<T>(std::sqrt(sum / count)) : T(0);
}

/// By how many rays a record was made; 1 where records do not keep it.
template <Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] double rays_of(const irradiance_record<S, T, F>& r) {
    if constexpr (F.noise) {
        return std::max(1u, r.rays());
    } else {
        return 1;
    }
}

/// The record with the irradiance that it and all records that reach it agree on: their first-order predictions weighed
/// by one over the expected squared error, which is their variance and the square of what each errs by. One ray's
/// variance is what they have in common, since a record's own goes up and down with its irradiance, and would pull
/// towards the dark. `tree` visits items with `.record`, and tells their number, which is where in `bends` to look.
template <typename Tree, Spectrum S, std::floating_point T, record_features F>
[[nodiscard]] irradiance_record<S, T, F> smoothed(const Tree& tree, const irradiance_record<S, T, F>& r,
                                                  std::span<const T> bends, const lookup_limits<T>& limits) {
    struct prediction {
        S irradiance;
        double bias2;
        double rays;
    };
    std::vector<prediction> predictions;
    double ray_variance{};
    const vec3<T> normal = r.normal();
    tree.visit_covering(r.position(), [&](const auto& item, std::uint32_t index) {
        const irradiance_record<S, T, F>& other = item.record;
        const record_view<T> view = look(other, r.position(), normal, limits);
        if (view.judged != verdict::used) { return; }
        ray_variance += variance_of(other) * rays_of(other);
        const T bias = bends[index] * view.t2 * static_cast<T>(max_component(other.irradiance()));
        predictions.push_back(
            {other.extrapolate(view.local, view.normal), square(static_cast<double>(bias)), rays_of(other)});
    });
    if (!(ray_variance > 0)) { return r; }
    ray_variance /= static_cast<double>(predictions.size());
    const double own = ray_variance / rays_of(r);
    S sum{};
    T weights{};
    double variances{};
    for (const prediction& p : predictions) {
        const double variance = ray_variance / p.rays;
        // What differs by more than noise explains (the difference of two has the variance of both) lies across an
        // edge.
        const double apart = static_cast<double>(largest_difference<S, T>(p.irradiance, r.irradiance()));
        const double edge2 = std::max(0.0, square(apart) - 4 * (own + variance));
        const T weight = static_cast<T>(own / (variance + p.bias2 + edge2));
        sum = sum + p.irradiance * static_cast<band_of<S>>(weight);
        weights += weight;
        variances += square(static_cast<double>(weight)) * variance;
    }
    const S mean = sum * static_cast<band_of<S>>(1 / weights);
    const T most = static_cast<T>(max_component(mean));
    return r.with_irradiance(mean, most > 0 ? static_cast<T>(std::sqrt(variances)) / (weights * most) : T(0));
}

}  // namespace aglow::detail
