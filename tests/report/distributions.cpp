#include <cmath>

#include <aglow/report/distributions.hpp>

#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("distributions: normal quantiles are those of the tables, into the far tail") {
    CHECK(normal_quantile(0.5) == Approx(0).margin(1e-15));
    CHECK(normal_quantile(0.975) == Approx(1.959963984540054).epsilon(1e-13));
    CHECK(normal_quantile(0.995) == Approx(2.5758293035489004).epsilon(1e-13));
    CHECK(normal_quantile(1e-6) == Approx(-4.753424308822899).epsilon(1e-13));
    for (const double p : {1e-250, 1e-20, 0.01, 0.3}) {
        CHECK(normal_cdf(normal_quantile(p)) == Approx(p).epsilon(1e-10));
    }
    CHECK(!is_finite(normal_quantile(0)));
    CHECK(!is_finite(normal_quantile(1)));
}

TEST_CASE("distributions: the incomplete beta function has its closed forms") {
    for (const double x : {1e-6, 0.1, 0.37, 0.5, 0.93, 0.999}) {
        CHECK(beta_cdf(x, 1, 7.5) == Approx(-std::expm1(7.5 * std::log1p(-x))).epsilon(1e-12));
        CHECK(beta_cdf(x, 3.2, 1) == Approx(std::pow(x, 3.2)).epsilon(1e-12));
        CHECK(beta_cdf(x, 0.5, 0.5) == Approx(2 / pi<double> * std::asin(std::sqrt(x))).epsilon(1e-12));
        CHECK(beta_cdf(x, 40, 60) + beta_cdf(1 - x, 60, 40) == Approx(1).epsilon(1e-12));
        if (x < 0.9) { CHECK(beta_quantile(beta_cdf(x, 4, 9), 4, 9) == Approx(x).epsilon(1e-9)); }
    }
}

TEST_CASE("distributions: Student's quantiles are those of the tables") {
    CHECK(student_t_quantile(0.975, 1) == Approx(12.706204736432095).epsilon(1e-10));
    CHECK(student_t_quantile(0.975, 2) == Approx(4.302652729911275).epsilon(1e-10));
    CHECK(student_t_quantile(0.975, 5) == Approx(2.570581835636314).epsilon(1e-10));
    CHECK(student_t_quantile(0.975, 10) == Approx(2.2281388519649385).epsilon(1e-10));
    CHECK(student_t_quantile(0.975, 100) == Approx(1.9839715184496334).epsilon(1e-10));
    CHECK(student_t_quantile(0.95, 1) == Approx(6.313751514675043).epsilon(1e-10));
    CHECK(student_t_quantile(0.995, 10) == Approx(3.169272672616838).epsilon(1e-10));
}

TEST_CASE("distributions: Student's t is Cauchy's law at one degree of freedom and the normal law at very many") {
    for (const double t : {-30.0, -2.0, -0.1, 0.0, 0.7, 5.0}) {
        CHECK(student_t_cdf(t, 1) == Approx(0.5 + std::atan(t) / pi<double>).epsilon(1e-12));
        CHECK(student_t_cdf(t, 2) == Approx(0.5 + t / (2 * std::sqrt(2 + t * t))).epsilon(1e-9));
        CHECK(student_t_cdf(t, 1e7) == Approx(normal_cdf(t)).epsilon(2e-5).margin(1e-12));
    }
}

TEST_CASE("distributions: the binomial law is the sum of its terms") {
    for (const double p : {0.01, 0.5, 0.95}) {
        double sum = 0;
        double term = std::pow(1 - p, 60);
        for (std::uint64_t k = 0; k <= 60; ++k) {
            sum += term;
            CHECK(binomial_cdf(k, 60, p) == Approx(sum).epsilon(1e-9).margin(1e-13));
            term *= static_cast<double>(60 - k) / static_cast<double>(k + 1) * p / (1 - p);
        }
    }
}

TEST_CASE("distributions: no failure in n trials allows 1 - (1 - confidence)^(1/n), the rule of three") {
    for (const std::uint64_t n : {10u, 100u, 3000u}) {
        const double exact = 1 - std::pow(0.05, 1.0 / static_cast<double>(n));
        CHECK(binomial_upper_bound(0, n, 0.95) == Approx(exact).epsilon(1e-9));
    }
    CHECK(binomial_upper_bound(5, 5, 0.95) == 1);
    CHECK(binomial_cdf(3, 200, binomial_upper_bound(3, 200, 0.95)) == Approx(0.05).epsilon(1e-9));
}
