// What holds for every public header, and for the lists that must name each of them.
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "architecture/files.hpp"
#include "support/catch.hpp"

namespace {

using architecture::contains;
using architecture::text_of;
using list = std::vector<std::string>;

list headers() { return architecture::files_below("include", ".hpp"); }

/// The lines of `names` that look like paths of public headers, as the build lists them.
list listed() { return architecture::all_matches(text_of("CMakeLists.txt"), "\n +(include/aglow/[^ \n]*)"); }

}  // namespace

TEST_CASE("headers: the build lists every one, once, and no other") {
    const list in_build = listed();
    for (const std::string& header : headers()) {
        INFO(header);
        CHECK(std::count(in_build.begin(), in_build.end(), header) == 1);
    }
    for (const std::string& header : in_build) {
        INFO(header);
        CHECK(contains(headers(), header));
    }
}

TEST_CASE("headers: within a folder the build lists them by the alphabet") {
    const list in_build = listed();
    for (std::size_t i = 1; i < in_build.size(); ++i) {
        const auto folder = [](const std::string& path) { return path.substr(0, path.rfind('/')); };
        INFO(in_build[i - 1] << " before " << in_build[i]);
        CHECK((folder(in_build[i - 1]) != folder(in_build[i]) || in_build[i - 1] < in_build[i]));
    }
}

TEST_CASE("headers: aglow.hpp includes every one") {
    const list included = architecture::includes_of("include/aglow/aglow.hpp");
    CHECK(included.size() + 1 == headers().size());
    for (const std::string& header : headers()) {
        if (header == "include/aglow/aglow.hpp") { continue; }
        INFO(header);
        CHECK(contains(included, std::string{"<"} + header.substr(std::string{"include/"}.size()) + ">"));
    }
}

TEST_CASE("headers: each opens with a sentence that says what it is") {
    for (const std::string& header : headers()) {
        INFO(header);
        const std::string text = text_of(header);
        const auto opening = architecture::all_matches(text, "^(//[^\n]*\n(?://[^\n]*\n)*)#pragma once\n");
        REQUIRE(opening.size() == 1);
        CHECK(opening.front().find('.') != std::string::npos);
    }
}

TEST_CASE("headers: none defines a macro") {
    for (const std::string& header : headers()) {
        INFO(header);
        CHECK(architecture::all_matches(text_of(header), "(?:^|\n)[ \t]*#[ \t]*(define [^\n]*)").empty());
    }
}

TEST_CASE("tests: each source is in the build") {
    const std::string build = text_of("tests/CMakeLists.txt");
    for (const std::string& source : architecture::files_below("tests", ".cpp")) {
        const std::string path = source.substr(std::string{"tests/"}.size());
        if (path.starts_with("must_not_compile/") || path.starts_with("packaging/")) { continue; }
        INFO(source);
        CHECK(build.find(path) != std::string::npos);
    }
}

TEST_CASE("tests: ctest can tell their names apart") {
    for (const std::string& source : architecture::files_below("tests", ".cpp")) {
        INFO(source);
        for (const std::string& name :
             architecture::all_matches(text_of(source), "TEST_CASE[A-Z_]*\\(\\s*\"([^\"]*)")) {
            INFO(name);
            CHECK(name.find_first_of(";\\") == std::string::npos);
            CHECK(std::count(name.begin(), name.end(), '[') == std::count(name.begin(), name.end(), ']'));
        }
    }
}
