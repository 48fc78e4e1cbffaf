// What a rendering cost, as a table for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/image_io.hpp"

namespace host {

/// A finished picture and what it took.
struct render_result {
    struct phase {
        std::string name;
        double seconds;
    };
    struct fact {
        std::string name;
        std::string value;
    };

    std::vector<layer> layers{};
    std::vector<phase> phases{};
    std::vector<fact> facts{};
    std::vector<std::string> notes{};
    std::optional<picture> heat{};  ///< error bars in false colour

    void add_fact(std::string name, std::uint64_t count) { facts.push_back({std::move(name), grouped(count)}); }
    void add_bytes(std::string name, std::uint64_t bytes);

    /// 1234567 as "1,234,567".
    [[nodiscard]] static std::string grouped(std::uint64_t n);
};

/// Writes the table to standard output.
void print_table(const render_result& result);

/// The most memory that the program has held so far, in bytes.
[[nodiscard]] std::uint64_t peak_memory();

}  // namespace host
