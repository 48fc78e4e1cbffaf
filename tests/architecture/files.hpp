// The source tree as the architecture tests read it: file names, lines and what they include.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace architecture {

namespace fs = std::filesystem;

/// The root of the checkout under test.
inline const fs::path root{AGLOW_ROOT};

/// The whole text of `path`, taken from the root; empty where there is no such file.
inline std::string text_of(const fs::path& path) {
    std::ifstream file{root / path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
}

/// Names, relative to the root and sorted, of all files below `folder` that end in `extension`.
inline std::vector<std::string> files_below(const fs::path& folder, std::string_view extension) {
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator{root / folder}) {
        if (entry.path().extension() == extension) {
            found.push_back(entry.path().lexically_relative(root).generic_string());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// The first group of every match of `pattern` in `text`, in order.
inline std::vector<std::string> all_matches(const std::string& text, const std::string& pattern) {
    const std::regex wanted{pattern};
    std::vector<std::string> found;
    for (std::sregex_iterator match{text.begin(), text.end(), wanted}, end; match != end; ++match) {
        found.push_back((*match)[1]);
    }
    return found;
}

/// What `path` includes, delimiters and all: `<vector>`, `"support/catch.hpp"`.
inline std::vector<std::string> includes_of(const fs::path& path) {
    return all_matches(text_of(path), R"((?:^|\n)[ \t]*#[ \t]*include[ \t]*([<"][^>"]*[>"]))");
}

inline bool contains(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

}  // namespace architecture
