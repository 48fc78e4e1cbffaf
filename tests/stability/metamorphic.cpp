// Rows 43 to 56: what must not change, or must change exactly so, when the scene does.
#include <cmath>
#include <numeric>
#include <vector>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/precompute_irradiance.hpp>

#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "stability/integrators.hpp"
#include "support/catch.hpp"

using namespace aglow;
using namespace stability;
using statistics::sample_mean;
using gray_scene = support::toy_scene<double, double>;
using gray_bulb = support::bulb<double, double>;

namespace {

/// How many numbers differ between two sets of pictures, the second times `scale`.
template <typename Map>
std::size_t differences(const std::vector<picture>& a, const std::vector<picture>& b, Map&& map) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t p = 0; p < a[i].pixels.size(); ++p) {
            if (map(a[i].pixels[p]) != b[i].pixels[p]) {
                UNSCOPED_INFO(a[i].by << " differs at pixel " << p << ": " << a[i].pixels[p].x << ", "
                                      << b[i].pixels[p].x);
                ++count;
            }
        }
    }
    return count;
}

/// The floor z = 0, reflecting half, seen from above.
gray_scene floor_of(double extent) {
    return {.rectangles = {{.corner = {-extent, -extent, 0},
                            .u = {2 * extent, 0, 0},
                            .v = {0, 2 * extent, 0},
                            .normal = {0, 0, 1},
                            .made_of = {.diffuse = 0.5}}}};
}

/// Mean over `count` paths of the light that comes to `at` from everywhere, W/m² through a small ball.
template <typename World, typename Light>
sample_mean fluence(const World& scene, const Light& light, const vec3<double>& at, std::uint64_t count,
                    std::uint64_t seed) {
    sample_mean mean;
    const path_tracer tracer{scene, light};
    for (std::uint64_t i = 0; i < count; ++i) {
        const random_numbers<double> numbers{{.seed = seed, .path = i}};
        auto random = numbers.at(0, purpose::camera);
        mean.add(tracer(ray<double>{at, uniform_sphere(random.next_2d())}, numbers).value);
    }
    return mean;
}

/// Whether two means agree within four of their standard errors.
bool alike(const sample_mean& a, const sample_mean& b) {
    return std::abs(a.mean() - b.mean()) <= 4 * std::hypot(a.standard_error(), b.standard_error()) + 1e-12;
}

gray_scene matte_room() {
    gray_scene scene{.rectangles = support::box_walls<double, double>(1, {.diffuse = 0.6})};
    scene.balls = {{.centre = {-0.5, 0.25, -0.5}, .radius = 0.375, .made_of = {.diffuse = 0.3}}};
    return scene;
}

support::met_panel<double, double> square(double from, double to, double glow = 5) {
    support::met_panel<double, double> light;
    light.shape = {.corner = {from, -0.25, 0.9375},
                   .u = {to - from, 0, 0},
                   .v = {0, 0.5, 0},
                   .normal = {0, 0, -1},
                   .made_of = {.glow = glow}};
    return light;
}

/// One of two bulbs, each half of the time and twice as bright.
struct both {
    using scalar = double;
    gray_bulb first, second;
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<double, double>> illuminate(const vec3<double>& x, R& random) const {
        const bool one = random.next_1d() < 0.5;
        auto light = (one ? first : second).illuminate(x, random);
        light->radiance_over_pdf *= 2;
        return light;
    }
};

/// One light in two parts.
struct halves {
    using scalar = double;
    support::met_panel<double, double> left, right;
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<double, double>> illuminate(const vec3<double>& x, R& random) const {
        auto light = (random.next_1d() < 0.5 ? left : right).illuminate(x, random);
        if (light) { light->radiance_over_pdf *= 2, light->pdf /= 2; }
        return light;
    }
    [[nodiscard]] double pdf(const vec3<double>& x, const vec3<double>& towards,
                             const support::toy_hit<double, double>& hit) const {
        return (hit.position.x < 0 ? left : right).pdf(x, towards, hit) / 2;
    }
};

}  // namespace

