// What the light is in scenes that a page of algebra can solve. Depends on the standard library alone.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace stability {

using std::numbers::pi;

/// Radiance anywhere in a closed room whose walls all have one albedo and glow with radiance 1.
[[nodiscard]] inline double furnace(double albedo) { return 1 / (1 - albedo); }

/// Indirect irradiance anywhere on the wall of a matte sphere around a light of `power` W, wherever the light is.
[[nodiscard]] inline double sphere_indirect(double power, double albedo, double radius) {
    return power * albedo / (4 * pi * radius * radius * (1 - albedo));
}

/// Radiance of the wall of an integrating sphere after the first strike of `power` W is spread by it; a fraction `port`
/// of the sphere is open.
[[nodiscard]] inline double integrating_sphere(double power, double albedo, double radius, double port) {
    const double area = 4 * pi * radius * radius;
    return power / (pi * area) * albedo / (1 - albedo * (1 - port));
}

struct pair_of_surfaces {
    double first;
    double second;
};

/// Radiosities of two surfaces that emit `e1` and `e2` with albedos `r1` and `r2`: the second sees the first with form
/// factor `f21` and itself with the rest, the first sees nothing but the second.
[[nodiscard]] inline pair_of_surfaces enclosure(double e1, double r1, double e2, double r2, double f21) {
    // B1 = e1 + r1 B2;  B2 = e2 + r2 (f21 B1 + (1 - f21) B2)
    const double b2 = (e2 + r2 * f21 * e1) / (1 - r2 * (1 - f21) - r2 * f21 * r1);
    return {e1 + r1 * b2, b2};
}

/// Radiosities of two equal spheres that meet at a common cap, a fraction `port` of each; the walls of the first glow.
[[nodiscard]] inline pair_of_surfaces kissing_spheres(double albedo, double port) {
    const double k = albedo * port / (1 - albedo * (1 - port));
    const double first = 1 / (1 - albedo * (1 - port) - albedo * port * k);
    return {first, k * first};
}

/// The second eigenvalue of the same: how slowly the two spheres come to agree.
[[nodiscard]] inline double kissing_spheres_second(double albedo, double port) { return albedo * (1 - 2 * port); }

/// Transmittance of `n` lossless sheets of reflectance `r` with all reflections between them.
[[nodiscard]] inline double stack_transmittance(double r, int n) { return (1 - r) / (1 + (n - 1) * r); }

/// Reflectance of a smooth boundary at normal incidence.
[[nodiscard]] inline double normal_reflectance(double index) {
    const double root = (index - 1) / (index + 1);
    return root * root;
}

/// Form factor between two equal parallel squares of side 1 at distance `d` (Howell C-11).
[[nodiscard]] inline double parallel_squares(double d) {
    const double x = 1 / d;
    const double q = std::sqrt(1 + x * x);
    const double logs = std::log((1 + x * x) / std::sqrt(1 + 2 * x * x));
    return 2 / (pi * x * x) * (logs + 2 * x * q * std::atan(x / q) - 2 * x * std::atan(x));
}

/// Form factor between two unit squares at right angles that share an edge (Howell C-14).
[[nodiscard]] inline double perpendicular_squares() {
    const double root = std::sqrt(2.0);
    const double logs = std::log(4.0 / 3) + std::log(3.0 / 4) + std::log(3.0 / 4);
    return (2 * std::atan(1.0) - root * std::atan(1 / root) + logs / 4) / pi;
}

/// Form factor from a disc of radius `r1` to a coaxial parallel one of radius `r2` at distance `h` (Howell C-41).
[[nodiscard]] inline double coaxial_discs(double r1, double r2, double h) {
    const double x = r1 / h;
    const double y = r2 / h;
    const double s = 1 + (1 + y * y) / (x * x);
    return (s - std::sqrt(s * s - 4 * (y / x) * (y / x))) / 2;
}

/// Irradiance on the axis of a disc of radiance 1.
[[nodiscard]] inline double under_disc(double radius, double height) {
    return pi * radius * radius / (radius * radius + height * height);
}

/// Share of the disc of a density estimate that lies on the surface, where its border is `t` radii away.
[[nodiscard]] inline double share_at_border(double t) {
    return t >= 1 ? 1 : 1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / pi;
}

/// Flux that a paraboloid of focal length `f` around a point light of intensity 1 throws within radius `s` of its axis:
/// the integral of I / (f + s²/4f)².
[[nodiscard]] inline double paraboloid_flux(double f, double s) {
    const double u = s * s / (4 * f);
    return 4 * pi * u / (f + u);
}

/// A corner of a polygon.
template <typename T>
using corner = std::array<T, 3>;

/// Lambert's formula by atan2, and the sum of the magnitudes of its terms, which its rounding error is measured by.
template <typename T>
struct lambert_sum {
    T irradiance;  ///< of a polygon of radiance 1, at the origin with normal +z
    T magnitude;
};

/// Irradiance at the origin, normal +z, from a polygon of radiance 1: clipped by the horizon, in any scalar.
template <typename T>
[[nodiscard]] lambert_sum<T> lambert_polygon(const std::vector<corner<T>>& whole) {
    std::vector<corner<T>> p;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const corner<T>& a = whole[i];
        const corner<T>& b = whole[(i + 1) % whole.size()];
        if (a[2] >= 0) { p.push_back(a); }
        if ((a[2] < 0) != (b[2] < 0)) {
            const T t = a[2] / (a[2] - b[2]);
            p.push_back({a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, T(0)});
        }
    }
    lambert_sum<T> sum{0, 0};
    for (std::size_t i = 0; i < p.size(); ++i) {
        const corner<T>& a = p[i];
        const corner<T>& b = p[(i + 1) % p.size()];
        const T x = a[1] * b[2] - a[2] * b[1];
        const T y = a[2] * b[0] - a[0] * b[2];
        const T z = a[0] * b[1] - a[1] * b[0];
        const T sine = std::hypot(x, y, z);
        if (!(sine > 0)) { continue; }
        const T term = std::atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * (z / sine) / 2;
        sum.irradiance += term;
        sum.magnitude += std::abs(term);
    }
    sum.irradiance = std::abs(sum.irradiance);
    return sum;
}

}  // namespace stability
