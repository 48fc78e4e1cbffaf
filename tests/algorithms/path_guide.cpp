#include <aglow/algorithms/path_guide.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>
#include <aglow/core/sobol.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::toy_scene;

namespace {

using S = glm::vec3;

/// What paths bring from a few places of the room with a mirror and a glass ball, each by itself.
template <typename Tracer>
std::vector<sample_mean> looked_around(const Tracer& tracer, std::uint64_t paths, std::uint64_t seed) {
    std::vector<sample_mean> means(6);
    for (std::size_t way = 0; way < means.size(); ++way) {
        for (std::uint64_t i = 0; i < paths; ++i) {
            const random_numbers<float> numbers{{.seed = seed, .pass = way, .path = i}};
            const vec2<float> u = numbers.at(0, purpose::camera).next_2d();
            vec3<float> d{0.6f * (u.x - 0.5f), 0.6f * (u.y - 0.5f), 0};
            d[static_cast<int>(way) % 3] += way < 3 ? 1.0f : -1.0f;
            const auto seen = tracer(ray<float>{{0.1f, -0.2f, 0.15f}, glm::normalize(d)}, numbers);
            means[way].add(static_cast<double>(max_component(seen.value)));
        }
    }
    return means;
}

/// All that a guide does at `point`, as one number.
template <typename T>
double fingerprint(const path_guide<T>& guide, const vec3<T>& point, const vec3<T>& normal) {
    const auto* lobes = guide.at(point, normal);
    if (!lobes) { return 0; }
    double sum = static_cast<double>(lobes->chance);
    for (std::size_t i = 0; i < lobes->room; ++i) { sum += static_cast<double>(i + 1) * double(lobes->share[i]); }
    return sum;
}

/// Places on the floor and the ceiling of the room.
template <typename Visit>
void on_floor_and_ceiling(const Visit& visit) {
    for (int i = 0; i < 32 * 32; ++i) {
        const float x = (static_cast<float>(i % 32) + 0.5f) / 16 - 1;
        const float y = (static_cast<float>(i / 32) + 0.5f) / 16 - 1;
        visit(vec3<float>{x, y, -1}, vec3<float>{0, 0, 1});
        visit(vec3<float>{x, y, 1}, vec3<float>{0, 0, -1});
    }
}

/// All photons go one way.
struct laser : support::no_light<S, float> {
    vec3<float> to{0.43f, -0.2f, -0.4f};
    template <Sampler R>
    [[nodiscard]] emission<S, float> emit(R&) const {
        const vec3<float> from{0, 0, 0.875f};
        return {{from, glm::normalize(to - from)}, S{1}};
    }
};

const auto room = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});

}  // namespace

