#include <aglow/algorithms/gloss_layer.hpp>

#include <cmath>

#include <glm/vec3.hpp>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace aglow;
using support::material;
using support::toy_hit;

namespace {

using T = float;

/// A sky over a surface: what comes from a direction.
struct sky {
    vec3<T> slope{0};
    bool half{false};
    [[nodiscard]] T operator()(const vec3<T>& w) const {
        if (half) { return w.x > 0 ? T(2) : T(0); }
        return 1 + glm::dot(slope, w);
    }
};

struct known_light {
    T irradiance;
    vec3<T> mean;
    T misfit;
};

/// What a gather would keep of it.
known_light gathered(const sky& s) {
    constexpr hemisphere_shape shape{24, 96};
    hemisphere_grid<T, T> grid{shape};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            grid.set(j, k, s(hemisphere_direction<T>(shape, j, k, {0.5f, 0.5f})), 1);
        }
    }
    const vec3<T> mean = incident_direction(grid);
    return {grid.irradiance(), mean, linear_misfit(grid, mean)};
}

/// What the lobe makes of the sky, by many directions.
T brute_force(const sky& s, const toy_hit<T, T>& hit, const vec3<T>& wo) {
    double sum = 0;
    constexpr std::uint32_t count = 1 << 16;
    for (std::uint32_t i = 0; i < count; ++i) {
        sobol_sampler<T> random{77, i};
        const auto next = hit.sample(wo, random, lobe_set::glossy_reflection);
        if (next) { sum += static_cast<double>(next->weight * s(next->wi)) / count; }
    }
    return static_cast<T>(sum);
}

constexpr std::size_t size = 12;

/// Into the room, down to its floor.
constexpr auto eye = [](const vec2<float>& film) {
    return ray<float>{{0, -0.9f, 0.3f}, glm::normalize(vec3<float>{film.x / 6 - 1, 1.2f, 0.2f - film.y / 6})};
};

using rgb = glm::vec3;

support::ball_room<rgb, float> glossy_room(double exponent) {
    auto room = support::room_with_balls<rgb, float>({0.6f, 0.5f, 0.4f}, {10, 12, 14});
    room.scene.balls.clear();
    room.scene.rectangles[4].made_of = {.diffuse = rgb{0.2f}, .glossy = rgb{0.4f, 0.5f, 0.5f}, .exponent = exponent};
    room.scene.lobes = lobe_set::diffuse_reflection | lobe_set::glossy_reflection;
    return room;
}

film<rgb> pictured(const auto& integrator, std::uint32_t samples) {
    film<rgb> result{size, size};
    result.expose(eye, integrator, {.samples = samples});
    return result;
}

glossy_caching_options options() {
    glossy_caching_options o;
    o.fill.rays = 1024;
    o.view = {.width = size, .height = size};
    o.gloss.least_spread = 0.05;
    return o;
}

}  // namespace

TEST_CASE("gloss_layer: under even and linear skies a lobe shines as by brute force") {
    for (const double exponent : {2.0, 10.0, 100.0}) {
        const material<T> m{.glossy = 0.8f, .exponent = exponent};
        const toy_hit<T, T> hit{{0, 0, 0}, {0, 0, 1}, &m, 1e-6f};
        for (const vec3<T>& wo : {vec3<T>{0, 0, 1}, glm::normalize(vec3<T>{1, 0.2f, 1})}) {
            for (const sky& s : {sky{}, sky{.slope = {0.5f, 0, 0}}, sky{.slope = {-0.3f, 0.2f, 0.5f}}}) {
                const known_light light = gathered(s);
                const auto lobe = lobe_in(linear_light<T>{light.mean, {0, 0, 1}}, hit, wo, 3, 256);
                CAPTURE(exponent, wo.x, s.slope.x, s.slope.z);
                CHECK(lobe.radiance * light.irradiance == Approx(brute_force(s, hit, wo)).epsilon(0.02));
            }
        }
    }
}

TEST_CASE(
    "gloss_layer: under a half-lit sky the error is within what Cauchy and Schwarz allow, more for narrow lobes") {
    const sky half{.half = true};
    const known_light light = gathered(half);
    double before = 0;
    for (const double exponent : {2.0, 10.0, 100.0}) {
        const material<T> m{.glossy = 0.8f, .exponent = exponent};
        const toy_hit<T, T> hit{{0, 0, 0}, {0, 0, 1}, &m, 1e-6f};
        double stated = 0;
        double largest = 0;
        for (const T tilt : {0.0f, 0.2f, 0.5f, -0.3f, -1.0f}) {
            const vec3<T> wo = glm::normalize(vec3<T>{tilt, 0.1f, 1});
            const auto lobe = lobe_in(linear_light<T>{light.mean, {0, 0, 1}}, hit, wo, 3, 256);
            const double off = std::abs(double(lobe.radiance * light.irradiance - brute_force(half, hit, wo)));
            const double bound = double(light.misfit * light.irradiance * lobe.deviation) / std::sqrt(pi<double>);
            CAPTURE(exponent, tilt, off, bound);
            CHECK(off <= bound + 0.02);
            stated = std::max(stated, bound);
            largest = std::max(largest, off);
        }
        CHECK(stated > before);
        // No statement without content: some view comes near it.
        CHECK(largest > stated / 20);
        before = stated;
    }
}

