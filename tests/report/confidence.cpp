#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/report/confidence.hpp>
#include <aglow/report/quantiles.hpp>
#include <aglow/report/tails.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Share of `rounds` samples of `count` numbers for which `holds(sample)`.
template <typename Draw, typename Holds>
double share(int rounds, int count, const Draw& draw, const Holds& holds) {
    int held = 0;
    for (int r = 0; r < rounds; ++r) {
        random_sampler<double> random{mix(11, static_cast<std::uint64_t>(r))};
        std::vector<double> sample;
        for (int i = 0; i < count; ++i) { sample.push_back(draw(random)); }
        held += holds(std::span<const double>{sample}) ? 1 : 0;
    }
    return static_cast<double>(held) / rounds;
}

constexpr auto exponential = [](random_sampler<double>& random) { return -std::log(1 - random.next_1d()); };
constexpr auto seldom_large = [](random_sampler<double>& random) {
    return random.next_1d() < 0.05 ? random.next_1d() : 0.01;
};

}  // namespace

TEST_CASE("quantile: linear between neighbours, the ends at 0 and 1, nothing of nothing") {
    const std::vector<double> values{4, 1, 3, 2};
    CHECK(quantile(values, 0) == 1);
    CHECK(quantile(values, 1) == 4);
    CHECK(median(values) == 2.5);
    CHECK(quantile(values, 1.0 / 3) == Approx(2));
    CHECK(median({}) == 0);
}

TEST_CASE("quantile: among infinities it is finite or infinite, and never NaN") {
    const double inf = std::numeric_limits<double>::infinity();
    CHECK(median(std::vector<double>{0, 0, inf}) == 0);
    CHECK(median(std::vector<double>{0, inf}) == inf);
    CHECK(median(std::vector<double>{1, inf, inf, inf}) == inf);
    CHECK(quantile(std::vector<double>{-1, 0, inf}, 0.5) == 0);
    CHECK(quantile(std::vector<double>{inf, inf}, 0.95) == inf);
}

TEST_CASE("rising order: each place once, by value, equal ones as they came") {
    const std::vector<double> values{3, 1, 2, 1, -5, 3};
    CHECK(rising_order(values) == std::vector<std::size_t>{4, 1, 3, 2, 0, 5});
    CHECK(rising_order({}).empty());
}

TEST_CASE("quantile bound: 58 values cannot bound the 95 % quantile at 95 %, and 59 can by their largest") {
    std::vector<double> values;
    for (int i = 1; i <= 58; ++i) { values.push_back(i); }
    CHECK(!quantile_upper_bound(values, 0.95, 0.95));
    values.push_back(59);
    CHECK(quantile_upper_bound(values, 0.95, 0.95) == 59.0);
}

TEST_CASE("quantile bound: exceeds the quantile as often as promised, for a law it does not know") {
    const double truth = -std::log(0.05);
    const double held =
        share(1000, 200, exponential, [&](auto s) { return *quantile_upper_bound(s, 0.95, 0.95) >= truth; });
    CHECK(held >= synthetic::least_coverage(1000));
    CHECK(held <= 0.99);
}

