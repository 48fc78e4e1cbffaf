// Whether a study got worse than an earlier one: paired seeds, and as many tests as there are, taken together.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// One quantity of one scene, method and step, before and after.
struct difference {
    std::string scene{};
    std::string method{};
    std::size_t budget{0};
    std::string quantity{};  ///< "relMSE", "MAPE" or "CPU seconds"
    double ratio{1};         ///< after / before, geometric mean over the paired seeds
    double p_value{1};       ///< two-sided paired t-test of the logarithms
    double adjusted_p{1};    ///< after Holm's correction over all differences
    std::size_t pairs{0};
    bool significant{false};
};

struct gate_options {
    /// Probability of calling anything a difference where nothing has changed.
    double miss = 0.05;
    /// Changes smaller than this are told but fail nothing, however sure.
    double smallest = 0.02;
};

/// Every quantity that both studies measured with two equal seeds or more, in the order of the first study.
[[nodiscard]] std::vector<difference> differences(const study& before, const study& after,
                                                  const gate_options& options = {});

/// Whether a significant difference is a worsening larger than `options.smallest`.
[[nodiscard]] bool worse(std::span<const difference> all, const gate_options& options = {});

/// p-values made larger so that the chance of any false one among them keeps to its level (Holm 1979).
[[nodiscard]] std::vector<double> holm_adjusted(std::span<const double> p_values);

/// The differences as lines of text, the significant ones first.
[[nodiscard]] std::string told(std::span<const difference> all);

}  // namespace error_vs_time
