#include <aglow/core/warp.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

namespace {

using aglow::vec2;
using aglow::vec3;

constexpr int samples = 200'000;
constexpr int rows = 24;
constexpr int columns = 24;

/// Counts of directions in cells of equal solid angle, and what `pdf(cos)`, constant around the axis, expects there.
template <typename T, typename Warp, typename Density>
statistics::chi2_result directions_follow(Warp&& warp, Density&& pdf) {
    aglow::random_sampler<T> random{1};
    std::vector<double> counts(rows * columns);
    for (int i = 0; i < samples; ++i) {
        const vec3<T> v = warp(random.next_2d());
        const double turn = std::atan2(double(v.y), double(v.x)) / (2 * aglow::pi<double>);
        const int row = std::clamp(static_cast<int>((double(v.z) + 1) / 2 * rows), 0, rows - 1);
        const int column = std::clamp(static_cast<int>((turn < 0 ? turn + 1 : turn) * columns), 0, columns - 1);
        counts[static_cast<std::size_t>(row * columns + column)] += 1;
    }
    std::vector<double> expected;
    for (int row = 0; row < rows; ++row) {
        const double low = -1 + 2.0 * row / rows;
        const double share = statistics::integral(low, low + 2.0 / rows, 200, pdf) * 2 * aglow::pi<double>;
        expected.insert(expected.end(), columns, share / columns * samples);
    }
    return statistics::chi2_test(counts, expected);
}

/// ∫ pdf over the sphere.
template <typename Density>
double over_sphere(Density&& pdf) {
    return 2 * aglow::pi<double> * (statistics::integral(-1, 0, 500, pdf) + statistics::integral(0, 1, 500, pdf));
}

/// The corners and edges of what a sampler gives, and the middle, where the disc's map has its seam.
template <typename T>
std::vector<vec2<T>> edges() {
    const T near_one = aglow::one_below<T>;
    const T small = std::numeric_limits<T>::min();
    std::vector<vec2<T>> all;
    for (const T x : {T(0), small, T(0x1p-24), T(0.25), T(0.5), T(0.75), near_one}) {
        for (const T y : {T(0), small, T(0x1p-24), T(0.25), T(0.5), T(0.75), near_one}) { all.push_back({x, y}); }
    }
    return all;
}

template <typename T>
bool is_unit(const vec3<T>& v) {
    return std::abs(glm::length(v) - 1) <= 4 * std::numeric_limits<T>::epsilon();
}

}  // namespace

TEMPLATE_TEST_CASE("warp: directions follow their densities", "", float, double) {
    using T = TestType;
    const auto p = [](const statistics::chi2_result& r) { return r.p; };
    CHECK(p(directions_follow<T>([](auto u) { return aglow::cosine_hemisphere(u); },
                                 [](double c) { return aglow::cosine_hemisphere_pdf(c); })) > 1e-4);
    CHECK(p(directions_follow<T>([](auto u) { return aglow::uniform_sphere(u); },
                                 [](double) { return aglow::uniform_sphere_pdf<double>(); })) > 1e-4);
    CHECK(p(directions_follow<T>([](auto u) { return aglow::uniform_hemisphere(u); },
                                 [](double c) { return c > 0 ? aglow::uniform_hemisphere_pdf<double>() : 0; })) > 1e-4);
    const double cone = 0.25;  // a border of cells, as the hemispheres' is
    CHECK(p(directions_follow<T>([&](auto u) { return aglow::uniform_cone(u, T(cone)); },
                                 [&](double c) { return c > 1 - cone ? aglow::uniform_cone_pdf(cone) : 0; })) > 1e-4);
}

TEST_CASE("warp: the test of directions refuses another density") {
    CHECK(directions_follow<float>([](auto u) { return aglow::cosine_hemisphere(u); },
                                   [](double c) { return c > 0 ? aglow::uniform_hemisphere_pdf<double>() : 0; })
              .p < 1e-9);
    CHECK(directions_follow<float>([](auto u) { return aglow::cosine_hemisphere(u); },
                                   [](double c) { return c > 0 ? (1.9 * c + 0.05) / (2 * aglow::pi<double>) : 0; })
              .p < 1e-4);
}

TEST_CASE("warp: densities integrate to one") {
    CHECK(over_sphere([](double c) { return aglow::cosine_hemisphere_pdf(c); }) == Approx(1).epsilon(1e-12));
    CHECK(over_sphere([](double) { return aglow::uniform_sphere_pdf<double>(); }) == Approx(1).epsilon(1e-12));
    CHECK(aglow::uniform_hemisphere_pdf<double>() * 2 * aglow::pi<double> == Approx(1).epsilon(1e-12));
    CHECK(aglow::concentric_disc_pdf<double>() * aglow::pi<double> == Approx(1).epsilon(1e-12));
    for (const double h : {1e-12, 1e-3, 0.5, 2.0}) {
        CHECK(aglow::uniform_cone_pdf(h) * 2 * aglow::pi<double> * h == Approx(1).epsilon(1e-12));
    }
    CHECK(aglow::uniform_triangle_pdf(0.25) * 0.25 == 1);
    CHECK(aglow::cosine_hemisphere_pdf(-0.5) == 0);
}

