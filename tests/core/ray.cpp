#include <aglow/core/ray.hpp>

#include <cmath>
#include <limits>

#include "support/catch.hpp"

namespace {

using aglow::vec3;

}  // namespace

TEMPLATE_TEST_CASE("ray: lifting scales exactly with powers of two", "", float, double) {
    using T = TestType;
    const vec3<T> point{T(0.3), T(-1.7), T(12.1)};
    const vec3<T> normal = glm::normalize(vec3<T>{1, 2, T(-0.5)});
    const vec3<T> direction = glm::normalize(vec3<T>{-1, 0, 3});
    const vec3<T> lifted = aglow::lift(point, normal, direction, aglow::position_error(aglow::max_abs(point)));
    for (int k = -60; k <= 60; ++k) {
        const T scale = std::ldexp(T(1), k);
        const vec3<T> p = point * scale;
        INFO("2^" << k);
        CHECK(aglow::lift(p, normal, direction, aglow::position_error(aglow::max_abs(p))) == lifted * scale);
    }
}

TEMPLATE_TEST_CASE("ray: a lifted point is on the side that the ray leaves on, by more than the rounding", "", float,
                   double) {
    using T = TestType;
    const vec3<T> normal = glm::normalize(vec3<T>{1, 2, 3});
    const vec3<T> point{1000, -2000, 1000};  // on the plane through the origin
    const T error = aglow::position_error(aglow::max_abs(point));
    for (const vec3<T>& direction : {normal, vec3<T>(-normal)}) {
        const vec3<T> lifted = aglow::lift(point, normal, direction, error);
        const T height = glm::dot(lifted, direction);
        CHECK(height > error * T(0.9));
        CHECK(height < error * T(1.1));
    }
    CHECK(aglow::lift(point, normal, vec3<T>{-2, 1, 0}, error) == point + normal * error);
}

TEST_CASE("ray: a fresh one reaches without end") {
    CHECK(aglow::ray<float>{}.reach == std::numeric_limits<float>::infinity());
    CHECK(aglow::ray<double>{}.reach == std::numeric_limits<double>::infinity());
}

TEST_CASE("ray: the error of a position is some ulps of its largest coordinate") {
    CHECK(aglow::position_error(1.0f) == 64 * std::numeric_limits<float>::epsilon());
    CHECK(aglow::position_error(4.0) == 4 * aglow::position_error(1.0));
    CHECK(aglow::max_abs(vec3<float>{1, -3, 2}) == 3);
    CHECK(aglow::max_abs(vec3<float>{-1, 0, 0.5f}) == 1);
    CHECK(aglow::max_abs(vec3<float>{0, 1, -2}) == 2);
}
