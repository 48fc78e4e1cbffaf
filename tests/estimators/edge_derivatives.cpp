#include <aglow/estimators/edge_derivatives.hpp>

#include <cmath>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"
#include "support/polygon.hpp"

using namespace aglow;
using support::point3;
using support::polygon;

namespace {

constexpr point3 up{0, 0, 1};

/// Corners above the plane z = 0, clockwise as seen from the origin.
polygon random_triangle(random_sampler<double>& random, double size) {
    const auto corner = [&] { return point3{random.next_1d() - 0.5, random.next_1d() - 0.5, random.next_1d() - 0.5}; };
    const point3 middle{random.next_1d() * 2 - 1, random.next_1d() * 2 - 1, 0.3 + size + random.next_1d()};
    polygon p{middle + corner() * size, middle + corner() * size, middle + corner() * size};
    if (glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), p[0]) < 0) { std::swap(p[1], p[2]); }
    return p;
}

template <typename T>
seen_edge<T> edge_of(const point3& a, const point3& b) {
    const double ra = glm::length(a);
    const double rb = glm::length(b);
    return {vec3<T>(a / ra), vec3<T>(b / rb), static_cast<T>(1 / ra), static_cast<T>(1 / rb)};
}

template <typename T>
vec2<T> gradient_of(const polygon& p) {
    vec2<T> sum{};
    for (std::size_t i = 0; i < p.size(); ++i) { sum += edge_gradient(edge_of<T>(p[i], p[(i + 1) % p.size()])); }
    return sum;
}

template <typename T>
tangent_matrix<T> hessian_of(const polygon& p) {
    tangent_matrix<T> sum;
    for (std::size_t i = 0; i < p.size(); ++i) { sum = sum + edge_hessian(edge_of<T>(p[i], p[(i + 1) % p.size()])); }
    return sum;
}

double at(const polygon& p, double x, double y) { return support::form_factor({x, y, 0}, up, p); }

double size_of(const tangent_matrix<double>& h) { return std::sqrt(h.xx * h.xx + 2 * h.xy * h.xy + h.yy * h.yy); }

}  // namespace

TEST_CASE("edge_gradient: the edges of a triangle sum to the finite differences of Lambert's formula") {
    random_sampler<double> random{1};
    for (int i = 0; i < 200; ++i) {
        const polygon p = random_triangle(random, i % 2 ? 1.0 : 0.2);
        const double h = 1e-4;
        const vec2<double> expected{(at(p, h, 0) - at(p, -h, 0)) / (2 * h), (at(p, 0, h) - at(p, 0, -h)) / (2 * h)};
        const vec2<double> got = gradient_of<double>(p);
        CHECK(glm::length(got - expected) < 1e-6 * glm::length(expected));
    }
}

TEST_CASE("edge_hessian: the edges of a triangle sum to the second differences of Lambert's formula") {
    random_sampler<double> random{2};
    for (int i = 0; i < 200; ++i) {
        const polygon p = random_triangle(random, i % 2 ? 1.0 : 0.2);
        const double h = 1e-3;
        const double centre = at(p, 0, 0);
        const tangent_matrix<double> expected{(at(p, h, 0) - 2 * centre + at(p, -h, 0)) / (h * h),
                                              (at(p, h, h) - at(p, h, -h) - at(p, -h, h) + at(p, -h, -h)) / (4 * h * h),
                                              (at(p, 0, h) - 2 * centre + at(p, 0, -h)) / (h * h)};
        const tangent_matrix<double> got = hessian_of<double>(p);
        CHECK(size_of(got + expected * -1.0) < 3e-5 * size_of(expected));
    }
}

TEST_CASE("edge_hessian: in float, errors stay at rounding however short the edges") {
    random_sampler<double> random{3};
    for (const double size : {0.1, 0.01, 0.003}) {
        double worst = 0;
        for (int i = 0; i < 200; ++i) {
            const polygon p = random_triangle(random, size);
            const seen_edge<float> e = edge_of<float>(p[0], p[1]);
            const auto exact = edge_hessian<double>({vec3<double>(e.d0), vec3<double>(e.d1), e.u0, e.u1});
            const auto got = edge_hessian(e);
            worst =
                std::max(worst, size_of(tangent_matrix<double>{got.xx, got.xy, got.yy} + exact * -1.0) / square(e.u0));
        }
        CHECK(worst < 1e-6);
    }
}

TEST_CASE("edge_hessian: an edge at infinity and an edge without length add nothing") {
    const vec3<float> a = glm::normalize(vec3<float>{1, 2, 3});
    const vec3<float> b = glm::normalize(vec3<float>{1, -2, 3});
    CHECK(edge_hessian<float>({a, b, 0, 0}) == tangent_matrix<float>{});
    CHECK(edge_hessian<float>({a, a, 1, 0.5f}) == tangent_matrix<float>{});
    CHECK(edge_gradient<float>({a, a, 1, 0.5f}) == vec2<float>{});
}

TEST_CASE("edge_hessian: an edge is the sum of the parts that it is cut into, however long") {
    random_sampler<double> random{4};
    for (const double angle : {0.3, 1.0, 2.0, 2.9}) {
        for (int i = 0; i < 50; ++i) {
            const point3 a = glm::normalize(point3{random.next_1d() - 0.5, random.next_1d() - 0.5, 0.5});
            const point3 side = glm::normalize(glm::cross(a, point3{0.3, random.next_1d() - 0.5, 0.4}));
            const auto at = [&](double psi) { return a * std::cos(psi) + side * std::sin(psi); };
            const double u0 = 0.2 + random.next_1d();
            const double u1 = 0.2 + random.next_1d();
            const double cut = angle * (0.2 + 0.6 * random.next_1d());
            // The reciprocal distance along a straight edge.
            const double u = (u0 * std::sin(angle - cut) + u1 * std::sin(cut)) / std::sin(angle);
            const auto whole = edge_hessian<double>({a, at(angle), u0, u1});
            const auto parts =
                edge_hessian<double>({a, at(cut), u0, u}) + edge_hessian<double>({at(cut), at(angle), u, u1});
            CAPTURE(angle, cut);
            CHECK(size_of(whole + parts * -1.0) < 1e-7 * (size_of(whole) + size_of(parts)));
            const auto slope = edge_gradient<double>({a, at(angle), u0, u1});
            const auto slopes =
                edge_gradient<double>({a, at(cut), u0, u}) + edge_gradient<double>({at(cut), at(angle), u, u1});
            CHECK(glm::length(slope - slopes) < 1e-10 * (1 + glm::length(slope)));
        }
    }
}
