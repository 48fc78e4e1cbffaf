#include <aglow/estimators/irradiance_hessian.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"
#include "support/occluded_light.hpp"

using namespace aglow;
using support::occluded_light;
using support::point3;

namespace {

double size_of(const tangent_matrix<double>& h) { return std::sqrt(h.xx * h.xx + 2 * h.xy * h.xy + h.yy * h.yy); }

/// A glowing wall at x = 1 that meets a darker ceiling at z = 1, both seen from the floor.
struct corner {
    support::polygon wall{{1, -2, 0}, {1, 2, 0}, {1, 2, 1}, {1, -2, 1}};
    support::polygon ceiling{{1, -2, 1}, {1, 2, 1}, {-2, 2, 1}, {-2, -2, 1}};
    double glow{0.4};

    [[nodiscard]] double irradiance(const point3& x) const {
        return support::irradiance(x, {0, 0, 1}, wall) + glow * support::irradiance(x, {0, 0, 1}, ceiling);
    }
    [[nodiscard]] hemisphere_grid<double, double> sampled(const point3& x, const hemisphere_shape& shape,
                                                          std::uint64_t seed) const {
        hemisphere_grid<double, double> grid{shape};
        random_sampler<double> random{seed};
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            for (std::uint32_t j = 0; j < shape.rings; ++j) {
                const point3 d = hemisphere_direction<double>(shape, j, k, random.next_2d());
                const double to_wall = support::hit(x, d, wall);
                const double to_ceiling = support::hit(x, d, ceiling);
                if (to_wall > 0) { grid.set(j, k, 1, to_wall, d, {-1, 0, 0}); }
                if (to_ceiling > 0) { grid.set(j, k, glow, to_ceiling, d, {0, 0, -1}); }
            }
        }
        return grid;
    }
};

/// The Hessian of irradiance over irradiance by second differences of the closed form.
template <typename World>
tangent_matrix<double> exact_hessian(const World& scene, const point3& x) {
    const double h = 2e-3;
    const auto at = [&](double dx, double dy) { return scene.irradiance({x.x + dx, x.y + dy, 0}); };
    const double centre = at(0, 0);
    return tangent_matrix<double>{(at(h, 0) - 2 * centre + at(-h, 0)) / (h * h),
                                  (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h),
                                  (at(0, h) - 2 * centre + at(0, -h)) / (h * h)} *
           (1 / centre);
}

}  // namespace

TEST_CASE("relative_hessian: is the sum over the outlines of all strata, one by one") {
    const hemisphere_shape shape{5, 9};
    const double u = 0.7;
    hemisphere_grid<double, double> grid{shape};
    random_sampler<double> random{5};
    double mean = 0;
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const double value = random.next_1d();
            grid.set(j, k, value, 1 / u);
            mean += value / shape.count();
        }
    }
    const auto at = [&](std::uint32_t ring, std::uint32_t sector) {
        return hemisphere_direction<double>(shape, std::min(ring, shape.rings - 1), sector,
                                            {ring < shape.rings ? 0.0 : 1.0, 0.0});
    };
    tangent_matrix<double> expected;
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            // Around the stratum. Two strata share an edge and go along it in opposite ways; the horizon is no edge.
            const std::array<point3, 4> corners{at(j, k), at(j + 1, k), at(j + 1, k + 1), at(j, k + 1)};
            for (std::size_t i = 0; i < 4; ++i) {
                if ((i == 1 && j + 1 == shape.rings) || (i == 3 && j == 0)) { continue; }
                const tangent_matrix<double> edge = edge_hessian<double>({corners[i], corners[(i + 1) % 4], u, u});
                expected = expected + edge * (grid.radiance()[grid.index(j, k)] / mean);
            }
        }
    }
    const auto got = relative_hessian(grid, hessian_weights<double>{shape});
    CHECK(size_of(got + expected * -1.0) < 1e-12 * size_of(expected));
}

TEST_CASE("relative_hessian: the curvature that sets the radius agrees with second differences of the closed form") {
    // The reach goes as the fourth root, so what counts is the ratio of the larger eigenvalues.
    for (const bool occluded : {false, true}) {
        const occluded_light scene{occluded};
        const hemisphere_shape shape{16, 50};
        const hessian_weights<double> weights{shape};
        std::vector<double> ratios;
        random_sampler<double> random{6};
        for (int i = 0; i < 60; ++i) {
            const point3 x{random.next_1d() * 2 - 1, random.next_1d() * 2 - 1, 0};
            const double exact = std::abs(principal(exact_hessian(scene, x)).major);
            const auto grid = support::sampled<double>(scene, x, shape, 900 + static_cast<std::uint64_t>(i));
            const double told = std::abs(principal(relative_hessian(grid, weights)).major);
            ratios.push_back(std::pow(told / exact, 0.25));
        }
        std::sort(ratios.begin(), ratios.end());
        INFO("occluded " << occluded << ": " << ratios[6] << ' ' << ratios[15] << ' ' << ratios[30] << ' ' << ratios[45]
                         << ' ' << ratios[54]);
        CHECK(ratios[30] == Approx(1).epsilon(0.1));
        CHECK(ratios[15] > 0.85);
        CHECK(ratios[45] < 1.2);
    }
}

