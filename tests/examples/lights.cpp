#include "common/lights.hpp"

#include <aglow/core/sobol.hpp>

#include "common/light_set.hpp"
#include "common/scenes/registry.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/polygon.hpp"

namespace {

using aglow::vec2;
using aglow::vec3;

template <typename T>
host::scene_description<T> lamp_over_nothing(const host::rectangle<T>& r) {
    host::scene_description<T> s{.name = "lamp", .about = ""};
    const std::size_t lamp = s.add({.radiance = {3, 2, 1}});
    const vec3<T> x = r.along * r.width;
    const vec3<T> y = r.across * r.height;
    s.add_quad(r.corner, r.corner + x, r.corner + x + y, r.corner + y, lamp);
    return s;
}

template <typename T>
std::vector<vec3<double>> corners(const host::rectangle<T>& r) {
    const vec3<double> c(r.corner);
    const vec3<double> x = vec3<double>(r.along) * static_cast<double>(r.width);
    const vec3<double> y = vec3<double>(r.across) * static_cast<double>(r.height);
    return {c, c + x, c + x + y, c + y};
}

}  // namespace

TEMPLATE_TEST_CASE("lights: a rectangle shines as Lambert's formula says, near and far", "", float, double) {
    using T = TestType;
    // Faces down from y = 2.
    const host::rectangle<T> r{{-1, 2, T(-0.5)}, {1, 0, 0}, {0, 0, 1}, 2, 1};
    const host::scene<T> scene{lamp_over_nothing(r)};
    REQUIRE(scene.lights().size() == 1);
    for (const vec3<T>& p :
         {vec3<T>{0, 0, 0}, vec3<T>{T(0.3), T(1.9), T(0.2)}, vec3<T>{1, T(1.5), T(2)}, vec3<T>{9, -3, 5}}) {
        for (const vec3<T>& n : {vec3<T>{0, 1, 0}, glm::normalize(vec3<T>{1, 1, -2}), vec3<T>{0, -1, 0}}) {
            const auto e = static_cast<T>(support::irradiance(vec3<double>(p), vec3<double>(n), corners(r)));
            const auto v = laws::illuminator(scene.lights(), scene, p, n, vec3<T>{3, 2, 1} * e, {.samples = 20000});
            INFO(v.message);
            CHECK(v.ok);
        }
    }
}

TEMPLATE_TEST_CASE("lights: a triangle shines as Lambert's formula says", "", float, double) {
    using T = TestType;
    const std::array<vec3<T>, 3> p{vec3<T>{0, 2, 0}, vec3<T>{0, 2, 2}, vec3<T>{-1, T(2.5), T(0.5)}};
    const host::triangle_light<T> light{p[0], p[1], p[2], vec3<T>{1}, T(0)};
    const std::vector<vec3<double>> shape{vec3<double>(p[0]), vec3<double>(p[1]), vec3<double>(p[2])};
    const vec3<T> at{T(-0.5), 0, 1};
    statistics::sample_mean mean;
    aglow::random_sampler<T> random{4};
    for (int i = 0; i < 40000; ++i) {
        const auto seen = light.illuminate(at, random.next_2d());
        mean.add(seen ? static_cast<double>(seen->radiance_over_pdf.x * std::max(T(0), seen->towards.y)) : 0.0);
    }
    INFO(mean.mean());
    CHECK(mean.mean() > 0);
    CHECK(mean.agrees(support::irradiance(vec3<double>(at), {0, 1, 0}, shape), 4, 1e-5));
}

TEMPLATE_TEST_CASE("lights: a sphere shines like a disc: E = pi L (r / d)^2 cos", "", float, double) {
    using T = TestType;
    host::scene_description<T> s{.name = "ball", .about = ""};
    const std::size_t lamp = s.add({.radiance = {3, 2, 1}});
    s.add_sphere({0, 4, 0}, 1, lamp);
    const host::scene<T> scene{s};
    for (const vec3<T>& p : {vec3<T>{0, 0, 0}, vec3<T>{0, T(2.9), 0}, vec3<T>{2, 1, 0}, vec3<T>{0, -40, 0}}) {
        const vec3<T> to = vec3<T>{0, 4, 0} - p;
        const T d2 = aglow::length2(to);
        // Holds while the whole sphere is above the horizon, as it is with the normal towards it.
        const T e = aglow::pi<T> / d2;
        const auto v =
            laws::illuminator(scene.lights(), scene, p, to / std::sqrt(d2), vec3<T>{3, 2, 1} * e, {.samples = 20000});
        INFO(v.message);
        CHECK(v.ok);
    }
}

