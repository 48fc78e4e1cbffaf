#include <aglow/core/numbers.hpp>

#include <cmath>
#include <limits>

#include "core/hard_numbers.hpp"
#include "support/catch.hpp"

using namespace hard_numbers;

TEMPLATE_TEST_CASE("numbers: finite is what is neither infinite nor NaN, whatever its sign and bits", "", float,
                   double) {
    using T = TestType;
    for (const T bad : {infinity<T>(), minus_infinity<T>(), nan<T>(), smallest_nan<T>(), minus_nan<T>()}) {
        CHECK_FALSE(aglow::is_finite(bad));
        CHECK_FALSE(std::isfinite(bad));
    }
    for (const T good : {T(0), minus_zero<T>(), T(1), T(-1), largest<T>(), -largest<T>(), smallest<T>(),
                         std::numeric_limits<T>::min()}) {
        CHECK(aglow::is_finite(good));
        CHECK(std::isfinite(good));
    }
}

TEMPLATE_TEST_CASE("numbers: nothing is between one_below and one", "", float, double) {
    using T = TestType;
    CHECK(aglow::one_below<T> < 1);
    CHECK(std::nextafter(aglow::one_below<T>, T(2)) == 1);
}

TEMPLATE_TEST_CASE("numbers: pi is the nearest there is", "", float, double) {
    using T = TestType;
    CHECK(aglow::pi<T> == static_cast<T>(std::acos(-1.0L)));
    CHECK(aglow::square(T(-3)) == 9);
}

static_assert(aglow::is_finite(1.0f) && !aglow::is_finite(std::numeric_limits<double>::infinity()));