TEST_CASE("path_guide: guided paths bring the same light as others, from everywhere") {
    const path_guide guide{room.scene, room.light};
    REQUIRE(guide.size() > 100);
    const auto plain = looked_around(path_tracer{room.scene, room.light}, 60'000, 1);
    const auto guided = looked_around(guided_path_tracer{room.scene, room.light, guide}, 60'000, 2);
    for (std::size_t way = 0; way < plain.size(); ++way) {
        CAPTURE(way, plain[way].mean(), guided[way].mean());
        const double noise = std::hypot(plain[way].standard_error(), guided[way].standard_error());
        CHECK(std::abs(plain[way].mean() - guided[way].mean()) < 4 * noise);
    }
}

TEST_CASE("path_guide: a guide made of a laser or of few photons or with extreme options changes noise alone") {
    const std::vector<path_guide<float>> guides{{room.scene, laser{}},
                                                {room.scene, room.light, {.cells = 1}},
                                                {room.scene, room.light, {.photons = 100}},
                                                {room.scene, room.light, {.gain = 1e300, .most = 0.25}},
                                                {room.scene, room.light, {.gain = 1e-30}}};
    const auto plain = looked_around(path_tracer{room.scene, room.light}, 40'000, 11);
    for (std::size_t i = 0; i < guides.size(); ++i) {
        const auto guided = looked_around(guided_path_tracer{room.scene, room.light, guides[i]}, 20'000, 12 + i);
        for (std::size_t way = 0; way < plain.size(); ++way) {
            CAPTURE(i, way, plain[way].mean(), guided[way].mean());
            const double noise = std::hypot(plain[way].standard_error(), guided[way].standard_error());
            CHECK(std::abs(plain[way].mean() - guided[way].mean()) < 4.5 * noise);
        }
    }
}

TEMPLATE_TEST_CASE("path_guide: a lamp that touches a mirror lights the floor as one twice as wide", "", float,
                   double) {
    using T = TestType;
    toy_scene<T, T> scene{.rectangles = {{.corner = {0, -8, 0}, .u = {8, 0, 0}, .v = {0, 16, 0}, .normal = {0, 0, 1}},
                                         {.corner = {0, -8, 0}, .u = {0, 16, 0}, .v = {0, 0, 8}, .normal = {1, 0, 0}}}};
    scene.rectangles[0].made_of.diffuse = T(0.5);
    scene.rectangles[1].made_of.mirror = T(1);
    support::met_panel<T, T> lamp{};
    lamp.shape = {.corner = {0, T(-0.25), 1},
                  .u = {T(0.5), 0, 0},
                  .v = {0, T(0.5), 0},
                  .normal = {0, 0, -1},
                  .made_of = {.glow = T(10)}};
    scene.rectangles.push_back(lamp.shape);
    const path_guide guide{scene, lamp};
    REQUIRE(!guide.empty());
    const guided_path_tracer tracer{scene, lamp, guide};
    for (const double x : {0.004, 0.25, 1.0, 4.0}) {
        // Lambert's sum over the edges of the lamp and its image, seen from the floor.
        const vec3<double> place{x, 0.125, 0};
        const vec3<double> corners[] = {{-0.5, -0.25, 1}, {0.5, -0.25, 1}, {0.5, 0.25, 1}, {-0.5, 0.25, 1}};
        double sum = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const vec3<double> a = glm::normalize(corners[i] - place);
            const vec3<double> b = glm::normalize(corners[(i + 1) % 4] - place);
            sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).z;
        }
        const double expected = 0.5 * 10 * std::abs(sum) / (2 * pi<double>);
        const vec3<T> from{static_cast<T>(x + 0.5), T(0.125), T(0.5)};
        const ray<T> eye{from, glm::normalize(vec3<T>(place) - from)};
        sample_mean mean;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            mean.add(static_cast<double>(tracer(eye, random_numbers<T>{{.seed = 13, .path = i}}).value));
        }
        CAPTURE(x, mean.mean(), mean.standard_error(), expected);
        CHECK(mean.agrees(expected, 4, 1e-6));
    }
}

TEST_CASE("path_guide: under the lamp's image in a ball, guided paths are at least four times less noisy") {
    toy_scene<S, float> scene{
        .rectangles = {{.corner = {-2, -2, 0}, .u = {4, 0, 0}, .v = {0, 4, 0}, .normal = {0, 0, 1}}}};
    scene.rectangles[0].made_of.diffuse = S{0.5f};
    scene.balls = {{.centre = {0, 0, 1}, .radius = 0.5f, .made_of = {.mirror = S{1}}}};
    support::met_panel<S, float> lamp{};
    lamp.shape = {.corner = {-0.25f, -0.25f, 2},
                  .u = {0.5f, 0, 0},
                  .v = {0, 0.5f, 0},
                  .normal = {0, 0, -1},
                  .made_of = {.glow = S{10}}};
    scene.rectangles.push_back(lamp.shape);
    const path_guide guide{scene, lamp};
    REQUIRE(!guide.empty());
    const ray<float> eye{{1.5f, 0.2f, 1.5f}, glm::normalize(vec3<float>{-0.1f, -0.1f, -1})};
    const auto seen = [&](const auto& tracer, std::uint64_t seed) {
        sample_mean mean;
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            mean.add(static_cast<double>(tracer(eye, random_numbers<float>{{.seed = seed, .path = i}}).value.x));
        }
        return mean;
    };
    const sample_mean plain = seen(path_tracer{scene, lamp}, 3);
    const sample_mean guided = seen(guided_path_tracer{scene, lamp, guide}, 4);
    CAPTURE(plain.mean(), plain.variance(), guided.mean(), guided.variance());
    CHECK(std::abs(plain.mean() - guided.mean()) < 4 * std::hypot(plain.standard_error(), guided.standard_error()));
    CHECK(4 * guided.variance() < plain.variance());
}

