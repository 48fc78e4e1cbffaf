#include <aglow/algorithms/photon_source.hpp>

#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace aglow;
using support::toy_scene;

namespace {

using S = glm::vec3;
using points_type = irradiance_points<S, float>;

random_numbers<float> numbers_of(std::uint64_t path) { return random_numbers<float>{{.seed = 1, .path = path}}; }

/// Irradiance `e` on one side of the square [-1, 1]² in the plane z = 0, known down to `radius`.
std::vector<irradiance_point<S, float>> floor_points(const S& e, float radius, const vec3<float>& normal = {0, 0, 1}) {
    std::vector<irradiance_point<S, float>> points;
    for (int y = -10; y <= 10; ++y) {
        for (int x = -10; x <= 10; ++x) {
            points.push_back({.position = {0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0},
                              .normal = normal,
                              .irradiance = e,
                              .error = 0.5f,
                              .radius = radius});
        }
    }
    return points;
}

toy_scene<S, float> floor_of(const support::material<S>& m) {
    toy_scene<S, float> scene;
    scene.rectangles = {{.corner = {-1, -1, 0}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}, .made_of = m}};
    return scene;
}

const support::bulb<S, float> lamp{.position = {0, 0, 1}, .intensity = S{1}};
const ray<float> down{{0.12f, 0.07f, 0.5f}, {0, 0, -1}};

}  // namespace

TEST_CASE("photon_source: where a ray lands, it reads irradiance times albedo / pi, and its error") {
    const auto scene = floor_of({.diffuse = {0.5f, 0.25f, 0.125f}});
    const points_type points{floor_points({2, 4, 8}, 0.1f)};
    const auto light = photon_source{scene, lamp, points}.incoming(down, numbers_of(0));
    CHECK(light.radiance.x == Approx(1 / pi<float>));
    CHECK(light.radiance.z == Approx(1 / pi<float>));
    CHECK(light.error == Approx(0.5f * 0.5f / pi<float>));
    CHECK(light.distance == 0.5f);
}

TEST_CASE("photon_source: nearer than the photons' spacing, and where no point fits, the path goes on by itself") {
    const auto scene = floor_of({.diffuse = S{0.5f}});
    const points_type coarse{floor_points(S{2}, 0.6f)};
    const points_type wrong_side{floor_points(S{2}, 0.1f, {0, 0, -1})};
    const points_type none;
    for (const auto* points : {&coarse, &wrong_side, &none}) {
        const photon_source source{scene, lamp, *points};
        for (std::uint64_t i = 0; i < 20; ++i) {
            const auto traced = path_tracer{scene, lamp}.incoming(down, numbers_of(i));
            CHECK(source.incoming(down, numbers_of(i)).radiance == traced.radiance);
            CHECK(source.incoming(down, numbers_of(i)).error == 0);
        }
    }
    // The same points are good enough from farther away, or for whoever says so.
    const ray<float> farther{{0.12f, 0.07f, 0.7f}, {0, 0, -1}};
    CHECK(photon_source{scene, lamp, coarse}.incoming(farther, numbers_of(0)).radiance.x == Approx(1 / pi<float>));
    CHECK(photon_source{scene, lamp, coarse, {.near = 0.5}}.incoming(down, numbers_of(0)).radiance.x ==
          Approx(1 / pi<float>));
}

TEST_CASE("photon_source: mirrors are followed to where something can be read") {
    auto scene = floor_of({.diffuse = S{0.5f}});
    scene.rectangles.push_back(
        {.corner = {-1, -1, 1}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, -1}, .made_of = {.mirror = S{0.25f}}});
    const points_type points{floor_points(S{2}, 0.1f)};
    const ray<float> up{{0.12f, 0.07f, 0.5f}, {0, 0, 1}};
    const auto light = photon_source{scene, lamp, points}.incoming(up, numbers_of(0));
    CHECK(light.radiance.x == Approx(0.25f / pi<float>));
    CHECK(light.distance == 0.5f);
}

TEST_CASE("photon_source: a leaf is read on both sides, or not at all") {
    const auto scene = floor_of({.diffuse = S{0.25f}, .transmit = S{0.5f}});
    auto both = floor_points(S{2}, 0.1f);
    const points_type one_side{both};
    const auto below = floor_points(S{10}, 0.1f, {0, 0, -1});
    both.insert(both.end(), below.begin(), below.end());
    const points_type two_sides{both};
    const auto read = photon_source{scene, lamp, two_sides}.incoming(down, numbers_of(0));
    CHECK(read.radiance.x == Approx((0.25f * 2 + 0.5f * 10) / pi<float>));
    const auto traced = path_tracer{scene, lamp}.incoming(down, numbers_of(0));
    CHECK(photon_source{scene, lamp, one_side}.incoming(down, numbers_of(0)).radiance == traced.radiance);
}

TEST_CASE("photon_source: what the asker finds himself is left to him") {
    auto scene = floor_of({.diffuse = S{0.5f}, .glow = S{100}});
    const points_type points{floor_points(S{2}, 0.1f)};
    const photon_source source{scene, lamp, points};
    CHECK(source.incoming(down, numbers_of(0)).radiance.x == Approx(1 / pi<float>));
    CHECK(source.incoming(down, numbers_of(0), emission_rule::all).radiance.x == Approx(100 + 1 / pi<float>));
}

TEST_CASE("photon_source: a point whose disc is cut is read only from where it can be seen") {
    auto points = floor_points(S{2}, 0.1f);
    const points_type whole{points};
    for (auto& p : points) { p.cut = true; }
    const points_type cut{points};
    auto scene = floor_of({.diffuse = S{0.5f}});
    CHECK(photon_source{scene, lamp, cut}.incoming(down, numbers_of(0)).radiance.x == Approx(1 / pi<float>));
    // A low wall between where the ray lands, at 0.12, and the nearest point, at 0.1.
    scene.rectangles.push_back({.corner = {0.11f, -1, 0},
                                .u = {0, 2, 0},
                                .v = {0, 0, 0.2f},
                                .normal = {1, 0, 0},
                                .made_of = {.diffuse = S{0.5f}}});
    const auto traced = path_tracer{scene, lamp}.incoming(down, numbers_of(0));
    CHECK(photon_source{scene, lamp, cut}.incoming(down, numbers_of(0)).radiance == traced.radiance);
    CHECK(photon_source{scene, lamp, whole}.incoming(down, numbers_of(0)).radiance.x == Approx(1 / pi<float>));
}

TEST_CASE("photon_source: caustics are not read where a map of reflected ones shows them") {
    const auto scene = floor_of({.diffuse = S{0.5f}});
    auto points = floor_points(S{2}, 0.1f);
    for (auto& p : points) { p.caustic = S{4}; }
    const points_type stored{points};
    const photon_source source{scene, lamp, stored};
    for (const auto rule : {emission_rule::all, emission_rule::indirect, emission_rule::no_caustics}) {
        CHECK(source.incoming(down, numbers_of(0), rule).radiance.x == Approx(3 / pi<float>));
    }
    CHECK(source.incoming(down, numbers_of(0), emission_rule::no_reflected).radiance.x == Approx(1 / pi<float>));
}
