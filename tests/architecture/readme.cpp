// The program that README.md shows is the one that people can build.
#include <string>

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
