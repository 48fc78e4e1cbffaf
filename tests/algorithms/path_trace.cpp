#include <aglow/algorithms/path_trace.hpp>

#include <glm/vec3.hpp>

#include <aglow/core/sobol.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::toy_scene;
using testing::furnace_light;
using testing::furnace_sphere;

namespace {

template <typename Tracer, typename T = typename Tracer::scalar>
sample_mean all_around(const Tracer& tracer, std::uint64_t paths, const vec3<T>& from) {
    sample_mean mean;
    for (std::uint64_t i = 0; i < paths; ++i) {
        const random_numbers<T> numbers{{.seed = 1, .path = i}};
        auto random = numbers.at(0, purpose::camera);
        const vec2<T> u = random.next_2d();
        mean.add(static_cast<double>(max_component(tracer(ray<T>{from, uniform_sphere(u)}, numbers).value)));
    }
    return mean;
}

template <typename S, typename T>
sample_mean radiance_in_furnace(S albedo, std::uint64_t paths) {
    const furnace_sphere<S, T> scene{.radius = T(2), .albedo = albedo, .glow = white<S>()};
    const furnace_light<S, T> light{.radius = T(2), .glow = white<S>()};
    return all_around(path_tracer{scene, light}, paths, vec3<T>{T(0.1), T(0.2), T(-0.3)});
}

using S = glm::vec3;

/// One pixel's worth of paths into the room of balls, summed.
S looked_at(const support::ball_room<S, float>& room, const vec3<float>& eye, float scale = 1) {
    const path_tracer tracer{room.scene, room.light};
    S sum{};
    for (std::uint64_t i = 0; i < 64; ++i) {
        const sobol_numbers<float> numbers{{.seed = 4}, static_cast<std::uint32_t>(i)};
        const vec2<float> u = numbers.at(0, purpose::camera).next_2d();
        const vec3<float> d = glm::normalize(vec3<float>{u.x - 0.5f, 1, u.y - 0.75f});
        sum += tracer(ray<float>{eye * scale, d}, numbers).value;
    }
    return sum;
}

}  // namespace

TEMPLATE_TEST_CASE("path_trace: a spherical furnace of albedo rho is 1 / (1 - rho) bright everywhere", "", float,
                   double) {
    using T = TestType;
    for (const double albedo : {0.5, 0.9, 0.99}) {
        const sample_mean mean = radiance_in_furnace<T, T>(T(albedo), 15000);
        CAPTURE(albedo, mean.mean(), mean.standard_error());
        CHECK(mean.agrees(1 / (1 - albedo), 4, 1e-5));
    }
}

TEST_CASE("path_trace: a black furnace is exactly as bright as its glow") {
    const sample_mean mean = radiance_in_furnace<glm::vec3, float>(glm::vec3{0}, 100);
    CHECK(mean.mean() == 1.0);
    CHECK(mean.variance() == 0.0);
}

TEST_CASE("path_trace: an albedo near one is bright, not dark and not endless") {
    const sample_mean mean = radiance_in_furnace<float, float>(0.9999f, 300);
    CHECK(mean.agrees(1 / (1 - double(0.9999f))));
}

TEST_CASE("path_trace: a box furnace of every lobe is 1 / (1 - rho) bright, and knows no lights by name") {
    // Emission that nobody looks at, met by paths alone.
    struct blind : support::no_light<double, double> {
        [[nodiscard]] double pdf(const vec3<double>&, const vec3<double>&,
                                 const support::toy_hit<double, double>&) const {
            return 0;
        }
    };
    for (const double albedo : {0.0, 0.5, 0.9, 0.99}) {
        const support::material<double> matte{.diffuse = albedo, .glow = 1};
        const support::material<double> mixed{.diffuse = albedo * 0.5, .mirror = albedo * 0.5, .glow = 1};
        for (const auto& wall : {matte, mixed}) {
            const toy_scene<double, double> box{.rectangles = support::box_walls<double, double>(1, wall)};
            const blind dark;
            const auto mean = all_around(path_tracer{box, dark}, 8000, vec3<double>{0.1, 0.2, -0.3});
            CAPTURE(albedo, mean.mean(), mean.standard_error());
            CHECK(mean.agrees(1 / (1 - albedo), 4, 1e-6));
        }
    }
}

