#include <algorithm>
#include <cmath>
#include <vector>

#include <aglow/report/claim_plan.hpp>
#include <aglow/report/render_until.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

/// An error of 8 % at work 4 that falls as samples do, seen by few probes that add 2.8 % at a noise of 1.4.
claim_outlook outlook(double sample_work) {
    claim_outlook known{.work = 4,
                        .decay = {.amplitude = 0.16, .exponent = 0.5},
                        .probes = 100,
                        .noise = 1.4,
                        .own = 0.028,
                        .samples = 13,
                        .sample_work = sample_work};
    for (std::size_t i = 0; i < known.z.size(); ++i) { known.z[i] = normal_quantile(1 - 0.05 * share_of_miss(i + 1)); }
    return known;
}

}  // namespace

TEST_CASE("claim plan: all claims together are wrong with the probability of one") {
    double sum = 0;
    for (std::size_t k = 1; k < 200; ++k) { sum += share_of_miss(k); }
    CHECK(sum == Approx(1));
    CHECK(share_of_miss(2) < share_of_miss(1));
}

TEST_CASE("claim plan: free probes are taken sharp and many, dear ones few and noisy on a better picture") {
    const claim_plan cheap = cheapest_claim(outlook(0));
    const claim_plan dear = cheapest_claim(outlook(1e-2));
    CHECK(cheap.probes > 1500);
    CHECK(cheap.noise < 0.38);
    CHECK(dear.probes == 300);
    CHECK(dear.noise == Approx(0.7));
    CHECK(dear.work >= cheap.work);
    // Nothing certifies before the error itself is at the target: 0.16 / √w = 0.05.
    CHECK(certified_work(outlook(0), cheap, 1) > std::pow(0.16 / 0.05, 2));
    CHECK(certified_work(outlook(0), cheap, 1) < 1.4 * std::pow(0.16 / 0.05, 2));
    CHECK(certified_work(outlook(0), dear, 1) > certified_work(outlook(0), cheap, 1));
}

TEST_CASE("claim plan: probes that are there cost nothing, and what they see weighs as much as their share") {
    claim_outlook known = outlook(1e-3);
    known.probes = 400;
    known.noise = 0.5;
    known.own = 0.01;
    CHECK(probes_cost(known, {4, 400, 0.5}) == 0);
    CHECK(probes_cost(known, {4, 800, 0.5}) == Approx(1e-3 * 13 * 400));
    CHECK(probes_cost(known, {4, 400, 0.25}) == Approx(1e-3 * 13 * 3 * 400));
    // Probes that chanced upon large errors want a far better picture; many more of them are worth their cost.
    known.seen = 1.5;
    CHECK(cheapest_claim(known).probes >= 600);
    known.seen = 1;
    CHECK(cheapest_claim(known).probes == 400);
}

TEST_CASE("claim plan: no other number or noise of probes, nor more or less work, is cheaper in the mean") {
    const claim_outlook known = outlook(3e-4);
    const claim_plan best = cheapest_claim(known);
    const double least = expected_cost(known, best);
    for (const double work : {0.85, 1.0, 1.2}) {
        for (const double probes : {0.5, 0.8, 1.25, 2.0}) {
            for (const double noise : {0.7, 0.85, 1.0, 1.2}) {
                const auto n = static_cast<std::size_t>(probes * static_cast<double>(best.probes));
                if (n < claim_outlook::least_probes || n > known.most_probes) { continue; }
                const claim_plan other{work * best.work, n,
                                       std::clamp(noise * best.noise, known.least_noise, known.most_noise)};
                CHECK(expected_cost(known, other) > 0.97 * least);
            }
        }
    }
}

TEST_CASE("claim plan: what probes cost in the mean is what many of them cost that claim until they hold") {
    claim_outlook known = outlook(1e-3);
    known.doubt = 0.1;
    known.seen = 1.3;
    const claim_plan plan{12, 500, 0.5};
    running_mean cost;
    random_sampler<double> random{7};
    for (int i = 0; i < 100000; ++i) {
        // A fifth of the probes is there and sees 1.3 times too much; the others, and the course of the error, may
        // differ from what is expected.
        const double deviation = std::hypot(known.doubt, 1.1 * known.ratio * std::sqrt(0.8 / 500));
        const double seen = std::pow(1.3, 0.2) * std::exp(deviation * synthetic::normal(random));
        double work = 12;
        std::size_t k = 0;
        while (k < claim_outlook::looks && seen * 0.16 / std::sqrt(work) > certifiable_error(known, plan, known.z[k])) {
            work *= known.growth;
            ++k;
        }
        cost.add((k < claim_outlook::looks ? work : 2 * work) + probes_cost(known, plan));
    }
    CHECK(expected_cost(known, plan) == Approx(cost.mean()).epsilon(0.02));
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
