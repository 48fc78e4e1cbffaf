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

struct corner {
    point3 direction;
    double u;
    double value;
};

/// A triangle's part of the sum, edge by edge, valued by its farthest corner: no table, no sharing of edges.
tangent_matrix<double> triangle(const std::array<corner, 3>& c) {
    const corner& far =
        *std::min_element(c.begin(), c.end(), [](const corner& a, const corner& b) { return a.u < b.u; });
    tangent_matrix<double> sum;
    for (std::size_t i = 0; i < 3; ++i) {
        const corner& a = c[i];
        const corner& b = c[(i + 1) % 3];
        sum = sum + edge_hessian<double>({a.direction, b.direction, a.u, b.u});
    }
    return sum * far.value;
}

/// The Hessian of irradiance over irradiance by second differences of the closed form.
tangent_matrix<double> exact_hessian(const occluded_light& scene, const point3& x) {
    const double h = 2e-3;
    const auto at = [&](double dx, double dy) { return scene.irradiance({x.x + dx, x.y + dy, 0}); };
    const double centre = at(0, 0);
    return tangent_matrix<double>{(at(h, 0) - 2 * centre + at(-h, 0)) / (h * h),
                                  (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h),
                                  (at(0, h) - 2 * centre + at(0, -h)) / (h * h)} *
           (1 / centre);
}

}  // namespace

TEST_CASE("relative_hessian: is the sum over the mesh's triangles, one by one") {
    const hemisphere_shape shape{5, 9};
    hemisphere_grid<double, double> grid{shape};
    random_sampler<double> random{5};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) { grid.set(j, k, random.next_1d(), 0.3 + random.next_1d()); }
    }
    double mean = 0;
    double zenith_value = 0;
    double zenith_u = 0;
    for (const double l : grid.radiance()) { mean += l / shape.count(); }
    const auto value = [&](double l) { return 0.99 * l / mean + 0.01; };
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        zenith_value += grid.radiance()[grid.index(0, k)] / shape.sectors;
        zenith_u += grid.inverse_distance()[grid.index(0, k)] / shape.sectors;
    }
    const auto at = [&](std::uint32_t row, std::uint32_t column) -> corner {
        if (row == 0) { return {{0, 0, 1}, zenith_u, value(zenith_value)}; }
        const std::size_t i = grid.index(row - 1, column % shape.sectors);
        return {hemisphere_direction<double>(shape, row - 1, column, {0.5, 0.5}), grid.inverse_distance()[i],
                value(grid.radiance()[i])};
    };
    tangent_matrix<double> expected;
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            if (j > 0) { expected = expected + triangle({at(j, k), at(j + 1, k + 1), at(j, k + 1)}); }
            expected = expected + triangle({at(j, k), at(j + 1, k), at(j + 1, k + 1)});
        }
        // The rim is no edge: beyond it the radiance goes on as it is.
        const std::uint32_t last = shape.rings;
        const std::array<corner, 3> t{at(last - 1, k), at(last, k), at(last, k + 1)};
        const corner& far = *std::min_element(t.begin(), t.end(), [](auto& a, auto& b) { return a.u < b.u; });
        expected = expected + edge_hessian<double>({t[1].direction, t[2].direction, t[1].u, t[2].u}) * -far.value;
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
