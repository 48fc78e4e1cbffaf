#include "render/options.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include "render/usage_error.hpp"
#include "support/catch.hpp"

namespace {

host::render_options read(std::initializer_list<const char*> words) {
    std::vector<const char*> line{"render"};
    line.insert(line.end(), words);
    const auto options = host::read_options(static_cast<int>(line.size()), line.data());
    REQUIRE(options);
    return *options;
}

/// What is said of a wrong line; empty where nothing is.
std::string complaint(std::initializer_list<const char*> words) {
    try {
        static_cast<void>(read(words));
    } catch (const host::usage_error& e) { return e.what(); }
    return {};
}

}  // namespace

TEST_CASE("options: a whole line is understood") {
    const auto o = read({"cornell-glass",
                         "--method",
                         "photon-map",
                         "--output",
                         "x/y.exr",
                         "--spp",
                         "64",
                         "--threads",
                         "3",
                         "--seed",
                         "7",
                         "--size",
                         "640x480",
                         "--caustic-photons",
                         "1000",
                         "--indirect-photons",
                         "0",
                         "--estimate",
                         "80",
                         "--view",
                         "caustic",
                         "--layers"});
    CHECK(o.scene == "cornell-glass");
    CHECK(o.how == host::method::photon_map);
    CHECK(o.output == "x/y.exr");
    CHECK(o.samples == 64);
    CHECK(o.threads == 3);
    CHECK(o.seed == 7);
    CHECK((o.width == 640 && o.height == 480));
    CHECK(o.caustic_photons == 1000);
    CHECK(o.indirect_photons == 0);
    CHECK_FALSE(o.direct_photons);
    CHECK(o.photons_per_estimate == 80);
    CHECK(o.show == host::view::caustic);
    CHECK(o.layers);
}

TEST_CASE("options: a picture is named after its scene, a model's without its folder") {
    CHECK(read({"furnace"}).output == "furnace.exr");
    CHECK(read({"models/bunny.ply"}).output == "bunny.exr");
}

TEST_CASE("options: -o is short for --output") { CHECK(read({"furnace", "-o", "x.png"}).output == "x.png"); }

TEST_CASE("options: what changes nothing is said, and nothing else") {
    const auto said = [](std::initializer_list<const char*> words) {
        std::string all;
        for (const std::string& line : read(words).unused) { all += line.substr(0, line.find(' ')) + ' '; }
        return all;
    };
    CHECK(said({"furnace", "--spp", "4", "--gather-rays", "9", "--accuracy", "0.2", "--direct-photons", "5"}).empty());
    CHECK(said({"furnace", "--method", "path", "--estimate", "9", "--gather-rays", "9"}) ==
          "--estimate --gather-rays ");
    CHECK(said({"furnace", "--method", "photon-map", "--accuracy", "1", "--gather-rays", "9"}) ==
          "--gather-rays --accuracy ");
    CHECK(said({"furnace", "--method", "irradiance-cache", "--caustic-photons", "9", "--indirect-photons", "9"}) ==
          "--indirect-photons ");
    CHECK(said({"furnace", "--time", "1", "--spp", "4"}) == "--spp ");
    CHECK(said({"furnace", "--until", "5%", "--spp", "4"}) == "--spp ");
    CHECK(said({"furnace", "--error-samples", "20000"}) == "--error-samples ");
    CHECK(said({"furnace", "--error", "--error-samples", "20000"}).empty());
    CHECK(said({"furnace", "--view", "direct", "--layers"}) == "--layers ");
    CHECK(said({"furnace", "--reference", "--spp", "4", "--accuracy", "1"}) == "--accuracy ");
}

TEST_CASE("options: every wrong wish is one line that names it") {
    const std::vector<std::pair<std::string, std::string>> wrong{
        {complaint({"furnace", "--method", "magic"}), "magic"},
        {complaint({"furnace", "--view", "inside"}), "inside"},
        {complaint({"furnace", "--spp", "0"}), "--spp"},
        {complaint({"furnace", "--error", "--error-samples", "9"}), "--error-samples"},
        {complaint({"furnace", "--spp", "-4"}), "--spp"},
        {complaint({"furnace", "--spp", "many"}), "--spp"},
        {complaint({"furnace", "--time", "nan"}), "--time"},
        {complaint({"furnace", "--threads", "0"}), "--threads"},
        {complaint({"furnace", "--size", "640"}), "640"},
        {complaint({"furnace", "--size", "0x10"}), "0x10"},
        {complaint({"furnace", "--size", "12x10px"}), "12x10px"},
        {complaint({"furnace", "--size", "99999x2"}), "99999x2"},
        {complaint({"furnace", "--estimate", "1"}), "--estimate"},
        {complaint({"furnace", "--output", "x.jpg"}), "x.jpg"},
        {complaint({"furnace", "--caustic-photons", "-1"}), "-1"},
        {complaint({"furnace", "--brightness", "2"}), "--brightness"},
        {complaint({"furnace", "another"}), "another"},
        {complaint({"furnace", "--reference", "--method", "path"}), "--reference"},
        {complaint({"furnace", "--reference", "--layers"}), "--reference"},
        {complaint({"furnace", "--spp"}), "--spp"},
        {complaint({"furnace", "--spp", "1.5"}), "1.5 is not a whole number from 1 to 16777216"},
        {complaint({"furnace", "--spp", "1e3"}), "1e3"},
        {complaint({"furnace", "--seed", "18446744073709551616"}), "18446744073709551616"},
        {complaint({"furnace", "--view", "direct", "--until", "5%"}), "--view direct"},
        {complaint({"furnace", "--view", "direct", "--error"}), "--view direct"},
        {complaint({"furnace", "--layers", "-o", "x.png"}), "x.png"},
        {complaint({"furnace", "--reference", "-o", "x.png"}), "x.png"},
        {complaint({}), "--list"},
    };
    for (const auto& [said, name] : wrong) {
        INFO(name << ": " << said);
        CHECK(said.find(name) != std::string::npos);
        CHECK(said.find('\n') == std::string::npos);
    }
}
