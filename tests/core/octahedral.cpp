#include <aglow/core/octahedral.hpp>

#include <algorithm>
#include <cmath>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/angle.hpp"
#include "support/catch.hpp"

namespace {

using aglow::octahedral;
using aglow::vec3;
using support::angle;

}  // namespace

static_assert(sizeof(octahedral) == 4);
static_assert(sizeof(aglow::coarse_octahedral) == 2);

TEMPLATE_TEST_CASE("octahedral: a million directions read back within the stated angle, and some are near it", "",
                   float, double) {
    using T = TestType;
    aglow::random_sampler<T> random{1};
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const vec3<T> v = aglow::uniform_sphere(random.next_2d());
        worst = std::max(worst, angle(v, octahedral{v}.template direction<T>()));
    }
    // Half a step in both coordinates, where a face is nearest to the origin: sqrt(18) / 65534.
    CHECK(worst <= 6.5e-5);
    CHECK(worst >= 6e-5);
}

TEST_CASE("octahedral: the axes are exact, either way") {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            vec3<float> v{};
            v[axis] = sign;
            CHECK(octahedral{v}.direction<float>() == v);
        }
    }
}

TEST_CASE("octahedral: the lower pole, the folds and the equator read back") {
    for (const vec3<double> raw : {vec3<double>{1e-9, 0, -1}, vec3<double>{-1e-9, 1e-9, -1}, vec3<double>{1, 1, 0},
                                   vec3<double>{-1, 1, -1e-9}, vec3<double>{0, -1, -1}, vec3<double>{-1, -1, -1}}) {
        const vec3<double> v = glm::normalize(raw);
        CHECK(angle(v, octahedral{v}.direction<double>()) <= 6.5e-5);
    }
}

TEST_CASE("octahedral: what was read back and is stored again does not drift") {
    aglow::random_sampler<double> random{3};
    for (int i = 0; i < 100'000; ++i) {
        const octahedral once{aglow::uniform_sphere(random.next_2d())};
        const vec3<double> v = once.direction<double>();
        REQUIRE(angle(v, octahedral{v}.direction<double>()) <= 1e-15);
    }
}

TEST_CASE("octahedral: what is read back is unit") {
    aglow::random_sampler<float> random{4};
    for (int i = 0; i < 100'000; ++i) {
        const vec3<float> v = octahedral{aglow::uniform_sphere(random.next_2d())}.direction<float>();
        REQUIRE(std::abs(aglow::length2(v) - 1) <= 4 * std::numeric_limits<float>::epsilon());
    }
}

TEST_CASE("octahedral: two bytes read back within their stated angle, without a tilt, and a sign needs no root") {
    aglow::random_sampler<double> random{3};
    double worst = 0;
    vec3<double> tilt{};
    bool same_side = true;
    const int count = 200'000;
    for (int i = 0; i < count; ++i) {
        const vec3<double> v = aglow::uniform_sphere(random.next_2d());
        const vec3<double> n = aglow::uniform_sphere(random.next_2d());
        const aglow::coarse_octahedral packed{v};
        const vec3<double> back = packed.direction<double>();
        worst = std::max(worst, angle(v, back));
        tilt += back - v;
        same_side = same_side && (glm::dot(packed.along<double>(), n) > 0) == (glm::dot(back, n) > 0);
    }
    // Half a step, as above: sqrt(18) / 254.
    CHECK(worst <= 0.0168);
    CHECK(worst >= 0.015);
    CHECK(glm::length(tilt) / count < 4 * 0.0168 / std::sqrt(double(count)));
    CHECK(same_side);
}
