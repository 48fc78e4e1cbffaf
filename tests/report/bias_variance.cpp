#include <cmath>
#include <limits>
#include <vector>

#include <aglow/report/bias_variance.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

constexpr std::size_t count = 20'000;

std::vector<double> noisy(double mean, double deviation, std::uint64_t seed) {
    std::vector<double> values(count);
    random_sampler<double> random{mix(seed)};
    for (double& x : values) { x = mean + deviation * synthetic::normal(random); }
    return values;
}

image_view<double> seen(const std::vector<double>& values) { return {values, values.size(), 1, 1}; }

}  // namespace

TEST_CASE("bias_variance: both parts are found beneath the noise of pictures and reference") {
    const std::vector<double> first = noisy(1, 0.02, 100);
    const std::vector<double> second = noisy(1, 0.02, 101);
    for (const double bias : {0.0, 0.01}) {
        bias_variance all;
        for (std::uint64_t s = 0; s < 8; ++s) { all.add(seen(noisy(1 + bias, 0.1, s))); }
        const error_parts parts = all.parts(seen(first), seen(second));
        CHECK(parts.pictures == 8);
        CHECK(parts.variance == Approx(0.01 / 1.01).epsilon(0.02));
        CHECK(parts.bias2 == Approx(bias * bias / 1.01).margin(4 * parts.bias2_error));
        CHECK(parts.bias2_error < 3e-5);
    }
}

TEST_CASE("bias_variance: one picture says nothing, and sizes must agree") {
    bias_variance all;
    const std::vector<double> values = noisy(1, 0.1, 1);
    all.add(seen(values));
    CHECK_THROWS_AS(all.parts(seen(values), seen(values)), std::invalid_argument);
    CHECK_THROWS_AS(all.add(image_view<double>{std::span{values}.first(5), 5, 1, 1}), std::invalid_argument);
}

TEST_CASE("bias_variance: a value that was broken in one picture or half is left out, and the rest is as it was") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> first(count, 1.0), second(count, 1.0);
    first[1] = nan;
    second[2] = nan;
    bias_variance all;
    for (std::uint64_t s = 0; s < 4; ++s) {
        std::vector<double> picture(count, s % 2 == 0 ? 1.0 : 3.0);
        if (s == 2) { picture[0] = nan; }
        all.add(seen(picture));
    }
    const error_parts parts = all.parts(seen(first), seen(second));
    // Each value is 1 or 3 in turn: variance 4 / 3, and a mean of 2 that is 1 off.
    CHECK(parts.variance == Approx(4.0 / 3 / 1.01).epsilon(1e-12));
    CHECK(parts.bias2 == Approx((1 - 1.0 / 3) / 1.01).epsilon(1e-12));
}
