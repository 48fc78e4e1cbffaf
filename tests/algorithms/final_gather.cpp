#include <aglow/algorithms/final_gather.hpp>

#include <limits>
#include <stdexcept>
#include <utility>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::material;
using support::toy_hit;

namespace {

using S = glm::vec3;

/// Answers every gather ray alike, whatever it asks.
template <typename F>
struct answers {
    F light;
    template <typename N>
    [[nodiscard]] incoming_light<S, float> incoming(const ray<float>& r, const N&, emission_rule) const {
        return light(r);
    }
};
template <typename F>
answers(F) -> answers<F>;

random_numbers<float> numbers_of(std::uint64_t path) { return random_numbers<float>{{.seed = 1, .path = path}}; }

template <typename Layer>
estimate<S> gathered(const Layer& layer, const material<S>& m, std::uint64_t path, const vec3<float>& wo = {0, 0, 1}) {
    return layer(toy_hit<S, float>{{0, 0, 0}, {0, 0, 1}, &m, 1e-6f}, wo, 1e-6f, numbers_of(path), 1);
}

const material<S> matte{.diffuse = {0.5f, 0.25f, 0.125f}};

template <typename Integrator>
sample_mean bundle(const Integrator& integrator, const vec3<float>& from, const vec3<float>& to, std::uint64_t count,
                   sample_mean& error) {
    const float width = 0.3f * glm::distance(from, to);
    sample_mean mean;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto numbers = numbers_of(i);
        const vec2<float> u = numbers.at(0, purpose::camera).next_2d() * width;
        const auto e = integrator(ray<float>{from, glm::normalize(to - from + vec3<float>{u.x, 0, u.y})}, numbers);
        mean.add(double(e.value.x));
        error.add(double(e.error));
    }
    return mean;
}

}  // namespace

TEST_CASE("final_gather: even light is reflected by the albedo, without noise") {
    const answers even{[](const ray<float>&) { return incoming_light<S, float>{S{2}, 1, 0.5f, 0.125f, -0.25f}; }};
    const auto e = gathered(gather_layer{even}, matte, 0);
    CHECK(e.value.x == Approx(1));
    CHECK(e.value.z == Approx(0.25));
    // No spread of its own. What the map's errors have in common stays; what each ray's has for itself, its spread
    // would tell.
    CHECK(e.common == Approx(0.5f * 0.125f).epsilon(1e-3));
    CHECK(e.bias == Approx(-0.5f * 0.25f).epsilon(1e-3));
    CHECK(e.error == Approx(0.5f * (0.25f + 2 * 0.125f)).epsilon(1e-3));
}

TEST_CASE("final_gather: a sky with a cosine gives two thirds, and the guess covers what is off") {
    const answers cosine{[](const ray<float>& r) { return incoming_light<S, float>{S{r.direction.z}}; }};
    sample_mean mean;
    int covered = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const auto e = gathered(gather_layer{cosine, {.rays = 16}}, matte, i);
        mean.add(double(e.value.x));
        covered += std::abs(e.value.x - 1.0f / 3) <= 2 * e.error ? 1 : 0;
    }
    CHECK(mean.agrees(1.0 / 3));
    CHECK(covered > 1900);
}

TEST_CASE("final_gather: few rays, even one, do not make the stated error small") {
    const answers cosine{[](const ray<float>& r) { return incoming_light<S, float>{S{r.direction.z}}; }};
    for (const std::uint32_t rays : {1u, 2u, 4u}) {
        running_mean value;
        running_mean error;
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const auto e = gathered(gather_layer{cosine, {.rays = rays}}, matte, i);
            value.add(double(e.value.x));
            error.add(double(e.error));
        }
        CAPTURE(rays);
        CHECK(error.mean() > value.deviation());
    }
}

TEST_CASE("final_gather: rays start off the surface, on the side that they leave by") {
    const answers side{[](const ray<float>& r) {
        CHECK(r.origin.z * r.direction.z > 0);
        CHECK(std::abs(glm::length(r.direction) - 1) < 1e-5f);
        return incoming_light<S, float>{r.direction.z > 0 ? S{1} : S{10}};
    }};
    const material<S> leaf{.diffuse = S{0.25f}, .transmit = S{0.5f}};
    sample_mean mean;
    for (std::uint64_t i = 0; i < 500; ++i) { mean.add(double(gathered(gather_layer{side}, leaf, i).value.x)); }
    CHECK(mean.agrees(0.25 + 5));
    CHECK(gathered(gather_layer{side}, leaf, 0, {0, 0, -1}).value.x > 1);
}

