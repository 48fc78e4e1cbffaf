// The inside of the cube [-1, 1]³ whose walls glow, each with a radiance of its own: irradiance in closed form.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/estimators/hemisphere.hpp>

#include "support/polygon.hpp"

namespace support {

struct glowing_room {
    /// Radiance of the walls at -x, +x, -y, +y, -z, +z.
    std::array<aglow::vec3<double>, 6> glow{
        {{1, 0.2, 0.1}, {0.1, 0.6, 0.2}, {0.3, 0.3, 0.3}, {0.5, 0.5, 0.4}, {0.2, 0.2, 0.2}, {2, 2, 1.5}}};
    double size{1};

    [[nodiscard]] static polygon wall(int i, double s) {
        const int axis = i / 2;
        const double at = i % 2 ? s : -s;
        polygon p;
        for (const auto& [a, b] : {std::pair{-s, -s}, {s, -s}, {s, s}, {-s, s}}) {
            point3 c;
            c[axis] = at;
            c[(axis + 1) % 3] = a;
            c[(axis + 2) % 3] = b;
            p.push_back(c);
        }
        return p;
    }

    /// Irradiance at a point on a wall or inside.
    [[nodiscard]] point3 irradiance(const point3& x, const point3& n) const {
        point3 sum{0};
        for (int i = 0; i < 6; ++i) {
            const double height = (i % 2 ? size : -size) - x[i / 2];
            if (std::abs(height) < 1e-9 * size) { continue; }
            sum += glow[static_cast<std::size_t>(i)] * (aglow::pi<double> * form_factor(x, n, wall(i, size)));
        }
        return sum;
    }

    /// How irradiance changes along x and y on the wall at -z.
    [[nodiscard]] aglow::vec2<double> gradient(const point3& x) const {
        const double h = 1e-4 * size;
        const auto at = [&](double dx, double dy) { return irradiance(x + point3{dx, dy, 0}, {0, 0, 1}).y; };
        return {(at(h, 0) - at(-h, 0)) / (2 * h), (at(0, h) - at(0, -h)) / (2 * h)};
    }

    /// Which wall a ray from inside meets, and how far away.
    template <typename T>
    [[nodiscard]] std::pair<int, T> meet(const aglow::ray<T>& r) const {
        T nearest = std::numeric_limits<T>::infinity();
        int found = 0;
        for (int a = 0; a < 3; ++a) {
            if (r.direction[a] == 0) { continue; }
            const int i = 2 * a + (r.direction[a] > 0 ? 1 : 0);
            const T t = ((r.direction[a] > 0 ? T(size) : -T(size)) - r.origin[a]) / r.direction[a];
            if (t > 0 && t < nearest) {
                nearest = t;
                found = i;
            }
        }
        return {found, nearest};
    }
};

/// One jittered hemisphere of the second band at `x` on the wall at -z, whose axes are the world's.
[[nodiscard]] inline aglow::hemisphere_grid<double, double> seen_in(const glowing_room& room, const point3& x,
                                                                    const aglow::hemisphere_shape& shape,
                                                                    std::uint64_t seed) {
    aglow::hemisphere_grid<double, double> grid{shape};
    aglow::random_sampler<double> random{aglow::mix(seed, 78)};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const point3 d = aglow::hemisphere_direction<double>(shape, j, k, random.next_2d());
            const auto [wall, distance] = room.meet(aglow::ray<double>{x, d});
            point3 normal{0};
            normal[wall / 2] = wall % 2 ? -1 : 1;
            grid.set(j, k, room.glow[static_cast<std::size_t>(wall)].y, distance, d, normal);
        }
    }
    return grid;
}

}  // namespace support
