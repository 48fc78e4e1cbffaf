// The judges are judged: known values, and the power to refuse what is wrong.
#include "support/statistics.hpp"

#include <cmath>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

TEST_CASE("statistics: the tails of the chi-square and normal distributions are the tabulated ones") {
    // Abramowitz & Stegun 1964, tables 26.7 and 26.8; two degrees of freedom have the tail exp(-x/2).
    CHECK(statistics::chi2_p(3.841458820694124, 1) == Approx(0.05).epsilon(1e-10));
    CHECK(statistics::chi2_p(18.307038053275146, 10) == Approx(0.05).epsilon(1e-10));
    CHECK(statistics::chi2_p(124.34211340400407, 100) == Approx(0.05).epsilon(1e-10));
    for (const double x : {0.01, 1.0, 10.0, 100.0}) {
        CHECK(statistics::chi2_p(x, 2) == Approx(std::exp(-x / 2)).epsilon(1e-12));
    }
    CHECK(statistics::chi2_p(0, 5) == 1);
    CHECK(statistics::chi2_p(1e6, 5) == 0);
    CHECK(statistics::normal_p(1.959963984540054) == Approx(0.05).epsilon(1e-10));
    CHECK(statistics::normal_p(-4) == Approx(6.334248366623996e-05).epsilon(1e-10));
    CHECK(statistics::chi2_p(4, 1) == Approx(statistics::normal_p(2)).epsilon(1e-10));
}

TEST_CASE("statistics: p is uniform for what is right, and nothing for what is one in fifty off") {
    statistics::sample_mean right;
    for (std::uint64_t trial = 0; trial < 400; ++trial) {
        aglow::random_sampler<double> random{aglow::mix(trial)};
        std::vector<double> counts(20);
        for (int i = 0; i < 2000; ++i) { counts[static_cast<std::size_t>(random.next_1d() * 20)] += 1; }
        right.add(statistics::chi2_uniform(counts).p);
    }
    CHECK(right.agrees(0.5, 4));
    CHECK(right.variance() == Approx(1.0 / 12).epsilon(0.25));

    aglow::random_sampler<double> random{1};
    std::vector<double> skewed(2);
    for (int i = 0; i < 100'000; ++i) { skewed[random.next_1d() < 0.51 ? 0 : 1] += 1; }
    CHECK(statistics::chi2_uniform(skewed).p < 1e-6);
}

TEST_CASE("statistics: rare cells are pooled, and what should not happen at all is refused") {
    const std::vector<double> expected{0.5, 0.5, 4, 50, 0};
    CHECK(statistics::chi2_test(std::vector<double>{1, 0, 4, 50, 0}, expected).degrees == 1);
    CHECK(statistics::chi2_test(std::vector<double>{1, 0, 4, 50, 0}, expected).p > 0.9);
    CHECK(statistics::chi2_test(std::vector<double>{1, 0, 4, 49, 1}, expected).p == 0);
    CHECK(statistics::chi2_test(std::vector<double>{30, 0, 4, 50, 0}, expected).p < 1e-6);
}

TEST_CASE("statistics: means know their spread, and agree with the truth as often as they should") {
    statistics::sample_mean four;
    for (const double x : {1.0, 2.0, 3.0, 6.0}) { four.add(x); }
    CHECK(four.mean() == 3);
    CHECK(four.variance() == Approx(14.0 / 3));
    CHECK(four.standard_error() == Approx(std::sqrt(14.0 / 12)));
    CHECK(four.agrees(3));
    CHECK_FALSE(four.agrees(30));

    statistics::sample_mean constant;
    for (int i = 0; i < 3; ++i) { constant.add(2); }
    CHECK(constant.agrees(2));
    CHECK_FALSE(constant.agrees(2.01));

    int beyond_two = 0;
    for (std::uint64_t trial = 0; trial < 2000; ++trial) {
        aglow::random_sampler<double> random{aglow::mix(trial)};
        statistics::sample_mean mean;
        for (int i = 0; i < 200; ++i) { mean.add(random.next_1d()); }
        beyond_two += mean.agrees(0.5, 2, 0) ? 0 : 1;
    }
    // 4.55 % of 2000 is 91, with a standard deviation of 9.3.
    CHECK(beyond_two > 91 - 38);
    CHECK(beyond_two < 91 + 38);
}

TEST_CASE("statistics: quadrature is exact for polynomials of degree nine") {
    CHECK(statistics::integral(0, 2, 1, [](double x) { return std::pow(x, 9); }) == Approx(102.4).epsilon(1e-13));
    CHECK(statistics::integral(0, std::acos(-1.0), 10, [](double x) { return std::sin(x); }) ==
          Approx(2).epsilon(1e-13));
}