TEST_CASE("path_guide: a furnace with a mirror and a glass ball in it is 1 / (1 - rho) bright, guided too") {
    // Emission that nobody looks at; the guide was made for another lamp, which changes noise alone.
    struct blind : support::no_light<double, double> {
        [[nodiscard]] double pdf(const vec3<double>&, const vec3<double>&,
                                 const support::toy_hit<double, double>&) const {
            return 0;
        }
    };
    const support::bulb<double, double> lamp{.position = {0.3, 0.4, 0.6}, .intensity = 1.0};
    const double albedo = 0.6;
    toy_scene<double, double> box{.rectangles = support::box_walls<double, double>(1, {.diffuse = albedo, .glow = 1})};
    box.balls = {{.centre = {-0.5, 0.25, -0.5}, .radius = 0.4, .made_of = {.mirror = 1.0}},
                 {.centre = {0.4, -0.3, -0.4}, .radius = 0.35, .made_of = {.glass = 1.5}}};
    const path_guide guide{box, lamp};
    REQUIRE(guide.size() > 100);
    const blind dark;
    const guided_path_tracer tracer{box, dark, guide};
    sample_mean mean;
    for (std::uint64_t i = 0; i < 60'000; ++i) {
        const random_numbers<double> numbers{{.seed = 5, .path = i}};
        const vec2<double> u = numbers.at(0, purpose::camera).next_2d();
        mean.add(tracer(ray<double>{{0.1, 0.2, 0.3}, uniform_sphere(u)}, numbers).value);
    }
    CAPTURE(mean.mean(), mean.standard_error());
    CHECK(mean.agrees(1 / (1 - albedo), 4, 1e-6));
}

TEST_CASE("path_guide: paths that the guide is not followed by gain no weight without end") {
    // A bright room with a lamp in a glass ball: nearly every place is guided, so that a path declines again and again.
    toy_scene<float, float> bright_room{.rectangles = support::box_walls<float, float>(1, {.diffuse = 0.9f})};
    bright_room.balls = {{.centre = {0, 0, 0.5f}, .radius = 0.3f, .made_of = {.glass = 1.5f}}};
    support::met_panel<float, float> lamp;
    lamp.shape = {.corner = {-0.1f, -0.1f, 0.5f}, .u = {0.2f, 0, 0}, .v = {0, 0.2f, 0}, .normal = {0, 0, -1}};
    lamp.shape.made_of.glow = 10;
    bright_room.rectangles.push_back(lamp.shape);
    const path_guide guide{bright_room, lamp};
    const guided_path_tracer guided{bright_room, lamp, guide};
    const ray<float> eye{{0.1f, -0.9f, 0.2f}, glm::normalize(vec3<float>{0.1f, 0.3f, -1})};
    float largest = 0;
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        largest = std::max(largest, guided(eye, random_numbers<float>{{.seed = 20, .path = i}}).value);
    }
    // No path by surfaces alone brings more than the lamp's radiance. One that has been declined until it counts four
    // times as much can be so once more, at a chance of `most`.
    CHECK(largest > 10);
    CHECK(static_cast<double>(largest) < 10 * 4 / (1 - path_guide_options{}.most));
}

