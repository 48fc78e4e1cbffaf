// Irradiance from polygons in closed form: Lambert's formula, with horizon and one convex occluder.
#pragma once

#include <cmath>
#include <vector>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace support {

using point3 = aglow::vec3<double>;
using polygon = std::vector<point3>;

/// The part of a convex polygon where dot(p - origin, inwards) >= 0.
inline polygon clipped(const polygon& p, const point3& origin, const point3& inwards) {
    polygon out;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const point3& a = p[i];
        const point3& b = p[(i + 1) % p.size()];
        const double da = glm::dot(a - origin, inwards);
        const double db = glm::dot(b - origin, inwards);
        if (da >= 0) { out.push_back(a); }
        if ((da < 0) != (db < 0)) { out.push_back(a + (b - a) * (da / (da - db))); }
    }
    return out;
}

/// Form factor of a polygon at `x` with unit normal `n`, whichever way its corners run (Lambert 1760, Arvo 1994).
inline double form_factor(const point3& x, const point3& n, const polygon& whole) {
    const polygon p = clipped(whole, x, n);
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const point3 a = p[i] - x;
        const point3 b = p[(i + 1) % p.size()] - x;
        const point3 c = glm::cross(a, b);
        const double sine = glm::length(c);
        if (sine > 0) { sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(n, c) / sine; }
    }
    return std::abs(sum) / (2 * aglow::pi<double>);
}

/// Irradiance at `x` from a polygon of radiance 1.
inline double irradiance(const point3& x, const point3& n, const polygon& light) {
    return aglow::pi<double> * form_factor(x, n, light);
}

/// The part of a convex `light` that a convex `occluder`, nearer to `x`, hides.
inline polygon hidden(const point3& x, polygon light, const polygon& occluder) {
    point3 middle{0};
    for (const point3& p : occluder) { middle += p / static_cast<double>(occluder.size()); }
    for (std::size_t i = 0; i < occluder.size() && !light.empty(); ++i) {
        point3 side = glm::cross(occluder[i] - x, occluder[(i + 1) % occluder.size()] - x);
        if (glm::dot(side, middle - x) < 0) { side = -side; }
        light = clipped(light, x, side);
    }
    return light;
}

/// Whether the ray from `x` along `d` meets a convex polygon; the distance, else 0.
inline double hit(const point3& x, const point3& d, const polygon& p) {
    const point3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double along = glm::dot(d, n);
    if (along == 0) { return 0; }
    const double t = glm::dot(p[0] - x, n) / along;
    if (!(t > 0)) { return 0; }
    const point3 at = x + d * t;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (glm::dot(glm::cross(p[(i + 1) % p.size()] - p[i], at - p[i]), n) < 0) { return 0; }
    }
    return t;
}

}  // namespace support
