#include <cmath>
#include <vector>

#include <aglow/report/bootstrap.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("bootstrap: the interval of a mean is that of Student for many normal runs") {
    std::vector<double> values;
    random_sampler<double> random{1};
    for (int i = 0; i < 400; ++i) { values.push_back(10 + synthetic::normal(random)); }
    const interval student = student_interval(mean_of(values), 0.95);
    const interval again =
        bootstrap(values.size(), [&](auto indices) { return plain_mean(pick(values, indices)); }, {.resamples = 4000});
    CHECK(again.estimate == Approx(student.estimate));
    CHECK(again.low == Approx(student.low).margin(0.15 * (student.high - student.low) / 2));
    CHECK(again.high == Approx(student.high).margin(0.15 * (student.high - student.low) / 2));
}

TEST_CASE("bootstrap: the ratio of medians of two sets holds the true ratio about as often as promised") {
    int held = 0;
    const int rounds = 300;
    for (int r = 0; r < rounds; ++r) {
        random_sampler<double> random{mix(5, static_cast<std::uint64_t>(r))};
        std::vector<double> slow, fast;
        for (int i = 0; i < 25; ++i) {
            slow.push_back(20 * std::exp(0.1 * synthetic::normal(random)));
            fast.push_back(2 * std::exp(0.1 * synthetic::normal(random)));
        }
        held += bootstrap_ratio(slow, fast, median, {.resamples = 500}).contains(10) ? 1 : 0;
    }
    CHECK(static_cast<double>(held) / rounds >= synthetic::least_coverage(rounds) - 0.02);
    CHECK(held < rounds);
}

TEST_CASE("bootstrap: the same seed gives the same bits, another seed another interval") {
    const std::vector<double> values{1, 5, 2, 8, 3};
    const auto mean = [&](auto indices) { return plain_mean(pick(values, indices)); };
    CHECK(bootstrap(5, mean).low == bootstrap(5, mean).low);
    CHECK(bootstrap_ratio(values, values, plain_mean).high == bootstrap_ratio(values, values, plain_mean).high);
    CHECK(bootstrap_ratio(values, values, plain_mean, {.seed = 1}).high !=
          bootstrap_ratio(values, values, plain_mean, {.seed = 2}).high);
    CHECK_THROWS_AS(bootstrap(0, mean), std::invalid_argument);
}

TEST_CASE("bootstrap: the interval of a ratio of means is that of their relative errors, for many normal runs") {
    std::vector<double> above, below;
    random_sampler<double> random{2};
    for (int i = 0; i < 400; ++i) {
        above.push_back(10 + synthetic::normal(random));
        below.push_back(5 + synthetic::normal(random));
    }
    const interval ratio = bootstrap_ratio(above, below, plain_mean, {.resamples = 4000});
    const double relative = std::sqrt(square(0.1) + square(0.2)) / std::sqrt(400.0);
    const double half = 1.96 * relative * ratio.estimate;
    CHECK(ratio.estimate == Approx(plain_mean(above) / plain_mean(below)));
    CHECK(ratio.low == Approx(ratio.estimate - half).margin(0.12 * half));
    CHECK(ratio.high == Approx(ratio.estimate + half).margin(0.12 * half));
}
