// Progressive photon mapping: passes with ever smaller radii, averaged; the bias goes to nothing with the noise.
//
// Knaus & Zwicker 2011: passes that remember nothing, so any order and any machine gives the same average. The first
// radius is local, the distance of the k-th photon; the share of it that is used shrinks by their rule.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/core/log_gamma.hpp>
#include <aglow/core/significant.hpp>

namespace aglow {

/// Squared radius of pass `i` (from 1) over that of the first, for shrinking by `alpha` in (0, 1): the closed form of
/// r²(i+1) / r²(i) = (i + alpha) / (i + 1) (Knaus & Zwicker 2011, (20)), which no product of passes can wear down.
[[nodiscard]] inline double radius2_share(double i, double alpha) {
    if (!(i > 1)) { return 1; }  // exactly, whatever the compiler makes of the differences
    return std::exp(log_gamma(i + alpha) - log_gamma(1 + alpha) - log_gamma(i + 1));
}

/// How passes are made.
struct progressive_options {
    std::size_t caustic{100'000};   ///< caustic photons per pass
    std::size_t indirect{100'000};  ///< indirect photons per pass
    double alpha{2.0 / 3};          ///< how slowly radii shrink, in (0, 1); 2/3 is the best rate
    density_options density{};      ///< of the first pass
    std::uint64_t seed{0};
};

/// Renders a film pass by pass. Keeps references to scene and lights; one thread at a time may call it.
template <Scene World, Illuminator Lights>
    requires Emitter<Lights>
class progressive_photon_mapping {
    using S = spectrum_of<World>;

public:
    /// Throws `std::invalid_argument` for an alpha outside (0, 1).
    progressive_photon_mapping(lasting<World> scene, lasting<Lights> lights, const progressive_options& options = {})
        : scene_{*scene}, lights_{*lights}, options_{options} {
        if (!(options.alpha > 0 && options.alpha < 1)) {
            throw std::invalid_argument("progressive_options.alpha must lie in (0, 1): " + significant(options.alpha));
        }
    }

    /// Traces one more set of photons and adds one sample to every pixel.
    template <typename Eye, Executor Run = in_sequence>
    void pass(film<S>& onto, const Eye& eye, const Run& run = {}) {
        const auto maps = trace_photons(scene_, lights_,
                                        {.caustic = options_.caustic,
                                         .indirect = options_.indirect,
                                         .paths = paths_,
                                         .most_bounces = most_bounces_,
                                         .seed = options_.seed,
                                         .pass = passes_},
                                        run);
        paths_ = {.caustic = maps.caustic.paths, .indirect = maps.indirect.paths};
        most_bounces_ = maps.most_bounces;
        ++passes_;
        density_options density = options_.density;
        density.shrink *= std::sqrt(radius2_share(static_cast<double>(passes_), options_.alpha));
        const layered_integrator integrator{scene_, lights_,
                                            layer_sum{direct_layer{scene_, lights_}, map_layer{maps.caustic, density},
                                                      map_layer{maps.indirect, density}}};
        onto.expose(eye, integrator, {.samples = 1, .seed = options_.seed, .fresh = true}, run);
    }

    [[nodiscard]] std::uint64_t passes() const { return passes_; }

private:
    const World& scene_;
    const Lights& lights_;
    progressive_options options_;
    photon_paths paths_{};
    std::uint32_t most_bounces_{0};  // of the first pass, so that all see the same light
    std::uint64_t passes_{0};
};

template <Scene World, Illuminator Lights>
progressive_photon_mapping(const World&, const Lights&, const progressive_options& = {})
    -> progressive_photon_mapping<World, Lights>;

}  // namespace aglow
