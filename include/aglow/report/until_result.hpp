// What `render_until` is asked for, and what it answers.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include <aglow/core/callback.hpp>
#include <aglow/report/audit_result.hpp>
#include <aglow/report/decay.hpp>

namespace aglow {

/// One look at the picture on the way.
struct until_check {
    double work{0};
    double error{0};            ///< estimate of the mean relative error
    double error_deviation{0};  ///< standard error of that
    double bound{0};            ///< what was claimed; 0 where this was only a look
    std::size_t probes{0};
};

struct until_progress {
    until_check last{};
    double predicted_work{0};  ///< work at which the target will be certified, as far as can be told; may be infinite
};

struct render_until_options {
    /// The target, the confidence over all claims together, and how probes are drawn. Its budget bounds the first look
    /// alone. Plans are for the bound on the mean error: with a `bias_target`, or `distribution_free`, claims come too
    /// early and may fail to the last.
    audit_options audit{};
    /// Work before the first look, in the host's unit: passes, samples, photons or seconds.
    double first_work = 1;
    /// The picture is given up when this much work is done.
    double most_work = std::numeric_limits<double>::infinity();
    /// Smallest and largest ratio of work between two looks.
    double least_growth = 1.15;
    double most_growth = 2;
    /// Standard errors of probes as shares of the target, instead of `audit.noise`: probes are first drawn with the
    /// largest, and claims take what is cheapest between the smallest and half of the largest.
    double most_noise = 1.4;
    double least_noise = 0.35;
    /// Probes of the first looks, and most probes of a claim.
    std::size_t scout_probes = 100;
    std::size_t most_probes = 2000;
    /// Work of one probe sample in the unit above; 0 where unknown, and then they are taken to cost nothing. Claims are
    /// made with probes and a picture that are cheapest in the mean, both together; until these are due, probes are
    /// sharpened for a tenth of the work so far at most, or half of it where noise seems heavy-tailed.
    double probe_work = 0;
    /// Called after every look; returning false ends the work.
    callback<const until_progress&> progress{};
};

enum class until_status { reached, unreachable, out_of_work, cancelled, broken };

/// `reached`: `certificate` is certified. `unreachable`: the error falls towards a floor above the target, or so near
/// it that `most_probes` do not tell it from one, so other settings are needed; or the noise of the probes stays
/// heavy-tailed, so that no claim can be made by them. `out_of_work`: `most_work` is done, or some sixty claims failed.
/// `broken`: the picture has pixels that are infinite or NaN, or the probes gave such answers or lost light to broken
/// ones of their host.
struct until_result {
    until_status status{until_status::out_of_work};
    audit_result certificate{};  ///< of the last claim, with the confidence of all claims together
    decay_fit decay{};
    double work{0};
    double predicted_work{0};
    std::size_t claims{0};
    std::size_t probe_samples{0};
    std::vector<until_check> checks{};
};

}  // namespace aglow
