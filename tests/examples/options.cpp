#include "render/options.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include "common/image_io.hpp"
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

TEST_CASE("options: -o is short for --output") { CHECK(read({"furnace", "-o", "x.exr"}).output == "x.exr"); }

TEST_CASE("options: a PNG is refused at once where none can be written") {
    CHECK(complaint({"furnace", "-o", "x.png"}).empty() == host::has_png());
}

TEST_CASE("options: of an option given twice the last counts") {
    const auto o = read({"furnace",    "--size",  "32x32",  "--spp",  "1",      "--method", "path",    "--until",
                         "1%",         "--view",  "direct", "--size", "8x4",    "--spp",    "4",       "--method",
                         "photon-map", "--until", "5%",     "--view", "beauty", "--layers", "--layers"});
    CHECK((o.width == 8 && o.height == 4));
    CHECK(o.samples == 4);
    CHECK(o.how == host::method::photon_map);
    CHECK(o.until == Approx(0.05));
    CHECK(o.show == host::view::beauty);
}

TEST_CASE("options: numbers are decimal, leading zeros or not") {
    const auto o = read({"furnace", "--spp", "010", "--seed", "00", "--threads", "08", "--size", "010x0020",
                         "--gather-rays", "0100", "--caustic-photons", "0777", "--error-samples", "020000"});
    CHECK(o.samples == 10);
    CHECK(o.seed == 0);
    CHECK(o.threads == 8);
    CHECK((o.width == 10 && o.height == 20));
    CHECK(o.gather_rays == 100);
    CHECK(o.caustic_photons == 777);
    CHECK(o.error_samples == 20000);
    CHECK(read({"furnace", "--seed", "18446744073709551615"}).seed == 18446744073709551615u);
}

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
        {complaint({"furnace", "--spp", "0x10"}), "0x10"},
        {complaint({"furnace", "--spp", "4", "8"}), "8"},
        {complaint({"furnace", "--spp", "x", "--spp", "4"}), "x is not a whole number"},
        {complaint({"furnace", "--spp", "4", "--spp", "x"}), "x is not a whole number"},
        {complaint({"furnace", "--spp", "4", "--spp"}), "--spp"},
        {complaint({"furnace", "--method", "path", "--method", "magic"}), "magic"},
        {complaint({"furnace", "--view", "beauty", "--view", "direct", "--error"}), "--view direct"},
        {complaint({"furnace", "--spp", ""}), "--spp"},
        {complaint({"furnace", "--time", ""}), "--time"},
        {complaint({"furnace", "--size", ""}), "--size"},
        {complaint({"furnace", "--until", ""}), "--until"},
        {complaint({"furnace", "--output", ""}), "--output"},
        {complaint({"furnace", "--method", ""}), "--method"},
        {complaint({"furnace", "--view", ""}), "--view"},
        {complaint({""}), "--list"},
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
