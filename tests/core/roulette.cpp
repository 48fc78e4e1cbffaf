#include <aglow/core/roulette.hpp>

#include <limits>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

TEST_CASE("roulette: what is carried on is, on average, what came") {
    aglow::random_sampler<double> random{1};
    for (const double after : {0.01, 0.3, 0.999, 1.0, 2.5}) {
        statistics::sample_mean carried;
        const double q = aglow::survival(1.0, after);
        for (int i = 0; i < 100'000; ++i) { carried.add(random.next_1d() < q ? after / q : 0.0); }
        INFO(after << ": " << carried.mean());
        CHECK(carried.agrees(after, 4));
    }
}

TEST_CASE("roulette: the largest component of a survivor never grows, for any throughput") {
    aglow::random_sampler<float> random{2};
    for (int i = 0; i < 10'000; ++i) {
        const float before = random.next_1d();
        const float after = before * random.next_1d();
        const float q = aglow::survival(before, after);
        if (q > 0) { CHECK(after / q <= before * 1.000001f); }
    }
}

TEMPLATE_TEST_CASE("roulette: the probability is one, none, or the ratio, and never more than the ceiling", "", float,
                   double) {
    using T = TestType;
    CHECK(aglow::survival(T(2), T(1)) == T(0.5));
    CHECK(aglow::survival(T(1), T(3)) == 1);
    CHECK(aglow::survival(T(1), T(0.99), T(0.95)) == T(0.95));
    CHECK(aglow::survival(T(1), T(0)) == 0);
    CHECK(aglow::survival(T(0), T(1)) == 0);
    CHECK(aglow::survival(T(1), T(-1)) == 0);
    const T nan = std::numeric_limits<T>::quiet_NaN();
    CHECK(aglow::survival(nan, T(1)) == 0);
    CHECK(aglow::survival(T(1), nan) == 0);
    CHECK(aglow::survival(std::numeric_limits<T>::denorm_min(), T(1)) == 1);
}

TEST_CASE("roulette: scaling both throughputs by a power of two changes nothing") {
    for (const float scale : {0x1p-90f, 0x1p-3f, 0x1p100f}) {
        CHECK(aglow::survival(0.7f * scale, 0.3f * scale) == aglow::survival(0.7f, 0.3f));
    }
}
