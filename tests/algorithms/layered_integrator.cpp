#include <aglow/algorithms/layered_integrator.hpp>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/sobol.hpp>

#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::toy_scene;

namespace {

using S = glm::vec3;

/// Means of value and guessed error over a bundle of rays into the room.
struct seen {
    sample_mean value{};
    sample_mean error{};
};

template <typename Integrator>
seen bundle(const Integrator& integrator, const vec3<float>& from, const vec3<float>& to, float width,
            std::uint64_t count) {
    seen result;
    for (std::uint64_t i = 0; i < count; ++i) {
        const random_numbers<float> numbers{{.seed = 3, .path = i}};
        const vec2<float> u = numbers.at(0, purpose::camera).next_2d() - 0.5f;
        const vec3<float> d = glm::normalize(to - from + vec3<float>{u.x * width, 0, u.y * width});
        const auto e = integrator(ray<float>{from, d}, numbers);
        result.value.add(double(e.value.x));
        result.error.add(double(e.error));
    }
    return result;
}

const vec3<float> eye{0, -0.95f, 0};

}  // namespace

TEST_CASE("layered_integrator: without diffuse layers it is path tracing of mirrors, gloss and emission") {
    // A glossy and mirroring floor under a large light: all light that is not specular comes over gloss.
    support::met_panel<S, float> light;
    light.shape = {
        .corner = {-2, -2, 1}, .u = {4, 0, 0}, .v = {0, 4, 0}, .normal = {0, 0, -1}, .made_of = {.glow = S{1}}};
    toy_scene<S, float> scene;
    const support::material<S> shiny{.glossy = S{0.5f}, .mirror = S{0.3f}, .exponent = 30};
    scene.rectangles = {light.shape,
                        {.corner = {-4, -4, 0}, .u = {8, 0, 0}, .v = {0, 8, 0}, .normal = {0, 0, 1}, .made_of = shiny}};
    const layered_integrator layered{scene, light, direct_layer{scene, light}};
    const path_tracer traced{scene, light};
    const vec3<float> from{-1, 0, 0.8f};
    const auto a = bundle(layered, from, {0, 0.5f, 0}, 0.5f, 20000);
    const auto b = bundle(traced, from, {0, 0.5f, 0}, 0.5f, 20000);
    CAPTURE(a.value.mean(), b.value.mean());
    CHECK(std::abs(a.value.mean() - b.value.mean()) <=
          4 * std::hypot(a.value.standard_error(), b.value.standard_error()));
    CHECK(a.error.mean() == 0);
}

TEST_CASE("layered_integrator: gloss beside a mirror and a matte ground is weighed as it was drawn") {
    // Densities must leave the mirror its share, or light is counted twice or lost.
    support::met_panel<S, float> light;
    light.shape = {
        .corner = {-1, -1, 1}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, -1}, .made_of = {.glow = S{1}}};
    toy_scene<S, float> scene;
    const support::material<S> mixed{.diffuse = S{0.2f}, .glossy = S{0.3f}, .mirror = S{0.45f}, .exponent = 8};
    scene.rectangles = {light.shape,
                        {.corner = {-4, -4, 0}, .u = {8, 0, 0}, .v = {0, 8, 0}, .normal = {0, 0, 1}, .made_of = mixed}};
    // No second bounce: the floor sees only the light.
    const layered_integrator layered{scene, light, direct_layer{scene, light}};
    const path_tracer traced{scene, light};
    const vec3<float> from{-1, 0, 0.8f};
    const auto a = bundle(layered, from, {0, 0.2f, 0}, 0.5f, 40000);
    const auto b = bundle(traced, from, {0, 0.2f, 0}, 0.5f, 40000);
    CAPTURE(a.value.mean(), b.value.mean(), a.value.standard_error());
    CHECK(std::abs(a.value.mean() - b.value.mean()) <=
          4 * std::hypot(a.value.standard_error(), b.value.standard_error()));
}

