#include "common/image_io.hpp"

#include <stdlib.h>  // mkdtemp

#include <cmath>
#include <fstream>
#include <limits>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

namespace {

namespace fs = std::filesystem;

/// A folder of this test's own, gone afterwards.
struct scratch {
    std::string name = (fs::temp_directory_path() / "aglow_image_io_XXXXXX").string();
    fs::path folder{::mkdtemp(name.data())};
    ~scratch() { fs::remove_all(folder); }
};

host::picture gradient(float scale) {
    host::picture p{7, 5};
    for (std::size_t i = 0; i < p.pixels.size(); ++i) {
        const float x = static_cast<float>(i) * scale;
        p.pixels[i] = {x, -x / 3, x * 1e20f};
    }
    p.at(2, 1) = {std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::infinity(), 0.1f};
    return p;
}

/// What `act` complains of; empty where it does not.
template <typename Act>
std::string complaint(Act&& act) {
    try {
        act();
    } catch (const std::runtime_error& e) { return e.what(); }
    return {};
}

bool names(const std::string& text, const fs::path& file) { return text.find(file.string()) != std::string::npos; }

}  // namespace

TEST_CASE("image_io: EXR gives back every layer bit for bit") {
    const scratch dir;
    const auto file = dir.folder / "layers.exr";
    host::write_exr(file, {{"", gradient(1)}, {"direct", gradient(0.1f)}, {"caustic", gradient(-2)}});
    CHECK(host::read_exr(file).pixels == gradient(1).pixels);
    CHECK(host::read_exr(file, "direct").pixels == gradient(0.1f).pixels);
    CHECK(host::read_exr(file, "caustic").pixels == gradient(-2).pixels);
    CHECK(host::read_exr(file).width == 7);
    CHECK_THROWS_AS(host::read_exr(file, "glow"), std::runtime_error);
}

TEST_CASE("image_io: halves keep eleven bits in half the space") {
    const scratch dir;
    host::picture noise{64, 64};
    for (std::size_t i = 0; i < noise.pixels.size(); ++i) {
        const auto u = [i](std::uint64_t band) { return aglow::unit_interval<float>(aglow::mix(3 * i + band)); };
        noise.pixels[i] = {u(0), 100 * u(1), 1e-3f + u(2)};
    }
    host::write_exr(dir.folder / "single.exr", {{"", noise}, {"b", noise}});
    host::write_exr(dir.folder / "half.exr", {{"", noise}, {"b", noise}}, host::precision::half);
    for (const char* name : {"", "b"}) {
        const host::picture back = host::read_exr(dir.folder / "half.exr", name);
        for (std::size_t i = 0; i < noise.pixels.size(); ++i) {
            for (int band = 0; band < 3; ++band) {
                // Half a unit of the eleventh bit; below 2^-14 halves are evenly spaced.
                const float off = std::abs(back.pixels[i][band] - noise.pixels[i][band]);
                CHECK(off <= std::max(noise.pixels[i][band], 0x1p-14f) * 0x1p-11f);
            }
        }
    }
    CHECK(5 * fs::file_size(dir.folder / "half.exr") < 3 * fs::file_size(dir.folder / "single.exr"));
}

TEST_CASE("image_io: what cannot be written leaves the older file whole and no part behind") {
    const scratch dir;
    const auto file = dir.folder / "good.exr";
    host::write_exr(file, {{"", gradient(1)}});
    // Two layers of different sizes are refused.
    CHECK_THROWS_AS(host::write_exr(file, {{"", gradient(3)}, {"x", host::picture{3, 3}}}), std::runtime_error);
    // A folder stands where the part would be written.
    fs::create_directories(dir.folder / "good.exr.part" / "in the way");
    CHECK_THROWS_AS(host::write_exr(file, {{"", gradient(3)}}), std::runtime_error);
    CHECK(host::read_exr(file).pixels == gradient(1).pixels);
    const auto there = dir.folder / "missing" / "x.exr";
    CHECK(names(complaint([&] { host::write_exr(there, {{"", gradient(1)}}); }), there));
}

