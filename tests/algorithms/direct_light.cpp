#include <aglow/algorithms/direct_light.hpp>

#include <cmath>
#include <limits>

#include <glm/vec3.hpp>

#include <aglow/algorithms/precompute_irradiance.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::bulb;
using support::panel;
using support::toy_hit;
using support::toy_scene;

namespace {

constexpr double turn2 = 2 * pi<double>;

/// A ball that glows all over, looked at uniformly by area.
struct glowing_ball {
    using scalar = double;
    vec3<double> centre{};
    double radius{1};

    template <Sampler R>
    [[nodiscard]] std::optional<illumination<double, double>> illuminate(const vec3<double>& point, R& random) const {
        const vec3<double> out = uniform_sphere(random.next_2d());
        const vec3<double> across = centre + out * radius - point;
        const double distance = glm::length(across);
        const double cosine = -glm::dot(out, across) / distance;
        if (!(cosine > 0)) { return std::nullopt; }
        const double density = distance * distance / (cosine * 2 * turn2 * radius * radius);
        return illumination<double, double>{across / distance, distance, 1 / density, density};
    }
};

/// Mean of the irradiance that `rays` looks find at a point of an empty scene.
template <typename Light, typename Where>
sample_mean irradiance(const Light& light, const vec3<double>& normal, int count, Where&& where) {
    sample_mean mean;
    random_sampler<double> random{5};
    for (int i = 0; i < count; ++i) {
        const toy_scene<double, double> empty;
        mean.add(direct_irradiance(empty, light, where(random), normal, 1e-9, 1, mix(static_cast<std::uint64_t>(i))));
    }
    return mean;
}

/// A light that answers what it was told to.
struct told_lamp {
    using scalar = float;
    illumination<glm::vec3, float> what{};
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<glm::vec3, float>> illuminate(const glm::vec3&, R&) const {
        return what;
    }
};

/// A bulb whose host tells the density of every light.
struct told_bulb : bulb<glm::vec3, float> {
    [[nodiscard]] float pdf(const glm::vec3&, const glm::vec3&, const toy_hit<glm::vec3, float>&) const { return 0; }
};

const vec3<double> up{0, 0, 1};

/// Radiance that a white matte floor at `point` sends straight up.
template <typename Light>
auto reflected(const toy_scene<glm::vec3, float>& scene, const Light& light, const glm::vec3& point,
               std::uint64_t i = 0) {
    static const support::material<glm::vec3> white_floor{.diffuse = glm::vec3{1}};
    const toy_hit<glm::vec3, float> hit{point, {0, 0, 1}, &white_floor, 1e-6f};
    return direct_light(scene, light, hit, glm::vec3{0, 0, 1}, 1e-6f, random_sampler<float>{mix(i)});
}

}  // namespace

TEST_CASE("direct_light: a bulb lights a floor by I cos / d2, exactly, and nothing below the horizon") {
    const bulb<glm::vec3, float> lamp{.position = {3, 0, 4}, .intensity = {1, 2, 4}};
    const glm::vec3 seen = reflected({}, lamp, {0, 0, 0});
    // cos = 4/5, d² = 25, f = 1/pi.
    CHECK(seen.x == Approx(0.8f / 25 / pi<float>).epsilon(1e-6));
    CHECK(seen.z == Approx(4 * 0.8f / 25 / pi<float>).epsilon(1e-6));
    for (const float z : {0.0f, -1e-9f, -4.0f}) {
        const bulb<glm::vec3, float> low{.position = {3, 0, z}, .intensity = {1, 2, 4}};
        CHECK(reflected({}, low, {0, 0, 0}) == glm::vec3{0});
    }
    const bulb<glm::vec3, float> grazing{.position = {1, 0, 1e-7f}, .intensity = {1, 2, 4}};
    CHECK(reflected({}, grazing, {0, 0, 0}).x == Approx(1e-7f / pi<float>).epsilon(1e-5));
}