TEST_CASE("layered_integrator: direct, caustic and indirect light add up to path tracing, nothing counted twice") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const auto maps = trace_photons(room.scene, room.light, {.direct = 60000, .caustic = 20000, .indirect = 60000});
    REQUIRE(maps.caustic.status == map_status::full);
    const map_layer<S, float> caustic{maps.caustic, {}};
    const map_layer<S, float> indirect{maps.indirect, {}};
    const map_layer<S, float> direct{maps.direct, {}};
    const layered_integrator rays{room.scene, room.light,
                                  layer_sum{direct_layer{room.scene, room.light}, caustic, indirect}};
    const layered_integrator looked_at{room.scene, room.light, layer_sum{direct, caustic, indirect}};
    const path_tracer traced{room.scene, room.light};
    // A wall; the mirror ball; the glass ball; the caustic below it.
    for (const vec3<float>& to : {vec3<float>{0, 1, 0.25f}, vec3<float>{-0.5f, 0.25f, -0.625f},
                                  vec3<float>{0.4375f, -0.25f, -0.5f}, vec3<float>{0.45f, -0.25f, -0.95f}}) {
        const auto truth = bundle(traced, eye, to, 0.3f, 20000);
        for (const auto& layered : {bundle(rays, eye, to, 0.3f, 3000), bundle(looked_at, eye, to, 0.3f, 3000)}) {
            const double off = std::abs(layered.value.mean() - truth.value.mean());
            const double chance = 4 * std::hypot(layered.value.standard_error(), truth.value.standard_error());
            CAPTURE(to.x, to.z, layered.value.mean(), truth.value.mean(), layered.error.mean(), chance);
            CHECK(off <= chance + 0.5 * layered.error.mean());
            CHECK(off <= 0.1 * truth.value.mean() + chance);
        }
    }
}

TEST_CASE("layered_integrator: photon maps look at a furnace and see 1 / (1 - rho) within their error") {
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) {
        const testing::furnace_sphere<float, float> scene{.radius = 2, .albedo = albedo, .glow = 1};
        const testing::furnace_light<float, float> light{.radius = 2, .glow = 1};
        const double truth = 1 / (1 - double(albedo));
        const photon_mapping shadow_rays{scene, light, {.photons = {.indirect = 40000}}};
        const photon_mapping maps{
            scene, light, {.photons = {.direct = 40000, .indirect = 40000}, .direct_from_map = true}};
        const auto look = [&](const auto& integrator) {
            sample_mean mean;
            sample_mean error;
            for (std::uint64_t i = 0; i < 400; ++i) {
                const random_numbers<float> numbers{{.path = i}};
                const vec3<float> d = uniform_sphere(numbers.at(0, purpose::camera).next_2d());
                const auto e = integrator(ray<float>{{0.1f, 0.2f, -0.3f}, d}, numbers);
                mean.add(double(e.value));
                error.add(double(e.error));
            }
            CAPTURE(albedo, mean.mean() / truth, error.mean() / truth, mean.standard_error() / truth);
            CHECK(std::abs(mean.mean() - truth) <= error.mean() + 4 * mean.standard_error() + 1e-5 * truth);
            // Photons of one path stand and fall together: their number of landings is geometric, its spread its mean.
            const double paths = static_cast<double>(integrator.maps().indirect.paths);
            CHECK(std::abs(mean.mean() / truth - 1) <= 0.01 + 4 * double(albedo) / std::sqrt(paths));
        };
        look(shadow_rays);
        look(maps);
    }
}

