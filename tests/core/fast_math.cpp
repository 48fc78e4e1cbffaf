// Compiled with -ffast-math, under which isnan and x != x are false: the guards must hold all the same.
#include <aglow/core/numbers.hpp>
#include <aglow/core/roulette.hpp>

#include <aglow/concepts/spectrum.hpp>

#include "core/hard_numbers.hpp"
#include "support/archetypes.hpp"
#include "support/catch.hpp"

#ifndef __FAST_MATH__
#error "this file is about -ffast-math"
#endif

using namespace hard_numbers;

TEMPLATE_TEST_CASE("fast math: bad numbers are told from finite ones by their bits", "", float, double) {
    using T = TestType;
    for (const T bad : {infinity<T>(), minus_infinity<T>(), nan<T>(), smallest_nan<T>(), minus_nan<T>()}) {
        CHECK_FALSE(aglow::is_finite(bad));
    }
    for (const T good : {T(0), minus_zero<T>(), T(-1), largest<T>(), smallest<T>()}) { CHECK(aglow::is_finite(good)); }
}

TEMPLATE_TEST_CASE("fast math: a bad band is no radiance, whichever it is", "", float, double) {
    using T = TestType;
    for (const T bad : {infinity<T>(), minus_infinity<T>(), nan<T>(), smallest_nan<T>(), minus_nan<T>(), T(-1)}) {
        CHECK_FALSE(aglow::is_radiance(bad));
        for (int band = 0; band < 3; ++band) {
            aglow::vec3<T> rgb{1, 2, 3};
            rgb[band] = bad;
            CHECK_FALSE(aglow::is_radiance(rgb));
        }
        CHECK_FALSE(aglow::is_radiance(archetypes::spectrum<T>::of(bad, T(1))));
        CHECK_FALSE(aglow::is_radiance(archetypes::spectrum<T>::of(T(1), bad)));
    }
    CHECK(aglow::is_radiance(aglow::vec3<T>{0, largest<T>(), 3}));
}

TEMPLATE_TEST_CASE("fast math: roulette ends what is not finite", "", float, double) {
    using T = TestType;
    for (const T bad : {infinity<T>(), nan<T>(), minus_nan<T>()}) {
        CHECK(aglow::survival(T(1), bad) == 0);
        CHECK(aglow::survival(bad, T(1)) == 0);
    }
    CHECK(aglow::survival(T(2), T(1)) == T(0.5));
}
