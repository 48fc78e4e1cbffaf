#include <cmath>
#include <vector>

#include <aglow/report/conformal.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

TEST_CASE("conformal: the rank is the one of the theorem, and too few scores say nothing") {
    std::vector<double> scores;
    for (int i = 19; i >= 1; --i) { scores.push_back(i); }
    CHECK(conformal_quantile(scores, 0.95) == 19.0);
    scores.pop_back();
    CHECK(!conformal_quantile(scores, 0.95));
    CHECK(conformal_quantile(scores, 0.5) == 11.0);
}

TEST_CASE("conformal: a fresh score is covered with the promised probability, for a skewed law") {
    running_mean covered;
    for (std::uint64_t r = 0; r < 2000; ++r) {
        random_sampler<double> random{mix(21, r)};
        std::vector<double> scores(99);
        for (double& s : scores) { s = -std::log(1 - random.next_1d()); }
        covered.add(1 - std::exp(-*conformal_quantile(scores, 0.95)));
    }
    CHECK(covered.mean() == Approx(0.95).margin(4 * covered.standard_error()));
}

TEST_CASE("conformal: each class gets its own scale, and small classes share that of all") {
    std::vector<double> scores;
    std::vector<std::uint32_t> classes;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const std::uint32_t id = i < 100 ? 3 : i < 190 ? 1 : 9;
        scores.push_back((id == 1 ? 10 : 1) * (1 + i % 7));
        classes.push_back(id);
    }
    const std::vector<class_scale> scales = conformal_scales(scores, classes, 0.95);
    REQUIRE(scales.size() == 3);
    CHECK(scale_of(scales, 1) == 70.0);
    CHECK(scale_of(scales, 3) == 7.0);
    CHECK(scales[2].id == 9);
    CHECK(scales[2].merged);
    CHECK(scales[2].scores == 200);
    CHECK(!scales[0].merged);
    CHECK(!scale_of(scales, 4));
}
