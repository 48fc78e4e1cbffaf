// Whether a study got worse than an earlier one: paired seeds, and as many tests as there are, taken together.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// One quantity of one scene, method and step, or of all steps of a method together, before and after.
struct difference {
    std::string scene{};
    std::string method{};
    std::optional<std::size_t> budget{};  ///< none for all steps together
    std::string quantity{};               ///< "relMSE", "MAPE" or "CPU seconds"
    double ratio{1};                      ///< after / before, geometric mean over the paired seeds
    double p_value{1};                    ///< two-sided paired t-test of the logarithms
    double adjusted_p{1};                 ///< after Holm's correction over all differences
    std::size_t pairs{0};                 ///< of runs of the same step and seed
    bool significant{false};
};

struct gate_options {
    /// Probability of calling anything a difference where nothing has changed.
    double miss = 0.05;
    /// Changes smaller than this are told but fail nothing, however sure: the same program takes a few per cent more or
    /// less time from one hour to the next, all its runs alike.
    double smallest = 0.05;
};

/// Every quantity that both studies measured with two equal seeds or more, sorted by scene and method. Few seeds cannot
/// show much of a single step, among so many; all steps of a method together can.
[[nodiscard]] std::vector<difference> differences(const study& before, const study& after,
                                                  const gate_options& options = {});

/// Whether a significant difference is a worsening larger than `options.smallest`.
[[nodiscard]] bool worse(std::span<const difference> all, const gate_options& options = {});

/// Scenes of both studies whose pictures cannot be compared, for their size or their reference, a line each.
[[nodiscard]] std::vector<std::string> other_scenes(const study& before, const study& after);

/// What the second study lost, a line each: steps and seeds of scenes that both have, steps that mean something else,
/// and pixels that are broken now.
[[nodiscard]] std::vector<std::string> losses(const study& before, const study& after);

/// In what else than their runs the studies differ, a line each: their making, and scenes that only one has.
[[nodiscard]] std::vector<std::string> unlike(const study& before, const study& after);

/// p-values made larger so that the chance of any false one among them keeps to its level (Holm 1979).
[[nodiscard]] std::vector<double> holm_adjusted(std::span<const double> p_values);

/// The differences as lines of text, the significant ones first; what is the same to the bit is left out.
[[nodiscard]] std::string told(std::span<const difference> all);

}  // namespace error_vs_time
