// All that was measured: scenes, runs, pictures and certificates of one study of error against time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <aglow/report/bias_variance.hpp>
#include <aglow/report/image_error.hpp>

namespace error_vs_time {

/// Version of report.json; raised when a reader of the old one would misread the new.
inline constexpr int schema_version = 1;

using text_pairs = std::vector<std::pair<std::string, std::string>>;
using number_pairs = std::vector<std::pair<std::string, double>>;

struct scene_note {
    std::string name{};
    std::string description{};
    std::size_t width{0};
    std::size_t height{0};
    std::string reference{};     ///< how the reference was made
    double reference_relmse{0};  ///< noise of the reference as relMSE; two halves of it leave none in squared errors
    double reference_mape{0};    ///< the same as MAPE, which is always left; 0 where it is not known
    std::size_t reference_pictures{1};  ///< 2 where the reference was two halves of independent noise
};

/// One picture made with one seed.
struct run_note {
    std::string scene{};
    std::string method{};
    std::size_t budget{0};   ///< step on the method's ladder of budgets, from 0
    std::string settings{};  ///< what that step means, for people
    std::uint64_t seed{0};
    double cpu_seconds{0};
    double wall_seconds{0};
    unsigned threads{1};
    number_pairs phases{};  ///< CPU seconds by phase
    number_pairs counts{};  ///< rays by kind, photons, records, lookups
    double peak_bytes{0};   ///< most memory in use
    aglow::image_error error{};
};

/// Bias and variance of one step of a method's ladder.
struct parts_note {
    std::string scene{};
    std::string method{};
    std::size_t budget{0};
    aglow::error_parts parts{};
};

/// An audit beside what it could not know.
struct audit_note {
    std::string scene{};
    std::string method{};
    std::size_t budget{0};
    std::string status{};
    std::string statement{};
    double target{0};
    double bound{0};
    double true_error{0};
    double bias_low{0};
    double bias_high{0};
    double true_bias{0};
    double seconds{0};
    double render_seconds{0};
};

/// A picture as it is shown: 8-bit sRGB, row by row, and its error in false colour (empty for the reference).
struct picture_note {
    std::string scene{};
    std::string method{};
    std::string caption{};
    std::size_t width{0};
    std::size_t height{0};
    std::vector<std::uint8_t> rgb{};
    std::vector<std::uint8_t> error_rgb{};
};

struct study {
    std::string title{};
    std::string baseline{};  ///< the method that all speed-ups are measured against
    std::vector<double> relmse_targets{8e-3, 1.9e-3, 1.2e-3, 4.5e-4, 1.3e-4};
    text_pairs provenance{};
    std::vector<scene_note> scenes{};
    std::vector<run_note> runs{};
    std::vector<parts_note> parts{};
    std::vector<audit_note> audits{};
    std::vector<picture_note> pictures{};
};

/// A measure of error that a study is drawn and summed up by.
struct metric {
    const char* name;
    const char* formula;
    double aglow::image_error::*value;
    bool squared;                 ///< falls as 1/time for independent samples, so 1/(error·time) is an efficiency
    std::vector<double> targets;  ///< errors whose time is told; those of relMSE are a study's own
};

/// The measures in the order of their columns; the first two are drawn.
[[nodiscard]] const std::vector<metric>& metrics();

/// The errors whose time a study tells, largest first.
[[nodiscard]] const std::vector<double>& targets_of(const study& all, const metric& what);

/// Names of a study's methods in the order of their first run, the baseline first.
[[nodiscard]] std::vector<std::string> methods_of(const study& all);

}  // namespace error_vs_time
