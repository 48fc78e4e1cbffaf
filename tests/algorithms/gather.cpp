#include <aglow/algorithms/gather.hpp>

#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/glowing_room.hpp"

using namespace aglow;
using support::glowing_room;
using support::point3;

namespace {

template <typename T>
auto light_of(const glowing_room& room) {
    return [&room](const ray<T>& r, const auto&) {
        const auto [wall, distance] = room.meet(r);
        return incoming_light<vec3<T>, T>{vec3<T>(room.glow[static_cast<std::size_t>(wall)]), distance};
    };
}

random_numbers<float> numbers_of(std::uint64_t path) { return random_numbers<float>{{1, 2, path}}; }

}  // namespace

TEST_CASE("gather_irradiance: in a furnace it is pi times radiance, without gradients, curvature or noise") {
    glowing_room room;
    room.glow.fill({0.5, 1, 2});
    const irradiance_estimator<float> estimator{hemisphere_of(200)};
    gather_workspace<vec3<float>, float> workspace;
    for (int i = 0; i < 5; ++i) {
        const gather_point<float> at{{0.1f * float(i), 0.3f, -1}, {0, 0, 1}, 1e-5f};
        const auto e = gather_irradiance(light_of<float>(room), at, numbers_of(1), estimator, workspace);
        CHECK(e.irradiance.y == Approx(pi<float>));
        CHECK(e.relative_noise == 0);
        CHECK(e.gradients.translation.x == vec3<float>{0});
        CHECK(e.curvature == tangent_matrix<float>{});
        CHECK(e.rejected == 0);
        CHECK(e.rays == estimator.shape().count());
    }
}

TEST_CASE("gather_irradiance: agrees with Lambert's formula within the noise it tells") {
    const glowing_room room;
    const irradiance_estimator<double> estimator{hemisphere_of(300)};
    gather_workspace<vec3<double>, double> workspace;
    double chi2 = 0;
    vec3<double> bias{0};
    const int runs = 200;
    for (int i = 0; i < runs; ++i) {
        random_sampler<double> where{static_cast<std::uint64_t>(i)};
        const gather_point<double> at{{where.next_1d() - 0.5, where.next_1d() - 0.5, -1}, {0, 0, 1}, 1e-12};
        const random_numbers<double> numbers{{0, 0, static_cast<std::uint64_t>(i)}};
        const auto e = gather_irradiance(light_of<double>(room), at, numbers, estimator, workspace);
        const vec3<double> off = e.irradiance - room.irradiance(at.position, at.normal);
        chi2 += square(off.x / (e.relative_noise * e.irradiance.x)) / runs;
        bias += off / double(runs);
        const auto once = gather_once(light_of<double>(room), at, numbers, estimator.shape());
        CHECK(glm::length(once - e.irradiance) < 1e-12 * e.irradiance.x);
    }
    // Edges make the told noise too large rather than too small.
    CHECK(chi2 < 1.3);
    CHECK(chi2 > 0.1);
    CHECK(std::abs(bias.x) < 0.003);
}

TEST_CASE("gather_irradiance: turning the world turns the answer") {
    // The same room seen from its floor and from a wall: the glow goes along with the axes.
    const glowing_room room;
    glowing_room turned;
    turned.glow = {room.glow[4], room.glow[5], room.glow[0], room.glow[1], room.glow[2], room.glow[3]};
    const irradiance_estimator<double> estimator{hemisphere_of(20000)};
    gather_workspace<vec3<double>, double> workspace;
    const random_numbers<double> numbers{{0, 0, 1}};
    const gather_point<double> floor{{0.2, 0.4, -1}, {0, 0, 1}, 1e-12};
    const gather_point<double> wall{{-1, 0.2, 0.4}, {1, 0, 0}, 1e-12};
    const auto a = gather_irradiance(light_of<double>(room), floor, numbers, estimator, workspace);
    const auto b = gather_irradiance(light_of<double>(turned), wall, numbers, estimator, workspace);
    const auto world = [](const auto& e) {
        const auto& t = e.gradients.translation;
        return e.axes.to_world({t.x.x, t.y.x, 0});
    };
    const point3 ga = world(a);
    const point3 gb = world(b);
    CHECK(glm::length(a.irradiance - b.irradiance) < 0.01);
    CHECK(glm::length(point3{gb.y, gb.z, gb.x} - ga) < 0.05 * glm::length(ga));
}

TEST_CASE("gather_irradiance: rays start off the surface, on the side of the normal, whichever it is") {
    for (const float side : {1.f, -1.f}) {
        const gather_point<float> at{{0, 0, 3}, {0, 0, side}, 0.25f};
        const auto incoming = [&](const ray<float>& r, const auto&) {
            CHECK(r.origin.z == 3 + side * 0.25f);
            CHECK(r.direction.z * side > 0);
            return incoming_light<float, float>{1, 1};
        };
        gather_workspace<float, float> workspace;
        const auto e = gather_irradiance(incoming, at, numbers_of(3), irradiance_estimator<float>{{4, 9}}, workspace);
        CHECK(e.irradiance == Approx(pi<float>));
    }
}

TEST_CASE("gather_irradiance: bad rays are counted, and the good ones stand in for them") {
    const auto incoming = [](const ray<float>&, const auto& numbers) {
        const bool bad = numbers.at(1, purpose::light).next_1d() < 0.1f;
        return incoming_light<float, float>{bad ? std::numeric_limits<float>::quiet_NaN() : 2.f, 1};
    };
    const gather_point<float> at{};
    const irradiance_estimator<float> estimator{{8, 25}};
    gather_workspace<float, float> workspace;
    const auto e = gather_irradiance(incoming, at, numbers_of(4), estimator, workspace);
    CHECK(e.rejected > 5);
    CHECK(e.rejected < 50);
    CHECK(e.irradiance == Approx(2 * pi<float>));
    CHECK(gather_once(incoming, at, numbers_of(4), estimator.shape()) == Approx(2 * pi<float>));
}

TEST_CASE("gather_hemisphere: the planes that rays meet are told along the axes that are returned") {
    const vec3<float> wall = glm::normalize(vec3<float>{0.5f, -0.2f, 0.7f});
    const auto met = [&](const ray<float>& r, const auto&) {
        const float cosine = glm::dot(r.direction, wall);
        incoming_light<float, float> light{.radiance = 1};
        if (cosine > 0.05f) {
            light.distance = 1 / cosine;
            light.normal = -wall;
        }
        return light;
    };
    hemisphere_grid<float, float> grid{hemisphere_shape{}};
    const gather_point<float> at{.normal = glm::normalize(vec3<float>{0.3f, 0.6f, 0.2f})};
    const frame<float> axes = gather_hemisphere(met, at, numbers_of(3), {6, 18}, grid);
    CHECK(glm::length(axes.z - at.normal) < 1e-6f);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < grid.planes().size(); ++i) {
        if (!(grid.inverse_distance()[i] > 0)) { continue; }
        ++seen;
        const auto& plane = grid.planes()[i];
        // The reciprocal distance of a plane is linear in the direction: here the cosine to the wall.
        CHECK(glm::length(axes.to_world(plane.slope) - wall) < 1e-4f);
        CHECK(glm::dot(axes.to_world(plane.direction), wall) == Approx(grid.inverse_distance()[i]).epsilon(1e-4));
    }
    CHECK(seen > 50);
}
