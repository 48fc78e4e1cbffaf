// A square light over the plane z = 0 with a smaller square between them, in closed form and as something to sample.
#pragma once

#include <limits>

#include <aglow/core/random.hpp>
#include <aglow/estimators/hemisphere.hpp>

#include "support/polygon.hpp"

namespace support {

struct occluded_light {
    bool occluded{true};
    double sky{0.2};            ///< radiance from wherever there is neither light nor occluder
    double occluder_glow{0.1};  ///< radiance of the occluder
    polygon light{{-1, -1, 2}, {1, -1, 2}, {1, 1, 2}, {-1, 1, 2}};
    polygon occluder{{-0.3, -0.2, 0.8}, {0.4, -0.2, 0.8}, {0.4, 0.3, 0.8}, {-0.3, 0.3, 0.8}};

    [[nodiscard]] double irradiance(const point3& x, const point3& n = {0, 0, 1}) const {
        const double lit = form_factor(x, n, light);
        const double near = occluded ? form_factor(x, n, occluder) : 0;
        const double shadow = occluded ? form_factor(x, n, hidden(x, light, occluder)) : 0;
        // The sky fills what neither covers; the whole hemisphere is 1.
        const double open = 1 - lit - near + shadow;
        return aglow::pi<double> * (lit - shadow + occluder_glow * near + sky * open);
    }

    [[nodiscard]] aglow::vec2<double> gradient(const point3& x) const {
        const double h = 1e-4;
        return {(irradiance({x.x + h, x.y, x.z}) - irradiance({x.x - h, x.y, x.z})) / (2 * h),
                (irradiance({x.x, x.y + h, x.z}) - irradiance({x.x, x.y - h, x.z})) / (2 * h)};
    }
};

/// One jittered hemisphere at `x`, whose axes are the world's.
template <typename T>
aglow::hemisphere_grid<T, T> sampled(const occluded_light& scene, const point3& x, const aglow::hemisphere_shape& shape,
                                     std::uint64_t seed) {
    aglow::hemisphere_grid<T, T> grid{shape};
    aglow::random_sampler<double> random{aglow::mix(seed, 77)};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const point3 d = aglow::hemisphere_direction<double>(shape, j, k, random.next_2d());
            const double near = scene.occluded ? hit(x, d, scene.occluder) : 0;
            const double far = hit(x, d, scene.light);
            const double radiance = near > 0 ? scene.occluder_glow : far > 0 ? 1 : scene.sky;
            const double distance = near > 0 ? near : far > 0 ? far : std::numeric_limits<double>::infinity();
            grid.set(j, k, static_cast<T>(radiance), static_cast<T>(distance), d, {0, 0, 1});
        }
    }
    return grid;
}

}  // namespace support