TEST_CASE("image_io: a full disk cuts off no picture that was whole") {
    const scratch dir;
    const fs::path full = "/dev/full";  // takes nothing
    if (!fs::exists(full)) { return; }
    const auto exr = dir.folder / "good.exr";
    host::write_exr(exr, {{"", gradient(1)}});
    fs::create_symlink(full, exr.string() + ".part");
    CHECK(names(complaint([&] { host::write_exr(exr, {{"", gradient(2)}}); }), exr));
    CHECK(host::read_exr(exr).pixels == gradient(1).pixels);
    if (!host::has_png()) { return; }
    const auto png = dir.folder / "good.png";
    host::write_png(png, gradient(0.1f));
    const auto before = host::read_png(png).pixels;
    fs::create_symlink(full, png.string() + ".part");
    CHECK(names(complaint([&] { host::write_png(png, gradient(0.3f)); }), png));
    CHECK(host::read_png(png).pixels == before);
}

TEST_CASE("image_io: PNG comes back as light, to its eight bits") {
    if (!host::has_png()) { return; }
    const scratch dir;
    host::picture ramp{256, 1};
    for (std::size_t i = 0; i < 256; ++i) { ramp.at(i, 0) = glm::vec3{float(i) / 255, 1 - float(i) / 255, 0.5f}; }
    host::write_png(dir.folder / "ramp.png", ramp);
    const host::picture back = host::read_png(dir.folder / "ramp.png");
    REQUIRE(back.width == 256);
    for (std::size_t i = 0; i < 256; ++i) {
        // Half a step of sRGB; it is steepest at white: 2.4 / 1.055 / 255 / 2.
        for (int band = 0; band < 3; ++band) { CHECK(std::abs(back.at(i, 0)[band] - ramp.at(i, 0)[band]) < 0.0046f); }
    }
    std::ofstream{dir.folder / "text.png"} << "not a picture";
    CHECK(
        names(complaint([&] { static_cast<void>(host::read_png(dir.folder / "text.png")); }), dir.folder / "text.png"));
}

TEST_CASE("image_io: a file that is no picture is refused by name") {
    const scratch dir;
    const auto file = dir.folder / "text.exr";
    std::ofstream{file} << "not a picture";
    CHECK(names(complaint([&] { static_cast<void>(host::read_exr(file)); }), file));
    CHECK_THROWS_AS(host::read_exr(dir.folder / "nothing.exr"), std::runtime_error);
}

TEST_CASE("image_io: the references have the means that their description says") {
    const auto mean = [](const host::picture& p) {
        aglow::vec3<double> sum{0};
        for (const auto& pixel : p.pixels) { sum += aglow::vec3<double>(pixel); }
        return sum / static_cast<double>(p.pixels.size());
    };
    const fs::path folder = AGLOW_REFERENCES;
    const auto diffuse = mean(host::read_exr(folder / "cornell-diffuse.exr"));
    CHECK(diffuse.x == Approx(0.196578).epsilon(1e-5));
    CHECK(diffuse.z == Approx(0.036435).epsilon(1e-4));
    const auto glass = mean(host::read_exr(folder / "cornell-glass.exr"));
    CHECK(glass.y == Approx(0.141383).epsilon(1e-5));
}

TEST_CASE("image_io: PNG is written where the build has it, else refused with words") {
    const scratch dir;
    const auto file = dir.folder / "view.png";
    if (!host::has_png()) {
        CHECK_THROWS_AS(host::write_png(file, gradient(1)), std::runtime_error);
        return;
    }
    host::write_png(file, gradient(0.1f));
    std::ifstream in{file, std::ios::binary};
    std::string magic(8, '\0');
    in.read(magic.data(), 8);
    CHECK(magic == "\x89PNG\r\n\x1a\n");
}