TEST_CASE("stability 43: a room 2^k larger makes the same picture to the bit, by every integrator") {
    const auto here = scaled_room{}.pictures();
    REQUIRE(here.size() == 6);
    for (const picture& p : here) {
        INFO(p.by);
        rgb sum{0};
        for (const rgb& x : p.pixels) { sum += x; }
        CHECK(sum.x > 1);
    }
    for (int k = -30; k <= 30; ++k) {
        CAPTURE(k);
        CHECK(differences(here, scaled_room{std::ldexp(1.0f, k)}.pictures(), [](const rgb& x) { return x; }) == 0);
    }
}

TEST_CASE("stability 44: lights 2^k brighter make a picture 2^k brighter to the bit, by every integrator") {
    const auto here = scaled_room{}.pictures();
    for (int k = -60; k <= 60; ++k) {
        const float power = std::ldexp(1.0f, k);
        CAPTURE(k);
        CHECK(differences(here, scaled_room{1, power}.pictures(), [&](const rgb& x) { return x * power; }) == 0);
    }
}

TEST_CASE("stability 48: permuted bands make a permuted picture to the bit, by every integrator") {
    const auto here = scaled_room{}.pictures();
    CHECK(differences(here, scaled_room(1, 1, 1).pictures(), [](const rgb& x) { return rgb{x.y, x.z, x.x}; }) == 0);
    CHECK(differences(here, scaled_room(1, 1, 2).pictures(), [](const rgb& x) { return rgb{x.z, x.x, x.y}; }) == 0);
}

TEST_CASE("stability 72: any number of threads makes the same picture to the bit, by every integrator") {
    const auto here = scaled_room{}.pictures();
    for (const unsigned threads : {1u, 2u, 3u, 5u, 8u, 16u}) {
        CAPTURE(threads);
        CHECK(differences(here, scaled_room{}.pictures({.threads = threads}), [](const rgb& x) { return x; }) == 0);
    }
}

TEST_CASE("stability 45: a room scaled by a factor that is no power of two is the same to 1e4 ulp") {
    const gray_scene sphere{.balls = {{.radius = 2, .made_of = {.diffuse = 0.5}}}};
    const ray<double> eye{{0.1, 0.2, -0.3}, glm::normalize(vec3<double>{1, 2, -1})};
    const gray_bulb light{.position = {0.9, -0.4, 0.7}, .intensity = 1};
    const double here = direct_light(sphere, light, *sphere.intersect(eye), -eye.direction, 1e-12,
                                     random_sampler<double>{1}, {.scattered = lobe_set::none});
    CHECK(here > 0);
    for (int decade = -12; decade <= 12; ++decade) {
        const double k = std::pow(10.0, decade);
        const gray_bulb moved{.position = light.position * k, .intensity = k * k};
        const gray_scene scaled = sphere.scaled(k);
        const ray<double> seen{eye.origin * k, eye.direction};
        const double there = direct_light(scaled, moved, *scaled.intersect(seen), -eye.direction, 1e-12 * k,
                                          random_sampler<double>{1}, {.scattered = lobe_set::none});
        CAPTURE(decade);
        CHECK(std::abs(there - here) <= 1e4 * 2.3e-16 * here);
        // Whole paths, bounce by bounce the same up to the rounding of each.
        const auto near = looks_along(path_tracer{sphere, light}, eye, 50);
        const auto far = looks_along(path_tracer{scaled, moved}, seen, 50);
        CHECK(std::abs(near.mean() - far.mean()) <= 1e-9 * near.mean());
    }
}

TEST_CASE("stability 46: moved by 2^20, direct light errs by no more than 8 ulp of the place over the feature") {
    const gray_scene floor = floor_of(4);
    for (const double x : {0.0, 0.5, 1.75}) {
        const auto irradiance = [&](double shift) {
            gray_scene moved = floor;
            moved.rectangles[0].corner += vec3<double>{shift};
            const gray_bulb light{.position = vec3<double>{0.25, 0.125, 1} + shift, .intensity = 1};
            const vec3<double> at = vec3<double>{x, 0.25, 0} + shift;
            return direct_irradiance(moved, light, at, {0, 0, 1}, position_error(shift + 4), 1, 1);
        };
        const double here = irradiance(0);
        CHECK(here > 0);
        // Coordinates on a grid of 2^-10 are exact there, so the answer is too, but for the lift off the surface.
        CHECK(std::abs(irradiance(0x1p20) - here) <= 8 * 0x1p-32 * here);
    }
}

