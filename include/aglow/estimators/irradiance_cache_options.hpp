// The settings of an irradiance cache, and whether they make sense.
#pragma once

#include <stdexcept>
#include <string>

#include <aglow/core/numbers.hpp>
#include <aglow/core/significant.hpp>
#include <aglow/estimators/record_reach.hpp>
#include <aglow/estimators/record_view.hpp>

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

namespace detail {

/// Throws `std::invalid_argument` that names the setting and its value.
inline void expect_setting(bool good, const char* name, double value) {
    if (!good) { throw std::invalid_argument("aglow: " + std::string{name} + " is " + significant(value)); }
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

}  // namespace aglow