TEST_CASE("lights: within a glowing sphere irradiance is pi L everywhere") {
    host::scene_description<double> s{.name = "inside", .about = ""};
    const std::size_t glow = s.add({.radiance = vec3<double>{2}});
    s.spheres.push_back({{1, 2, 3}, 2, glow, true});
    const host::scene<double> scene{s};
    for (const vec3<double>& p : {vec3<double>{1, 2, 3}, vec3<double>{2, 2.5, 3}, vec3<double>{1, 3.5, 3.2}}) {
        const auto v = laws::illuminator(scene.lights(), scene, p, vec3<double>{0, 0.6, 0.8},
                                         vec3<double>{2 * aglow::pi<double>}, {.samples = 40000});
        INFO(v.message);
        CHECK(v.ok);
    }
}

TEST_CASE("lights: a lamp without size shines with I cos / d^2") {
    host::light_set<double> lights;
    lights.add(host::point_light<double>{{0, 3, 4}, {10, 5, 1}});
    aglow::random_sampler<double> random{1};
    const auto seen = lights.illuminate({0, 0, 0}, random);
    REQUIRE(seen);
    CHECK(seen->distance == Approx(5));
    CHECK(seen->pdf == 0);
    CHECK(seen->radiance_over_pdf.x * seen->towards.y == Approx(10 * 0.6 / 25));
    CHECK(laws::emitter(lights, vec3<double>{10, 5, 1} * (4 * aglow::pi<double>)).ok);
}

TEST_CASE("lights: the open sky shines with pi times its cosine-weighted mean") {
    const host::sky<double> s{
        .ground = vec3<double>{0.5}, .horizon = vec3<double>{1, 2, 3}, .zenith = vec3<double>{3, 2, 1}};
    aglow::bounds<double> box;
    box.add({-1, -1, -1});
    box.add({1, 1, 1});
    host::light_set<double> lights;
    lights.add(host::sky_light<double>{s, box, 0});
    host::geometry<double> nothing;
    nothing.finish();
    const auto e = [](double horizon, double zenith) {
        // ∫ (h + (z - h) y) y dw over the upper half = pi h + (z - h) 2 pi / 3.
        return aglow::pi<double> * horizon + (zenith - horizon) * 2 * aglow::pi<double> / 3;
    };
    const vec3<double> p{0.1, 0.2, 0.3};
    host::scene_description<double> empty{.name = "empty", .about = ""};
    empty.add_sphere({0, 1e6, 0}, 1e-3, empty.add({}));
    const host::scene<double> scene{empty};
    const vec3<double> up{e(1, 3), e(2, 2), e(3, 1)};
    CHECK(laws::illuminator(lights, scene, p, vec3<double>{0, 1, 0}, up, {.samples = 30000}).ok);
    CHECK(laws::illuminator(lights, scene, p, vec3<double>{0, -1, 0}, vec3<double>{0.5 * aglow::pi<double>},
                            {.samples = 30000})
              .ok);
    CHECK(laws::emitter(lights, lights.power()).ok);
    // Power: pi r^2 times ∫ L dw = 2 pi (ground + mean of horizon and zenith).
    CHECK(lights.power().x == Approx(aglow::pi<double> * 3 * 2 * aglow::pi<double> * (0.5 + 2)));
}

TEST_CASE("lights: the open sky's particles flow evenly through every place") {
    // In a constant sky of radiance L the mean of power / (area of the disc) over all particles is the fluence 4 pi L /
    // pi..; counted here as what crosses a small sphere: pi r^2 times 4 pi L watts.
    const host::sky<double> s{.ground = vec3<double>{1}};
    aglow::bounds<double> box;
    box.add({-1, -1, -1});
    box.add({1, 1, 1});
    const host::sky_light<double> light{s, box, 0};
    aglow::random_sampler<double> random{8};
    for (const vec3<double>& centre : {vec3<double>{0, 0, 0}, vec3<double>{0.8, -0.6, 0.3}}) {
        statistics::sample_mean through;
        for (int i = 0; i < 100000; ++i) {
            const vec2<double> u = random.next_2d();
            const auto e = light.emit(u, random.next_2d());
            const vec3<double> from = centre - e.path.origin;
            const double along = glm::dot(from, e.path.direction);
            const double miss2 = aglow::length2(from) - along * along;
            through.add(along > 0 && miss2 < 0.04 ? e.power.x : 0.0);
        }
        INFO(through.mean());
        CHECK(through.agrees(aglow::pi<double> * 0.04 * 4 * aglow::pi<double>));
    }
}

TEMPLATE_TEST_CASE("lights: every built-in scene's lights send out the power they say", "", float, double) {
    for (const auto& description : host::scenes::all<TestType>()) {
        const host::scene<TestType> scene{description};
        const auto v = laws::emitter(scene.lights(), scene.lights().power(), {.samples = 20000});
        INFO(description.name << ": " << v.message);
        CHECK(v.ok);
    }
}

