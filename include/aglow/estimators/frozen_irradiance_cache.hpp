// Irradiance records that stay, only to be asked.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/packed_spheres.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_cache_options.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_pairs.hpp>
#include <aglow/estimators/record_view.hpp>

namespace aglow {

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
        : options_{options}, limits_{options.lookup, options.reach.metric, options.smoothing && Features.noise} {
        std::vector<stored_sphere<T>> spheres;
        spheres.reserve(items.size());
        for (const item& i : items) {
            const auto number = static_cast<std::uint32_t>(spheres.size());
            spheres.push_back({i.record.position(), limit2_of(i.record.longest_radius()), number});
        }
        reaches_ = packed_spheres<T>{std::move(spheres)};
        const std::vector<std::uint32_t> numbers = reaches_.hand_out_items();
        records_.resize(numbers.size());
        bends_.resize(numbers.size());
        places_.resize(items.size());
        for (std::uint32_t place = 0; place < numbers.size(); ++place) {
            if (numbers[place] == packed_spheres<T>::none) { continue; }
            const item& one = items[numbers[place]];
            records_[place].record = one.record;
            bends_[place] = one.bend;
            places_[numbers[place]] = place;
        }
    }

    /// Irradiance at `point` on the side of `normal` (unit); false where no record is acceptable. `counters` hears what
    /// became of each record.
    template <typename Counters = no_counters>
    [[nodiscard]] irradiance_answer<S, T> lookup(const vec3<T>& point, const vec3<T>& normal,
                                                 Counters&& counters = {}) const {
        sphere_hits<T> near;
        reaches_.search(covering_question<T>{point}, near);
        return blend(point, normal, near.items(), counters);
    }

    /// Looks up every place, which has a `position` and a unit `normal`: `answers[i]` becomes what `lookup` says of
    /// `places[i]`; to the bit on x86-64, elsewhere a compiler may round otherwise. Of gray or RGB light one and a half
    /// times as fast, more where places in a row lie together; and memory is asked for ahead, so that places in no
    /// order are answered two and a half times as fast of a hundred thousand records and more. Expects as many answers
    /// as places.
    template <typename Place>
    void lookup_each(std::span<const Place> places, std::span<irradiance_answer<S, T>> answers) const {
        no_counters nothing;
        const auto blend_one = [&](std::size_t i, std::span<const std::uint32_t> near) {
            answers[i] = blend(places[i].position, places[i].normal, near, nothing);
        };
        const auto position = [&](std::size_t i) -> const auto& { return places[i].position; };
        if constexpr (detail::has_lanes<S, T>) {
            detail::record_pairs<S, Features, kept> pairs{records_.data(), bends_.data(), limits_};
            const bool far = bytes() > simd::near_memory;
            reaches_.search_each(places.size(), position, [&](std::size_t i, std::span<const std::uint32_t> near) {
                if (near.size() > pairs.most) { return blend_one(i, near); }
                if (far) { expect(near); }
                pairs.add(places[i].position, places[i].normal, near, answers[i]);
            });
            pairs.finish();
        } else {
            reaches_.search_each(places.size(), position, blend_one);
        }
    }

    /// The same, and where the light comes from.
    [[nodiscard]] light_answer<S, T> light(const vec3<T>& point, const vec3<T>& normal) const
        requires(Features.incident) {
        light_blend<S, T> blend{point, normal, limits_};
        sphere_hits<T> near;
        reaches_.search(covering_question<T>{point}, near);
        for (const std::uint32_t place : near.items()) { blend.add(at(place)); }
        return blend.answer();
    }

    /// What the record says that fits best, however badly: for the odd point between all reaches. Asks every record, so
    /// takes as long as a few gather rays. False only where no record faces the same half space.
    [[nodiscard]] irradiance_answer<S, T> nearest(const vec3<T>& point, const vec3<T>& normal) const {
        std::uint32_t best = packed_spheres<T>::none;
        T least = std::numeric_limits<T>::infinity();
        for (const std::uint32_t place : places_) {
            const record& r = records_[place].record;
            const frame<T> axes = r.axes();
            const T turn = length2(normal - axes.z) / 2;
            const T misfit = r.distance2(r.local(point, axes)) + turn / limits_.turn;
            if (turn < 1 && misfit < least) {
                least = misfit;
                best = place;
            }
        }
        if (best == packed_spheres<T>::none) { return {}; }
        const S& irradiance = records_[best].record.irradiance();
        T error = std::min(T(1), least * bends_[best]);
        if constexpr (Features.noise) { error += records_[best].record.relative_noise(); }
        return {irradiance, static_cast<T>(max_component(irradiance)) * error, limits_.weight, 1};
    }

    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(places_.size()); }
    /// The record of number `index`, which is where it was in the items. Expects `index < size()`.
    [[nodiscard]] const record& operator[](std::uint32_t index) const { return records_[places_[index]].record; }
    [[nodiscard]] const irradiance_cache_options& options() const { return options_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const {
        return records_.capacity() * sizeof(kept) + bends_.capacity() * sizeof(T) +
               places_.capacity() * sizeof(std::uint32_t) + reaches_.bytes();
    }

private:
    // As few lines of memory to a record as there can be.
    struct alignas(sizeof(record) % 64 == 0 ? 64 : alignof(record)) kept {
        irradiance_record<S, T, Features> record;
    };
    struct near_record {
        const irradiance_record<S, T, Features>& record;
        T bend;
    };
    [[nodiscard]] near_record at(std::uint32_t place) const { return {records_[place].record, bends_[place]}; }

    template <typename Counters>
    [[nodiscard]] irradiance_answer<S, T> blend(const vec3<T>& point, const vec3<T>& normal,
                                                std::span<const std::uint32_t> places, Counters& counters) const {
        record_blend<S, T> blend{point, normal, limits_};
        blend.add(
            places.size(), [&](std::size_t i) { return at(places[i]); },
            [&](detail::verdict v) { detail::count(counters, v); });
        const irradiance_answer<S, T> answer = blend.answer();
        detail::count_lookup(counters, static_cast<bool>(answer));
        return answer;
    }

    void expect(std::span<const std::uint32_t> places) const {
        for (const std::uint32_t place : places) {
            simd::prefetch(&records_[place]);
            simd::prefetch(&bends_[place]);
        }
    }

    std::vector<kept> records_;          // by place
    std::vector<T> bends_;               // likewise
    std::vector<std::uint32_t> places_;  // of the items, by number
    irradiance_cache_options options_;
    detail::lookup_limits<T> limits_;
    packed_spheres<T> reaches_;
};

}  // namespace aglow
