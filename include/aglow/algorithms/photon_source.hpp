// Light along gather rays, read from precomputed irradiance where they land.
//
// Jensen 1996 with Christensen 1999: the photon map for all bounces but the last. Where a ray lands nearer than the
// photons' own spacing, the map knows no detail, and the ray goes on instead (a second gather).
#pragma once

#include <optional>

#include <aglow/algorithms/layers.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/estimators/irradiance_points.hpp>

namespace aglow {

/// How gather rays read the map.
struct photon_source_options {
    double near{1};        ///< a hit nearer than so many photon radii is gathered once more
    path_options paths{};  ///< for the rays that go on
};

namespace detail {

/// Notes faults where those of the picture's own paths are, if nowhere else.
inline void note_with(const path_options& paths, photon_source_options& source) {
    if (!source.paths.faults) { source.paths.faults = paths.faults; }
}

}  // namespace detail

/// A source of incoming light: mirrors and gloss are followed, diffuse surfaces read from the irradiance points. Keeps
/// references; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
class photon_source {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;

public:
    /// What gathering into it can meet.
    static constexpr lobe_set possible_lobes = static_lobes<World>;

    photon_source(lasting<World> scene, lasting<Lights> lights, lasting<irradiance_points<S, T>> points,
                  const photon_source_options& options = {})
        : scene_{*scene}, lights_{*lights}, points_{*points}, options_{options} {}

    /// Light that comes along `gather`; emission that the asker finds by himself is left to him.
    template <Numbers N>
    [[nodiscard]] incoming_light<S, T> incoming(const ray<T>& gather, const N& numbers,
                                                emission_rule rule = emission_rule::indirect) const {
        const auto read = [&](const hit_of<World>& hit, const vec3<T>& wo, T travelled, T error, bool mirrored) {
            return this->read(hit, wo, travelled, error, mirrored && rule == emission_rule::no_reflected);
        };
        return walk_path(scene_, lights_, gather, numbers, rule, options_.paths, read);
    }

private:
    [[nodiscard]] std::optional<estimate<S>> read(const hit_of<World>& hit, const vec3<T>& wo, T travelled, T error,
                                                  bool without_caustic) const {
        bool usable = true;
        const auto irradiance = [&](const vec3<T>& side) -> estimate<S> {
            const auto found = points_.nearest(vec3<T>(hit.position), side);
            usable = usable && found && travelled >= static_cast<T>(options_.near) * found->radius;
            if (!found) { return {}; }
            // Behind a thin wall lie points of the same plane and side.
            const vec3<T> lifted = side * error;
            usable =
                usable && !(found->cut && scene_.occluded(vec3<T>(hit.position) + lifted, found->position + lifted));
            return {without_caustic ? found->without_caustic : found->value, found->error, found->common, found->bias};
        };
        const estimate<S> radiance = diffuse_radiance<static_lobes<World>>(hit, wo, irradiance);
        if (!usable) { return std::nullopt; }
        return radiance;
    }

    const World& scene_;
    const Lights& lights_;
    const irradiance_points<S, T>& points_;
    photon_source_options options_;
};

template <Scene World, Illuminator Lights>
photon_source(const World&, const Lights&, const irradiance_points<spectrum_of<World>, scalar_of<World>>&,
              const photon_source_options& = {}) -> photon_source<World, Lights>;

}  // namespace aglow