TEST_CASE("final_gather: nothing to gather for mirrors, nor without rays, and broken light is left out") {
    const answers loud{[](const ray<float>&) -> incoming_light<S, float> { throw std::logic_error("asked"); }};
    const material<S> mirror{.mirror = S{1}};
    CHECK(gathered(gather_layer{loud}, mirror, 0).value == S{0});
    CHECK(gathered(gather_layer{loud, {.rays = 0}}, matte, 0).value == S{0});
    const answers broken{[](const ray<float>& r) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        return r.direction.x > 0 ? incoming_light<S, float>{{1, nan, 1}} : incoming_light<S, float>{S{2}};
    }};
    const auto e = gathered(gather_layer{broken}, matte, 0);
    CHECK(is_radiance(e.value));
    CHECK(e.value.x == Approx(0.5).epsilon(0.2));
}

TEST_CASE("final_gather: light and guess are scaled exactly by powers of two") {
    const auto with = [](float s) {
        const answers sky{[=](const ray<float>& r) {
            return incoming_light<S, float>{S{r.direction.z * s}, 1, 0.1f * s};
        }};
        return gathered(gather_layer{sky}, matte, 3);
    };
    const auto here = with(1);
    for (int k = -60; k <= 60; k += 4) {
        const float s = std::ldexp(1.0f, k);
        CHECK(with(s).value == here.value * s);
        CHECK(with(s).error == here.error * s);
    }
}

TEST_CASE("final_gather: a furnace is 1 / (1 - rho) bright within the error that is told") {
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) {
        const testing::furnace_sphere<float, float> scene{.radius = 2, .albedo = albedo, .glow = 1};
        const testing::furnace_light<float, float> light{.radius = 2, .glow = 1};
        const final_gathering gather{scene, light, {.photons = {.direct = 4000, .indirect = 40000}, .rays = 16}};
        const double truth = 1 / (1 - double(albedo));
        sample_mean mean;
        sample_mean error;
        for (std::uint64_t i = 0; i < 300; ++i) {
            const auto numbers = numbers_of(i);
            const vec3<float> d = uniform_sphere(numbers.at(0, purpose::camera).next_2d());
            const auto e = gather(ray<float>{{0.1f, 0.2f, -0.3f}, d}, numbers);
            mean.add(double(e.value));
            error.add(double(e.error));
        }
        CAPTURE(albedo, mean.mean() / truth, error.mean() / truth);
        CHECK(std::abs(mean.mean() - truth) <= error.mean() + 4 * mean.standard_error() + 1e-5 * truth);
        const double paths = static_cast<double>(gather.maps().indirect.paths);
        CHECK(std::abs(mean.mean() / truth - 1) <= 0.01 + 4 * double(albedo) / std::sqrt(paths));
    }
}

TEST_CASE(
    "final_gather: a room of balls is as path tracing sees it, with maps of caustics and their reflection, and "
    "without") {
    const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    const path_tracer traced{room.scene, room.light};
    const final_gathering with_caustics{
        room.scene, room.light, {.photons = {.direct = 5000, .caustic = 20000, .indirect = 40000}, .rays = 16}};
    const final_gathering without{room.scene, room.light, {.photons = {.direct = 5000, .indirect = 40000}, .rays = 16}};
    const final_gathering with_reflected{
        room.scene,
        room.light,
        {.photons = {.direct = 5000, .caustic = 20000, .indirect = 40000, .reflected = 20000}, .rays = 16}};
    REQUIRE(with_caustics.maps().caustic.status == map_status::full);
    REQUIRE(with_reflected.maps().reflected.status == map_status::full);
    // A wall; the floor between the balls; the caustic of the glass ball, from below it.
    const vec3<float> eye{0, -0.95f, 0};
    const std::pair<vec3<float>, vec3<float>> looks[] = {
        {eye, {0, 1, 0.25f}}, {eye, {0, 0.3f, -1}}, {{0.45f, -0.25f, -0.9f}, {0.45f, -0.25f, -1}}};
    for (const auto& [from, to] : looks) {
        sample_mean none;
        const auto truth = bundle(traced, from, to, 20000, none);
        CHECK(none.mean() == 0);
        sample_mean error;
        const auto a = bundle(with_caustics, from, to, 800, error);
        const double chance = 4 * std::hypot(a.standard_error(), truth.standard_error());
        CAPTURE(a.mean(), truth.mean(), error.mean(), chance);
        CHECK(std::abs(a.mean() - truth.mean()) <= chance + 0.5 * error.mean());
        CHECK(std::abs(a.mean() - truth.mean()) <= chance + 0.05 * truth.mean());
        const auto c = bundle(with_reflected, from, to, 800, error);
        const double chance_c = 4 * std::hypot(c.standard_error(), truth.standard_error());
        CAPTURE(c.mean(), chance_c);
        CHECK(std::abs(c.mean() - truth.mean()) <= chance_c + 0.05 * truth.mean());
        // Without the map, gather rays find caustics by chance: noisy, and right in the mean.
        const auto b = bundle(without, from, to, 800, error);
        const double chance_b = 4 * std::hypot(b.standard_error(), truth.standard_error());
        CAPTURE(b.mean(), chance_b);
        CHECK(std::abs(b.mean() - truth.mean()) <= chance_b + 0.05 * truth.mean());
    }
}
