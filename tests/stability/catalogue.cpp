#include "stability/catalogue.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "support/catch.hpp"

using namespace stability;

namespace {

std::string sources_of(const std::filesystem::path& folder) {
    std::string all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{folder}) {
        if (entry.path().extension() != ".cpp" || entry.path().filename() == "catalogue.cpp") { continue; }
        std::ifstream file{entry.path()};
        all.append(std::istreambuf_iterator<char>{file}, {});
    }
    return all;
}

}  // namespace

TEST_CASE("catalogue: all eighty rows are there, in order, and each is a test by its number") {
    const std::string sources = sources_of(AGLOW_ROOT "/tests/stability");
    for (std::size_t i = 0; i < catalogue.size(); ++i) {
        CHECK(catalogue[i].number == static_cast<int>(i) + 1);
        CAPTURE(i + 1);
        CHECK(sources.find("\"stability " + std::to_string(i + 1) + ":") != std::string::npos);
    }
}

TEST_CASE("catalogue: what is to be measured is finite, positive and belongs to a row that compares numbers") {
    for (const measured_case& m : measured_cases()) {
        CAPTURE(m.row, m.what);
        CHECK(m.expected < 1e300);
        CHECK(m.expected > 0);
        CHECK(catalogue[static_cast<std::size_t>(m.row - 1)].how != nearness::status);
    }
}

TEST_CASE("catalogue: a measurement is held to its row and no nearer") {
    CHECK(holds(catalogue[42], 1, 1, 0));
    CHECK_FALSE(holds(catalogue[42], 1 + 1e-15, 1, 0));
    CHECK(holds(catalogue[0], 2.0399, 2, 0.01));
    CHECK_FALSE(holds(catalogue[0], 2.0401, 2, 0.01));
    CHECK(holds(catalogue[57], 1 + 7 * 2.2e-16, 1, 0));
    CHECK_FALSE(holds(catalogue[57], 1 + 9 * 2.3e-16, 1, 0));
    CHECK_FALSE(holds(catalogue[35], 1.2, 1, 0.1));
    CHECK_FALSE(holds(catalogue[1], std::nan(""), 1, 0));
}