TEST_CASE("layered_integrator: both ways from the first glass, what is behind a pane is known without noise") {
    // Straight down through the boundary to a glowing floor, and back up to a glowing ceiling.
    toy_scene<S, float> scene;
    const auto level = [](float z, const vec3<float>& normal, const support::material<S>& m) {
        return support::rectangle<S, float>{
            .corner = {-1, -1, z}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = normal, .made_of = m};
    };
    scene.rectangles = {level(2, {0, 0, -1}, {.glow = S{5}}), level(0, {0, 0, 1}, {.glass = 1.5}),
                        level(-1, {0, 0, 1}, {.glow = S{2}})};
    const support::no_light<S, float> dark;
    const auto none = [](const auto&, const auto&, float, const auto&, std::uint32_t) { return estimate<S>{}; };
    const ray<float> down{{0.1f, 0.2f, 1}, {0, 0, -1}};
    const double reflected = 0.04;  // Fresnel: ((1.5 - 1) / (1.5 + 1))^2
    const double truth = reflected * 5 + (1 - reflected) * 2;
    const auto look = [&](std::uint32_t splits) {
        sample_mean mean;
        const layered_integrator layered{scene, dark, none, {.split = splits}};
        for (std::uint64_t i = 0; i < 4000; ++i) {
            mean.add(double(layered(down, random_numbers<float>{{.path = i}}).value.x));
        }
        return mean;
    };
    const auto both = look(1);
    CHECK(both.mean() == Approx(truth));
    CHECK(both.standard_error() < 1e-6);
    const auto by_chance = look(0);
    CHECK(by_chance.agrees(truth));
    CHECK(by_chance.standard_error() > 0.005);
}

TEST_CASE("layered_integrator: a mirror before the glass is none of those that are followed both ways") {
    // Down to a mirror, up to a pane, through it to a glowing ceiling: the share that the pane sends back comes again.
    toy_scene<S, float> scene;
    const auto level = [](float z, const vec3<float>& normal, const support::material<S>& m) {
        return support::rectangle<S, float>{
            .corner = {-1, -1, z}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = normal, .made_of = m};
    };
    scene.rectangles = {level(3, {0, 0, -1}, {.glow = S{1}}), level(2, {0, 0, 1}, {.glass = 1.5}),
                        level(0, {0, 0, 1}, {.mirror = S{0.5f}})};
    const support::no_light<S, float> dark;
    const auto none = [](const auto&, const auto&, float, const auto&, std::uint32_t) { return estimate<S>{}; };
    const layered_integrator layered{scene, dark, none, {.most_bounces = 3, .split = 1}};
    const ray<float> down{{0.1f, 0.2f, 1}, {0, 0, -1}};
    for (std::uint64_t i = 0; i < 50; ++i) {
        CHECK(layered(down, random_numbers<float>{{.path = i}}).value.x == Approx(0.5 * 0.96));
    }
}

TEST_CASE("layered_integrator: a depth cap keeps as many surfaces as in path tracing") {
    toy_scene<S, float> scene;
    support::met_panel<S, float> light;
    light.shape = {
        .corner = {-1, -1, 2}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, -1}, .made_of = {.glow = S{3}}};
    scene.rectangles = {
        light.shape,
        {.corner = {-1, -1, 0}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}, .made_of = {.mirror = S{0.5f}}}};
    const ray<float> down{{0, 0, 1}, {0, 0, -1}};
    const random_numbers<float> numbers{{.seed = 1}};
    for (const std::uint32_t cap : {1u, 2u, 9u}) {
        const layered_integrator layered{scene, light, direct_layer{scene, light}, {.most_bounces = cap}};
        CHECK(layered(down, numbers).value == path_trace(scene, light, down, numbers, {.most_bounces = cap}));
        CHECK(layered(down, numbers).value == S{1.5f});
    }
}

TEST_CASE("layered_integrator: flawed hosts and layers never break a sum") {
    auto room = support::room_with_balls<S, float>(S{0.6f}, S{1});
    const auto broken_layer = [](const auto& hit, const auto&, float, const auto&, std::uint32_t) {
        const float bad = hit.position.x > 0 ? support::not_a_number : 1.0f;
        return estimate<S>{{1, bad, 1}, bad};
    };
    for (const support::flaw wrong : support::all_flaws) {
        const support::flawed_scene scene{room.scene, wrong};
        const layered_integrator layered{scene, room.light, layer_sum{direct_layer{scene, room.light}, broken_layer}};
        for (std::uint64_t i = 0; i < 300; ++i) {
            const random_numbers<float> numbers{{.path = i}};
            const vec3<float> d = uniform_sphere(numbers.at(0, purpose::camera).next_2d());
            const auto e = layered(ray<float>{{0, 0, 0.3f}, d}, numbers);
            REQUIRE(is_radiance(e.value));
            REQUIRE(is_finite(e.error));
        }
    }
}
