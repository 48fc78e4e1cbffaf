// What to ask of photon tracing, and what comes back: three maps that know how they came about.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include <aglow/algorithms/energy_ledger.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/estimators/photon_map.hpp>

namespace aglow {

/// Emitted paths that each map takes its photons from.
struct photon_paths {
    std::size_t direct{0};
    std::size_t caustic{0};
    std::size_t indirect{0};
    std::size_t reflected{0};
};

/// How many photons, and how.
struct photon_options {
    std::size_t direct{0};               ///< photons wanted straight from the lights; 0 leaves the map out
    std::size_t caustic{0};              ///< wanted over specular surfaces only; 0 leaves the map out, and such
                                         ///< photons are among the indirect ones
    std::size_t indirect{0};             ///< wanted after a diffuse or glossy bounce; 0 leaves the map out
    std::size_t reflected{0};            ///< wanted of the indirect ones that were a caustic before their only such
                                         ///< bounce, in a map of their own as well; needs a caustic map
    std::size_t most_paths{16'000'000};  ///< paths emitted at the most, whatever is still wanted, the pilot apart
    std::size_t pilot_paths{8192};       ///< paths of the pilot that finds out how many are needed
    double full_share{0.25};             ///< share of all light from which on indirect light is worth all photons that
                                         ///< are wanted (closed rooms have about a half); below, as many as bring no
                                         ///< more noise, share / sqrt(photons), and the paths of 32 pilots at least.
                                         ///< Likewise reflected caustics beside the caustics. 0 seeks all, as for a
                                         ///< dim room behind a garden in the sun
    photon_paths paths{};                ///< of each map, where known from an earlier pass, whose `most_bounces` belong
                                         ///< to them; 0: the pilot finds out
    std::uint32_t most_bounces{0};       ///< depth cap; 0 for none: roulette ends paths without bias. Where half of
                                         ///< the pilot's paths meet 4096 surfaces, that is the cap: `capped` tells
    std::uint64_t seed{0};               ///< another seed, another picture
    std::uint64_t pass{0};               ///< of a progressive rendering
    callback<double> progress{};         ///< told the share done, from any thread; false stops early
};

/// How a photon map came out.
enum class map_status {
    left_out,  ///< not wanted, or the scene cannot have such light
    full,      ///< about as many photons as wanted
    partly,    ///< fewer than wanted: the light is rare and not worth more paths, or has no more; or it was stopped
    empty      ///< none landed
};

/// A photon map, and how it came about.
template <Spectrum S, std::floating_point T>
struct traced_map : photon_map<S, T> {
    map_status status{map_status::left_out};
    std::size_t wanted{0};
    std::size_t paths{0};  ///< emitted paths that could have stored here: what its power was divided by
    std::string why{};     ///< one clause for people, such as "left out, no specular surface"; also of what hosts did
                           ///< wrong: "full, 73 of 9000 particles dropped: normals that are not unit"
    double common{0};      ///< standard error of the whole map's flux over the flux: what no estimate can average away
};

/// What `trace_photons` gives back.
template <Spectrum S, std::floating_point T>
struct photon_maps {
    traced_map<S, T> direct{};
    traced_map<S, T> caustic{};
    traced_map<S, T> indirect{};
    traced_map<S, T> reflected{};  ///< a part of `indirect` once more, for gathers that leave it out
    energy_ledger<S> ledger{};
    std::uint32_t most_bounces{0};  ///< the depth cap that held, asked for or found by the pilot; 0 for none

    [[nodiscard]] std::size_t size() const { return direct.size() + caustic.size() + indirect.size(); }
};

}  // namespace aglow