TEMPLATE_TEST_CASE("path_guide: guided directions follow their density, which integrates to one", "", float, double) {
    using T = TestType;
    detail::guide_lobes<T> lobes;
    lobes.chance = T(0.5);
    for (std::size_t i = 0; i < lobes.room; ++i) {
        const T turn = static_cast<T>(i) * T(2.4);
        const T up = T(0.2) + T(0.03) * static_cast<T>(i);
        lobes.x[i] = std::cos(turn);
        lobes.y[i] = std::sin(turn);
        lobes.z[i] = up;
        lobes.radius2[i] = T(0.02) + T(0.004) * static_cast<T>(i);
        lobes.share[i] = T(2 * i + 1) / static_cast<T>(lobes.room * lobes.room);
    }
    const vec3<T> point{T(0.1), T(-0.2), T(0.1)};
    constexpr std::size_t rows = 16;
    constexpr std::size_t columns = 32;
    constexpr std::size_t fine = 24;
    const auto direction = [](double z, double angle) {
        const double r = std::sqrt(1 - z * z);
        return vec3<T>{T(r * std::cos(angle)), T(r * std::sin(angle)), T(z)};
    };
    std::vector<double> expected(rows * columns);
    double all = 0;
    for (std::size_t i = 0; i < rows * fine * columns * fine; ++i) {
        const std::size_t row = i / (columns * fine);
        const std::size_t column = i % (columns * fine);
        const double z = 2 * (static_cast<double>(row) + 0.5) / (rows * fine) - 1;
        const double angle = 2 * pi<double> * (static_cast<double>(column) + 0.5) / (columns * fine);
        const double p = static_cast<double>(lobes.pdf(point, direction(z, angle))) * 4 * pi<double> /
                         (rows * fine * columns * fine);
        expected[row / fine * columns + column / fine] += p;
        all += p;
    }
    CHECK(all == Approx(1).epsilon(2e-3));
    constexpr std::size_t samples = 100'000;
    std::vector<double> counts(rows * columns);
    for (std::size_t i = 0; i < samples; ++i) {
        random_sampler<T> random{mix(7, i)};
        const std::size_t lobe = lobes.choose(random.next_1d());
        const auto wi = lobes.sample(point, lobe, random.next_2d());
        REQUIRE(wi);
        CHECK(lobes.pdf(point, *wi, lobe) > 0);
        const double angle = std::atan2(double(wi->y), double(wi->x));
        const double turn = angle < 0 ? angle / (2 * pi<double>)+1 : angle / (2 * pi<double>);
        const auto cell = [](double x, std::size_t n) {
            return std::min(static_cast<std::size_t>(std::max(0.0, x * static_cast<double>(n))), n - 1);
        };
        ++counts[cell((double(wi->z) + 1) / 2, rows) * columns + cell(turn, columns)];
    }
    for (double& e : expected) { e *= samples / all; }
    const auto found = statistics::chi2_test(counts, expected);
    CAPTURE(found.chi2, found.degrees);
    CHECK(found.p > 1e-4);
}

TEMPLATE_TEST_CASE("guide_lobes: lobes are chosen as often as their shares say, with shares of nothing among them", "",
                   float, double) {
    using T = TestType;
    constexpr std::size_t most = detail::guide_lobes<T>::room;
    const T third = T(1) / 3;
    std::vector<std::array<T, most>> cases{{1}, {0, 1}, {T(0.5), 0, T(0.25), 0, 0, T(0.25)}, {third, third, 0, third}};
    cases.push_back({});
    cases.back().fill(T(1) / most);
    cases.push_back({});
    cases.back()[0] = cases.back()[most - 1] = T(0.5);
    // By rounding less than 1 together, and nothing after the last.
    cases.push_back({T(0.5), T(0.5) - 4 * std::numeric_limits<T>::epsilon()});
    for (const auto& share : cases) {
        const detail::guide_lobes<T> lobes{.share = share};
        constexpr std::size_t count = 1 << 14;
        std::array<double, most> chosen{};
        for (std::size_t i = 0; i < count; ++i) { ++chosen[lobes.choose((T(i) + T(0.5)) / count)]; }
        for (std::size_t i = 0; i < most; ++i) {
            CAPTURE(i, share[i]);
            CHECK(std::abs(chosen[i] - count * static_cast<double>(share[i])) <= 1);
        }
        CHECK(share[lobes.choose(0)] > 0);
        CHECK(share[lobes.choose(1 - std::numeric_limits<T>::epsilon() / 2)] > 0);
    }
}

