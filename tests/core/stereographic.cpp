#include <aglow/core/stereographic.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/angle.hpp"
#include "support/catch.hpp"

namespace {

using aglow::stereographic;
using aglow::vec3;
using support::angle;

}  // namespace

static_assert(sizeof(stereographic) == 4);

TEMPLATE_TEST_CASE("stereographic: a million directions read back within the stated angle, and some are near it", "",
                   float, double) {
    using T = TestType;
    aglow::random_sampler<T> random{1};
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const vec3<T> v = aglow::uniform_sphere(random.next_2d());
        worst = std::max(worst, angle(v, stereographic{v}.template direction<T>()));
    }
    // Half a step in both coordinates at a pole, where a step turns twice as far: sqrt((1/32767)² + (1/16383)²).
    CHECK(worst <= 7e-5);
    CHECK(worst >= 6e-5);
}

TEST_CASE("stereographic: the axes are exact, of any length") {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            vec3<float> v{};
            v[axis] = sign;
            CHECK(stereographic{v}.direction<float>() == v);
            CHECK(stereographic{v * 5.f}.direction<float>() == v);
        }
    }
    CHECK(stereographic{}.direction<float>() == vec3<float>{0, 0, 1});
}

TEST_CASE("stereographic: both poles, the equator and what is just below it read back") {
    for (const vec3<double> raw : {vec3<double>{1e-9, 0, -1}, vec3<double>{-1e-9, 1e-9, 1}, vec3<double>{1, 1, 0},
                                   vec3<double>{-1, 1, -1e-9}, vec3<double>{0, -1, -1}, vec3<double>{-1, -3, 1e-5}}) {
        const vec3<double> v = glm::normalize(raw);
        CHECK(angle(v, stereographic{v}.direction<double>()) <= 7e-5);
    }
}

TEST_CASE("stereographic: what is read back is unit, and its frame is the one of that normal") {
    aglow::random_sampler<float> random{4};
    for (int i = 0; i < 100'000; ++i) {
        vec3<float> v = aglow::uniform_sphere(random.next_2d());
        if (i % 4 == 0) { v = glm::normalize(vec3<float>{v.x, v.y, v.z * 1e-5f}); }
        const stereographic packed{v};
        const auto turned = packed.turned<float>();
        REQUIRE(std::abs(aglow::length2(turned.normal) - 1) <= 8 * std::numeric_limits<float>::epsilon());
        const aglow::frame<float> axes{turned}, of_normal{turned.normal};
        const vec3<float> way = aglow::uniform_sphere(random.next_2d());
        REQUIRE(glm::length(turned.to_local(way) - axes.to_local(way)) <= 1e-6f);
        REQUIRE(glm::length(axes.x - of_normal.x) + glm::length(axes.y - of_normal.y) <= 2e-6f);
    }
}
