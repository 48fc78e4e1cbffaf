// The reference: path tracing, slow and right, the judge of all others.
//
// Kajiya 1986, with next-event estimation, multiple importance sampling and Russian roulette; unbiased, no depth cap
// unless asked for.
#pragma once

#include <aglow/algorithms/path_walk.hpp>
#include <aglow/core/lasting.hpp>

namespace aglow {

/// An integrator: radiance along a ray by path tracing. Keeps references; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
class path_tracer {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    path_tracer(lasting<World> scene, lasting<Lights> lights, const path_options& options = {})
        : scene_{*scene}, lights_{*lights}, options_{options} {}

    /// Radiance that comes back along `eye`, W/(m² sr); unbiased without `most_bounces`, so its own error guess is 0.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        return {walk_path<true>(scene_, lights_, eye, numbers, emission_rule::all, options_).radiance, 0};
    }

    /// Light that comes along a gather ray; emission that the asker finds by himself is left to him.
    template <Numbers N>
    [[nodiscard]] incoming_light<spectrum, scalar> incoming(const ray<scalar>& gather, const N& numbers,
                                                            emission_rule rule = emission_rule::indirect) const {
        return walk_path(scene_, lights_, gather, numbers, rule, options_);
    }

    /// The same, but for where the host's faults are noted: there, if the options name no place.
    [[nodiscard]] path_tracer watched(host_faults& faults) const {
        path_tracer same = *this;
        if (!same.options_.faults) { same.options_.faults = &faults; }
        return same;
    }
    /// Where the host's faults are noted; null for nowhere.
    [[nodiscard]] const host_faults* faults() const { return options_.faults; }

private:
    const World& scene_;
    const Lights& lights_;
    path_options options_;
};

template <Scene World, Illuminator Lights>
path_tracer(const World&, const Lights&, const path_options& = {}) -> path_tracer<World, Lights>;

/// Radiance along one ray by path tracing, for a host that wants no object.
template <Scene World, Illuminator Lights, Numbers N>
[[nodiscard, gnu::always_inline]] inline spectrum_of<World> path_trace(const World& scene, const Lights& lights,
                                                                       const ray<scalar_of<World>>& eye,
                                                                       const N& numbers,
                                                                       const path_options& options = {}) {
    return walk_path<true>(scene, lights, eye, numbers, emission_rule::all, options).radiance;
}

}  // namespace aglow