TEMPLATE_TEST_CASE("lights: in every built-in scene looking at lights finds what rays find", "", float, double) {
    for (const auto& description : host::scenes::all<TestType>()) {
        // Of no size, no ray meets a lamp; in the furnace a light stands before another, which this law does not know.
        if (!description.lamps.empty() || description.name == "furnace") { continue; }
        const host::scene<TestType> scene{description};
        const auto b = scene.bounds();
        // Two places in the air of each.
        for (const TestType x : {TestType(0.31), TestType(0.73)}) {
            const vec3<TestType> p = b.low + b.extent() * vec3<TestType>{x, TestType(0.58), TestType(0.4)};
            const auto n = glm::normalize(vec3<TestType>{x, 1, -x});
            const auto v = laws::illuminator_meets_rays(scene.lights(), scene, p, n, {.samples = 40000});
            INFO(description.name << ": " << v.message);
            CHECK(v.ok);
        }
    }
}

TEMPLATE_TEST_CASE("spherical_rectangle: its angle is that of the four corners' two triangles", "", float, double) {
    using T = TestType;
    const host::rectangle<T> r{{-1, 2, T(-0.5)}, {1, 0, 0}, {0, 0, 1}, 2, 1};
    const auto p = corners(r);
    // Van Oosterom & Strackee 1983, (8).
    const auto triangle = [](vec3<double> a, vec3<double> b, vec3<double> c) {
        a = glm::normalize(a);
        b = glm::normalize(b);
        c = glm::normalize(c);
        const double det = std::abs(glm::dot(a, glm::cross(b, c)));
        return 2 * std::atan2(det, 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
    };
    aglow::random_sampler<double> random{6};
    for (int i = 0; i < 1000; ++i) {
        const vec3<double> eye{4 * random.next_1d() - 2, 4 * random.next_1d(), 4 * random.next_1d() - 2};
        if (std::abs(eye.y - 2) < 0.01) { continue; }
        const double truth =
            triangle(p[0] - eye, p[1] - eye, p[2] - eye) + triangle(p[0] - eye, p[2] - eye, p[3] - eye);
        const host::spherical_rectangle<T> seen{r, vec3<T>(eye)};
        CHECK(static_cast<double>(seen.solid_angle()) == Approx(truth).margin(sizeof(T) == 4 ? 2e-6 : 1e-14));
    }
}

TEST_CASE("spherical_rectangle: its points lie in it and are uniform by solid angle") {
    const host::rectangle<double> r{{-1, 2, -0.5}, {1, 0, 0}, {0, 0, 1}, 2, 1};
    const vec3<double> eye{0.7, 1.8, 0.9};
    const host::spherical_rectangle<double> seen{r, eye};
    constexpr std::size_t n = 8;
    std::array<double, n * n> counts{};
    std::array<double, n * n> expected{};
    aglow::random_sampler<double> random{6};
    constexpr int samples = 40000;
    for (int i = 0; i < samples; ++i) {
        const vec3<double> at = seen.at(random.next_2d()) - r.corner;
        REQUIRE(std::abs(at.y) < 1e-9);
        const auto x = std::min(n - 1, static_cast<std::size_t>(at.x / 2 * n));
        const auto z = std::min(n - 1, static_cast<std::size_t>(at.z * n));
        REQUIRE((at.x >= 0 && at.z >= 0 && at.x <= 2 && at.z <= 1));
        counts[z * n + x] += 1;
    }
    for (std::size_t i = 0; i < n * n; ++i) {
        const host::rectangle<double> cell{r.at({double(i % n) / n, double(i / n) / n}), r.along, r.across, 2.0 / n,
                                           1.0 / n};
        expected[i] = samples * host::spherical_rectangle<double>{cell, eye}.solid_angle() / seen.solid_angle();
    }
    CHECK(statistics::chi2_test(counts, expected).p > 1e-4);
}

TEST_CASE("light_set: one stratified number chooses the light and the place") {
    host::light_set<double> lights;
    lights.add(host::point_light<double>{{0, 0, 1}, vec3<double>{1}});
    lights.add(host::point_light<double>{{0, 1, 0}, vec3<double>{3}});
    int first = 0;
    constexpr std::uint32_t n = 1024;
    for (std::uint32_t i = 0; i < n; ++i) {
        aglow::sobol_sampler<double> random{77, i};
        first += lights.illuminate({0, 0, 0}, random)->towards.z > 0.5;
    }
    CHECK(first == 256);
}

TEST_CASE("light_set: without a light there is nothing to see or send") {
    const host::light_set<float> dark;
    aglow::random_sampler<float> random{1};
    CHECK_FALSE(dark.illuminate({0, 0, 0}, random));
    CHECK(dark.emit(random).power == vec3<float>{0});
    CHECK(dark.power() == vec3<float>{0});
}
