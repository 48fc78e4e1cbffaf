// What the person at the command line asks for.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace host {

enum class method { path, irradiance_cache, photon_map, final_gather, gather_cache };
enum class view { beauty, direct, indirect, caustic, records, photons };

/// All settings of one picture; what is empty is left to the library.
struct render_options {
    std::string scene{};
    method how{method::gather_cache};
    view show{view::beauty};
    std::filesystem::path output{};
    std::uint32_t samples{16};
    double seconds{0};
    /// What `seconds` are counted from.
    std::chrono::steady_clock::time_point begun{std::chrono::steady_clock::now()};
    unsigned threads{0};
    std::uint64_t seed{0};
    std::size_t width{256};
    std::size_t height{256};
    std::optional<std::size_t> direct_photons{};
    std::optional<std::size_t> caustic_photons{};
    std::optional<std::size_t> indirect_photons{};
    std::optional<std::uint32_t> photons_per_estimate{};
    std::optional<std::uint32_t> gather_rays{};
    std::optional<double> accuracy{};
    bool layers{false};
    bool error{false};
    /// Most samples of that audit.
    std::optional<std::size_t> error_samples{};
    /// The mean relative error that an audit shall certify; 0 for as many samples as told.
    double until{0};
    /// Path tracing in two independent halves, in one file of half floats.
    bool reference{false};
    bool list{false};
    float exposure{1};
    /// What was said and changes nothing, a line each.
    std::vector<std::string> unused{};
};

/// Reads the command line. Throws `usage_error` for what makes no sense; empty where help was asked for and given.
[[nodiscard]] std::optional<render_options> read_options(int count, const char* const* words);

[[nodiscard]] std::string name_of(method how);

}  // namespace host
