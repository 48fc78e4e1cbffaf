// The few numbers that a study comes down to: curves, slopes, times to an error and speed-ups.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <aglow/report/confidence.hpp>
#include <aglow/report/convergence.hpp>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// One row a budget: medians over seeds and the 5 to 95 % band.
[[nodiscard]] std::vector<aglow::convergence_row> curve(const study& all, const std::string& scene,
                                                        const std::string& method, const metric& what);

/// Exponent of error ~ CPU seconds over all runs; nothing below two different times with an error.
[[nodiscard]] std::optional<aglow::line_fit> slope(const study& all, const std::string& scene,
                                                   const std::string& method, const metric& what);

/// The CPU seconds that a method takes to an error: the median over seeds of where each seed's curve crosses it.
struct time_to {
    aglow::crossing median{};                   ///< `before` or `never` where the median seed's curve does not cross
    std::vector<double> seconds{};              ///< of every seed, where all of them cross
    std::optional<aglow::interval> interval{};  ///< bootstrap over seeds, where all of them cross
};

[[nodiscard]] time_to time_to_target(const study& all, const std::string& scene, const std::string& method,
                                     const metric& what, double target);

/// How many times faster than the baseline a method gets to an error, with its bootstrap interval over seeds. Where one
/// of the two does not cross, the estimate is a limit and `sign` says which: '>' at least, '<' at most.
struct speed_up {
    char sign{'='};
    double estimate{0};
    std::optional<aglow::interval> interval{};
};

/// Nothing where neither limit is known, for the baseline itself, or without a baseline.
[[nodiscard]] std::optional<speed_up> speed_up_to_target(const study& all, const std::string& scene,
                                                         const std::string& method, const metric& what, double target);

}  // namespace error_vs_time