TEST_CASE("path_trace: a bulb anywhere in a matte sphere makes the closed form's radiance") {
    const support::bulb<double, double> aside{.position = {0.9, -0.4, 0.7}, .intensity = 1.0};
    const ray<double> eye{{0.1, 0.2, -0.3}, glm::normalize(vec3<double>{1, 2, -1})};
    for (const double albedo : {0.5, 0.9}) {
        const toy_scene<double, double> sphere{.balls = {{.radius = 2, .made_of = {.diffuse = albedo}}}};
        sample_mean mean;
        for (std::uint64_t i = 0; i < 20000; ++i) {
            mean.add(path_trace(sphere, aside, eye, random_numbers<double>{{.path = i}}));
        }
        const auto x = sphere.intersect(eye)->position;
        const vec3<double> across = aside.position - x;
        const double direct = glm::dot(-x / 2.0, across) / std::pow(glm::length(across), 3);
        const double indirect = albedo / (4 * (1 - albedo));
        CHECK(mean.agrees(albedo / pi<double> * (direct + indirect)));
    }
}

TEST_CASE("path_trace: an integrating sphere with a port is as bright as the closed form") {
    const double f = 0.1;
    const double rho = 0.9;
    toy_scene<double, double> sphere{.balls = {{.radius = 1, .made_of = {.diffuse = rho}, .port = 1 - 2 * f}}};
    const support::bulb<double, double> middle{.intensity = 1.0};
    sample_mean mean;
    for (std::uint64_t i = 0; i < 40000; ++i) {
        const random_numbers<double> numbers{{.path = i}};
        mean.add(path_trace(sphere, middle, ray<double>{{0, 0, 0}, {0.6, 0, -0.8}}, numbers));
    }
    // Wall: direct E = I; of what is reflected, 1 - f stays: M = rho (E + (1 - f) M).
    const double reflected = rho * (1 + (1 - f) * rho / (1 - rho * (1 - f)));
    CHECK(mean.agrees(reflected / pi<double>));
}

TEST_CASE("path_trace: scaling geometry or light by a power of two is exact") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const vec3<float> eye{0.1f, -0.9f, 0.2f};
    const S here = looked_at(room, eye);
    CHECK(here.x > 0);
    for (int k = -30; k <= 30; k += 3) {
        const float s = std::ldexp(1.0f, k);
        auto larger = room;
        larger.scene = room.scene.scaled(s);
        larger.light.shape.corner *= s;
        larger.light.shape.u *= s;
        larger.light.shape.v *= s;
        CHECK(looked_at(larger, eye, s) == here);
    }
    for (int k = -60; k <= 60; k += 6) {
        auto brighter = room;
        brighter.light.shape.made_of.glow *= std::ldexp(1.0f, k);
        brighter.scene.rectangles.back().made_of.glow *= std::ldexp(1.0f, k);
        CHECK(looked_at(brighter, eye) == here * std::ldexp(1.0f, k));
    }
}

TEST_CASE("path_trace: permuted bands give a permuted picture") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const auto turned = support::room_with_balls<S, float>({0.5f, 0.3f, 0.7f}, {12, 14, 10});
    const S a = looked_at(room, {0.1f, -0.9f, 0.2f});
    const S b = looked_at(turned, {0.1f, -0.9f, 0.2f});
    CHECK(b == S{a.y, a.z, a.x});
}

TEST_CASE("path_trace: a world without lights is exactly black") {
    const toy_scene<S, float> sphere{.balls = {{.radius = 2, .made_of = {.diffuse = S{0.9f}}}}};
    const support::no_light<S, float> dark;
    const auto mean = all_around(path_tracer{sphere, dark}, 200, vec3<float>{});
    CHECK(mean.mean() == 0);
    const toy_scene<S, float> nothing;
    const auto empty = all_around(path_tracer{nothing, dark}, 10, vec3<float>{});
    CHECK(empty.mean() == 0);
}

TEST_CASE("path_trace: bands of the host's own see a furnace each of its own") {
    using five = support::bands<5>;
    const five albedo{{0, 0.25f, 0.5f, 0.75f, 0.9f}};
    const five ones{{1, 1, 1, 1, 1}};
    const furnace_sphere<five, float> scene{.radius = 2, .albedo = albedo, .glow = ones};
    const furnace_light<five, float> light{.radius = 2, .glow = ones};
    std::array<sample_mean, 5> means;
    for (std::uint64_t i = 0; i < 8000; ++i) {
        const random_numbers<float> numbers{{.path = i}};
        const five seen = path_trace(scene, light, ray<float>{{0.1f, 0, 0}, {0, 0, 1}}, numbers);
        for (std::size_t b = 0; b < 5; ++b) { means[b].add(double(seen.of[b])); }
    }
    for (std::size_t b = 0; b < 5; ++b) { CHECK(means[b].agrees(1 / (1 - double(albedo.of[b])), 4, 1e-5)); }
}
