#include <aglow/algorithms/seen_irradiance.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/estimators/irradiance_points.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::toy_scene;

namespace {

using S = glm::vec3;

}  // namespace

TEST_CASE("seen_irradiance: even light is as bright at a wall and in a corner as in the middle of the floor") {
    // 1 W/m² on the floor of a room of 2 x 2 m. Half of a photon's disc at a wall, three quarters in a corner, lie
    // where no photon can be.
    toy_scene<S, float> room;
    room.rectangles = support::box_walls<S, float>(1.0f, {.diffuse = S{0.5f}});
    const vec3<float> up{0, 0, 1};
    const auto shape = GENERATE(kernel_shape::constant, kernel_shape::cone, kernel_shape::epanechnikov,
                                kernel_shape::biweight, kernel_shape::gaussian);
    random_sampler<float> random{5};
    sample_mean middle, wall, near_wall, corner;
    for (int run = 0; run < 200; ++run) {
        std::vector<landed_photon<S, float>> photons;
        for (int i = 0; i < 4000; ++i) {
            const vec2<float> u = random.next_2d();
            const packed_direction<std::int16_t> facing{up};
            photons.push_back({{2 * u.x - 1, 2 * u.y - 1, -1}, {S{4 / 4000.0f}, facing, facing}});
        }
        const photon_map<S, float> map{photons};
        const density_options few{.count = 50, .kernel = shape};
        const std::vector<char> none_left_out;
        const detail::seen_irradiance<toy_scene<S, float>, S> seen{room, map, few, 1e-5f, none_left_out, 1.0f};
        const auto at = [&](float x, float y) {
            const std::array<irradiance_point<S, float>, 1> there{{{.position = {x, y, -1}, .normal = up}}};
            return double(seen(std::span<const irradiance_point<S, float>>{there}).front().value.x);
        };
        const float along = 1.6f * random.next_1d() - 0.8f;
        middle.add(at(along / 2, 0));
        wall.add(at(along, 0.999f));
        near_wall.add(at(-0.94f, along));
        corner.add(at(0.999f, -0.999f));
    }
    for (const sample_mean& m : {middle, wall, near_wall, corner}) {
        CAPTURE(m.mean(), m.standard_error());
        CHECK(std::abs(m.mean() - 1) < 0.22 + 3 * m.standard_error());
        CHECK(m.standard_error() < 0.02);
    }
}

TEST_CASE("seen_irradiance: photons behind a thin wall do not count, and what the wall cuts is told") {
    // 1 W/m² on the floor at one side of a wall, 100 at the other; the wall stands a tenth of a metre away.
    toy_scene<S, float> halves;
    halves.rectangles = {{.corner = {0, -4, 0}, .u = {0, 8, 0}, .v = {0, 0, 1}, .normal = {1, 0, 0}}};
    const vec3<float> up{0, 0, 1};
    std::vector<landed_photon<S, float>> photons;
    random_sampler<float> random{3};
    for (int i = 0; i < 40000; ++i) {
        const vec2<float> u = random.next_2d() * 2.0f - 1.0f;
        const packed_direction<std::int16_t> facing{up};
        photons.push_back({{u.x, u.y, 0}, {S{(u.x < 0 ? 1 : 100) * 4 / 40000.0f}, facing, facing}});
    }
    const photon_map<S, float> map{photons};
    const density_options options{.count = 2000};
    const std::vector<char> none_left_out;
    const detail::seen_irradiance<toy_scene<S, float>, S> seen{halves, map, options, 1e-5f, none_left_out, 1.0f};
    const std::array<irradiance_point<S, float>, 2> places{
        {{.position = {-0.1f, 0, 0}, .normal = up}, {.position = {-0.6f, 0, 0}, .normal = up}}};
    const auto found = seen(std::span<const irradiance_point<S, float>>{places});
    CHECK(map.irradiance(places[0].position, up, options).value.x > 10);
    CHECK(found[0].value.x == Approx(1).epsilon(0.1));
    CHECK(found[0].cut);
    CHECK(found[1].value.x == Approx(1).epsilon(0.1));
    CHECK(!found[1].cut);
    // Half of the photons left out, each with twice the power, make the same light in the mean.
    std::vector<char> every_other(map.size());
    for (std::size_t i = 0; i < every_other.size(); ++i) { every_other[i] = mix(1, i) % 2 == 0; }
    const detail::seen_irradiance<toy_scene<S, float>, S> half{halves, map, options, 1e-5f, every_other, 2.0f};
    const auto less = half(std::span<const irradiance_point<S, float>>{places});
    CHECK(less[1].value.x == Approx(1).epsilon(0.1));
    CHECK(less[1].radius > 1.3f * found[1].radius);
}

TEST_CASE("seen_irradiance: a ball does not hide its own photons where the floor cuts their disc") {
    // 1 W/m² all over a ball that touches the floor.
    const float radius = 0.3f;
    const vec3<float> centre{0, 0, radius};
    toy_scene<S, float> scene;
    scene.balls = {{.centre = centre, .radius = radius}};
    scene.rectangles = {{.corner = {-1, -1, 0}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}}};
    random_sampler<float> random{6};
    constexpr std::array<float, 4> heights{-0.95f, -0.9f, -0.8f, -0.5f};
    std::array<sample_mean, 4> value;
    std::array<sample_mean, 4> told;
    for (int run = 0; run < 20; ++run) {
        std::vector<landed_photon<S, float>> photons;
        for (int i = 0; i < 2000; ++i) {
            const vec3<float> n = uniform_sphere(random.next_2d());
            const packed_direction<std::int16_t> facing{n};
            photons.push_back({centre + n * radius, {S{4 * pi<float> * radius * radius / 2000}, facing, facing}});
        }
        const photon_map<S, float> map{photons};
        const density_options density{};
        const std::vector<char> none_left_out;
        const detail::seen_irradiance<toy_scene<S, float>, S> seen{scene, map, density, 1e-5f, none_left_out, 1.0f};
        for (std::size_t h = 0; h < heights.size(); ++h) {
            for (int i = 0; i < 16; ++i) {
                const float angle = 2 * pi<float> * (static_cast<float>(i) + random.next_1d()) / 16;
                const float across = std::sqrt(1 - square(heights[h]));
                const vec3<float> n{across * std::cos(angle), across * std::sin(angle), heights[h]};
                const std::array<irradiance_point<S, float>, 1> there{{{.position = centre + n * radius, .normal = n}}};
                const auto read = seen(std::span<const irradiance_point<S, float>>{there}).front();
                value[h].add(double(read.value.x));
                told[h].add(double(read.error));
                CHECK((h > 0 || read.cut));
            }
        }
    }
    for (std::size_t h = 0; h < heights.size(); ++h) {
        CAPTURE(heights[h], value[h].mean(), told[h].mean());
        CHECK(std::abs(value[h].mean() - 1) < 0.2);
    }
}