TEST_CASE("direct_light: a bulb among lights that scattered rays can meet is theirs to share in nothing") {
    const bulb<glm::vec3, float> lamp{.position = {3, 0, 4}, .intensity = {1, 2, 4}};
    const told_bulb known{lamp};
    CHECK(reflected({}, known, {0, 0, 0}) == reflected({}, lamp, {0, 0, 0}));
    CHECK(reflected({}, known, {0, 0, 0}).x > 0);
}

TEST_CASE("direct_light: a bulb too near for its radiance to be a number is black, never infinite") {
    for (const float d : {1e-2f, 1e-8f, 1e-15f, 1e-20f, 1e-30f, 0.0f}) {
        const bulb<glm::vec3, float> lamp{.position = {0, 0, d}, .intensity = {1, 1, 1}};
        const glm::vec3 seen = reflected({}, lamp, {0, 0, 0});
        CAPTURE(d);
        CHECK(is_radiance(seen));
        if (d > 1e-16f) { CHECK(seen.x == Approx(1 / (pi<float> * d * d)).epsilon(1e-5)); }
    }
}

TEST_CASE("direct_light: a disc on the axis gives pi L R2 / (R2 + h2)") {
    for (const double h : {0.25, 1.0, 5.0}) {
        const panel<double, double> disc{.shape = {.corner = {-1, -1, h},
                                                   .u = {2, 0, 0},
                                                   .v = {0, 2, 0},
                                                   .normal = -up,
                                                   .made_of = {.glow = 1.0},
                                                   .round = true}};
        const auto mean = irradiance(disc, up, 20000, [](auto&) { return vec3<double>{}; });
        CAPTURE(h, mean.mean());
        CHECK(mean.agrees(pi<double> / (1 + h * h)));
    }
}

TEST_CASE("direct_light: a ball above the horizon gives pi L (R / d)2 cos") {
    const glowing_ball ball{.centre = {3, 0, 4}, .radius = 1.5};
    const auto mean = irradiance(ball, up, 60000, [](auto&) { return vec3<double>{}; });
    CHECK(mean.agrees(pi<double> * 0.3 * 0.3 * 0.8));
}

TEST_CASE("direct_light: parallel and perpendicular unit squares see each other by the form factors of the books") {
    const auto anywhere = [](auto& random) {
        const vec2<double> u = random.next_2d();
        return vec3<double>{u.x, u.y, 0};
    };
    const panel<double, double> above{
        .shape = {.corner = {0, 0, 1}, .u = {1, 0, 0}, .v = {0, 1, 0}, .normal = -up, .made_of = {.glow = 1.0}}};
    const panel<double, double> beside{
        .shape = {.corner = {0, 0, 0}, .u = {0, 1, 0}, .v = {0, 0, 1}, .normal = {1, 0, 0}, .made_of = {.glow = 1.0}}};
    const auto parallel = irradiance(above, up, 60000, anywhere);
    CHECK(parallel.agrees(pi<double> * 0.19982489569838746));
    const auto perpendicular = irradiance(beside, up, 60000, anywhere);
    CHECK(perpendicular.agrees(pi<double> * 0.20004377607540316));
}

TEST_CASE("direct_light: what stands between hides the light, and what stands behind does not") {
    const bulb<glm::vec3, float> lamp{.position = {0, 0, 2}, .intensity = {1, 1, 1}};
    const auto plate = [](float z) {
        toy_scene<glm::vec3, float> s;
        s.rectangles = {{.corner = {-1, -1, z}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}}};
        return s;
    };
    CHECK(reflected(plate(1), lamp, {0, 0, 0}) == glm::vec3{0});
    CHECK(reflected(plate(1.99f), lamp, {0, 0, 0}) == glm::vec3{0});
    CHECK(reflected(plate(2.01f), lamp, {0, 0, 0}).x > 0);
    CHECK(reflected(plate(-0.5f), lamp, {0, 0, 0}).x > 0);
    // The surface itself, met a rounding error off, does not hide it.
    CHECK(reflected(plate(0), lamp, {0, 0, 0}).x > 0);
}

