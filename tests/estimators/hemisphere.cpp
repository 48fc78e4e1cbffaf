#include <aglow/estimators/hemisphere.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Radiance a function of local direction, distance another; one jittered sample per stratum.
template <typename S, typename T, typename Radiance, typename Distance>
hemisphere_grid<S, T> sampled(const hemisphere_shape& shape, std::uint64_t seed, Radiance&& radiance,
                              Distance&& distance) {
    hemisphere_grid<S, T> grid{shape};
    random_sampler<T> random{seed};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const vec3<T> d = hemisphere_direction<T>(shape, j, k, random.next_2d());
            grid.set(j, k, radiance(d), distance(d));
        }
    }
    return grid;
}

}  // namespace

TEST_CASE("hemisphere_direction: each direction lies in its own stratum and above the horizon, whatever the numbers") {
    const hemisphere_shape shape{5, 7};
    for (std::uint32_t j = 0; j < shape.rings; ++j) {
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            for (const float u : {0.f, 0.25f, one_below<float>}) {
                const vec3<float> d = hemisphere_direction<float>(shape, j, k, {u, 0.5f});
                CHECK(d.z > 0);
                CHECK(glm::length(d) == Approx(1).epsilon(1e-6));
                const double ring = 5.0 * (double(d.x) * d.x + double(d.y) * d.y);
                CHECK(ring > j - 1e-5);
                CHECK(ring < j + 1 + 1e-5);
                const double angle = std::atan2(d.y, d.x) / (2 * pi<double>)+1;
                if (ring > 1e-6) { CHECK(std::fmod(angle, 1.0) * 7 == Approx(k + 0.5)); }
            }
        }
    }
}

TEST_CASE("hemisphere_of: about as many strata as rays were asked for, and about square") {
    for (const std::uint32_t rays : {1u, 64u, 200u, 400u, 1000u, 4096u}) {
        const hemisphere_shape shape = hemisphere_of(rays);
        CHECK(shape.rings >= 2);
        CHECK(shape.sectors >= 6);
        if (rays >= 64) { CHECK(shape.count() == Approx(rays).epsilon(0.05)); }
        if (rays >= 64) { CHECK(double(shape.sectors) / shape.rings == Approx(pi<double>).epsilon(0.2)); }
    }
}

TEST_CASE("hemisphere_grid: uniform radiance gives pi times itself and no noise") {
    const auto grid = sampled<vec3<float>, float>(
        {8, 16}, 1,
        [](auto) {
            return vec3<float>{1, 2, 3};
        },
        [](auto) { return 1.f; });
    CHECK(grid.irradiance().x == Approx(pi<float>));
    CHECK(grid.irradiance().y == Approx(2 * pi<float>));
    CHECK(grid.irradiance().z == Approx(3 * pi<float>));
    CHECK(relative_noise(grid) == 0);
    CHECK(grid.mean_inverse_distance() == Approx(1));
    const vec3<float> incident = incident_direction(grid);
    CHECK(std::abs(incident.x) < 1e-5f);
    CHECK(std::abs(incident.y) < 1e-5f);
    CHECK(incident.z == Approx(2.0 / 3).epsilon(0.01));
}

TEST_CASE("hemisphere_grid: the mean over many hemispheres is the integral of radiance times cosine") {
    // L = z² + x: the integral of (z² + x) z over the hemisphere is pi / 2.
    double sum = 0;
    double sum2 = 0;
    const int runs = 400;
    for (int i = 0; i < runs; ++i) {
        const double e = sampled<double, double>(
                             {4, 9}, 100 + static_cast<std::uint64_t>(i),
                             [](const vec3<double>& d) { return d.z * d.z + d.x + 1; }, [](auto) { return 1.0; })
                             .irradiance();
        sum += e;
        sum2 += e * e;
    }
    const double mean = sum / runs;
    const double error = std::sqrt((sum2 / runs - mean * mean) / runs);
    CHECK(std::abs(mean - 1.5 * pi<double>) < 4 * error);
    CHECK(error < 0.005);
}

TEST_CASE("relative_noise: is the spread of irradiance over independent hemispheres, where radiance is noise") {
    const hemisphere_shape shape{8, 24};
    std::vector<double> values;
    double told = 0;
    const int runs = 300;
    for (int i = 0; i < runs; ++i) {
        random_sampler<double> noise{mix(7, static_cast<std::uint64_t>(i))};
        const auto grid = sampled<double, double>(
            shape, 300 + static_cast<std::uint64_t>(i),
            [&](const vec3<double>& d) { return (noise.next_1d() < 0.2 ? 5.0 : 0.0) * (1 + d.x); },
            [](auto) { return 1.0; });
        values.push_back(grid.irradiance());
        told += square(relative_noise(grid) * grid.irradiance()) / runs;
    }
    double mean = 0;
    double variance = 0;
    for (const double v : values) { mean += v / runs; }
    for (const double v : values) { variance += (v - mean) * (v - mean) / (runs - 1); }
    // The variance of 300 runs is known to 8 %.
    CHECK(told / variance == Approx(1).epsilon(0.25));
}

TEST_CASE("hemisphere_grid: bad samples are counted and leave the others alone") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    hemisphere_grid<vec3<float>, float> grid{{2, 5}};
    for (std::uint32_t k = 0; k < 5; ++k) {
        for (std::uint32_t j = 0; j < 2; ++j) { grid.set(j, k, {1, 1, 1}, 2); }
    }
    CHECK(grid.rejected() == 0);
    hemisphere_grid<vec3<float>, float> bad{{2, 5}};
    bad.set(0, 0, {nan, 1, 1}, 2);
    bad.set(0, 1, {1, inf, 1}, 2);
    bad.set(0, 2, {1, 1, -1}, 2);
    bad.set(0, 3, {1, 1, 1}, nan);
    bad.set(0, 4, {1, 1, 1}, 0);
    bad.set(1, 0, {1, 1, 1}, -1);
    bad.set(1, 1, {1, 1, 1}, -inf);
    CHECK(bad.rejected() == 7);
    CHECK(bad.irradiance() == vec3<float>{0});
    for (std::uint32_t k = 2; k < 5; ++k) { bad.set(1, k, {1, 1, 1}, 2); }
    CHECK(bad.irradiance().x == Approx(pi<float>));
    CHECK(bad.mean_inverse_distance() == Approx(0.5f));
}

TEST_CASE("hemisphere_grid: the open sky is infinitely far, and that is no special case") {
    const auto open = sampled<double, double>(
        {4, 8}, 1, [](auto) { return 1.0; }, [](auto) { return infinity; });
    CHECK(open.rejected() == 0);
    CHECK(open.mean_inverse_distance() == 0);
    CHECK(open.nearest_inverse_distance() == 0);
}

TEST_CASE("nearest_inverse_distance: what grazes the horizon is not near, however bright") {
    // A floor just below: only the outermost ring meets it.
    const hemisphere_shape shape{16, 32};
    const auto grid = sampled<double, double>(
        shape, 1, [](const vec3<double>& d) { return d.z < 0.2 ? 100.0 : 1.0; },
        [](const vec3<double>& d) { return d.z < 0.2 ? 0.01 : 4.0; });
    CHECK(grid.nearest_inverse_distance() == 0.25);
}

TEST_CASE("hemisphere_grid: refuses a shape that cannot be cut") {
    CHECK_THROWS_AS((hemisphere_grid<float, float>{{1, 8}}), std::invalid_argument);
    CHECK_THROWS_AS((hemisphere_grid<float, float>{{4, 2}}), std::invalid_argument);
}