TEMPLATE_TEST_CASE("guide_lobes: a cone ends for the density where it ends for the directions, however narrow", "",
                   float, double) {
    using T = TestType;
    for (const T sine2 : {T(1e-4), T(1e-3), T(0.1), T(0.9)}) {
        for (std::uint64_t i = 0; i < 2000; ++i) {
            random_sampler<T> random{mix(10, i)};
            const vec3<T> point = uniform_sphere(vec2<T>(random.next_2d()));
            const vec3<T> to = uniform_sphere(vec2<T>(random.next_2d())) * (1 + 5 * T(random.next_1d()));
            const vec3<T> centre = point + to;
            detail::guide_lobes<T> lobes{.share = {1}};
            lobes.x[0] = centre.x, lobes.y[0] = centre.y, lobes.z[0] = centre.z;
            lobes.radius2[0] = sine2 * length2(to);
            const T height = lobes.one_minus_cosine(sine2);
            const T turn = T(random.next_1d());
            const frame<T> around{glm::normalize(to)};
            CAPTURE(sine2, i);
            CHECK(lobes.pdf(point, around.to_world(uniform_cone({T(1), turn}, height * T(0.9998)))) > 0);
            CHECK(lobes.pdf(point, around.to_world(uniform_cone({T(1), turn}, height * T(1.0002)))) == 0);
        }
    }
}

TEMPLATE_TEST_CASE("guide_lobes: from within a ball nearly half of all directions lead into it, from its centre none",
                   "", float, double) {
    using T = TestType;
    detail::guide_lobes<T> lobes{.share = {1}};
    lobes.x[0] = 1;
    lobes.radius2[0] = T(0.25);
    for (const T away : {T(1e-15), T(1e-3), T(0.49)}) {
        const vec3<T> point{1, 0, away};
        const auto wi = lobes.sample(point, 0, {T(0.5), T(0.25)});
        REQUIRE(wi);
        CHECK(wi->z < 0);
        CHECK(static_cast<double>(lobes.pdf(point, *wi, 0)) == Approx(1 / (2 * pi<double> * 0.9)).epsilon(1e-5));
    }
    const vec3<T> centre{1, 0, 0};
    CHECK(!lobes.sample(centre, 0, {T(0.5), T(0.25)}));
    CHECK(lobes.pdf(centre, {0, 0, 1}) == 0);
}

TEST_CASE("path_guide: what a surface weighs its samples by, guided, still averages to its albedo") {
    const path_guide guide{room.scene, room.light};
    const support::material<S> matte{.diffuse = {0.7f, 0.5f, 0.3f}};
    const support::material<S> mixed{.diffuse = {0.3f, 0.2f, 0.1f}, .glossy = S{0.2f}, .mirror = S{0.3f}};
    std::size_t guided = 0;
    for (const auto& made_of : {matte, mixed}) {
        std::size_t places = 0;
        on_floor_and_ceiling([&](const vec3<float>& point, const vec3<float>& normal) {
            if (!guide.at(point, normal) || ++places % 100 != 0) { return; }
            const support::toy_hit<S, float> hit{point, normal, &made_of, 0};
            const vec3<float> wo = glm::normalize(normal + vec3<float>{0.3f, 0.4f, 0});
            sample_mean with;
            sample_mean without;
            for (std::uint64_t i = 0; i < 20'000; ++i) {
                random_sampler<float> random{mix(8, i)};
                const auto next = guide.sample(hit, wo, random, lobe_set::all);
                with.add(next ? static_cast<double>(next->weight.x) : 0);
                guided += next && next->boost > 1 ? 1 : 0;
                random_sampler<float> other{mix(9, i)};
                const auto plain = hit.sample(wo, other, lobe_set::all);
                without.add(plain ? static_cast<double>(plain->weight.x) : 0);
            }
            CAPTURE(point.x, point.y, point.z, with.mean(), without.mean());
            const double noise = std::hypot(with.standard_error(), without.standard_error());
            CHECK(std::abs(with.mean() - without.mean()) < 4.5 * noise + 1e-6);
        });
        CHECK(places > 300);
    }
    CHECK(guided > 1000);
}

