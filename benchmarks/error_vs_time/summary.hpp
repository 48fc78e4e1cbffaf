// The few numbers that a study comes down to: curves, slopes, times to an error and speed-ups.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <aglow/report/confidence.hpp>
#include <aglow/report/convergence.hpp>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// Fewer seeds have no interval of 95 %: the median lies beyond all n of them with a probability of 2^(1−n). Intervals
/// over fewer reach from the least to the most.
inline constexpr std::size_t seeds_for_95 = 6;

/// Different seeds of a scene's runs, of the method that has fewest.
[[nodiscard]] std::size_t seeds_in(const study& all, const std::string& scene);

/// One row a budget: medians over seeds and the 5 to 95 % band.
[[nodiscard]] std::vector<aglow::convergence_row> curve(const study& all, const std::string& scene,
                                                        const std::string& method, const metric& what);

/// Exponent of error ~ CPU seconds over all runs; nothing where the longest is not twice the shortest.
[[nodiscard]] std::optional<aglow::line_fit> slope(const study& all, const std::string& scene,
                                                   const std::string& method, const metric& what);

/// The CPU seconds that a method takes to an error: the median over seeds of where each seed's curve crosses it.
struct time_to {
    aglow::crossing median{};                   ///< `before` or `never` where the median seed's curve does not cross
    std::vector<double> seconds{};              ///< of every seed, where all of them cross
    std::optional<aglow::interval> interval{};  ///< over seeds, where all of them cross
};

[[nodiscard]] time_to time_to_target(const study& all, const std::string& scene, const std::string& method,
                                     const metric& what, double target);

/// The CPU seconds that the baseline would take to an error, where it stopped above it: each seed's last error carried
/// on as fast as its errors fell over all its runs, and as those of independent samples at least, so that nothing looks
/// faster for it than it is. The median over seeds; nothing where the baseline gets there, or has no error.
[[nodiscard]] std::optional<double> carried_on(const study& all, const std::string& scene, const metric& what,
                                               double target);

/// How many times faster than the baseline a method gets to an error, with its interval over seeds. Where one of the
/// two does not cross, the estimate is a limit and `sign` says which: '>' at least, '<' at most.
struct speed_up {
    char sign{'='};
    double estimate{0};
    std::optional<aglow::interval> interval{};
    std::optional<double> about{};  ///< the same with the baseline carried on, where that is what does not cross
};

/// Nothing where neither limit is known, for the baseline itself, or without a baseline.
[[nodiscard]] std::optional<speed_up> speed_up_to_target(const study& all, const std::string& scene,
                                                         const std::string& method, const metric& what, double target);

/// One step of a method beside what the baseline takes to errors as small, seed by seed.
struct equal_error {
    char sign{'='};  ///< '~' where the baseline is carried on in a seed or more, '<' where it was better from the start
    double baseline_seconds{0};  ///< median over seeds
    aglow::interval ratio{};     ///< baseline's over the method's time: median and interval over seeds
};

/// Nothing for the baseline itself, or where it shares no seed with the step.
[[nodiscard]] std::optional<equal_error> at_equal_error(const study& all, const std::string& scene,
                                                        const std::string& method, std::size_t budget,
                                                        const metric& what);

}  // namespace error_vs_time
