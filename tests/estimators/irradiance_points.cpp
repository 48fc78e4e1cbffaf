#include <aglow/estimators/irradiance_points.hpp>

#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// A place on the inside of the cube [-1, 1]³.
irradiance_point<float, float> on_wall(random_sampler<float>& random, float irradiance) {
    const int wall = static_cast<int>(random.next_1d() * 6);
    const float side = wall % 2 == 0 ? -1.0f : 1.0f;
    irradiance_point<float, float> p{.irradiance = irradiance, .error = irradiance / 2, .radius = 0.1f};
    p.position[wall / 2] = side;
    p.position[(wall / 2 + 1) % 3] = 2 * random.next_1d() - 1;
    p.position[(wall / 2 + 2) % 3] = 2 * random.next_1d() - 1;
    p.normal[wall / 2] = -side;
    return p;
}

const vec3<float> up{0, 0, 1};

}  // namespace

TEST_CASE("irradiance_points: the nearest of the same side is what brute force finds") {
    random_sampler<float> random{1};
    std::vector<irradiance_point<float, float>> points;
    for (int i = 0; i < 3000; ++i) { points.push_back(on_wall(random, static_cast<float>(i))); }
    const irradiance_points<float, float> stored{points};
    CHECK(stored.size() == points.size());
    for (int i = 0; i < 2000; ++i) {
        const auto query = on_wall(random, 0);
        float best = std::numeric_limits<float>::max();
        float answer = -1;
        for (const auto& p : points) {
            const float d = distance2(p.position, query.position);
            if (p.normal == query.normal && d < best) {
                best = d;
                answer = p.irradiance;
            }
        }
        const auto found = stored.nearest(query.position, query.normal);
        REQUIRE(found);
        CHECK(found->value == answer);
        CHECK(found->error == answer / 2);
        CHECK(found->radius == 0.1f);
    }
}

TEST_CASE("irradiance_points: where nothing was stored, there is no answer") {
    CHECK_FALSE(irradiance_points<float, float>{}.nearest({0, 0, 0}, up));
    std::vector<irradiance_point<float, float>> points;
    for (int i = 0; i < 400; ++i) {
        points.push_back({.position = {0.01f * static_cast<float>(i % 20), 0.01f * static_cast<float>(i / 20), 0},
                          .normal = up,
                          .irradiance = 1});
    }
    const irradiance_points<float, float> stored{points};
    CHECK(stored.nearest({0.1f, 0.1f, 0}, up));
    CHECK_FALSE(stored.nearest({5, 5, 0}, up));
    CHECK_FALSE(stored.nearest({0.1f, 0.1f, 0}, -up));
    CHECK_FALSE(stored.nearest({0.1f, 0.1f, 0}, {1, 0, 0}));
}

TEST_CASE("irradiance_points: a shelf does not answer for the one below it") {
    // Two shelves that both look up, nearer to each other than their points are: the upper one is bright.
    std::vector<irradiance_point<float, float>> points;
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 20; ++x) {
            const float px = static_cast<float>(x);
            const float py = static_cast<float>(y);
            points.push_back({.position = {px, py, 0}, .normal = up, .irradiance = 1});
            points.push_back({.position = {px + 0.5f, py + 0.5f, 0.1f}, .normal = up, .irradiance = 100});
        }
    }
    const irradiance_points<float, float> stored{points};
    random_sampler<float> random{4};
    for (int i = 0; i < 500; ++i) {
        const vec2<float> u = random.next_2d() * 18.0f + 0.5f;
        const auto low = stored.nearest({u.x, u.y, 0}, up);
        REQUIRE(low);
        // Where the lower shelf's own point is farther than four heights, the plane cannot tell them apart.
        const float dx = u.x - std::round(u.x);
        const float dy = u.y - std::round(u.y);
        if (dx * dx + dy * dy < 0.16f) { CHECK(low->value == 1); }
    }
}

TEST_CASE("irradiance_points: broken irradiance is left out") {
    const float broken = std::numeric_limits<float>::quiet_NaN();
    std::vector<irradiance_point<glm::vec3, float>> points{
        {.position = {0, 0, 0}, .normal = up, .irradiance = glm::vec3{broken}},
        {.position = {0.01f, 0, 0}, .normal = up, .irradiance = {1, -1, 0}},
        {.position = {broken, 0, 0}, .normal = up, .irradiance = glm::vec3{1}},
        {.position = {1, 1, 0}, .normal = up, .irradiance = glm::vec3{2}}};
    const irradiance_points<glm::vec3, float> stored{points};
    CHECK(stored.size() == 1);
    const auto found = stored.nearest({1, 1, 0}, up);
    REQUIRE(found);
    CHECK(found->value == glm::vec3{2});
}

TEST_CASE("irradiance_points: scaling by a power of two changes no answer") {
    random_sampler<float> random{1};
    std::vector<irradiance_point<float, float>> points;
    std::vector<irradiance_point<float, float>> queries;
    for (int i = 0; i < 500; ++i) { points.push_back(on_wall(random, static_cast<float>(i))); }
    for (int i = 0; i < 100; ++i) { queries.push_back(on_wall(random, 0)); }
    const irradiance_points<float, float> stored{points};
    for (int k = -30; k <= 30; k += 6) {
        const float s = std::ldexp(1.0f, k);
        auto larger = points;
        for (auto& p : larger) { p.position *= s; }
        const irradiance_points<float, float> scaled{larger};
        for (const auto& q : queries) {
            const auto a = stored.nearest(q.position, q.normal);
            const auto b = scaled.nearest(q.position * s, q.normal);
            REQUIRE(a.has_value() == b.has_value());
            if (a) { CHECK(a->value == b->value); }
        }
    }
}

TEST_CASE(
    "irradiance_points: what all points are off by together is read with each, and broken caustics are left out") {
    std::vector<irradiance_point<float, float>> points(3, {.position = {0, 0, 0}, .normal = up, .irradiance = 3});
    points[1].position.x = 1;
    points[2].position.x = 2;
    points[1].caustic = std::numeric_limits<float>::quiet_NaN();
    points[2].caustic = 2;
    const irradiance_points<float, float> stored{points, in_sequence{}, {.common = 0.1, .bias = -0.02}};
    CHECK(stored.size() == 2);
    const auto found = stored.nearest({2, 0, 0}, up);
    REQUIRE(found);
    CHECK(found->value == 5);
    CHECK(found->without_caustic == 3);
    CHECK(found->common == Approx(0.5));
    CHECK(found->bias == Approx(-0.1));
}

TEST_CASE("shared_error: of two, deviations add by squares and biases as they are, and both are in the error") {
    const shared_error sum = shared_error{.common = 0.3, .bias = 0.1} + shared_error{.common = 0.4, .bias = -0.3};
    CHECK(sum.common == Approx(0.5));
    CHECK(sum.bias == Approx(-0.2));
    const auto e = sum.on(vec3<float>{1, 2, 0}, 1.5f);
    CHECK(e.value == vec3<float>{1, 2, 0});
    CHECK(e.common == Approx(1));
    CHECK(e.bias == Approx(-0.4));
    CHECK(e.error == Approx(2.5));  // 1.5 of its own, and two deviations of 1
}