TEST_CASE("path_guide: one thread and three learn the same") {
    const path_guide one{room.scene, room.light};
    const path_guide three{room.scene, room.light, path_guide_options{}, own_threads{3}};
    CHECK(one.size() == three.size());
    std::size_t guided = 0;
    on_floor_and_ceiling([&](const vec3<float>& point, const vec3<float>& normal) {
        guided += one.at(point, normal) ? 1 : 0;
        CHECK(fingerprint(one, point, normal) == fingerprint(three, point, normal));
    });
    CHECK(guided > 300);
}

TEST_CASE("path_guide: scaling geometry or light by a power of two changes no path") {
    const path_guide here{room.scene, room.light};
    const auto look = [](const auto& world, const path_guide<float>& guide, float scale) {
        const guided_path_tracer tracer{world.scene, world.light, guide};
        S sum{};
        for (std::uint32_t i = 0; i < 64; ++i) {
            const sobol_numbers<float> numbers{{.seed = 4}, i};
            const vec2<float> u = numbers.at(0, purpose::camera).next_2d();
            const vec3<float> d = glm::normalize(vec3<float>{u.x - 0.5f, 1, u.y - 0.75f});
            sum += tracer(ray<float>{vec3<float>{0.1f, -0.9f, 0.2f} * scale, d}, numbers).value;
        }
        return sum;
    };
    const S seen = look(room, here, 1);
    CHECK(seen.x > 0);
    for (const int k : {-20, -3, 1, 12, 20}) {
        const float s = std::ldexp(1.0f, k);
        auto larger = room;
        larger.scene = room.scene.scaled(s);
        larger.light.shape.corner *= s;
        larger.light.shape.u *= s;
        larger.light.shape.v *= s;
        CHECK(look(larger, path_guide{larger.scene, larger.light}, s) == seen);
        auto brighter = room;
        brighter.light.shape.made_of.glow *= s;
        brighter.scene.rectangles.back().made_of.glow *= s;
        CHECK(look(brighter, path_guide{brighter.scene, brighter.light}, 1) == seen * s);
    }
}

TEST_CASE("path_guide: a scene without mirrors is not guided, and its paths are those of the path tracer") {
    auto matte = room;
    matte.scene.balls.clear();
    matte.scene.lobes = lobe_set::diffuse_reflection;
    const path_guide guide{matte.scene, matte.light};
    CHECK(guide.empty());
    const path_tracer plain{matte.scene, matte.light};
    const guided_path_tracer guided{matte.scene, matte.light, guide};
    for (std::uint64_t i = 0; i < 200; ++i) {
        const random_numbers<float> numbers{{.seed = 6, .path = i}};
        const ray<float> eye{{0.1f, 0.2f, 0.3f}, uniform_sphere(numbers.at(0, purpose::camera).next_2d())};
        CHECK(plain(eye, numbers).value == guided(eye, numbers).value);
    }
}

TEST_CASE("path_guide: settings out of range are refused by name") {
    const auto make = [](const path_guide_options& options) { return path_guide{room.scene, room.light, options}; };
    CHECK_THROWS_WITH(make({.most = 1}), "most: not between 0 and 1");
    // 1 in single precision, where nothing would be left to the surface.
    CHECK_THROWS_WITH(make({.most = 1 - 1e-9}), "most: not between 0 and 1");
    CHECK_THROWS_WITH(make({.gain = -1}), "gain: below 0");
    CHECK_THROWS_WITH(make({.gain = std::numeric_limits<double>::quiet_NaN()}), "gain: below 0");
    CHECK_THROWS_WITH(make({.cells = 0}), "cells: not between 1 and 256");
    CHECK_THROWS_WITH(make({.cells = 257}), "cells: not between 1 and 256");
}
