// What a fill pass is asked, and what it tells: the words of fill_cache.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include <aglow/algorithms/gather.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/estimators/irradiance_cache_options.hpp>

namespace aglow {

/// A place that may need a record. The other side of a surface that lets light through is a candidate of its own, with
/// the normal turned round.
template <std::floating_point T>
struct cache_candidate {
    gather_point<T> place{};
    T footprint{};        ///< diameter of a pixel there, 0 where none is meant
    std::uint64_t key{};  ///< names the candidate: what its random numbers are drawn from
};

/// How a cache is filled.
struct fill_cache_options {
    /// Rays of each hemisphere, about.
    std::uint32_t rays{350};

    /// How far so many gather rays may differ from their mean, in units of it. Where they differ more, as where light
    /// comes through a slit, the hemispheres get 4 or 16 times as many, whichever is nearest to what that calls for.
    /// Records must keep their noise. 0: the same for all.
    double scatter{0.9};

    /// A record whose noise, relative to its light, is below this has rays enough, however they scatter.
    double noise{0.048};

    /// Names the run of random numbers.
    std::uint64_t seed{0};

    /// The sum of weights that a candidate wants. Well above the cache's own `minimum_weight`: several records at each
    /// point average their noise, and the picture finds enough between candidates too.
    double minimum_weight{0.5};

    /// The spacing of each round relative to the one before, in (0, 1).
    double refinement{0.7};

    /// The most records in the cache; the coarsest come first. 0: no limit.
    std::size_t maximum_records{0};
};

/// How far a fill pass is: told after each batch of gathers.
struct fill_progress {
    std::size_t records;     ///< inserted so far
    std::size_t candidates;  ///< in all
    std::size_t uncovered;   ///< not covered when the present round began; in the end, without cover
    double sharpened{0};     ///< share of the rays done that go where those before scattered; they come last
};

/// What a fill pass did.
struct fill_result {
    std::size_t records{0};     ///< inserted
    std::size_t refused{0};     ///< gathered but refused by the cache
    std::uint64_t rays{0};      ///< shot
    std::uint64_t rejected{0};  ///< of these, how many brought no number
    std::size_t rounds{0};
    std::size_t uncovered{0};  ///< candidates without cover in the end
    bool cancelled{false};
};

/// A source of incoming light that knows of irradiance which its rays do not bring: `unseen(gather_point)`, an
/// `estimate` in W/m².
template <typename F, typename T>
concept KnowsUnseen = requires(const F& incoming, const gather_point<T>& at) {
    incoming.unseen(at).value;
    incoming.unseen(at).error;
};

namespace detail {

/// Throws `std::invalid_argument` for options that make no sense.
inline void check(const fill_cache_options& o) {
    expect_setting(o.rays > 0, "rays", o.rays);
    expect_setting(is_finite(o.minimum_weight) && o.minimum_weight >= 0, "minimum_weight", o.minimum_weight);
    expect_setting(is_finite(o.scatter) && o.scatter >= 0, "scatter", o.scatter);
    expect_setting(is_finite(o.noise) && o.noise >= 0, "noise", o.noise);
    expect_setting(o.refinement > 0 && o.refinement <= 0.95, "refinement", o.refinement);
}

}  // namespace detail

}  // namespace aglow
