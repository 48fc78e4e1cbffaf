#include <aglow/core/packed_direction.hpp>

#include <algorithm>
#include <cstdint>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/angle.hpp"
#include "support/catch.hpp"

namespace {

using aglow::packed_direction;
using aglow::vec3;

template <typename I, typename T>
double worst_angle() {
    aglow::random_sampler<T> random{1};
    double worst = 0;
    for (int i = 0; i < 500'000; ++i) {
        const vec3<T> v = aglow::uniform_sphere(random.next_2d());
        worst = std::max(worst, support::angle(v, packed_direction<I>{v}.template direction<T>()));
    }
    return worst;
}

}  // namespace

static_assert(sizeof(packed_direction<std::int8_t>) == 3 && sizeof(packed_direction<std::int16_t>) == 6);

TEMPLATE_TEST_CASE("packed_direction: directions read back within the stated angles", "", float, double) {
    CHECK(worst_angle<std::int16_t, TestType>() <= 3e-5);
    CHECK(worst_angle<std::int8_t, TestType>() <= 0.008);
    CHECK(worst_angle<std::int8_t, TestType>() >= 0.004);
}

TEST_CASE("packed_direction: the axes are exact, either way, and rounding beyond one is cut") {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            vec3<float> v{};
            v[axis] = sign;
            CHECK(packed_direction<std::int8_t>{v}.direction<float>() == v);
            CHECK(packed_direction<std::int16_t>{v}.direction<float>() == v);
            CHECK(packed_direction<std::int8_t>{v * 1.0001f} == packed_direction<std::int8_t>{v});
        }
    }
}
