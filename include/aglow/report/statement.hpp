// An audit's result in words, for people who decide on it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include <aglow/core/significant.hpp>
#include <aglow/report/audit_result.hpp>

namespace aglow {

/// `share` as a percentage with three significant digits, such as "4.13 %"; "unknown" where it is not finite.
[[nodiscard]] inline std::string percent(double share) {
    if (!is_finite(share)) { return "unknown"; }
    if (share == 0) { return "0 %"; }
    return significant(100 * share, 3) + " %";
}

/// A probability near one as a percentage, with as many digits as tell it from 100 %.
[[nodiscard]] inline std::string percent_sure(double probability) {
    const double miss = 1 - probability;
    const int nines = miss > 0 ? static_cast<int>(std::ceil(-std::log10(miss))) : 0;
    return significant(100 * probability, std::clamp(nines + 1, 3, 15)) + " %";
}

[[nodiscard]] inline const char* words(audit_status status) {
    switch (status) {
        case audit_status::certified: return "certified";
        case audit_status::not_certified: return "not certified";
        default: return "inconclusive";
    }
}

/// The statements of an audit, one a line, each with what it means; what was not seen by the probe comes last.
[[nodiscard]] inline std::string statement(const audit_result& result) {
    const std::string sure = "with " + percent_sure(result.confidence) + " confidence, ";
    const std::string clipped = result.distribution_free ? ", errors above 100 % counted as 100 %," : "";
    const double bound = result.distribution_free ? result.clipped_error_bound : result.mean_error_bound;
    std::string text = std::string{words(result.status)} + ": mean relative error" + clipped + " within " +
                       percent(result.target) + '\n';
    for (const std::string& reason : result.reasons) { text += "because " + reason + '\n'; }
    if (result.probes > 0) {
        text += sure + "the mean relative error" + clipped + " is at most " + percent(bound) + " (estimate " +
                percent(result.mean_error) + (result.distribution_free ? ", nothing clipped)\n" : ")\n");
        text += sure + "the energy is off by " + percent(result.energy_bias.low) + " to " +
                percent(result.energy_bias.high) + '\n';
        if (result.quantile_bound) {
            text += sure + percent_sure(result.quantile) + " of the pixels are off by at most " +
                    percent(*result.quantile_bound) + '\n';
        }
        text += "seen: " + std::to_string(result.probes) + " pixels, " + std::to_string(result.samples) + " samples\n";
    }
    for (const unseen_transport& u : result.unseen) {
        text += "not seen by the probe, nothing is said of it: " + u.what + ", " + percent(u.flux_share) +
                " of the light\n";
    }
    return text;
}

}  // namespace aglow