TEMPLATE_TEST_CASE("warp: at the edges of the square directions are unit and densities above zero", "", float, double) {
    using T = TestType;
    for (const vec2<T>& u : edges<T>()) {
        INFO(u.x << ' ' << u.y);
        const vec3<T> cosine = aglow::cosine_hemisphere(u);
        CHECK(is_unit(cosine));
        CHECK(aglow::cosine_hemisphere_pdf(cosine.z) > 0);
        CHECK(is_unit(aglow::uniform_sphere(u)));
        const vec3<T> upper = aglow::uniform_hemisphere(u);
        CHECK(is_unit(upper));
        CHECK(upper.z > 0);
        for (const T h : {T(1e-12), T(1e-3), T(0.5), T(1), T(2)}) {
            const vec3<T> narrow = aglow::uniform_cone(u, h);
            CHECK(is_unit(narrow));
            CHECK(narrow.z >= 1 - h - std::numeric_limits<T>::epsilon());
            CHECK(aglow::is_finite(aglow::uniform_cone_pdf(h)));
        }
        const vec2<T> p = aglow::concentric_disc(u);
        CHECK(p.x * p.x + p.y * p.y <= 1 + 4 * std::numeric_limits<T>::epsilon());
        const vec2<T> b = aglow::uniform_triangle(u);
        CHECK((b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 + std::numeric_limits<T>::epsilon()));
    }
}

TEMPLATE_TEST_CASE("warp: the disc is uniform by area, and its rim is the square's", "", float, double) {
    using T = TestType;
    aglow::random_sampler<T> random{2};
    std::vector<double> counts(20 * 20);
    for (int i = 0; i < samples; ++i) {
        const vec2<T> p = aglow::concentric_disc(random.next_2d());
        const double turn = std::atan2(double(p.y), double(p.x)) / (2 * aglow::pi<double>);
        const int ring = std::min(static_cast<int>(double(p.x * p.x + p.y * p.y) * 20), 19);
        const int sector = std::min(static_cast<int>((turn < 0 ? turn + 1 : turn) * 20), 19);
        counts[static_cast<std::size_t>(ring * 20 + sector)] += 1;
    }
    CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    for (T x = 0; x < 1; x += T(0.03)) {
        for (const vec2<T>& u : {vec2<T>{x, 0}, vec2<T>{0, x}}) {
            CHECK(double(glm::length(aglow::concentric_disc(u))) == Approx(1).epsilon(1e-6));
        }
    }
    CHECK(aglow::concentric_disc(vec2<T>(T(0.5))) == vec2<T>{0, 0});
}

TEMPLATE_TEST_CASE("warp: neighbours on the square are neighbours on the disc", "", float, double) {
    using T = TestType;
    aglow::random_sampler<T> random{3};
    for (int i = 0; i < 10'000; ++i) {
        const vec2<T> u = random.next_2d() * T(0.999);
        const vec2<T> step = random.next_2d() * T(0.001);
        REQUIRE(glm::length(aglow::concentric_disc(u + step) - aglow::concentric_disc(u)) < 4 * T(0.001));
    }
}

TEMPLATE_TEST_CASE("warp: the triangle is uniform by area", "", float, double) {
    using T = TestType;
    aglow::random_sampler<T> random{4};
    // A grid of n x n half-squares cuts the triangle into n² equal ones.
    constexpr int n = 16;
    std::vector<double> counts(n * n);
    for (int i = 0; i < samples; ++i) {
        const vec2<T> b = aglow::uniform_triangle(random.next_2d());
        const int x = std::min(static_cast<int>(b.x * n), n - 1);
        const int y = std::min(static_cast<int>(b.y * n), n - 1 - x);
        const bool upper = double(b.x) * n - x + double(b.y) * n - y > 1 && x + y < n - 1;
        // Row x holds 2 (n - x) - 1 triangles, two a square and one at the hypotenuse.
        const int before = x * (2 * n - x);
        counts[static_cast<std::size_t>(before + 2 * y + (upper ? 1 : 0))] += 1;
    }
    CHECK(statistics::chi2_uniform(counts).p > 1e-4);
}

TEMPLATE_TEST_CASE("warp: a narrow cone keeps its directions apart", "", float, double) {
    using T = TestType;
    // Half an angle of 1e-4: the cosine of a float is one there, the sine is not.
    const T h = T(5e-9);
    aglow::random_sampler<T> random{5};
    statistics::sample_mean sine2;
    for (int i = 0; i < 10'000; ++i) {
        const vec3<T> v = aglow::uniform_cone(random.next_2d(), h);
        sine2.add(double(v.x) * double(v.x) + double(v.y) * double(v.y));
    }
    CHECK(sine2.agrees(5e-9, 4));
}
