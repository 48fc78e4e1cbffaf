// A small table that can be written as HTML or as Markdown.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace error_vs_time {

/// The first columns are words, the others numbers.
struct table {
    std::string caption{};
    std::vector<std::string> head{};
    std::vector<std::vector<std::string>> rows{};
    std::size_t words{1};  ///< columns of words
};

/// Empty where the table has no rows.
[[nodiscard]] std::string html(const table& what);
[[nodiscard]] std::string markdown(const table& what);

}  // namespace error_vs_time
