#include <algorithm>
#include <cmath>
#include <vector>

#include <aglow/report/claim_plan.hpp>
#include <aglow/report/render_until.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

/// An error of 8 % at work 4 that falls as samples do, seen by probes that add 1 % at a noise of one half.
claim_outlook outlook(double sample_work) {
    return {.work = 4,
            .decay = {.amplitude = 0.16, .exponent = 0.5},
            .own = 0.01,
            .samples = 100,
            .sample_work = sample_work};
}

}  // namespace

TEST_CASE("claim plan: free probes are taken sharp and many, dear ones few and noisy on a better picture") {
    const claim_plan cheap = cheapest_claim(outlook(0));
    const claim_plan dear = cheapest_claim(outlook(1e-2));
    CHECK(cheap.probes > 1500);
    CHECK(cheap.noise == Approx(0.35));
    CHECK(dear.probes == 200);
    CHECK(dear.noise == Approx(0.7).epsilon(0.001));
    CHECK(dear.work > cheap.work);
    // Nothing certifies before the error itself is at the target: 0.16 / √w = 0.05.
    CHECK(cheap.work > std::pow(0.16 / 0.05, 2));
    CHECK(cheap.work < 1.3 * std::pow(0.16 / 0.05, 2));
}

TEST_CASE("claim plan: no other number or noise of probes, nor more or less work, is cheaper in the mean") {
    const claim_outlook known = [] {
        claim_outlook o = outlook(3e-4);
        o.doubt = 0.2;
        return o;
    }();
    const claim_plan best = cheapest_claim(known);
    const double least = expected_cost(known, best);
    for (const double work : {0.85, 1.0, 1.2}) {
        for (const double probes : {0.5, 0.8, 1.25, 2.0}) {
            for (const double noise : {0.7, 0.85, 1.0}) {
                const auto n = static_cast<std::size_t>(probes * static_cast<double>(best.probes));
                if (n < 200 || n > known.most_probes) { continue; }
                const claim_plan other{work * best.work, n, std::max(known.least_noise, noise * best.noise)};
                CHECK(expected_cost(known, other) > 0.97 * least);
            }
        }
    }
}

TEST_CASE("claim plan: what a claim costs in the mean is what many of them cost that fail and are made again") {
    claim_outlook known = outlook(1e-3);
    known.doubt = 0.25;
    const claim_plan plan{12, 300, 0.5};
    const double probes = known.sample_work * known.samples * 300;
    running_mean cost;
    random_sampler<double> random{7};
    for (int i = 0; i < 100000; ++i) {
        // The error is what was expected but for doubt; the claim sees it but for its few probes.
        const double error = known.decay.at(12) * std::exp(known.doubt * synthetic::normal(random));
        const double seen = error * std::exp(1.1 * known.ratio / std::sqrt(300.0) * synthetic::normal(random));
        const bool holds = seen < certifiable_error(known, 300, 0.5);
        const double spread = std::hypot(known.doubt, 1.1 * known.ratio / std::sqrt(300.0));
        const double again = known.decay.work_to(certifiable_error(known, 300, 0.5) / (1 + spread));
        cost.add(holds ? 12 + probes : std::clamp(again, 1.2 * 12, 4.0 * 12) + 2 * probes);
    }
    CHECK(expected_cost(known, plan) == Approx(cost.mean()).epsilon(0.01));
}

TEST_CASE("claim plan: an error that stays above the target has no claim") {
    claim_outlook known = outlook(1e-4);
    known.decay.floor = 0.06;
    CHECK(!is_finite(cheapest_claim(known).work));
}

TEST_CASE("likely error: on noisy probes it is near the truth, where the plain mean is half too large") {
    const synthetic::field f{synthetic::damage::noise, 5};
    running_mean likely, bound;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const audit_options options{.target = f.mean_error(), .noise = 1, .seed = seed};
        const audit_result a = audit(f.image(), f.probe(), options);
        likely.add(a.likely_error / f.mean_error());
        bound.add(a.mean_error / f.mean_error());
    }
    CAPTURE(likely.mean(), likely.standard_error(), bound.mean());
    CHECK(std::abs(likely.mean() - 1) < 0.1 + 3 * likely.standard_error());
    CHECK(bound.mean() > 1);
}

TEST_CASE("audit: pixels whose noise is larger get more samples, and the number asked for is kept on average") {
    synthetic::field f{synthetic::damage::noise, 5};
    for (double& x : f.truth) { x = 1; }
    f.picture = f.truth;
    std::vector<double> taken(synthetic::field::pixels), looked(synthetic::field::pixels);
    const auto probe = [&](std::size_t pixel, std::uint64_t seed, std::size_t count) {
        taken[pixel] += static_cast<double>(count);
        looked[pixel] += 1;
        const double spread = pixel % 2 == 0 ? 0.2 : 1.0;
        return 1 + spread * synthetic::normal_of(seed) / std::sqrt(static_cast<double>(count));
    };
    const audit_result a = audit(f.image(), probe, {.target = 0.05});
    double even = 0, odd = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) { (i % 2 == 0 ? even : odd) += taken[i]; }
    CHECK(odd > 2 * even);
    CHECK(odd < 5 * even);
    const double asked = static_cast<double>(a.samples_per_probe * a.probes);
    CHECK(static_cast<double>(a.samples) == Approx(1.125 * asked).epsilon(0.1));
}
