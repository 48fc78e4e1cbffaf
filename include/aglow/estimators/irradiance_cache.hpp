// Irradiance remembered at few points and blended between them.
//
// Ward et al. 1988: indirect light changes slowly, so it is worked out where no record reaches and interpolated
// elsewhere. Here with gradients (1992), neighbour clamping (Krivanek et al. 2006) and ellipses of equal error
// (Schwarzhaupt et al. 2012). Knows no rays: whoever has irradiance hands it in.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/octree.hpp>
#include <aglow/containers/stable_array.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/frozen_irradiance_cache.hpp>
#include <aglow/estimators/irradiance_cache_options.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_neighbours.hpp>
#include <aglow/estimators/record_reach.hpp>
#include <aglow/estimators/record_sharing.hpp>

namespace aglow {

/// What became of an estimate handed to a cache.
enum class record_status {
    inserted,
    /// Not a number somewhere, negative light, no unit normal, or more than half of the rays rejected.
    bad_estimate,
    /// The reach is too small or too large to be squared.
    bad_reach
};

namespace detail {

/// A length between two others in a byte, rounded upwards to one of 256 that go up by the same factor.
template <std::floating_point T>
class length_between {
public:
    length_between(T length, T shortest, T longest) {
        const T share = longest > shortest ? std::log2(length / shortest) / std::log2(longest / shortest) : T(0);
        code_ = static_cast<std::uint8_t>(std::ceil(std::clamp(share, T(0), T(1)) * T(255)));
    }

    [[nodiscard]] T of(T shortest, T longest) const {
        if (code_ == 255) { return longest; }
        return shortest * std::exp2(std::log2(longest / shortest) * (static_cast<T>(code_) / T(255)));
    }

private:
    std::uint8_t code_;
};

}  // namespace detail

/// An irradiance cache that grows. Lookups are safe from many threads while nobody inserts.
template <Spectrum S, std::floating_point T = band_of<S>, record_features Features = record_features{}>
class irradiance_cache {
public:
    using record = irradiance_record<S, T, Features>;
    using estimate = irradiance_estimate<S, T>;
    using frozen = frozen_irradiance_cache<S, T, Features>;
    using spectrum = S;
    using scalar = T;

    /// A cache for a scene of the given radius, which is what the options' lengths are measured by.
    /// Throws `std::invalid_argument` for a radius or options that make no sense.
    explicit irradiance_cache(T scene_radius, const irradiance_cache_options& options = {})
        : options_{options}, scene_radius_{scene_radius}, limits_{options.lookup, options.reach.metric} {
        detail::check(options);
        detail::expect_setting(is_finite(scene_radius) && scene_radius > 0,
                               "scene radius (half the diagonal of the scene's bounds)",
                               static_cast<double>(scene_radius));
        shortest_ = static_cast<T>(options.reach.minimum_radius) * scene_radius;
        longest_ = static_cast<T>(options.reach.maximum_radius) * scene_radius;
    }
    explicit irradiance_cache(const bounds<T>& scene, const irradiance_cache_options& options = {})
        : irradiance_cache{scene.radius(), options} {}

    /// Irradiance at `point` on the side of `normal` (unit); false where no record is acceptable. `counters` hears what
    /// became of each record.
    template <typename Counters = no_counters>
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal,
                                                 Counters&& counters = {}) const {
        record_blend<S, T> blend{point, normal, limits_};
        struct near_record {
            const irradiance_record<S, T, Features>& record;
            T bend;
        };
        const item* near[few];
        std::size_t count = 0;
        const auto add_near = [&] {
            blend.add(
                count,
                [&](std::size_t i) {
                    return near_record{near[i]->record, own_bend(*near[i])};
                },
                [&](detail::verdict v) { detail::count(counters, v); });
            count = 0;
        };
        tree_.visit_covering(point, [&](const item& i) {
            near[count++] = &i;
            if (count == few) { add_near(); }
        });
        add_near();
        const irradiance_answer<S, T> answer = blend.answer();
        detail::count_lookup(counters, static_cast<bool>(answer));
        return answer;
    }

    /// The reach that `e` would have here, neighbours apart. `footprint`: diameter of a pixel at the point, 0 for none.
    [[nodiscard]] record_reach<T> reach(const estimate& e, T footprint = 0) const {
        return reach_of(e, options_.reach, scene_radius_, footprint);
    }

    /// Remembers `e`. Clamps it and its neighbours to the fixed point R_i = min_j (R_j + |x_i - x_j|) of all records'
    /// own reaches, which does not depend on the order of insertion.
    record_status insert(const estimate& e, T footprint = 0) {
        record_reach<T> r = reach(e, footprint);
        if (!is_usable(e, r)) { return refuse(record_status::bad_estimate); }
        const detail::length_between<T> lowest{r.lowest, shortest_, longest_};
        const T own = r.own_radius;
        if (options_.clamp_neighbours) {
            r.radius = std::max(lowest.of(shortest_, longest_), clamped(e.position, own));
        }
        const record made{e, r};
        if (!tree_.insert({made, own}, made.position(), made.longest_radius())) {
            return refuse(record_status::bad_reach);
        }
        lowest_.append(lowest);
        if (options_.clamp_neighbours) { clamp_others(e.position, own); }
        settle();
        return record_status::inserted;
    }

