// What a study is asked for on the command line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace error_vs_time {

struct options {
    std::filesystem::path output{"build/error_vs_time"};
    std::vector<std::string> scenes{"cornell-diffuse", "cornell-glass"};
    std::vector<double> relmse_targets{};  ///< those of a study where there are none
    std::size_t size{256};
    std::size_t seeds{3};
    std::uint32_t reference_samples{2048};  ///< of each half, where a reference has to be made
    bool full{false};
    bool smoke{false};
    bool help{false};
};

extern const std::string_view usage;

/// Reads the words after the program's name. Throws `std::invalid_argument` that names the word. Scenes are taken as
/// they are named.
[[nodiscard]] options parse(std::span<const std::string_view> words);

}  // namespace error_vs_time
