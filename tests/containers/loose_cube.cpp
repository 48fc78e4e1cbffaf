#include <aglow/containers/loose_cube.hpp>

#include <cmath>
#include <limits>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
vec3<T> in_unit_cube(random_sampler<T>& random) {
    return {random.next_1d(), random.next_1d(), random.next_1d()};
}

template <typename T>
T farthest_axis(const vec3<T>& a, const vec3<T>& b) {
    return max_abs(a - b);
}

}  // namespace

TEMPLATE_TEST_CASE("loose_cube: the octant of a point holds it, and is an octant of the cube to the bit", "", float,
                   double) {
    using T = TestType;
    random_sampler<T> random{1};
    int wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        const vec3<T> p = in_unit_cube(random) * T(20) - T(10);
        auto cube = detail::loose_cube<T>::around_sphere(p, T(0.1) * random.next_1d());
        wrong += !cube.holds(p, 0);
        const auto wider = cube.doubled();
        const auto again = wider.octant(wider.octant_of(cube.middle));
        wrong += again.middle != cube.middle || again.half != cube.half || !wider.holds(p, 0);
        for (; cube.divisible(); cube = cube.octant(cube.octant_of(p))) { wrong += !cube.holds(p, 0); }
    }
    CHECK(wrong == 0);
}

TEMPLATE_TEST_CASE("loose_cube: neither a wider sphere is held nor a centre on an upper face", "", float, double) {
    using T = TestType;
    const detail::loose_cube<T> cube{vec3<T>{2}, T(1)};
    CHECK(cube.holds(vec3<T>{1}, 1));
    for (int axis = 0; axis < 3; ++axis) {
        vec3<T> upper{2}, below{2};
        upper[axis] = 3;
        below[axis] = std::nextafter(T(1), T(0));
        CHECK_FALSE(cube.holds(upper, 0));
        CHECK_FALSE(cube.holds(below, 0));
    }
    CHECK_FALSE(cube.holds(vec3<T>{1}, T(1.01)));
}

TEMPLATE_TEST_CASE("loose_cube: octants near are those whose boxes come within reach along every axis", "", float,
                   double) {
    using T = TestType;
    random_sampler<T> random{2};
    int wrong = 0, near = 0, far = 0;
    for (int i = 0; i < 5000; ++i) {
        // Sixty-fourths: no sum is rounded.
        const auto coarse = [&] { return std::floor(random.next_1d() * 256 - 128) / 64; };
        const detail::loose_cube<T> cube{vec3<T>{0}, T(1)};
        const vec3<T> p{coarse(), coarse(), coarse()};
        const T reach = std::abs(coarse()) / 2;
        const unsigned found = cube.octants_near(p, reach);
        for (unsigned octant = 0; octant < 8; ++octant) {
            const auto child = cube.octant(octant);
            const vec3<T> nearest = glm::min(glm::max(p, child.middle - child.half), child.middle + child.half);
            const T distance = farthest_axis(p, nearest);
            const bool is_found = (found >> octant & 1u) != 0;
            wrong += distance < reach ? !is_found : distance > reach && is_found;
            ++(is_found ? near : far);
        }
    }
    CHECK(wrong == 0);
    CHECK(near > 5000);
    CHECK(far > 5000);
}

TEMPLATE_TEST_CASE("loose_cube: the cube around a point holds it, however near below zero", "", float, double) {
    using T = TestType;
    const T tiny = std::numeric_limits<T>::denorm_min();
    const T small = std::numeric_limits<T>::min();
    for (const T x : {-tiny, -32 * tiny, -small, -T(1e4) * small, -T(1e-20), T(0), tiny}) {
        for (const T radius : {T(1e-3), T(10), T(5e6)}) {
            const vec3<T> p{x, 1, -x};
            const auto cube = detail::loose_cube<T>::around_sphere(p, radius);
            CAPTURE(x, radius);
            CHECK(cube.holds(p, radius));
            CHECK(cube.doubled().holds(p, radius));
        }
    }
}
