#include <aglow/core/numbers.hpp>

#include <algorithm>
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

TEMPLATE_TEST_CASE(
    "numbers: inverse_root is right within two ulp at any scale and exact for powers of four, root within three", "",
    float, double) {
    using T = TestType;
    const long double ulp = static_cast<long double>(std::numeric_limits<T>::epsilon());
    long double worst = 0, worst_root = 0;
    for (int k = -90; k <= 90; ++k) {
        for (int i = 0; i < 300; ++i) {
            const T x = std::ldexp(T(1) + T(3) * static_cast<T>(i) / T(300), 2 * (k / 2));
            if (!(x >= std::numeric_limits<T>::min())) { continue; }
            const long double right = 1 / std::sqrt(static_cast<long double>(x));
            worst = std::max(worst, std::abs(static_cast<long double>(aglow::inverse_root(x)) / right - 1));
            worst_root = std::max(worst_root, std::abs(static_cast<long double>(aglow::root(x)) * right - 1));
        }
        CHECK(aglow::inverse_root(std::ldexp(T(1), 2 * (k / 2))) == std::ldexp(T(1), -(k / 2)));
    }
    CHECK(worst <= 2 * ulp);
    CHECK(worst_root <= 3 * ulp);
    CHECK(aglow::root(T(0)) == 0);
    // What is left of nothing is a number.
    CHECK(aglow::is_finite(aglow::inverse_root(T(0))));
    CHECK(T(0) * aglow::inverse_root(T(0)) == 0);
}

static_assert(aglow::is_finite(1.0f) && !aglow::is_finite(std::numeric_limits<double>::infinity()));
