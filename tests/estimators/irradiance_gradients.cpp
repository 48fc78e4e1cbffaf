#include <aglow/estimators/irradiance_gradients.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"
#include "support/glowing_room.hpp"
#include "support/occluded_light.hpp"

using namespace aglow;
using support::glowing_room;
using support::occluded_light;
using support::point3;

namespace {

struct mean_gradients {
    vec2<double> translation{};
    vec2<double> rotation{};
};

mean_gradients mean_of_many(const occluded_light& scene, const point3& x, const hemisphere_shape& shape, int runs) {
    const gradient_weights<double> weights{shape};
    mean_gradients mean;
    for (int i = 0; i < runs; ++i) {
        const auto grid = support::sampled<double>(scene, x, shape, static_cast<std::uint64_t>(i));
        const irradiance_gradients<double> g = gradients(grid, weights);
        mean.translation += vec2<double>{g.translation.x, g.translation.y} / double(runs);
        mean.rotation += vec2<double>{g.rotation.x, g.rotation.y} / double(runs);
    }
    return mean;
}

}  // namespace

TEST_CASE("gradients: translation is the derivative of Lambert's formula, with and without an occluder") {
    for (const bool occluded : {false, true}) {
        const occluded_light scene{occluded};
        for (const point3& x : {point3{0.1, 0.2, 0}, point3{-0.6, 0.3, 0}, point3{0.4, -0.5, 0}}) {
            const mean_gradients mean = mean_of_many(scene, x, {128, 400}, 8);
            const vec2<double> exact = scene.gradient(x);
            INFO("occluded " << occluded << " at " << x.x << ' ' << x.y);
            CHECK(glm::length(mean.translation - exact) < 0.025 * glm::length(exact));
        }
    }
}

TEST_CASE("gradients: near the corners of a room they are as steep as Lambert's formula, from few rays and close by") {
    const glowing_room room;
    const hemisphere_shape shape = hemisphere_of(400);
    const gradient_weights<double> weights{shape};
    for (const double x : {0.5, 0.9, 0.98}) {
        const point3 here{x, 0.2, -1};
        vec2<double> mean{0};
        vec2<double> squares{0};
        constexpr int runs = 400;
        for (int i = 0; i < runs; ++i) {
            const auto g = gradients(support::seen_in(room, here, shape, static_cast<std::uint64_t>(i)), weights);
            const vec2<double> one{g.translation.x, g.translation.y};
            mean += one / double(runs);
            squares += one * one / double(runs);
        }
        const vec2<double> exact = room.gradient(here);
        const double chance = glm::length(glm::sqrt((squares - mean * mean) / double(runs)));
        CAPTURE(x, mean.x, mean.y, exact.x, exact.y, chance);
        CHECK(glm::length(mean - exact) < 0.04 * glm::length(exact) + 4 * chance);
        CHECK(chance < 0.03 * glm::length(exact));
    }
}

TEST_CASE("gradients: a wall that hides another moves the border, whichever way it faces") {
    // To the left something black ends at distance 1, to the right a bright wall is 10 times as far. The border lies
    // along y; moving towards it by 1 turns it by 1 a radian's worth at the zenith.
    const hemisphere_shape shape{32, 100};
    const gradient_weights<double> weights{shape};
    const auto steepness = [&](const point3& facing) {
        hemisphere_grid<double, double> grid{shape};
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            for (std::uint32_t j = 0; j < shape.rings; ++j) {
                const point3 d = hemisphere_direction<double>(shape, j, k, {0.5, 0.5});
                const bool left = d.x < 0;
                const point3 normal = left ? facing : point3{0, 0, -1};
                grid.set(j, k, left ? 0 : 1, (left ? 1 : 10) / d.z, d, normal);
            }
        }
        return gradients(grid, weights).translation.x;
    };
    // The edge of a half plane at height 1: E = pi/2 (1 + x / sqrt(1 + x²)) of what is right of it.
    CHECK(steepness({0, 0, -1}) == Approx(pi<double> / 2).epsilon(0.03));
    // The back of a roof whose ridge is that edge is as near where it ends.
    CHECK(steepness(glm::normalize(point3{0.2, 0, -1})) == Approx(pi<double> / 2).epsilon(0.15));
    CHECK(steepness(glm::normalize(point3{-0.2, 0, -1})) == Approx(pi<double> / 2).epsilon(0.15));
}

TEST_CASE("gradients: rotation is the derivative of Lambert's formula by the normal") {
    const occluded_light scene{true};
    for (const point3& x : {point3{0.1, 0.2, 0}, point3{-0.6, 0.3, 0}}) {
        const mean_gradients mean = mean_of_many(scene, x, {32, 100}, 40);
        const double h = 1e-4;
        const auto tilted = [&](double ax, double ay) {
            // The normal turned by (ax, ay): n' = n + (ax, ay) x n, so that n x n' is (ax, ay).
            return scene.irradiance(x, glm::normalize(point3{ay, -ax, 1}));
        };
        const vec2<double> exact{(tilted(h, 0) - tilted(-h, 0)) / (2 * h), (tilted(0, h) - tilted(0, -h)) / (2 * h)};
        CHECK(glm::length(mean.rotation - exact) < 0.02 * glm::length(exact));
    }
}

