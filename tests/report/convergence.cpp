#include <cmath>
#include <vector>

#include <aglow/report/convergence.hpp>
#include <aglow/report/decay.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("slope: a power law is found exactly and without doubt") {
    const std::vector<double> times{1, 2, 4, 8, 16};
    std::vector<double> errors;
    for (const double t : times) { errors.push_back(0.3 * std::pow(t, -1.0 / 3)); }
    const line_fit fit = fit_slope(times, errors);
    CHECK(fit.slope == Approx(-1.0 / 3).epsilon(1e-12));
    CHECK(std::exp(fit.at_zero) == Approx(0.3));
    CHECK(fit.slope_error < 1e-12);
}

TEST_CASE("slope: its standard error is the spread of slopes over many noisy series") {
    running_mean slopes, errors;
    for (std::uint64_t r = 0; r < 2000; ++r) {
        random_sampler<double> random{mix(8, r)};
        std::vector<double> x, y;
        for (int i = 0; i < 8; ++i) {
            x.push_back(i);
            y.push_back(1 - 0.5 * i + 0.2 * synthetic::normal(random));
        }
        const line_fit fit = fit_line(x, y);
        slopes.add(fit.slope);
        errors.add(fit.slope_error * fit.slope_error);
    }
    CHECK(slopes.mean() == Approx(-0.5).margin(4 * slopes.standard_error()));
    CHECK(errors.mean() == Approx(slopes.variance()).epsilon(0.12));
}

TEST_CASE("slope: numbers that have no logarithm are left out, and one point is no line") {
    CHECK(fit_slope(std::vector<double>{1, 2, 4}, std::vector<double>{1, 0, 0.5}).slope == Approx(-0.5));
    CHECK_THROWS_AS(fit_slope(std::vector<double>{1}, std::vector<double>{1}), std::invalid_argument);
    CHECK_THROWS_AS(fit_line(std::vector<double>{1, 1}, std::vector<double>{1, 2}), std::invalid_argument);
}

TEST_CASE("time to error: on a power law the crossing is where the law says") {
    std::vector<double> times, errors;
    for (double t = 1; t < 100; t *= 3) {
        times.push_back(t);
        errors.push_back(0.4 / std::sqrt(t));
    }
    const crossing at = time_to_error(times, errors, 0.1);
    CHECK(at.when == crossing::kind::at);
    CHECK(at.time == Approx(16));
    CHECK(time_to_error(times, errors, 0.5).when == crossing::kind::before);
    CHECK(time_to_error(times, errors, 0.5).time == 1);
    CHECK(time_to_error(times, errors, 0.001).when == crossing::kind::never);
    CHECK(time_to_error({}, {}, 0.1).when == crossing::kind::never);
    // Of two-half references an error may come out below zero.
    for (const double none : {0.0, -1e-6}) {
        std::vector<double> sunk(times.size(), none);
        sunk[0] = errors[0];
        const crossing below = time_to_error(times, sunk, 0.1);
        CHECK(below.when == crossing::kind::at);
        CHECK(below.time == times[1]);
    }
}

TEST_CASE("convergence table: one row a budget with medians, bands and an efficiency that is flat for pure variance") {
    std::vector<timed_error> runs;
    for (std::size_t budget : {2u, 0u, 1u}) {
        const double seconds = std::pow(2.0, static_cast<double>(budget));
        for (int seed = 0; seed < 5; ++seed) { runs.push_back({budget, seconds, (8.0 + seed) / seconds}); }
    }
    const std::vector<convergence_row> rows = convergence_table(runs);
    REQUIRE(rows.size() == 3);
    for (std::size_t b = 0; b < 3; ++b) {
        CHECK(rows[b].budget == b);
        CHECK(rows[b].runs == 5);
        CHECK(rows[b].error * rows[b].seconds == Approx(10));
        CHECK(rows[b].efficiency == Approx(0.1));
        CHECK(rows[b].error_low * rows[b].seconds == Approx(8.2));
        CHECK(rows[b].error_high * rows[b].seconds == Approx(11.8));
    }
}

TEST_CASE("decay: floor, amplitude and exponent of an exact series are found, and the work to a target") {
    std::vector<measured_error> points;
    for (double w = 1; w < 2000; w *= 2) { points.push_back({w, 0.08 + 0.5 * std::pow(w, -0.5), 0.001}); }
    const decay_fit fit = fit_decay(points);
    CHECK(fit.floor == Approx(0.08).epsilon(0.02));
    CHECK(fit.exponent == Approx(0.5));
    CHECK(fit.floor_low > 0.07);
    CHECK(fit.floor_low <= fit.floor);
    CHECK(fit.work_to(0.1) == Approx(625).epsilon(0.1));
    CHECK(!is_finite(fit.work_to(0.07)));
}

TEST_CASE("decay: a slow fall without a floor is not mistaken for one") {
    int mistaken = 0;
    for (std::uint64_t r = 0; r < 300; ++r) {
        std::vector<measured_error> points;
        for (double w = 1; w < 300; w *= 2) {
            const double e = 0.4 * std::pow(w, -0.25);
            points.push_back({w, e * (1 + 0.05 * synthetic::normal_of(mix(r, points.size()))), 0.05 * e});
        }
        mistaken += fit_decay(points).floor_low > 0.05 ? 1 : 0;
    }
    CHECK(mistaken <= 3);
}

TEST_CASE("decay: one measurement follows the law of independent samples, two their own slope, none says nothing") {
    const std::vector<measured_error> two{{1, 0.4, 0.01}, {16, 0.2, 0.01}};
    CHECK(fit_decay(std::span{two}.first(1)).work_to(0.1) == Approx(16));
    CHECK(fit_decay(two).exponent == Approx(0.25));
    CHECK(fit_decay(two).work_to(0.1) == Approx(256));
    CHECK(fit_decay({}).amplitude == 0);
}

TEST_CASE("decay: of noisy series, the least floor is no higher than the true one, and one that is none is not told") {
    int above = 0;
    int invented = 0;
    const auto series = [](double floor, std::uint64_t r) {
        std::vector<measured_error> points;
        for (double w = 1; w < 300; w *= 2) {
            const double e = floor + 0.4 * std::pow(w, -0.5);
            points.push_back({w, e * (1 + 0.05 * synthetic::normal_of(mix(r, points.size() + 7))), 0.05 * e});
        }
        return points;
    };
    for (std::uint64_t r = 0; r < 300; ++r) {
        above += fit_decay(series(0.08, r)).floor_low > 0.08 ? 1 : 0;
        const decay_fit none = fit_decay(series(0, r));
        CHECK(none.floor >= 0);
        invented += none.floor > 0 ? 1 : 0;
    }
    // Three and a half standard deviations, and two.
    CHECK(above <= 1);
    CHECK(invented <= 30);
}
