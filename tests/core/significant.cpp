#include <aglow/core/significant.hpp>

#include <limits>
#include <stdexcept>
#include <string>

#include <aglow/estimators/irradiance_cache.hpp>

#include "support/catch.hpp"

using aglow::significant;

TEST_CASE("significant: digits are kept where the number is, and zeros behind them are not") {
    CHECK(significant(0.1) == "0.1");
    CHECK(significant(2.5e-9) == "2.5e-09");
    CHECK(significant(-1e300) == "-1e+300");
    CHECK(significant(12) == "12");
    CHECK(significant(0) == "0");
    CHECK(significant(1.0 / 3, 3) == "0.333");
    CHECK(significant(std::numeric_limits<double>::quiet_NaN()).find("nan") != std::string::npos);
    CHECK(significant(-std::numeric_limits<double>::infinity()) == "-inf");
    // The longest there is.
    CHECK(std::stod(significant(-2.2250738585072014e-308, 17)) == -2.2250738585072014e-308);
}

TEST_CASE("significant: a setting that is refused is told as it was given, however small") {
    std::string said;
    try {
        aglow::irradiance_cache_options wrong;
        wrong.reach.accuracy = -2.5e-9;
        (void)aglow::irradiance_cache<float>{{{0, 0, 0}, {1, 1, 1}}, wrong};
    } catch (const std::invalid_argument& e) { said = e.what(); }
    CHECK(said == "aglow: accuracy is -2.5e-09");
}