TEST_CASE("student interval: holds for normal numbers, as often as it says and not more") {
    const auto normal = [](random_sampler<double>& random) { return 5 + 2 * synthetic::normal(random); };
    const double held =
        share(20'000, 12, normal, [](auto s) { return student_interval(mean_of(s), 0.95).contains(5); });
    CHECK(held == Approx(0.95).margin(4 * std::sqrt(0.95 * 0.05 / 20'000)));
}

TEST_CASE("skewed upper bound: holds where the mean rests on few large numbers, and Student's does not") {
    const double truth = 0.05 * 0.5 + 0.95 * 0.01;
    const double skewed = share(2000, 200, seldom_large, [&](auto s) { return skewed_upper_bound(s, 0.95) >= truth; });
    const double student =
        share(2000, 200, seldom_large, [&](auto s) { return student_interval(mean_of(s), 0.90).high >= truth; });
    CHECK(skewed >= synthetic::least_coverage(2000) - 0.01);
    CHECK(student < skewed - 0.01);
    CHECK(student < synthetic::least_coverage(2000));
}

TEST_CASE("skewed upper bound: solves Hall's equation, by the third standardised moment") {
    const std::vector<double> values{0, 0, 0, 1};
    CHECK(skewness(values) == Approx(0.75));  // (3 (-1/2)^3 + (3/2)^3) / 4
    CHECK(skewness(std::vector<double>{1, 0, 0, 0}) == Approx(0.75));
    CHECK(skewness(std::vector<double>{-1, 0, 1}) == Approx(0).margin(1e-15));
    for (const double confidence : {0.6, 0.9, 0.95}) {
        const double bound = skewed_upper_bound(values, confidence);
        const double at = (0.25 - bound) / 0.5;
        const double skew = 0.75;
        // Hall 1992, (2.4): this, times the root of n, is normal for the true mean.
        const double turned = at + skew * at * at / 3 + skew * skew * at * at * at / 27 + skew / (6 * 4);
        CHECK(turned * 2 == Approx(-student_t_quantile(confidence, 3)));
    }
}

TEST_CASE("cautious interval: holds on skewed and on long-tailed symmetric laws, where one of its parents does not") {
    const auto tailed = [](random_sampler<double>& random) {
        return (random.next_1d() < 0.5 ? -1 : 1) * std::exp(1.5 * synthetic::normal(random));
    };
    const double mean = 0.05 * 0.5 + 0.95 * 0.01;
    const auto holds = [](double truth) {
        return [truth](auto s) { return cautious_interval(s, 0.95).contains(truth); };
    };
    CHECK(share(2000, 200, seldom_large, holds(mean)) >= synthetic::least_coverage(2000));
    CHECK(share(2000, 200, tailed, holds(0)) >= synthetic::least_coverage(2000));
    CHECK(share(2000, 200, tailed, [](auto s) {
              std::vector<double> mirrored(s.begin(), s.end());
              for (double& x : mirrored) { x = -x; }
              return skewed_upper_bound(s, 0.975) >= 0 && skewed_upper_bound(mirrored, 0.975) >= 0;
          }) < synthetic::least_coverage(2000));
}

TEST_CASE("bernstein and betting bounds: hold for every law in [0, 1], betting with much less room") {
    const double truth = 0.05 * 0.5 + 0.95 * 0.01;
    double bernstein = 0;
    double betting = 0;
    const double held = share(500, 400, seldom_large, [&](auto s) {
        bernstein += empirical_bernstein_upper_bound(s, 0.95) / 500;
        betting += betting_upper_bound(s, 0.95) / 500;
        return betting_upper_bound(s, 0.95) >= truth && empirical_bernstein_upper_bound(s, 0.95) >= truth;
    });
    CHECK(held >= 0.95);
    CHECK(betting < 0.8 * bernstein);
    CHECK(betting < 2 * truth);
    CHECK(betting_upper_bound(std::vector<double>(100, 1.0), 0.95) == Approx(1));
}

TEST_CASE("hill index: finds the index of a pure power law") {
    for (const double index : {0.25, 0.5, 0.9}) {
        std::vector<double> values;
        random_sampler<double> random{5};
        for (int i = 0; i < 20'000; ++i) { values.push_back(std::pow(1 - random.next_1d(), -index)); }
        CHECK(hill_index(values, 2000) == Approx(index).epsilon(4 / std::sqrt(2000.0)));
    }
    CHECK(hill_index(std::vector<double>{1, 2}, 5) == 0);
}

TEST_CASE("largest share: one of four equal numbers is a quarter, whatever their signs") {
    CHECK(largest_share(std::vector<double>{1, -1, 1, -1}) == 0.25);
    CHECK(largest_share(std::vector<double>{0, 0}) == 0);
}
