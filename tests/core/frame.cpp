#include <aglow/core/frame.hpp>

#include <cmath>
#include <limits>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/catch.hpp"

namespace {

using aglow::frame;
using aglow::vec3;

/// By how many ulps the axes miss being unit, orthogonal and right-handed.
template <typename T>
double defect(const frame<T>& f) {
    const auto off = [](T found, T wanted) { return std::abs(double(found) - double(wanted)); };
    double worst = 0;
    for (const double d :
         {off(glm::dot(f.x, f.x), 1), off(glm::dot(f.y, f.y), 1), off(glm::dot(f.x, f.y), 0),
          off(glm::dot(f.x, f.z), 0), off(glm::dot(f.y, f.z), 0), off(glm::dot(glm::cross(f.x, f.y), f.z), 1)}) {
        worst = std::max(worst, d);
    }
    return worst / double(std::numeric_limits<T>::epsilon());
}

}  // namespace

TEMPLATE_TEST_CASE("frame: the axes are orthonormal and right-handed to 4 ulp for a million normals", "", float,
                   double) {
    using T = TestType;
    aglow::random_sampler<T> random{1};
    double worst = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        worst = std::max(worst, defect(frame<T>{aglow::uniform_sphere(random.next_2d())}));
    }
    CHECK(worst <= 4);
}

TEMPLATE_TEST_CASE("frame: the poles, their surroundings and the equator are no exceptions", "", float, double) {
    using T = TestType;
    for (const T sign : {T(1), T(-1)}) {
        for (T tilt = 1; tilt > std::numeric_limits<T>::min(); tilt /= 8) {
            CHECK(defect(frame<T>{glm::normalize(vec3<T>{tilt, -tilt / 3, sign})}) <= 4);
            CHECK(defect(frame<T>{glm::normalize(vec3<T>{1, T(0.5), sign * tilt})}) <= 4);
        }
        CHECK(defect(frame<T>{vec3<T>{0, 0, sign}}) == 0);
        CHECK(defect(frame<T>{vec3<T>{sign, 0, 0}}) == 0);
        CHECK(defect(frame<T>{vec3<T>{0, sign, 0}}) == 0);
        CHECK(defect(frame<T>{vec3<T>{sign, 0, T(-0.0)}}) == 0);
    }
}

TEMPLATE_TEST_CASE("frame: to the world and back is where it was, and z goes to the normal exactly", "", float,
                   double) {
    using T = TestType;
    aglow::random_sampler<T> random{2};
    for (int i = 0; i < 1000; ++i) {
        const frame<T> around{aglow::uniform_sphere(random.next_2d())};
        const vec3<T> v = aglow::uniform_sphere(random.next_2d());
        CHECK(glm::length(around.to_local(around.to_world(v)) - v) <= 8 * std::numeric_limits<T>::epsilon());
        CHECK(around.to_world({0, 0, 1}) == around.z);
    }
}

TEST_CASE("frame: a fresh one is the world's axes") {
    const vec3<float> v{1, 2, 3};
    CHECK(frame<float>{}.to_world(v) == v);
    CHECK(frame<float>{}.to_local(v) == v);
}
