#include <aglow/algorithms/precompute_irradiance.hpp>

#include <glm/vec3.hpp>

#include <aglow/algorithms/trace_photons.hpp>

#include "support/archetypes.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::toy_scene;

namespace {

using S = glm::vec3;

const support::bulb<S, float> lamp{.intensity = {1, 2, 4}};

toy_scene<S, float> sphere(float albedo) { return {.balls = {{.radius = 2, .made_of = {.diffuse = S{albedo}}}}}; }

/// Readings of all that can be read on the inside of the sphere.
template <typename Points>
std::pair<sample_mean, sample_mean> readings(const Points& points) {
    sample_mean value;
    sample_mean error;
    random_sampler<float> random{1};
    for (int i = 0; i < 1000; ++i) {
        const vec3<float> n = uniform_sphere(random.next_2d());
        const auto read = points.nearest(n * 2.0f, -n);
        REQUIRE(read);
        value.add(double(read->value.x));
        error.add(double(read->error));
    }
    return {value, error};
}

}  // namespace

TEST_CASE("precompute_irradiance: in a matte sphere all light is P / (4 pi R2 (1 - rho)), by shadow rays or photons") {
    for (const float albedo : {0.5f, 0.9f}) {
        const auto scene = sphere(albedo);
        const auto maps = trace_photons(scene, lamp, {.direct = 40000, .indirect = 80000});
        const double truth = 1.0 / 4 / (1 - double(albedo));
        for (const std::uint32_t rays : {4u, 0u}) {
            const auto points = precompute_irradiance(scene, lamp, maps, {.every = 8, .shadow_rays = rays});
            const double photons = static_cast<double>(maps.direct.size() + maps.indirect.size());
            CHECK(std::abs(static_cast<double>(points.size()) - photons / 8) < 4 * std::sqrt(photons * 7 / 64));
            const auto [value, error] = readings(points);
            CAPTURE(albedo, rays, value.mean() / truth);
            const double paths = static_cast<double>(maps.indirect.paths);
            const shared_error shared = points.shared();
            CHECK(std::abs(value.mean() / truth - 1) <= std::abs(shared.bias) + 4 * shared.common + 0.003);
            // Of an indirect share rho of all light: see the closed form of `trace_photons`.
            CHECK(shared.common == Approx(double(albedo) / std::sqrt(double(albedo) * paths)).epsilon(0.1));
            CHECK(std::abs(value.mean() - truth) <= error.mean());
        }
    }
}

TEST_CASE("precompute_irradiance: points at every photon, or at every other, are no brighter than they should be") {
    const auto scene = sphere(0.5f);
    const auto maps = trace_photons(scene, lamp, {.direct = 20000, .indirect = 40000});
    for (const std::size_t every : {1u, 2u, 3u}) {
        const auto [value, error] = readings(precompute_irradiance(scene, lamp, maps, {.every = every}));
        CAPTURE(every);
        // Of two or one in k = 50 photons more or less.
        CHECK(value.mean() == Approx(1.0 / 4 / (1 - 0.5)).epsilon(0.03));
    }
}

TEST_CASE("precompute_irradiance: what few direct photons lose at edges is told") {
    const testing::furnace_box<float, float> box{1, 0.5f, 1};
    const testing::furnace_box_light<float, float> light{1, 1};  // direct light and all together: pi, 2 pi everywhere
    for (const std::size_t photons : {2000u, 5000u}) {
        sample_mean mean;
        sample_mean bias;
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            const auto maps = trace_photons(box, light, {.direct = photons, .indirect = 50000, .seed = seed});
            const auto points = precompute_irradiance(box, light, maps, {.shadow_rays = 0, .seed = seed});
            sample_mean read;
            for (std::uint32_t i = 0; i < 500; ++i) {
                sobol_sampler<float> random{98, i};
                const auto hit = box.intersect(ray<float>{{0, 0, 0}, uniform_sphere(random.next_2d())});
                REQUIRE(hit);
                const auto found = points.nearest(hit->position, -hit->normal);
                if (found) { read.add(double(found->value)); }
            }
            mean.add(read.mean() / (2 * pi<double>));
            bias.add(points.shared().bias);
        }
        CAPTURE(photons, mean.mean());
        CHECK(bias.mean() < 0);
        CHECK(std::abs(mean.mean() - 1) < std::abs(bias.mean()) + 0.01);
        CHECK(std::abs(mean.mean() - 1) > std::abs(bias.mean()) / 4);
    }
}

