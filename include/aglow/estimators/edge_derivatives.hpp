// What one edge of a polygon adds to the derivatives of the irradiance that the polygon causes.
//
// Lambert's formula differentiated (Arvo 1994; Holzschuch & Sillion 1998), written with unit directions and reciprocal
// distances instead of vertices: an edge at infinity is u = 0, an edge without length adds 0, and floats suffice.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A symmetric 2x2 matrix of the tangent plane: [[xx, xy], [xy, yy]].
template <std::floating_point T>
struct tangent_matrix {
    T xx{};
    T xy{};
    T yy{};
    friend bool operator==(const tangent_matrix&, const tangent_matrix&) = default;
};

template <std::floating_point T>
[[nodiscard]] constexpr tangent_matrix<T> operator+(const tangent_matrix<T>& a, const tangent_matrix<T>& b) {
    return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}
template <std::floating_point T>
[[nodiscard]] constexpr tangent_matrix<T> operator*(const tangent_matrix<T>& a, T k) {
    return {a.xx * k, a.xy * k, a.yy * k};
}

/// An edge as seen from the origin: unit directions of its ends, and one over their distances (0 = infinitely far).
template <std::floating_point T>
struct seen_edge {
    vec3<T> d0{};
    vec3<T> d1{};
    T u0{};
    T u1{};
};

namespace detail {

/// The angle between an edge's ends, its sine, and the integrals over the angle of s0² and s0 s1, where
/// s0 = sin(angle - psi)/sin(angle), s1 = sin(psi)/sin(angle) place the direction between the ends.
template <std::floating_point T>
struct edge_angle {
    T angle;
    T sine;
    T a;
    T b;
};

template <std::floating_point T>
[[nodiscard]] edge_angle<T> angle_of(const seen_edge<T>& e) {
    const T sine = glm::length(glm::cross(e.d0, e.d1));
    const T cosine = glm::dot(e.d0, e.d1);
    const T w = std::atan2(sine, cosine);
    // Below, the closed forms lose digits to cancellation; their series do not.
    if (w < (sizeof(T) == 4 ? T(0.5) : T(0.08))) {
        const T w2 = w * w;
        const T a = w / 3 * (1 + w2 * (T(2) / 15 + w2 * (T(2) / 105 + w2 * (T(4) / 1575 + w2 * (T(2) / 6237)))));
        const T b = w / 6 * (1 + w2 * (T(7) / 30 + w2 * (T(31) / 840 + w2 * (T(127) / 25200 + w2 * (T(73) / 114048)))));
        return {w, sine, a, b};
    }
    const T s2 = 2 * sine * sine;
    return {w, sine, (w - sine * cosine) / s2, (sine - w * cosine) / s2};
}

/// Integral of u² (4 d d^T - I) over the angle of the edge, tangent part; Gauss-Legendre, four points per quarter
/// radian.
template <std::floating_point T>
[[nodiscard]] tangent_matrix<T> edge_moment(const seen_edge<T>& e, T angle, T sine) {
    static constexpr std::array<double, 4> node{-0.86113631159405258, -0.33998104358485626, 0.33998104358485626,
                                                0.86113631159405258};
    static constexpr std::array<double, 4> weight{0.34785484513745386, 0.65214515486254614, 0.65214515486254614,
                                                  0.34785484513745386};
    const int parts = 1 + static_cast<int>(angle * 4);
    const T half = angle / static_cast<T>(2 * parts);
    tangent_matrix<T> sum;
    for (int i = 0; i < 4 * parts; ++i) {
        const auto j = static_cast<std::size_t>(i % 4);
        const T psi = half * (static_cast<T>(2 * (i / 4) + 1) + static_cast<T>(node[j]));
        const T s0 = std::sin(angle - psi) / sine;
        const T s1 = std::sin(psi) / sine;
        const T x = s0 * e.d0.x + s1 * e.d1.x;
        const T y = s0 * e.d0.y + s1 * e.d1.y;
        const T w = static_cast<T>(weight[j]) * half * square(s0 * e.u0 + s1 * e.u1);
        sum = sum + tangent_matrix<T>{4 * x * x - 1, 4 * x * y, 4 * y * y - 1} * w;
    }
    return sum;
}

}  // namespace detail

/// The edge's part of the gradient of a polygon's form factor as the receiver moves in its plane, whose normal is +z.
/// Sum over the edges, clockwise as seen from the receiver; irradiance is pi times radiance times form factor.
template <std::floating_point T>
[[nodiscard]] vec2<T> edge_gradient(const seen_edge<T>& e) {
    const auto [w, sine, a, b] = detail::angle_of(e);
    if (!(sine > 0)) { return {}; }
    const vec3<T> across = e.d1 * e.u0 - e.d0 * e.u1;
    const vec3<T> p = (e.d0 * e.u0 + e.d1 * e.u1) * a + (e.d1 * e.u0 + e.d0 * e.u1) * b;
    const T height = 2 * (e.d0.x * e.d1.y - e.d0.y * e.d1.x) / sine;
    const T turn = w / sine;
    return vec2<T>{height * p.x - turn * across.y, height * p.y + turn * across.x} / (2 * pi<T>);
}

/// The edge's part of the second derivatives of the form factor; as `edge_gradient`.
template <std::floating_point T>
[[nodiscard]] tangent_matrix<T> edge_hessian(const seen_edge<T>& e) {
    const auto [w, sine, a, b] = detail::angle_of(e);
    if (!(sine > 0)) { return {}; }
    const vec3<T> across = e.d1 * e.u0 - e.d0 * e.u1;
    const vec2<T> g = vec2<T>{-across.y, across.x} / sine;
    const vec3<T> p = (e.d0 * e.u0 + e.d1 * e.u1) * a + (e.d1 * e.u0 + e.d0 * e.u1) * b;
    const T height = (e.d0.x * e.d1.y - e.d0.y * e.d1.x) / sine;
    const tangent_matrix<T> outer{2 * g.x * p.x, g.x * p.y + g.y * p.x, 2 * g.y * p.y};
    return (outer + detail::edge_moment(e, w, sine) * height) * (1 / pi<T>);
}

}  // namespace aglow
