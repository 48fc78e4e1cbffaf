// The programs that README.md and the examples' tutorial show are those that people can build.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "architecture/files.hpp"
#include "support/catch.hpp"

TEST_CASE("readme: its first program is examples/minimal.cpp, letter by letter") {
    const std::string readme = architecture::text_of("README.md");
    const std::string fence = "\n```cpp\n";
    const auto begin = readme.find(fence);
    REQUIRE(begin != std::string::npos);
    const auto first = begin + fence.size();
    const auto last = readme.find("\n```\n", first);
    REQUIRE(last != std::string::npos);
    CHECK(readme.substr(first, last + 1 - first) == architecture::text_of("examples/minimal.cpp"));
}

namespace {

/// What stands between ```cpp and ``` in `page`, one string a block.
std::vector<std::string> snippets_of(const std::string& page) {
    const std::string fence = "\n```cpp\n";
    std::vector<std::string> found;
    for (auto begin = page.find(fence); begin != std::string::npos; begin = page.find(fence, begin + 1)) {
        const auto first = begin + fence.size();
        found.push_back(page.substr(first, page.find("\n```\n", first) + 1 - first));
    }
    return found;
}

/// `text` without the blanks that its lines begin with: a snippet may be cut out of a function.
std::string without_indent(const std::string& text) {
    std::istringstream lines{text};
    std::string result = "\n";
    for (std::string line; std::getline(lines, line);) {
        const auto first = line.find_first_not_of(' ');
        result += (first == std::string::npos ? std::string{} : line.substr(first)) + '\n';
    }
    return result;
}

}  // namespace

TEST_CASE("readme: all code in examples/README.md stands in an example that is compiled, line by line") {
    std::vector<std::string> sources;
    for (const char* extension : {".cpp", ".hpp"}) {
        for (const std::string& file : architecture::files_below("examples", extension)) {
            sources.push_back(without_indent(architecture::text_of(file)));
        }
    }
    const std::vector<std::string> snippets = snippets_of(architecture::text_of("examples/README.md"));
    CHECK(snippets.size() >= 8);
    for (const std::string& snippet : snippets) {
        INFO(snippet);
        const std::string wanted = without_indent(snippet);
        CHECK(std::any_of(sources.begin(), sources.end(),
                          [&](const std::string& source) { return source.find(wanted) != std::string::npos; }));
    }
}