TEST_CASE("stability 47: far from the origin, float loses what its ulp explains, and bounds say how much that is") {
    const auto pixel = [](auto one, double shift) {
        using T = decltype(one);
        support::toy_scene<T, T> scene{.rectangles = {{.corner = vec3<T>{T(-4 + shift), T(-4 + shift), T(shift)},
                                                       .u = {8, 0, 0},
                                                       .v = {0, 8, 0},
                                                       .normal = {0, 0, 1},
                                                       .made_of = {.diffuse = T(0.5)}}}};
        const support::bulb<T, T> light{.position = vec3<T>{T(shift), T(shift), T(shift + 1)}, .intensity = 1};
        const ray<T> eye{vec3<T>{T(0.5 + shift), T(shift), T(1 + shift)}, {0, 0, -1}};
        return static_cast<double>(path_trace(scene, light, eye, random_numbers<T>{{}}, {.most_bounces = 1}));
    };
    const double exact = 0.5 / aglow::pi<double> / std::pow(1.25, 1.5);
    CHECK(pixel(1.0, 0) == Approx(exact).epsilon(1e-14));
    CHECK(pixel(1.0, 1e6) == Approx(exact).epsilon(1e-9));
    CHECK(pixel(1.0f, 0) == Approx(exact).epsilon(1e-6));
    // The place is known to an ulp of 1e5 = 2^-7, and E changes by three times as much at most.
    CHECK(pixel(1.0f, 1e5) == Approx(exact).epsilon(3 * 0x1p-7));
    const bounds<float> near{rgb{-4}, rgb{4}};
    const bounds<float> far{rgb{1e6f - 4}, rgb{1e6f + 4}};
    CHECK(coordinate_loss(near) < 1e-6f);
    CHECK(coordinate_loss(bounds<float>{rgb{1e5f}, rgb{1e5f + 8}}) < 0.01f);
    CHECK(coordinate_loss(far) > 0.001f);
    CHECK(coordinate_loss(bounds<float>{rgb{1e6f}, rgb{1e6f + 1}}) > 0.01f);
}

TEST_CASE("stability 49: gray in three bands is gray in one, to the bit") {
    const auto room3 = support::room_with_balls<rgb, float>(rgb{0.6f}, rgb{10});
    const auto room1 = support::room_with_balls<float, float>(0.6f, 10.0f);
    for (std::uint64_t i = 0; i < 500; ++i) {
        const random_numbers<float> numbers{{.path = i}};
        auto random = numbers.at(0, purpose::camera);
        const ray<float> eye{{0.1f, -0.9f, 0.2f}, uniform_sphere(random.next_2d())};
        const rgb colour = path_trace(room3.scene, room3.light, eye, numbers);
        const float gray = path_trace(room1.scene, room1.light, eye, numbers);
        CHECK(colour == rgb{gray});
    }
}

TEST_CASE("stability 50: two lights together are the sum of each alone") {
    gray_scene scene = matte_room();
    const gray_bulb a{.position = {0.5, 0.5, 0.5}, .intensity = 1};
    const gray_bulb b{.position = {-0.5, -0.5, 0.7}, .intensity = 2};
    const vec3<double> at{0.2, 0.1, 0};
    const auto first = fluence(scene, a, at, 20000, 1);
    const auto second = fluence(scene, b, at, 20000, 2);
    const auto together = fluence(scene, both{a, b}, at, 20000, 3);
    const double spread = std::hypot(first.standard_error(), second.standard_error());
    CHECK(std::abs(together.mean() - first.mean() - second.mean()) <=
          4 * std::hypot(spread, together.standard_error()));
    // A photon map of fixed radius is linear in its photons.
    std::vector<landed_photon<double, double>> photons;
    random_sampler<double> random{5};
    for (int i = 0; i < 400; ++i) {
        photons.push_back({{random.next_1d(), random.next_1d(), 0},
                           {random.next_1d(), packed_direction<std::int16_t>{vec3<double>{0, 0, 1}},
                            packed_direction<std::int16_t>{vec3<double>{0, 0, 1}}}});
    }
    const std::span<const landed_photon<double, double>> all{photons};
    const auto e = [](std::span<const landed_photon<double, double>> some) {
        return photon_map<double, double>{some}
            .irradiance({0.5, 0.5, 0}, {0, 0, 1}, {.count = 0, .max_radius = 0.25})
            .value;
    };
    CHECK(std::abs(e(all) - e(all.first(200)) - e(all.last(200))) <= 400 * 2.3e-16 * e(all));
}