TEST_CASE("relative_hessian: where wall and ceiling meet, the curvature is that of the closed form") {
    const corner scene;
    const hemisphere_shape shape{12, 34};
    const hessian_weights<double> weights{shape};
    for (const double away : {0.1, 0.3, 0.6}) {
        const point3 x{1 - away, 0.1, 0};
        const double exact = std::abs(principal(exact_hessian(scene, x)).major);
        std::vector<double> ratios;
        for (std::uint64_t i = 0; i < 41; ++i) {
            const double told = std::abs(principal(relative_hessian(scene.sampled(x, shape, i), weights)).major);
            ratios.push_back(std::pow(told / exact, 0.25));
        }
        std::sort(ratios.begin(), ratios.end());
        INFO(away << " from the wall: " << ratios[4] << ' ' << ratios[20] << ' ' << ratios[36]);
        CHECK(ratios[20] == Approx(1).epsilon(0.1));
    }
}

TEST_CASE("relative_hessian: uniform radiance has none, at any distances") {
    const hemisphere_shape shape{6, 18};
    hemisphere_grid<float, float> grid{shape};
    random_sampler<float> random{8};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) { grid.set(j, k, 3, 0.2f + random.next_1d()); }
    }
    CHECK(relative_hessian(grid, hessian_weights<float>{shape}) == tangent_matrix<float>{});
}

TEST_CASE("relative_hessian: a black hemisphere has none either, and nothing divides by it") {
    const hemisphere_shape shape{4, 12};
    hemisphere_grid<float, float> grid{shape};
    CHECK(relative_hessian(grid, hessian_weights<float>{shape}) == tangent_matrix<float>{});
}

TEST_CASE("relative_hessian: in a scene 2^k larger it is exactly 4^-k as large") {
    const hemisphere_shape shape{8, 24};
    const hessian_weights<float> weights{shape};
    const auto grid = support::sampled<float>(occluded_light{}, {0.1, 0.3, 0}, shape, 1);
    const tangent_matrix<float> h = relative_hessian(grid, weights);
    for (const int k : {-20, -3, 1, 17}) {
        hemisphere_grid<float, float> scaled{shape};
        for (std::uint32_t s = 0; s < shape.sectors; ++s) {
            for (std::uint32_t j = 0; j < shape.rings; ++j) {
                const std::size_t i = grid.index(j, s);
                scaled.set(j, s, std::ldexp(grid.radiance()[i], 5), std::ldexp(1 / grid.inverse_distance()[i], k));
            }
        }
        // A reciprocal of a reciprocal may round; take those of the unscaled grid through the same mill.
        hemisphere_grid<float, float> same{shape};
        for (std::uint32_t s = 0; s < shape.sectors; ++s) {
            for (std::uint32_t j = 0; j < shape.rings; ++j) {
                const std::size_t i = grid.index(j, s);
                same.set(j, s, grid.radiance()[i], 1 / grid.inverse_distance()[i]);
            }
        }
        CHECK(relative_hessian(scaled, weights) == relative_hessian(same, weights) * std::ldexp(1.f, -2 * k));
    }
    CHECK(size_of({h.xx, h.xy, h.yy}) > 0.01);
}

TEST_CASE("principal: eigenvalues and axis of matrices made from them, at any scale") {
    random_sampler<double> random{9};
    for (const double scale : {1e-20, 1e-6, 1.0, 1e12}) {
        for (int i = 0; i < 50; ++i) {
            const double angle = random.next_1d() * pi<double>;
            const double major = (random.next_1d() < 0.5 ? -1 : 1) * scale;
            const double minor = major * (random.next_1d() * 1.9 - 0.95);
            const double c = std::cos(angle);
            const double s = std::sin(angle);
            const tangent_matrix<double> h{major * c * c + minor * s * s, (major - minor) * c * s,
                                           major * s * s + minor * c * c};
            const auto p = principal(h);
            CHECK(p.major == Approx(major).epsilon(1e-9));
            CHECK(std::abs(p.minor - minor) < 1e-9 * scale);
            CHECK(std::abs(p.axis.x * s - p.axis.y * c) < 1e-6);
        }
    }
    CHECK(principal(tangent_matrix<double>{2, 0, 2}).minor == 2);
    CHECK(principal(tangent_matrix<float>{}).major == 0);
}
