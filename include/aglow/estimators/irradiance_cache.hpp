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
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/octree.hpp>
#include <aglow/containers/packed_spheres.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_neighbours.hpp>
#include <aglow/estimators/record_reach.hpp>
#include <aglow/estimators/record_sharing.hpp>

namespace aglow {

/// How records reach, are found and clamp each other.
struct irradiance_cache_options {
    record_reach_options reach{};
    record_lookup_options lookup{};

    /// A record reaches no farther than a neighbour's reach and the way to it, so what one of them saw near counts for
    /// all around (Krivanek et al. 2006).
    bool clamp_neighbours{true};

    /// When frozen, each record takes the irradiance that it and its neighbours' extrapolations agree on, weighed by
    /// noise and by how wrong they proved. Worth as much as half as many rays again where radiance is noisy. Needs
    /// noise to be kept.
    bool smoothing{true};
};

/// What became of an estimate handed to a cache.
enum class record_status {
    inserted,
    /// Not a number somewhere, negative light, no unit normal, or more than half of the rays rejected.
    bad_estimate,
    /// The reach is too small or too large to be squared.
    bad_reach
};

namespace detail {

/// Throws `std::invalid_argument` that names the setting and its value.
inline void expect_setting(bool good, const char* name, double value) {
    if (!good) { throw std::invalid_argument("aglow: " + std::string{name} + " is " + std::to_string(value)); }
}

inline void check(const irradiance_cache_options& o) {
    // Written so that NaN is refused, under -ffast-math too.
    const auto positive = [](double x) { return is_finite(x) && x > 0; };
    expect_setting(positive(o.reach.accuracy), "accuracy", o.reach.accuracy);
    expect_setting(positive(o.reach.minimum_radius), "minimum_radius", o.reach.minimum_radius);
    expect_setting(positive(o.reach.maximum_radius) && o.reach.maximum_radius >= o.reach.minimum_radius,
                   "maximum_radius", o.reach.maximum_radius);
    expect_setting(is_finite(o.reach.minimum_footprints) && o.reach.minimum_footprints >= 0, "minimum_footprints",
                   o.reach.minimum_footprints);
    expect_setting(positive(o.reach.geometric_limit), "geometric_limit", o.reach.geometric_limit);
    expect_setting(is_finite(o.reach.maximum_ratio) && o.reach.maximum_ratio >= 1, "maximum_ratio",
                   o.reach.maximum_ratio);
    expect_setting(positive(o.lookup.normal_limit) && o.lookup.normal_limit < 1.5, "normal_limit (in radians)",
                   o.lookup.normal_limit);
    expect_setting(positive(o.lookup.plane_tolerance), "plane_tolerance", o.lookup.plane_tolerance);
    expect_setting(is_finite(o.lookup.minimum_weight) && o.lookup.minimum_weight >= 0, "minimum_weight",
                   o.lookup.minimum_weight);
}

}  // namespace detail

/// A finished irradiance cache: only to be asked. Safe from many threads.
template <Spectrum S, std::floating_point T = band_of<S>, record_features Features = record_features{}>
class frozen_irradiance_cache {
public:
    using record = irradiance_record<S, T, Features>;
    using spectrum = S;
    using scalar = T;

    /// A record, and its error at its own radius relative to its irradiance.
    struct item {
        irradiance_record<S, T, Features> record;
        T bend;
    };

    /// Holds nothing and answers nothing.
    frozen_irradiance_cache() : frozen_irradiance_cache{std::vector<item>{}, irradiance_cache_options{}} {}

    /// Near items lie side by side in memory, whatever their numbers. Expects usable records.
    frozen_irradiance_cache(const std::vector<item>& items, const irradiance_cache_options& options)
        : options_{options}, limits_{options.lookup, options.reach.metric} {
        std::vector<stored_sphere<T>> spheres;
        spheres.reserve(items.size());
        for (const item& i : items) {
            const auto number = static_cast<std::uint32_t>(spheres.size());
            spheres.push_back({i.record.position(), limit2_of(i.record.longest_radius()), number});
        }
        reaches_ = packed_spheres<T>{std::move(spheres)};
        items_.reserve(items.size());
        places_.resize(items.size());
        reaches_.renumber([&](std::uint32_t i) {
            items_.push_back(items[i]);
            return places_[i] = size() - 1;
        });
    }

