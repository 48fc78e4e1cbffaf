#include <aglow/core/bounds.hpp>

#include <cmath>
#include <limits>

#include <aglow/core/numbers.hpp>

#include "support/catch.hpp"

namespace {

using aglow::bounds;
using aglow::vec3;

}  // namespace

TEMPLATE_TEST_CASE("bounds: a fresh box is empty, small and contains nothing", "", float, double) {
    using T = TestType;
    const bounds<T> box;
    CHECK(box.empty());
    CHECK(box.diagonal() == 0);
    CHECK(box.extent() == vec3<T>{});
    CHECK_FALSE(box.contains({0, 0, 0}));
    CHECK(aglow::is_finite(box.centre().x));
}

TEMPLATE_TEST_CASE("bounds: a box takes the shape of what is added, points and boxes", "", float, double) {
    using T = TestType;
    bounds<T> box;
    box.add(vec3<T>{1, 2, 3});
    CHECK_FALSE(box.empty());
    CHECK(box.diagonal() == 0);
    CHECK(box.contains({1, 2, 3}));
    box.add(vec3<T>{-1, 4, 0});
    CHECK(box.low == vec3<T>{-1, 2, 0});
    CHECK(box.high == vec3<T>{1, 4, 3});
    CHECK(box.centre() == vec3<T>{0, 3, T(1.5)});
    CHECK(box.diagonal() == Approx(std::sqrt(17.0)));
    CHECK(box.radius() == box.diagonal() / 2);
    CHECK(box.contains({1, 4, 3}));
    CHECK_FALSE(box.contains({1, 4, T(3.001)}));

    bounds<T> other;
    other.add(vec3<T>{9, 9, 9});
    other.add(box);
    CHECK(other.contains({-1, 2, 0}));
    other.add(bounds<T>{});
    CHECK(other.high == vec3<T>{9, 9, 9});
    CHECK(other.low == box.low);
}

TEMPLATE_TEST_CASE("bounds: scaling by a power of two scales the diagonal exactly, as small and large as numbers go",
                   "", float, double) {
    using T = TestType;
    bounds<T> box;
    box.add(vec3<T>{T(0.1), T(0.2), T(0.3)});
    box.add(vec3<T>{T(0.7), T(1.9), T(0.5)});
    const T reference = box.diagonal();
    const int range = std::numeric_limits<T>::max_exponent - 4;
    for (const int k : {-range + 30, -100, -30, -1, 1, 30, 100, range}) {
        bounds<T> scaled;
        scaled.add(box.low * std::ldexp(T(1), k));
        scaled.add(box.high * std::ldexp(T(1), k));
        INFO("2^" << k);
        CHECK(scaled.diagonal() == std::ldexp(reference, k));
    }
}

TEST_CASE("bounds: NaN added to a box changes nothing") {
    bounds<float> box;
    box.add(vec3<float>{1, 2, 3});
    box.add(vec3<float>(std::numeric_limits<float>::quiet_NaN()));
    CHECK(box.low == vec3<float>{1, 2, 3});
    CHECK(box.high == vec3<float>{1, 2, 3});
}

TEMPLATE_TEST_CASE("bounds: coordinates lose an ulp of the farthest corner beside the diagonal, and all at a point", "",
                   float, double) {
    using T = TestType;
    const T ulp = std::numeric_limits<T>::epsilon();
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{}) == 0);
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{{1, 2, 3}, {1, 2, 3}}) == 1);
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{{0, 0, 0}, {0, 0, 0}}) == 1);
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{{-1024, 0, 0}, {-1021, 4, 0}}) == 1024 * ulp / 5);
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{{0, 1020, 0}, {3, 1024, 0}}) == 1024 * ulp / 5);
    // Two neighbouring numbers are not told from one.
    CHECK(aglow::coordinate_loss(aglow::bounds<T>{{1, 0, 0}, {1 + ulp, 0, 0}}) == 1);
}
