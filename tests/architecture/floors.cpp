// The folders are floors, and what a header includes lies below it.
#include <map>
#include <string>
#include <vector>

#include "architecture/files.hpp"
#include "support/catch.hpp"

namespace {

using architecture::includes_of;
using list = std::vector<std::string>;

/// What the headers of a folder may include, beside their own folder.
const std::map<std::string, list> may_include{
    {"core", {}},
    {"concepts", {"core"}},
    {"containers", {"core"}},
    {"estimators", {"core", "concepts/spectrum.hpp", "containers"}},
    {"algorithms", {"core", "concepts", "containers", "estimators"}},
    {"report", {"core"}},
};

/// "photon_map.hpp" of "<aglow/estimators/photon_map.hpp>" is on the floor "estimators".
std::string floor_of(const std::string& path) { return path.substr(0, path.find('/')); }

bool allowed(const std::string& from, const std::string& to) {
    const list& below = may_include.at(floor_of(from));
    return floor_of(from) == floor_of(to) || architecture::contains(below, floor_of(to)) ||
           architecture::contains(below, to);
}

/// The path below `aglow/` of what an include line names; empty if it names another library.
std::string ours(const std::string& include) {
    const auto found = architecture::all_matches(include, "^<aglow/(.*)>$");
    return found.empty() ? "" : found.front();
}

/// Every header below include/aglow, by its path from there, but for the table of contents.
list headers() {
    list found;
    for (const std::string& file : architecture::files_below("include", ".hpp")) {
        const std::string path = file.substr(std::string{"include/aglow/"}.size());
        if (path != "aglow.hpp") { found.push_back(path); }
    }
    return found;
}

}  // namespace

TEST_CASE("floors: the arrows point down only") {
    REQUIRE(!headers().empty());
    for (const std::string& header : headers()) {
        INFO("include/aglow/" << header);
        REQUIRE(may_include.contains(floor_of(header)));
        for (const std::string& include : includes_of("include/aglow/" + header)) {
            INFO("includes " << include);
            CHECK((ours(include).empty() || allowed(header, ours(include))));
        }
    }
}

TEST_CASE("floors: the table refuses what points up or sideways") {
    CHECK_FALSE(allowed("core/bounds.hpp", "concepts/hit.hpp"));
    CHECK_FALSE(allowed("containers/kd_tree.hpp", "estimators/photon.hpp"));
    CHECK_FALSE(allowed("estimators/photon_map.hpp", "concepts/intersector.hpp"));
    CHECK_FALSE(allowed("report/image_error.hpp", "estimators/photon_map.hpp"));
    CHECK(allowed("estimators/photon_map.hpp", "concepts/spectrum.hpp"));
    CHECK(allowed("algorithms/final_gather.hpp", "algorithms/gather.hpp"));
}

TEST_CASE("floors: below the lowest there is GLM and std alone") {
    const list glm{"<glm/common.hpp>", "<glm/geometric.hpp>", "<glm/vec2.hpp>", "<glm/vec3.hpp>"};
    for (const std::string& header : headers()) {
        INFO("include/aglow/" << header);
        for (const std::string& include : includes_of("include/aglow/" + header)) {
            INFO("includes " << include);
            const bool of_std = !architecture::all_matches(include, "^<([a-z_0-9]+)>$").empty();
            const bool of_machine = !architecture::all_matches(include, "^<([a-z]+intrin\\.h|arm_neon\\.h)>$").empty();
            CHECK((of_std || !ours(include).empty() || architecture::contains(glm, include) ||
                   (of_machine && header.starts_with("core/simd"))));
        }
    }
}

TEST_CASE("floors: no header prints, logs, or reads files") {
    const list refused{"<iostream>", "<cstdio>", "<fstream>", "<filesystem>", "<print>", "<syncstream>"};
    for (const std::string& header : headers()) {
        INFO("include/aglow/" << header);
        for (const std::string& include : includes_of("include/aglow/" + header)) {
            INFO("includes " << include);
            CHECK_FALSE(architecture::contains(refused, include));
        }
    }
}
