#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"

using aglow::running_mean;

TEST_CASE("running_mean: a spread of one around a million is found to a thousandth") {
    running_mean all;
    long double sum = 0;
    std::vector<double> values;
    aglow::random_sampler<double> random{7};
    for (int i = 0; i < 200'000; ++i) {
        values.push_back(1e6 + std::sqrt(12.0) * (random.next_1d() - 0.5));
        all.add(values.back());
        sum += values.back();
    }
    long double squares = 0;
    const long double mean = sum / static_cast<long double>(values.size());
    for (const double x : values) { squares += (x - mean) * (x - mean); }
    const auto variance = static_cast<double>(squares / static_cast<long double>(values.size() - 1));
    CHECK(all.mean() == Approx(static_cast<double>(mean)).epsilon(1e-14));
    CHECK(all.variance() == Approx(variance).epsilon(1e-9));
    CHECK(std::abs(all.deviation() - 1) < 5 / std::sqrt(200'000.0));
}

TEST_CASE("running_mean: merging parts is the same as seeing all, and merging nothing changes nothing") {
    running_mean whole, left, right;
    aglow::random_sampler<double> random{3};
    for (int i = 0; i < 1000; ++i) {
        const double x = 1e6 + random.next_1d();
        whole.add(x);
        (i < 137 ? left : right).add(x);
    }
    left.merge(right);
    CHECK(left.count() == whole.count());
    CHECK(left.mean() == Approx(whole.mean()).epsilon(1e-15));
    CHECK(left.variance() == Approx(whole.variance()).epsilon(1e-9));
    const double before = left.variance();
    left.merge(running_mean{});
    CHECK(left.variance() == before);
}

TEST_CASE("running_mean: infinity and NaN are counted and never summed") {
    running_mean all;
    all.add(1);
    all.add(std::numeric_limits<double>::infinity());
    all.add(std::numeric_limits<double>::quiet_NaN());
    all.add(3);
    CHECK(all.mean() == 2);
    CHECK(all.variance() == 2);
    CHECK(all.count() == 2);
    CHECK(all.rejected() == 2);
}

TEST_CASE("running_mean: one number says nothing of the spread") {
    running_mean all;
    CHECK(all.mean() == 0);
    all.add(5);
    CHECK(all.mean() == 5);
    CHECK(!aglow::is_finite(all.standard_error()));
}
