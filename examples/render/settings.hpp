// What the options of a command mean to the library's methods.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/photon_integrators.hpp>

#include "render/options.hpp"

namespace host {

/// The settings of every method.
class render_settings {
public:
    /// Keeps a reference.
    explicit render_settings(const render_options& options) : options_{options} {}

    [[nodiscard]] aglow::density_options density() const {
        aglow::density_options d;
        d.count = options_.photons_per_estimate.value_or(d.count);
        return d;
    }
    [[nodiscard]] aglow::photon_mapping_options photon_mapping() const {
        aglow::photon_mapping_options o;
        o.photons = photons(o.photons);
        o.density = density();
        o.direct_from_map = o.photons.direct > 0;
        return o;
    }
    [[nodiscard]] aglow::final_gathering_options final_gathering() const {
        aglow::final_gathering_options o;
        set_maps(o);
        o.rays = options_.gather_rays.value_or(o.rays);
        return o;
    }
    [[nodiscard]] aglow::gather_caching_options gather_caching() const {
        aglow::gather_caching_options o;
        set_maps(o);
        o.caching = caching();
        return o;
    }
    [[nodiscard]] aglow::caching_options caching() const {
        aglow::caching_options c;
        c.view.width = options_.width;
        c.view.height = options_.height;
        c.view.seed = options_.seed;
        c.fill.seed = options_.seed;
        if (options_.until > 0) {
            c.fill.rays = static_cast<std::uint32_t>(std::max(16.0, 100 * fineness() * fineness()));
            c.cache.reach.accuracy = 0.12 * std::pow(fineness(), -0.6);
        }
        c.fill.rays = options_.gather_rays.value_or(c.fill.rays);
        c.cache.reach.accuracy = options_.accuracy.value_or(c.cache.reach.accuracy);
        c.caustics.photons = photons(c.caustics.photons);
        c.caustics.photons.direct = c.caustics.photons.indirect = 0;  // its rays find such light without photons
        c.caustics.density = density();
        return c;
    }

private:
    /// How much finer maps and caches must be than for an error of 5 %, which is where picture and audits together are
    /// cheapest with the numbers here; their own error falls with the square root of rays, and slower with photons.
    [[nodiscard]] double fineness() const { return std::clamp(0.05 / options_.until, 0.25, 25.0); }

    [[nodiscard]] aglow::photon_options photons(aglow::photon_options wanted) const {
        if (options_.until > 0) {
            const auto times = [&](std::size_t count, double factor) {
                return static_cast<std::size_t>(static_cast<double>(count) * factor);
            };
            wanted.indirect = times(wanted.indirect, 0.5 * std::pow(fineness(), 1.5));
            wanted.caustic = times(wanted.caustic, std::max(1.0, std::pow(fineness(), 1.5)));
        }
        wanted.direct = options_.direct_photons.value_or(wanted.direct);
        wanted.caustic = options_.caustic_photons.value_or(wanted.caustic);
        wanted.indirect = options_.indirect_photons.value_or(wanted.indirect);
        if (options_.indirect_photons) { wanted.full_share = 0; }  // who names a number wants them all
        wanted.seed = options_.seed;
        return wanted;
    }

    /// The photon maps of a method that gathers, and how they are read.
    template <typename Options>
    void set_maps(Options& o) const {
        o.photons = photons(o.photons);
        o.density = density();
        o.irradiance.density.count = o.density.count;
        o.irradiance.seed = options_.seed;
    }

    const render_options& options_;
};

}  // namespace host
