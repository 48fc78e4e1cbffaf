#include <string>

#include <aglow/core/version.hpp>

#include "support/catch.hpp"

TEST_CASE("version: the first number that differs decides") {
    using number = aglow::version_number;
    CHECK(number{1, 0, 0} > number{0, 9, 9});
    CHECK(number{1, 2, 0} > number{1, 1, 9});
    CHECK(number{1, 2, 3} > number{1, 2, 2});
    CHECK(number{1, 2, 3} == number{1, 2, 3});
}

TEST_CASE("version: the build and the header name the same release") {
    const auto& [major, minor, patch] = aglow::version;
    CHECK(std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(patch) == AGLOW_BUILD_VERSION);
}
