#include <aglow/core/log_gamma.hpp>

#include <cmath>

#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("log_gamma: knows factorials, the square root of pi, and what is very large") {
    double factorial = 1;
    for (int n = 1; n < 30; ++n) {
        CHECK(log_gamma(n) == Approx(std::log(factorial)).epsilon(1e-14).margin(4e-14));
        factorial *= n;
    }
    CHECK(log_gamma(0.5) == Approx(0.5 * std::log(pi<double>)).epsilon(1e-13));
    for (const double x : {1e-3, 2.0 / 3, 1e7, 1e12}) {
        CHECK(log_gamma(x + 1) == Approx(log_gamma(x) + std::log(x)).epsilon(1e-14).margin(1e-14));
    }
}