    /// Irradiance at `point` on the side of `normal` (unit); false where no record is acceptable.
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal) const {
        no_counters nothing;
        return lookup(point, normal, nothing);
    }
    template <typename Counters>
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal,
                                                 Counters& counters) const {
        record_blend<S, T> blend{point, normal, limits_};
        sphere_hits<T> near;
        reaches_.search(covering_question<T>{point}, near);
        const std::span<const std::uint32_t> numbers = near.items();
        blend.add(
            numbers.size(), [&](std::size_t i) -> const item& { return items_[numbers[i]]; },
            [&](detail::verdict v) { detail::count(counters, v); });
        const irradiance_answer<S, T> answer = blend.answer();
        detail::count_lookup(counters, static_cast<bool>(answer));
        return answer;
    }

    /// The same, and where the light comes from.
    [[nodiscard]] light_answer<S, T> light(const vec3<T>& point, const vec3<T>& normal) const
        requires(Features.incident) {
        light_blend<S, T> blend{point, normal, limits_};
        sphere_hits<T> near;
        reaches_.search(covering_question<T>{point}, near);
        for (const std::uint32_t number : near.items()) { blend.add(items_[number]); }
        return blend.answer();
    }

    /// What the record says that fits best, however badly: for the odd point between all reaches. Asks every record, so
    /// takes as long as a few gather rays. False only where no record faces the same half space.
    [[nodiscard]] irradiance_answer<S, T> nearest(const vec3<T>& point, const vec3<T>& normal) const {
        const item* best = nullptr;
        T least = std::numeric_limits<T>::infinity();
        for (const item& i : items_) {
            const frame<T> axes = i.record.axes();
            const T turn = length2(normal - axes.z) / 2;
            const T misfit = i.record.distance2(i.record.local(point, axes)) + turn / limits_.turn;
            if (turn < 1 && misfit < least) {
                least = misfit;
                best = &i;
            }
        }
        if (!best) { return {}; }
        const T error = static_cast<T>(max_component(best->record.irradiance())) * std::min(T(1), least * best->bend);
        return {best->record.irradiance(), error, limits_.weight, 1};
    }

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(items_.size()); }
    /// The record of number `index`, which is where it was in the items. Expects `index < size()`.
    [[nodiscard]] const record& operator[](std::uint32_t index) const { return items_[places_[index]].record; }
    [[nodiscard]] const irradiance_cache_options& options() const { return options_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const {
        return items_.capacity() * sizeof(item) + places_.capacity() * sizeof(std::uint32_t) + reaches_.bytes();
    }

private:
    std::vector<item> items_;
    std::vector<std::uint32_t> places_;  // of the items, by number
    irradiance_cache_options options_;
    detail::lookup_limits<T> limits_;
    packed_spheres<T> reaches_;
};

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
        detail::expect_setting(is_finite(scene_radius) && scene_radius > 0, "scene radius",
                               static_cast<double>(scene_radius));
    }
    explicit irradiance_cache(const bounds<T>& scene, const irradiance_cache_options& options = {})
        : irradiance_cache{scene.radius(), options} {}

    /// Irradiance at `point` on the side of `normal` (unit); false where no record is acceptable.
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal) const {
        no_counters nothing;
        return lookup(point, normal, nothing);
    }
    template <typename Counters>
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal,
                                                 Counters& counters) const {
        record_blend<S, T> blend{point, normal, limits_};
        const item* near[few];
        std::size_t count = 0;
        const auto add_near = [&] {
            blend.add(
                count, [&](std::size_t i) -> const item& { return *near[i]; },
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
        const T own = r.own_radius;
        if (options_.clamp_neighbours) { r.radius = std::max(r.lowest, clamped(e.position, own)); }
        const record made{e, r};
        const T bend = own_bend(r.radius);
        if (!tree_.insert({made, bend, own, r.lowest, tree_.size()}, made.position(), made.longest_radius())) {
            return refuse(record_status::bad_reach);
        }
        if (options_.clamp_neighbours) { clamp_others(e.position, own); }
        // What has settled is found faster, and at half as many more at a time settling costs some three steps each.
        if (size() >= settles_at_) {
            tree_.settle([](const item& i) { return i.record.longest_radius(); });
            settles_at_ = size() + size() / 2;
        }
        return record_status::inserted;
    }

    [[nodiscard]] std::uint32_t size() const { return tree_.size(); }
    [[nodiscard]] const record& operator[](std::uint32_t index) const { return tree_[index].record; }
    [[nodiscard]] const irradiance_cache_options& options() const { return options_; }
    [[nodiscard]] T scene_radius() const { return scene_radius_; }

    /// How many estimates were refused.
    [[nodiscard]] std::size_t refused() const { return refused_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const { return tree_.bytes(); }

    /// The records in their present reach and in their order, ready to be asked only. Each learns from its neighbours
    /// how far off its extrapolation is, and, with `smoothing`, what they take its irradiance to be.
    template <Executor E = in_sequence>
    [[nodiscard]] frozen freeze(const E& run = {}) const {
        std::vector<T> bends(size());
        for_each_record(run, [&](std::size_t i, const item& one) {
            bends[i] = detail::learnt_bend(tree_, one.record, own_bend(one.record.radius()), limits_);
        });
        std::vector<typename frozen::item> items(size());
        for_each_record(run, [&](std::size_t i, const item& one) {
            const bool smooth = options_.smoothing && Features.noise;
            const std::span<const T> all{bends};
            items[i] = {smooth ? detail::smoothed(tree_, one.record, all, limits_) : one.record, bends[i]};
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
        T bend;
        T own_radius;
        T lowest;
        std::uint32_t index;
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
        tree_.visit_covering(position, [&](const item& other) {
            const T limit = own + glm::distance(other.record.position(), position);
            const T radius = std::max(other.lowest, limit);
            if (radius < other.record.radius()) { shrunk.emplace_back(other.index, radius); }
        });
        for (const auto& [index, radius] : shrunk) {
            item& other = tree_[index];
            other.record = other.record.with_radius(radius);
            other.bend = own_bend(radius);
        }
    }

    /// What the rule that set the reach takes the error at the border to be, relative to the irradiance.
    [[nodiscard]] T own_bend(T radius) const {
        const T accuracy = static_cast<T>(options_.reach.accuracy);
        if (options_.reach.metric != error_metric::hessian) { return accuracy; }
        // Half of lambda R², where R = accuracy (4 scene² / lambda)^(1/4).
        return std::min(T(1), 2 * square(accuracy * accuracy * scene_radius_ / radius));
    }

    irradiance_cache_options options_;
    T scene_radius_;
    detail::lookup_limits<T> limits_;
    octree<item, T> tree_;
    std::uint32_t settles_at_{64};
    std::size_t refused_{0};
};

}  // namespace aglow