TEST_CASE("gloss_layer: a mirror has no spread, a lobe of f = cos round the normal a quarter") {
    const auto spread = [](double exponent) {
        const material<T> m{.glossy = 0.8f, .exponent = exponent};
        const toy_hit<T, T> hit{{0, 0, 0}, {0, 0, 1}, &m, 1e-6f};
        return lobe_in(linear_light<T>{}, hit, vec3<T>{0, 0, 1}, 0, 64).spread;
    };
    // Light by f cos = cos^(n + 1) has a mean cosine of (n + 2) / (n + 3).
    for (const double n : {1.0, 5.0, 50.0}) { CHECK(spread(n) == Approx(1 / (n + 3)).epsilon(0.1)); }
    CHECK(spread(1e5) < 1e-4f);
}

TEST_CASE("gloss_layer: of no directions one is drawn") {
    const material<T> m{.glossy = 0.8f, .exponent = 10};
    const toy_hit<T, T> hit{{0, 0, 0}, {0, 0, 1}, &m, 1e-6f};
    const auto with = [&](std::uint32_t samples) {
        return lobe_in(linear_light<T>{}, hit, vec3<T>{0, 0, 1}, 0, samples).radiance;
    };
    CHECK(with(1) > 0);
    CHECK(with(0) == with(1));
}

TEST_CASE("gloss_layer: a room with a broadly glossy floor looks as path tracing says, within the stated error") {
    const auto room = glossy_room(4);
    const bounds<float> box{{-1, -1, -1}, {1, 1, 1}};
    const film<rgb> truth = pictured(path_tracer{room.scene, room.light}, 512);
    const irradiance_caching cached{room.scene, room.light, box, eye, options()};
    STATIC_REQUIRE(decltype(cached)::cache_type::record::features.incident);
    const film<rgb> seen = pictured(cached, 32);
    int covered = 0;
    double off = 0;
    double level = 0;
    for (std::size_t i = 0; i < size * size; ++i) {
        const std::size_t x = i % size, y = i / size;
        const float d = max_component(glm::abs(seen.radiance(x, y) - truth.radiance(x, y)));
        covered += d <= seen.error(x, y) + 3 * truth.error(x, y) ? 1 : 0;
        off += static_cast<double>(seen.radiance(x, y).y - truth.radiance(x, y).y);
        level += static_cast<double>(truth.radiance(x, y).y);
    }
    CAPTURE(covered, off / level);
    CHECK(covered >= 137);
    CHECK(std::abs(off / level) < 0.02);
}

TEST_CASE("gloss_layer: what all that is read from the cache is off by together is told of gloss too") {
    const auto room = glossy_room(4);
    const bounds<float> box{{-1, -1, -1}, {1, 1, 1}};
    const irradiance_caching cached{room.scene, room.light, box, eye, options()};
    const auto nothing = [](auto&&...) { return estimate<rgb>{}; };
    const auto with = [&](const shared_error& shared) {
        const glossy_cache_layers layers{room.scene, room.light, cached.cache(), nothing, {}, shared, nullptr};
        const auto floor = room.scene.intersect({{0.1f, 0.1f, 0}, {0, 0, -1}});
        REQUIRE(floor);
        return layers(*floor, {0, 0, 1}, 1e-6f, random_numbers<float>{{}}, 0);
    };
    const auto told = with({.common = 0.5, .bias = -0.25});
    const auto untold = with({});
    CHECK(told.value == untold.value);
    CHECK(untold.common == 0);
    CHECK(told.common > 0);
    CHECK(told.bias == -told.common / 2);
    CHECK(told.error >= 2 * told.common);
}

TEST_CASE("gloss_layer: lobes narrower than asked for are left to rays, to the last bit") {
    const auto room = glossy_room(1000);
    const bounds<float> box{{-1, -1, -1}, {1, 1, 1}};
    const irradiance_caching with{room.scene, room.light, box, eye, options()};
    const caching_options plain = options();
    const irradiance_caching without{room.scene, room.light, box, eye, plain};
    STATIC_REQUIRE_FALSE(decltype(without)::cache_type::record::features.incident);
    const film<rgb> a = pictured(with, 2);
    const film<rgb> b = pictured(without, 2);
    for (std::size_t i = 0; i < size * size; ++i) {
        CHECK(a.radiance(i % size, i / size) == b.radiance(i % size, i / size));
    }
}
