// Indirect light on matte lobes from an irradiance cache, and what the gather rays of its records read.
#pragma once

#include <cmath>
#include <concepts>
#include <cstdint>

#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/incoming_light.hpp>
#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/algorithms/photon_options.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/estimators/estimate.hpp>

namespace aglow {

/// What gather rays for records bring from `Source`, by path tracing alone: mirrors are for them to find.
template <typename Source>
struct ray_reader {
    Source source;

    template <typename R, Numbers N>
    [[nodiscard]] auto operator()(const R& r, const N& numbers) const {
        return source.incoming(r, numbers, emission_rule::indirect);
    }
};

/// What gather rays for records bring from `Source` beside a caustic map. Caustics that were reflected once are left
/// out of the rays, which would find the small bright spots by chance, and added from their own map: evenly, from many
/// photons.
template <typename Source, Spectrum S, std::floating_point T>
struct caustic_reader {
    Source source;
    emission_rule caustics;
    const traced_map<S, T>& reflected;
    density_options density;

    template <Numbers N>
    [[nodiscard]] auto operator()(const ray<T>& r, const N& numbers) const {
        return source.incoming(r, numbers, caustics);
    }
    [[nodiscard]] estimate<S> unseen(const gather_point<T>& at) const {
        return told_by(reflected, {.common = reflected.common}, at.position, at.normal, density);
    }
};

/// Layer: indirect light on diffuse lobes from a cache; where it has no record, from a small gather of its own into
/// `Reader` (see `IncomingLight`, `KnowsUnseen`).
template <typename Cache, typename Reader>
class cache_layer {
public:
    /// `shared`: what all that `reader` brings is off by together.
    cache_layer(lasting<Cache> cache, Reader reader, const shared_error& shared = {},
                const hemisphere_shape& fallback = {2, 8})
        : cache_{*cache}, reader_{reader}, shared_{shared}, fallback_{fallback} {}

    template <Surface H, Numbers N>
    [[nodiscard]] estimate<surface_spectrum<H>> operator()(const H& hit, const vec3<hit_scalar<H>>& wo,
                                                           hit_scalar<H> error, const N& numbers,
                                                           std::uint32_t bounce) const {
        using S = surface_spectrum<H>;
        using T = hit_scalar<H>;
        return diffuse_radiance(hit, wo, [&](const vec3<T>& side) -> estimate<S> {
            const auto answer = cache_.lookup(vec3<T>(hit.position), side);
            if (answer) { return shared_.on(answer.irradiance, static_cast<band_of<S>>(answer.error)); }
            const gather_point<T> here{vec3<T>(hit.position), side, error};
            S gathered = gather_once(reader_, here, N{numbers.fork(bounce)}, fallback_);
            if constexpr (KnowsUnseen<Reader, T>) { gathered = gathered + reader_.unseen(here).value; }
            return shared_.on(gathered,
                              max_component(gathered) / std::sqrt(static_cast<band_of<S>>(fallback_.count())));
        });
    }

private:
    const Cache& cache_;
    Reader reader_;
    shared_error shared_;
    hemisphere_shape fallback_;
};

template <typename Cache, typename Reader>
cache_layer(const Cache&, Reader, const shared_error& = {}, const hemisphere_shape& = {2, 8})
    -> cache_layer<Cache, Reader>;

}  // namespace aglow