TEST_CASE("precompute_irradiance: 1, 2, 3 and 8 threads and any executor know the same") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const auto maps = trace_photons(room.scene, room.light, {.direct = 1000, .caustic = 1000, .indirect = 2000});
    const auto one = precompute_irradiance(room.scene, room.light, maps);
    const auto check = [&](const auto& run) {
        const auto other = precompute_irradiance(room.scene, room.light, maps, {}, run);
        REQUIRE(other.size() == one.size());
        for (std::size_t i = 0; i < maps.indirect.size(); i += 7) {
            const vec3<float> n = glm::normalize(maps.indirect.photons()[i].normal.direction<float>());
            const auto a = one.nearest(maps.indirect.position(i), n);
            const auto b = other.nearest(maps.indirect.position(i), n);
            REQUIRE((a && b));
            CHECK(a->value == b->value);
            CHECK(a->error == b->error);
            CHECK(a->radius == b->radius);
        }
    };
    for (const unsigned threads : {1u, 2u, 3u, 8u}) { check(own_threads{threads}); }
    check(archetypes::executor{});
}

TEST_CASE("precompute_irradiance: maps of nothing give no points") {
    const photon_maps<S, float> none;
    CHECK(precompute_irradiance(sphere(0.5f), lamp, none).empty());
}

TEST_CASE("precompute_irradiance: a point every none is a point at every photon") {
    const auto scene = sphere(0.5f);
    const auto maps = trace_photons(scene, lamp, {.direct = 500, .pilot_paths = 64});
    CHECK(precompute_irradiance(scene, lamp, maps, {.every = 0}).size() == maps.direct.size());
}

TEST_CASE("precompute_irradiance: direct irradiance is only that of the side asked for, and shadows are black") {
    const support::bulb<S, float> above{.position = {0, 0, 2}, .intensity = S{4}};
    const toy_scene<S, float> empty;
    const vec3<float> up{0, 0, 1};
    CHECK(direct_irradiance(empty, above, vec3<float>{0}, up, 1e-6f, 4, 0).x == Approx(1));
    CHECK(direct_irradiance(empty, above, vec3<float>{0}, -up, 1e-6f, 4, 0) == S{0});
    CHECK(direct_irradiance(empty, above, vec3<float>{0}, up, 1e-6f, 0, 0) == S{0});
    toy_scene<S, float> shaded;
    shaded.balls = {{.centre = {0, 0, 1}, .radius = 0.1f}};
    CHECK(direct_irradiance(shaded, above, vec3<float>{0}, up, 1e-6f, 4, 0) == S{0});
}

TEST_CASE("precompute_irradiance: scaling the scene by a power of two changes no reading") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const photon_options few{.direct = 200, .caustic = 100, .indirect = 500, .pilot_paths = 512};
    const auto maps = trace_photons(room.scene, room.light, few);
    const auto here = precompute_irradiance(room.scene, room.light, maps);
    for (const int k : {-30, -7, 12, 30}) {
        const float s = std::ldexp(1.0f, k);
        auto light = room.light;
        light.shape.corner *= s;
        light.shape.u *= s;
        light.shape.v *= s;
        const auto scene = room.scene.scaled(s);
        const auto there = precompute_irradiance(scene, light, trace_photons(scene, light, few));
        REQUIRE(there.size() == here.size());
        for (std::size_t i = 0; i < maps.indirect.size(); ++i) {
            const vec3<float> n = glm::normalize(maps.indirect.photons()[i].normal.direction<float>());
            const auto a = here.nearest(maps.indirect.position(i), n);
            const auto b = there.nearest(maps.indirect.position(i) * s, n);
            REQUIRE((a && b));
            CHECK(a->value == b->value);
            CHECK(a->error == b->error);
            CHECK(a->radius * s == b->radius);
        }
    }
}