TEST_CASE("stability 51: a light cut in two shines like the whole") {
    gray_scene scene = matte_room();
    const auto whole = square(-0.5, 0.5);
    gray_scene with_whole = scene;
    with_whole.rectangles.push_back(whole.shape);
    const halves cut{square(-0.5, 0), square(0, 0.5)};
    gray_scene with_cut = scene;
    with_cut.rectangles.push_back(cut.left.shape);
    with_cut.rectangles.push_back(cut.right.shape);
    const auto a = fluence(with_whole, whole, {0.2, 0.1, 0}, 20000, 1);
    const auto b = fluence(with_cut, cut, {0.2, 0.1, 0}, 20000, 2);
    CAPTURE(a.mean(), b.mean());
    CHECK(alike(a, b));
}

TEST_CASE("stability 52: light from here is seen there as light from there is seen here") {
    gray_scene scene = matte_room();
    scene.balls[0].made_of = {.glossy = 0.5, .exponent = 10};
    const vec3<double> here{0.5, 0.5, 0.5};
    const vec3<double> there{-0.6, -0.5, 0.3};
    const auto forth = fluence(scene, gray_bulb{.position = here, .intensity = 1}, there, 60000, 1);
    const auto back = fluence(scene, gray_bulb{.position = there, .intensity = 1}, here, 60000, 2);
    CAPTURE(forth.mean(), back.mean());
    CHECK(alike(forth, back));
}

TEST_CASE("stability 53: a world turned by a right angle is as bright") {
    gray_scene scene = matte_room();
    gray_scene turned = scene;
    turned.balls[0].centre = {-0.25, -0.5, -0.5};
    const auto a = fluence(scene, gray_bulb{.position = {0.5, 0.25, 0.5}, .intensity = 1}, {0, 0.5, 0}, 20000, 1);
    const auto b = fluence(turned, gray_bulb{.position = {-0.25, 0.5, 0.5}, .intensity = 1}, {-0.5, 0, 0}, 20000, 2);
    CAPTURE(a.mean(), b.mean());
    CHECK(alike(a, b));
}

TEST_CASE("stability 54: a wall that is there twice counts once, by every integrator") {
    scaled_room twice;
    twice.inner.scene.rectangles.push_back(twice.inner.scene.rectangles[1]);
    CHECK(differences(scaled_room{}.pictures(), twice.pictures(), [](const rgb& x) { return x; }) == 0);
}

TEST_CASE("stability 55: a black ball that nothing meets changes nothing, by every integrator") {
    scaled_room beside;
    beside.inner.scene.balls.push_back({.centre = {100, 0, 0}, .radius = 1});
    CHECK(differences(scaled_room{}.pictures(), beside.pictures(), [](const rgb& x) { return x; }) == 0);
}

TEST_CASE("stability 56: no place is brighter than the lights over what the walls take") {
    const double rho = 0.7;
    gray_scene scene{.rectangles = support::box_walls<double, double>(1, {.diffuse = rho})};
    const auto light = square(-0.5, 0.5, 1);
    scene.rectangles.push_back(light.shape);
    random_sampler<double> random{9};
    for (int i = 0; i < 12; ++i) {
        const vec3<double> at{random.next_1d() - 0.5, random.next_1d() - 0.5, random.next_1d() - 0.5};
        const auto mean = fluence(scene, light, at, 2000, static_cast<std::uint64_t>(i));
        CHECK(mean.mean() >= 0);
        CHECK(mean.mean() <= 1 / (1 - rho) + 4 * mean.standard_error());
    }
}
