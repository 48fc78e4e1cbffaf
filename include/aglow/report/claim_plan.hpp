// Which probes would certify a picture at the least cost: from when on they look at it, how many and how sharp.
//
// Few noisy probes are cheap but want a picture well below the target; many sharp ones certify it just below. What that
// is worth depends on what a sample of either costs. Probes look again for nothing as the picture gets better, but each
// claim takes of the probability to be wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <aglow/core/numbers.hpp>
#include <aglow/report/decay.hpp>
#include <aglow/report/distributions.hpp>

namespace aglow {

/// The share of all probability to be wrong that claim `k` (1, 2, ...) gets: 0.2 · 0.8^(k−1), 1 in all. The same
/// probes claim again and again, and each time about as well.
[[nodiscard]] inline double share_of_miss(std::size_t k) { return 0.2 * std::pow(0.8, static_cast<double>(k) - 1); }

/// How many probes shall claim from when on, and the standard error of each as a share of the target.
struct claim_plan {
    double work{std::numeric_limits<double>::infinity()};
    std::size_t probes{200};
    double noise{0.5};
};

/// What is known before a claim, and between which bounds it may be chosen.
struct claim_outlook {
    static constexpr std::size_t looks = 8;
    static constexpr std::size_t least_probes = 300;  ///< fewer, and of skewed errors, are too often wrong together

    double target{0.05};
    std::array<double, looks> z{};  ///< normal quantiles of the confidence of the next claims
    double growth{1.15};            ///< of work from one to the next
    double work{1};                 ///< done so far
    decay_fit decay{};              ///< the picture's mean error
    double seen{1};                 ///< the error that the present probes' bound speaks of, over what `decay` says
    double doubt{0};                ///< relative standard error of what `decay` says of the work to come
    double ratio{1};                ///< standard deviation over mean of the errors that probes see
    std::size_t probes{100};        ///< drawn so far
    double noise{0.5};              ///< of each, as a share of the target
    double own{0};                  ///< mean size of that, relative as errors are
    double samples{1};              ///< that each took
    double sample_work{0};
    std::size_t most_probes{2000};
    double most_noise{0.7};  ///< above, what probes add to the errors is as uncertain as these
    double least_noise{0.35};
};

/// The most and sharpest probes that may be had, at once.
[[nodiscard]] inline claim_plan best_probes(const claim_outlook& known) {
    return {known.work, known.most_probes, std::min(known.noise, known.least_noise)};
}

/// How far the bound lies above what the probes see, relative to that.
[[nodiscard]] inline double reach_of(const claim_outlook& known, const claim_plan& plan, double z) {
    return 1.1 * z * known.ratio / std::sqrt(static_cast<double>(plan.probes));
}

/// The error of a picture that such probes bound by `bound` more often than not: half of what their noise adds to |e|
/// is in the estimate, (e + √(e² + n²)) / 2, and the bound lies z standard errors above it.
[[nodiscard]] inline double error_behind(const claim_outlook& known, const claim_plan& plan, double z, double bound) {
    const double seen = bound / (1 + reach_of(known, plan, z));
    const double own = known.own * plan.noise / known.noise;
    return seen > 0 ? seen - own * own / (4 * seen) : 0;
}

/// The largest error of a picture that such probes certify more often than not.
[[nodiscard]] inline double certifiable_error(const claim_outlook& known, const claim_plan& plan, double z) {
    return error_behind(known, plan, z, known.target);
}

/// The work at which such probes certify a picture whose error seems to them `factor` times as large as expected, as
/// they look at it again and again.
[[nodiscard]] inline double certified_work(const claim_outlook& known, const claim_plan& plan, double factor) {
    double work = plan.work;
    for (const double z : known.z) {
        if (factor * known.decay.at(work) <= certifiable_error(known, plan, z)) { return work; }
        work *= known.growth;
    }
    return 2 * work;
}

/// What the probes of `plan` cost beyond those drawn so far, which stay and take in further samples.
[[nodiscard]] inline double probes_cost(const claim_outlook& known, const claim_plan& plan) {
    const double samples = square(known.noise / plan.noise) * static_cast<double>(plan.probes);
    return known.sample_work * known.samples * (samples - static_cast<double>(known.probes));
}

/// What it costs in the mean to have such probes and to render on until they certify the picture. What the present
/// probes see is also seen by more, as far as they are the same.
[[nodiscard]] inline double expected_cost(const claim_outlook& known, const claim_plan& plan) {
    constexpr std::array fifths{-1.2816, -0.5244, 0.0, 0.5244, 1.2816};  // medians of the fifths of a normal law
    const double old_share = static_cast<double>(known.probes) / static_cast<double>(plan.probes);
    const double fresh = square(1.1 * known.ratio) * (1 - old_share) / static_cast<double>(plan.probes);
    const double spread = std::sqrt(square(known.doubt) + fresh);
    const double centre = std::pow(known.seen, old_share);
    double work = 0;
    for (const double x : fifths) {
        work += certified_work(known, plan, centre * std::exp(x * spread)) / fifths.size();
    }
    return work + probes_cost(known, plan);
}

/// The plan that costs least in the mean; its work is infinite where none would come to an end.
[[nodiscard]] inline claim_plan cheapest_claim(const claim_outlook& known) {
    claim_plan best{.noise = known.least_noise};
    double least = std::numeric_limits<double>::infinity();
    const double most_noise = std::min(known.noise, known.most_noise);
    for (double noise = most_noise; noise >= 0.99 * std::min(most_noise, known.least_noise);
         noise /= 1.1892) {  // 2^(1/4)
        for (std::size_t probes = std::max(known.probes, claim_outlook::least_probes); probes <= known.most_probes;
             probes += (probes + 3) / 4) {
            claim_plan plan{known.work, probes, noise};
            const double goal = certifiable_error(known, plan, known.z.front());
            if (!(goal > 0)) { continue; }
            for (const double caution : {0.8, 0.9, 1.0, 1.1, 1.25}) {
                const double work = known.decay.work_to(caution * goal);
                if (!is_finite(work)) { continue; }
                plan.work = std::max(known.work, work);
                const double cost = expected_cost(known, plan);
                if (cost < least) {
                    least = cost;
                    best = plan;
                }
            }
        }
    }
    return best;
}

}  // namespace aglow
