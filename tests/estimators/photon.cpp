#include <aglow/estimators/photon.hpp>

#include <glm/vec3.hpp>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/catch.hpp"

using namespace aglow;

static_assert(sizeof(photon<glm::vec3>) <= 24);
static_assert(sizeof(photon<float>) <= 16);
static_assert(sizeof(photon<double>) <= 24);
static_assert(std::is_trivially_copyable_v<photon<glm::vec3>>);

TEST_CASE("photon: directions come back within 5e-5 rad and without a tilt") {
    random_sampler<double> random{7};
    vec3<double> tilt{};
    double worst = 0;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
        const vec3<double> w = uniform_sphere(random.next_2d());
        const photon<float> p{1, packed_direction<std::int16_t>{w}, packed_direction<std::int16_t>{w}};
        worst = std::max(worst, glm::length(p.wi.direction<double>() - w));
        tilt += p.wi.direction<double>() - w;
    }
    CHECK(worst < 5e-5);
    // A decoder at the floor of its bins would be off by half a step, 1.5e-5, in the mean.
    CHECK(glm::length(tilt) / count < 1e-6);
}

TEST_CASE("photon: it arrived on the side that it came from") {
    const photon<float> p{1, packed_direction<std::int16_t>{vec3<float>{0, 0.6f, 0.8f}},
                          packed_direction<std::int16_t>{vec3<float>{0, 0, 1}}};
    CHECK(p.arrived_on(vec3<float>{0, 0, 1}));
    CHECK_FALSE(p.arrived_on(vec3<float>{0, 0, -1}));
    CHECK_FALSE(p.arrived_on(vec3<float>{1, 0, 0}));
}