TEST_CASE("gradients: every border between two rings counts, the first included") {
    // A bright cap within the first ring, everything at distance 1 but brighter on one side of ring 0: only the border
    // between rings 0 and 1 sees a change, so leaving it out gives 0.
    const hemisphere_shape shape{8, 16};
    hemisphere_grid<double, double> grid{shape};
    for (std::uint32_t k = 0; k < 16; ++k) {
        for (std::uint32_t j = 0; j < 8; ++j) { grid.set(j, k, j == 0 && k < 8 ? 2.0 : 1.0, 1); }
    }
    const gradient_weights<double> weights{shape};
    double radial = 0;
    for (std::uint32_t k = 0; k < 8; ++k) { radial -= weights.sectors()[k].centre.y * weights.rings()[1].radial; }
    // The two borders between sectors 7|8 and 15|0 add their exact share.
    const double turning =
        weights.rings()[0].turning * (weights.sectors()[0].sideways.y - weights.sectors()[8].sideways.y);
    CHECK(gradients(grid, weights).translation.y == Approx(radial + turning));
    CHECK(std::abs(radial) > 0.1);
}

TEST_CASE("gradients: uniform radiance has none, at any distances") {
    const hemisphere_shape shape{8, 20};
    hemisphere_grid<vec3<float>, float> grid{shape};
    random_sampler<float> random{3};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) { grid.set(j, k, {1, 2, 3}, 0.1f + random.next_1d()); }
    }
    const irradiance_gradients<vec3<float>> g = gradients(grid, gradient_weights<float>{shape});
    CHECK(g.translation.x == vec3<float>{0});
    CHECK(g.translation.y == vec3<float>{0});
    CHECK(glm::length(g.rotation.x) < 1e-5f);
    CHECK(glm::length(g.rotation.y) < 1e-5f);
}

TEST_CASE("gradients: bands are strangers to each other") {
    const hemisphere_shape shape{6, 18};
    hemisphere_grid<vec3<float>, float> colour{shape};
    hemisphere_grid<vec3<float>, float> swapped{shape};
    hemisphere_grid<float, float> gray{shape};
    random_sampler<float> random{4};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const vec3<float> l{random.next_1d(), random.next_1d(), random.next_1d()};
            const float distance = 0.5f + random.next_1d();
            colour.set(j, k, l, distance);
            swapped.set(j, k, {l.z, l.x, l.y}, distance);
            gray.set(j, k, l.x, distance);
        }
    }
    const gradient_weights<float> weights{shape};
    const auto c = gradients(colour, weights);
    const auto s = gradients(swapped, weights);
    const auto g = gradients(gray, weights);
    CHECK(c.translation.x.x == g.translation.x);
    CHECK(c.rotation.y.x == g.rotation.y);
    CHECK(s.translation.y == vec3<float>{c.translation.y.z, c.translation.y.x, c.translation.y.y});
}

TEST_CASE("gradients: where samples were rejected the others stand in, as they do for irradiance") {
    const hemisphere_shape shape{6, 18};
    hemisphere_grid<double, double> all{shape};
    hemisphere_grid<double, double> some{shape};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const double l = k < 9 ? 1.0 : 0.0;
            all.set(j, k, l, 1);
            some.set(j, k, k >= 9 && k < 12 ? nan : l, 1);
        }
    }
    const gradient_weights<double> weights{shape};
    // The rejected ones were black: only the share of each sample changes.
    const double share = some.irradiance() / all.irradiance();
    CHECK(share == Approx(18.0 / 15));
    CHECK(gradients(some, weights).rotation.x == Approx(gradients(all, weights).rotation.x * share));
}

TEST_CASE("gradient_weights: the weights are the integrals of their borders and strata, exactly") {
    for (const hemisphere_shape& shape : {hemisphere_shape{2, 6}, hemisphere_shape{8, 25}, hemisphere_shape{37, 116}}) {
        const gradient_weights<double> weights{shape};
        double turning = 0;
        double rotation = 0;
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            turning += weights.rings()[j].turning;
            rotation += weights.rings()[j].rotation;
            // The mean of tan over a stratum by the midpoint rule in sin²; towards the horizon it has a root's pole.
            double mean = 0;
            constexpr int steps = 20000;
            for (int i = 0; i < steps; ++i) {
                const double sine2 = (j + (i + 0.5) / steps) / shape.rings;
                mean += std::sqrt(sine2 / (1 - sine2)) / steps;
            }
            CHECK(weights.rings()[j].rotation * shape.count() / pi<double> == Approx(mean).epsilon(0.01));
        }
        // From the zenith to the horizon: of cos / (r sin) cos sin, and of tan under the cosine.
        CHECK(turning == Approx(1).epsilon(1e-12));
        CHECK(rotation == Approx(square(pi<double>) / (2 * shape.sectors)).epsilon(1e-12));
    }
}