    /// Takes the light of another estimate at the place of record `index`, whose reach stays as it is; false where the
    /// estimate is bad. Expects `index < size()` and the record's normal.
    bool replace(std::uint32_t index, const estimate& e) {
        item& one = tree_[index];
        if (!is_usable(e, record_reach<T>{.radius = one.record.radius()})) { return false; }
        one.record = one.record.with_light(e);
        return true;
    }

    /// How much one gather ray around record `index` differs from their mean, relative to it, as the noise of the
    /// records around it tells, without its own: what it happened to see decides nothing. 0 where there are none.
    [[nodiscard]] T scatter_around(std::uint32_t index) const requires(Features.noise) {
        return detail::scatter_around(tree_, index, limits_);
    }

    [[nodiscard]] std::uint32_t size() const { return tree_.size(); }
    [[nodiscard]] const record& operator[](std::uint32_t index) const { return tree_[index].record; }
    [[nodiscard]] const irradiance_cache_options& options() const { return options_; }
    [[nodiscard]] T scene_radius() const { return scene_radius_; }

    /// How many estimates were refused.
    [[nodiscard]] std::size_t refused() const { return refused_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const { return tree_.bytes() + lowest_.bytes(); }

    /// The records in their present reach and in their order, ready to be asked only. Each learns from its neighbours
    /// how far off its extrapolation is, and, with `smoothing`, what they take its irradiance to be.
    template <Executor E = in_sequence>
    [[nodiscard]] frozen freeze(const E& run = {}) const {
        std::vector<T> bends(size());
        std::vector<char> learnt(size());
        for_each_record(run, [&](std::size_t i, const item& one) {
            const std::optional<T> bend = detail::learnt_bend(tree_, one.record, limits_);
            bends[i] = bend.value_or(own_bend(one));
            learnt[i] = bend.has_value();
        });
        std::vector<typename frozen::item> items(size());
        for_each_record(run, [&](std::size_t i, const item& one) {
            const bool smooth = options_.smoothing && Features.noise;
            const std::span<const T> all{bends};
            const record finished = smooth ? detail::smoothed(tree_, one.record, all, limits_) : one.record;
            // What neighbours showed is so much light, whatever the record takes its own to be now.
            items[i] = {finished, learnt[i] ? detail::relative_to(bends[i], one.record, finished) : bends[i]};
        });
        return frozen{items, options_};
    }

    /// What lookups of `finished`, this cache frozen, are off by together at `places`, a picture's, as far as the
    /// records know: their noise, and the bias of speaking for each other and of being smoothed. Each place has a
    /// `position` and a unit `normal`.
    template <typename Places>
    [[nodiscard]] shared_error shared(const frozen& finished, const Places& places) const {
        return detail::shared_by_records(tree_, finished, places, limits_);
    }

private:
    struct item {
        irradiance_record<S, T, Features> record;
        T own_radius;  ///< without neighbours
    };

    template <Executor E, typename Body>
    void for_each_record(const E& run, Body&& body) const {
        for_each_block(run, size(), 64, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) { body(i, tree_[static_cast<std::uint32_t>(i)]); }
        });
    }

    static constexpr std::size_t few = 32;

    record_status refuse(record_status why) {
        ++refused_;
        return why;
    }

    // The triangle inequality makes one step from the own reaches the fixed point of any number of steps.
    [[nodiscard]] T clamped(const vec3<T>& position, T own) const {
        T radius = own;
        tree_.visit_within(position, own, [&](const item& other) {
            radius = std::min(radius, other.own_radius + glm::distance(other.record.position(), position));
        });
        return radius;
    }

    void clamp_others(const vec3<T>& position, T own) {
        std::vector<std::pair<std::uint32_t, T>> shrunk;
        tree_.visit_covering(position, [&](const item& other, std::uint32_t index) {
            const T limit = own + glm::distance(other.record.position(), position);
            if (!(limit < other.record.radius())) { return; }
            const T radius = std::max(lowest_[index].of(shortest_, longest_), limit);
            if (radius < other.record.radius()) { shrunk.emplace_back(index, radius); }
        });
        for (const auto& [index, radius] : shrunk) { tree_[index].record = tree_[index].record.with_radius(radius); }
    }

    // What has settled is found faster; a small part at a time leaves little that has not.
    void settle() {
        if (size() < settles_at_) { return; }
        tree_.settle_latest([](const item& i) { return i.record.longest_radius(); });
        settles_at_ = size() + std::max(size() / 16, 32u);
    }

    /// What the rule that set the reach takes the error at the border to be, relative to the irradiance; more where a
    /// lower limit raised the reach.
    [[nodiscard]] T own_bend(const item& one) const {
        const T accuracy = static_cast<T>(options_.reach.accuracy);
        const T radius = one.record.radius();
        const T raised = std::max(T(1), radius / one.own_radius);
        if (options_.reach.metric != error_metric::hessian) { return std::min(T(1), accuracy * raised); }
        // Half of lambda R², where the own R = accuracy (4 scene² / lambda)^(1/4).
        return std::min(T(1), 2 * square(accuracy * accuracy * scene_radius_ / radius * square(raised)));
    }

    irradiance_cache_options options_;
    T scene_radius_;
    T shortest_{0}, longest_{0};  // reaches
    detail::lookup_limits<T> limits_;
    octree<item, T> tree_;
    stable_array<detail::length_between<T>> lowest_{};  // what each reach never falls below
    std::uint32_t settles_at_{32};
    std::size_t refused_{0};
};

}  // namespace aglow
