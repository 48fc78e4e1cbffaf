// Which claim on a picture would be the cheapest that holds: how far to render, and how hard to look.
//
// Few noisy probes are cheap but want a picture well below the target; many sharp ones certify it just below. What that
// is worth depends on what a sample of either costs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <aglow/core/numbers.hpp>
#include <aglow/report/decay.hpp>
#include <aglow/report/distributions.hpp>

namespace aglow {

/// A claim to be made when `work` is done.
struct claim_plan {
    double work{std::numeric_limits<double>::infinity()};
    std::size_t probes{200};
    double noise{0.5};  ///< standard error of a probe, as a share of the target
};

/// What is known before a claim, and between which bounds it may be chosen.
struct claim_outlook {
    double target{0.05};
    double z{1.88};     ///< normal quantile of the claim's confidence
    double work{1};     ///< done so far
    decay_fit decay{};  ///< the picture's mean error
    double doubt{0};    ///< relative standard error of what `decay` says
    double ratio{1};    ///< standard deviation over mean of the errors that probes see
    double noise{0.5};  ///< at which probes were drawn so far, as a share of the target
    double own{0};      ///< mean size of their noise then, relative as errors are
    double samples{1};  ///< that each took then
    double sample_work{0};
    std::size_t most_probes{2000};
    double most_noise{0.7};  ///< above, what probes add to the errors is as uncertain as these
    double least_noise{0.35};
};

/// The largest error of a picture that so many probes of so much noise certify more often than not: half of what their
/// noise adds to |e| is in the estimate, (e + √(e² + n²)) / 2, and the bound lies z standard errors above it.
[[nodiscard]] inline double certifiable_error(const claim_outlook& known, std::size_t probes, double noise) {
    const double reach = 1.1 * known.z * known.ratio / std::sqrt(static_cast<double>(probes));
    const double seen = known.target / (1 + reach);
    const double own = known.own * noise / known.noise;
    return seen - own * own / (4 * seen);
}

/// What a claim costs in the mean, picture and probes together: where it fails, the picture is rendered on and claimed
/// again.
[[nodiscard]] inline double expected_cost(const claim_outlook& known, const claim_plan& plan) {
    const double count = static_cast<double>(plan.probes);
    const double probes = known.sample_work * known.samples * square(known.noise / plan.noise) * count;
    const double goal = certifiable_error(known, plan.probes, plan.noise);
    const double spread = std::sqrt(square(known.doubt) + square(1.1 * known.ratio) / count);
    const double holds = normal_cdf(std::log(goal / known.decay.at(plan.work)) / spread);
    const double again = std::clamp(known.decay.work_to(goal / (1 + spread)), 1.2 * plan.work, 4 * plan.work);
    return plan.work + probes + (1 - holds) * (again - plan.work + probes);
}

/// The claim that costs least in the mean; its work is infinite where none would hold.
[[nodiscard]] inline claim_plan cheapest_claim(const claim_outlook& known) {
    claim_plan best{.noise = known.least_noise};
    double least = std::numeric_limits<double>::infinity();
    for (double noise = known.least_noise; noise <= 1.01 * known.most_noise; noise *= 1.1892) {  // 2^(1/4)
        for (std::size_t probes = 200; probes <= known.most_probes; probes += (probes + 3) / 4) {
            const double goal = certifiable_error(known, probes, noise);
            if (!(goal > 0)) { continue; }
            for (const double caution : {0.0, 0.5, 1.0, 1.5}) {
                const double work = known.decay.work_to(goal / (1 + caution * known.doubt));
                if (!is_finite(work)) { break; }
                const claim_plan plan{std::max(known.work, work), probes, noise};
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
