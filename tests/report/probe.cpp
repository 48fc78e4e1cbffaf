#include <cmath>

#include <aglow/report/probe.hpp>
#include <aglow/report/running_mean.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("probe: the choices are all the ways to choose batches") {
    CHECK(batch_choices<8>.size() == 1);
    CHECK(batch_choices<8>[0] == 255);
    for (const unsigned half : batch_choices<4>) { CHECK(std::popcount(half) == 4); }
    for (const unsigned pair : batch_choices<2>) { CHECK(std::popcount(pair) == 2); }
    CHECK(std::popcount(batch_choices<4>.back()) == 4);
}

TEST_CASE("probe: samples asked one by one or in batches cost the same and have the same mean") {
    const auto single = [](std::size_t pixel, std::uint64_t seed) {
        return static_cast<double>(pixel) - std::log(1 - random_sampler<double>{seed}.next_1d());
    };
    const auto batch = [](std::size_t pixel, std::uint64_t seed, std::size_t count) {
        random_sampler<double> random{seed};
        return static_cast<double>(pixel) + synthetic::exponential_mean(random, count);
    };
    running_mean ones, many, spread;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const probe_record a = draw_probe(single, 7, 1, 16, {1, 2, i});
        const probe_record b = draw_probe(batch, 7, 1, 16, {1, 2, i});
        CHECK(a.samples == 128);
        CHECK(b.samples == 128);
        ones.add(a.mean(0));
        many.add(b.mean(0));
        spread.add(a.batch_variance(0));
    }
    CHECK(ones.mean() == Approx(8).margin(4 * ones.standard_error()));
    CHECK(many.mean() == Approx(8).margin(4 * many.standard_error()));
    CHECK(ones.variance() == Approx(1 / 128.0).epsilon(0.15));
    CHECK(many.variance() == Approx(1 / 128.0).epsilon(0.15));
    CHECK(spread.mean() == Approx(1 / 16.0).epsilon(0.05));
}

TEST_CASE("probe: merged samples weigh as many as they are") {
    const auto constant = [](double x) { return [x](std::size_t, std::uint64_t, std::size_t) { return x; }; };
    probe_record one = draw_probe(constant(2), 7, 1, 10, path_key{1, 0, 0});
    const probe_record more = draw_probe(constant(6), 7, 1, 30, path_key{2, 0, 0});
    one.merge(more);
    CHECK(one.mean(0) == Approx(5));
    CHECK(one.batch_variance(0) == Approx(0).margin(1e-12));
    CHECK(one.samples == 8 * 40);
}

TEST_CASE(
    "probe: the less noisy estimate of a distance is never below it, and less than half as far above where it "
    "matters") {
    // Noise of the mean of all batches is 1, so this is the whole range in which noise and distance mix.
    double plain_at_0 = 0;
    double less_at_0 = 0;
    for (const double distance : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0}) {
        running_mean plain, less;
        for (std::uint64_t i = 0; i < 40'000; ++i) {
            random_sampler<double> random{mix(3, i)};
            probe_record record{.pixel = 0, .channels = 1};
            for (std::size_t b = 0; b < probe_batches; ++b) {
                record.batches.push_back(distance + std::sqrt(8.0) * synthetic::normal(random));
            }
            const auto size = [&](unsigned chosen) { return std::abs(record.mean(chosen, 0)); };
            plain.add(size(255));
            less.add(less_noisy(size));
        }
        CAPTURE(distance, less.mean(), plain.mean());
        CHECK(less.mean() > distance - 4 * less.standard_error());
        CHECK(less.mean() < distance + std::max(plain.mean() - distance, 0.06) + 4 * less.standard_error());
        if (distance == 0) {
            plain_at_0 = plain.mean();
            less_at_0 = less.mean();
        }
    }
    CHECK(plain_at_0 == Approx(std::sqrt(2 / pi<double>)).epsilon(0.02));
    CHECK(less_at_0 == Approx((3 - 2.8 * std::sqrt(2.0) + 1.6) * std::sqrt(2 / pi<double>)).epsilon(0.04));
}