TEST_CASE("direct_light: the sky is hidden by anything at any distance") {
    toy_scene<float, float> s;
    const toy_hit<float, float> hit{{0, 0, 0}, {0, 0, 1}, nullptr, 1e-6f};
    const float far = std::numeric_limits<float>::infinity();
    CHECK(sees(s, hit, vec3<float>{0, 0, 1}, far, 1e-6f));
    s.balls = {{.centre = {0, 0, 1000}, .radius = 1}};
    CHECK_FALSE(sees(s, hit, vec3<float>{0, 0, 1}, far, 1e-6f));
    CHECK(sees(s, hit, vec3<float>{0, 1, 0}, far, 1e-6f));
}

TEST_CASE("direct_light: broken radiance and broken directions are black") {
    const float broken = std::numeric_limits<float>::quiet_NaN();
    const glm::vec3 above{0, 0, 1};
    using look = illumination<glm::vec3, float>;
    CHECK(reflected({}, told_lamp{look{above, 1, glm::vec3{1}, 0}}, {}).x > 0);
    for (const look& flawed : {look{above, 1, {1, broken, 1}, 0}, look{above, 1, {1, -1, 1}, 0},
                               look{above, 1, {1, 1, std::numeric_limits<float>::infinity()}, 0},
                               look{glm::vec3{broken}, 1, glm::vec3{1}, 0}}) {
        CHECK(reflected({}, told_lamp{flawed}, {}) == glm::vec3{0});
    }
}

TEST_CASE("direct_light: the shares of two techniques add up to one") {
    for (const double a : {1e-30, 1e-3, 1.0, 1e20}) {
        for (const double b : {1e-25, 0.5, 7.0}) {
            CHECK(balance(a, b) + balance(b, a) == Approx(1));
            CHECK(balance(a, b) == Approx(a / (a + b)));
        }
        CHECK(balance(a, 0.0) == 1);
        CHECK(balance(0.0, a) == 0);
    }
    CHECK(balance(0.0, 0.0) == 0);
    CHECK(balance(std::numeric_limits<double>::quiet_NaN(), 1.0) == 0);
}

TEST_CASE("direct_light: a lamp does not hide itself from places that see it from aside, wherever the scene lies") {
    const auto lamp_at = [](float x) {
        panel<float, float> lamp;
        lamp.shape = {.corner = {x - 0.5f, -0.5f, 3},
                      .u = {1, 0, 0},
                      .v = {0, 1, 0},
                      .normal = {0, 0, -1},
                      .made_of = {.glow = 1}};
        return lamp;
    };
    const toy_scene<float, float> empty;
    for (const float place : {0.f, 10.f, 100.f, 300.f}) {
        for (const float aside : {2.f, 6.f, 13.f, 16.f}) {
            const panel<float, float> lamp = lamp_at(place + aside);
            toy_scene<float, float> scene;
            scene.rectangles = {lamp.shape};
            const vec3<float> point{place, 0, 0};
            const float error = position_error(place + 20);
            const auto seen = [&](const auto& world) {
                return direct_irradiance(world, lamp, point, vec3<float>{0, 0, 1}, error, 64, 7);
            };
            CAPTURE(place, aside);
            CHECK(seen(empty) > 0);
            CHECK(seen(scene) == seen(empty));
        }
    }
}

TEMPLATE_TEST_CASE("direct_light: a plate a thousandth before a light hides it", "", float, double) {
    using T = TestType;
    panel<T, T> lamp;
    lamp.shape = {.corner = {T(-0.5), T(-0.5), 10}, .u = {1, 0, 0}, .v = {0, 1, 0}, .normal = {0, 0, -1}};
    lamp.shape.made_of.glow = 1;
    toy_scene<T, T> scene;
    scene.rectangles = {{.corner = {-1, -1, T(9.999)}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, -1}}};
    CHECK(direct_irradiance(scene, lamp, vec3<T>{0}, vec3<T>{0, 0, 1}, position_error(T(10)), 64, 7) == 0);
}
