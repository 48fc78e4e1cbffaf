// The tables of a report, one function each.
#pragma once

#include <string>

#include "error_vs_time/study.hpp"
#include "error_vs_time/table.hpp"

namespace error_vs_time {

/// CPU seconds to the metric's targets, median over seeds and their interval; the baseline's also carried on.
[[nodiscard]] table times_to_targets(const study& all, const std::string& scene, const metric& what);

/// Speed-up over the baseline at the metric's targets, with its interval over seeds.
[[nodiscard]] table speed_ups(const study& all, const std::string& scene, const metric& what);

/// Every step of every method, beside the baseline's time to the same relMSE.
[[nodiscard]] table steps(const study& all, const std::string& scene);

/// Exponents of every metric over CPU seconds, with standard errors.
[[nodiscard]] table slopes(const study& all, const std::string& scene);

/// 1/(relMSE · seconds) by step of the budget: falling where bias takes over.
[[nodiscard]] table efficiencies(const study& all, const std::string& scene);

/// Medians of every metric at each method's largest budget.
[[nodiscard]] table final_errors(const study& all, const std::string& scene);

/// Bias and variance at every step for which they were measured.
[[nodiscard]] table bias_and_variance(const study& all, const std::string& scene);

/// CPU seconds by phase, at each method's largest budget.
[[nodiscard]] table phase_times(const study& all, const std::string& scene);

/// Rays, photons, records and memory, at each method's largest budget.
[[nodiscard]] table work_done(const study& all, const std::string& scene);

/// What the audits said beside what is true.
[[nodiscard]] table certificates(const study& all, const std::string& scene);

}  // namespace error_vs_time
