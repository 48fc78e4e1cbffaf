// Pictures that are wrong on purpose: an audit must not certify them, and must certify what is right.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/report/audit.hpp>

#include "common/image_io.hpp"
#include "common/scene.hpp"
#include "common/scenes/registry.hpp"
#include "support/catch.hpp"

namespace {

using rgb = glm::vec3;
constexpr std::size_t side = 64;
constexpr std::uint64_t audits = 5;

/// The diffuse box at 64 x 64, and its truth: the independent renderer's picture, 4 x 4 of its pixels in each.
struct known_box {
    host::scene<float> scene{*host::scenes::find<float>("cornell-diffuse")};
    std::vector<float> truth{};

    known_box() : truth(3 * side * side) {
        const host::picture whole = host::read_exr(std::filesystem::path{AGLOW_REFERENCES} / "cornell-diffuse.exr");
        for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
            const std::size_t pixel = i / 4 % side + i / (16 * side) * side;
            for (std::size_t c = 0; c < 3; ++c) { truth[3 * pixel + c] += whole.pixels[i][static_cast<int>(c)] / 16; }
        }
    }

    [[nodiscard]] auto eye() const {
        return [this](const aglow::vec2<float>& film) { return scene.view().through(film, side, side); };
    }

    template <typename Integrator>
    [[nodiscard]] std::vector<float> picture(const Integrator& integrator) const {
        aglow::film<rgb> film{side, side};
        film.expose(eye(), integrator, {.samples = 16, .seed = 7}, aglow::own_threads{});
        std::vector<float> values;
        for (std::size_t i = 0; i < side * side; ++i) {
            const rgb p = film.radiance(i % side, i / side);
            values.insert(values.end(), {p.x, p.y, p.z});
        }
        return values;
    }

    /// As `audit_options::target` has it.
    [[nodiscard]] double mean_error(const std::vector<float>& values) const {
        double light = 0;
        for (const float x : values) { light += static_cast<double>(x); }
        const double floor = aglow::audit_options{}.dark * light / static_cast<double>(values.size());
        double sum = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double right = static_cast<double>(truth[i]);
            sum += std::abs(static_cast<double>(values[i]) - right) / (right + floor);
        }
        return sum / static_cast<double>(values.size());
    }

    /// How many of a few audits, each of its own seed, certify.
    [[nodiscard]] std::uint64_t certified(const std::vector<float>& values, aglow::audit_options options) const {
        const auto through = eye();
        const aglow::path_tracer tracer{scene, scene.lights()};
        const aglow::pixel_probe probe{through, tracer, side};
        const aglow::image_view<float> image{values, side, side, 3};
        std::uint64_t count = 0;
        for (options.seed = 0; options.seed < audits; ++options.seed) {
            const auto stated = aglow::audit(image, probe, options, aglow::own_threads{});
            count += stated.status == aglow::audit_status::certified ? 1u : 0u;
        }
        return count;
    }
};

/// At a target just below the error of `wrong`, which `right` is well within.
void check_control(const known_box& box, const std::vector<float>& wrong, const std::vector<float>& right) {
    const double error = box.mean_error(wrong);
    CAPTURE(error, box.mean_error(right));
    REQUIRE(box.mean_error(right) < 0.7 * error);
    CHECK(box.certified(wrong, {.target = 0.97 * error}) == 0);
    CHECK(box.certified(right, {.target = 0.97 * error}) >= audits - 1);
}

}  // namespace

TEST_CASE("controls: a photon map with three times the radius is not certified, and with its own it is") {
    const known_box box;
    const auto with = [&](double radius) {
        const aglow::photon_mapping_options how{.photons = {.indirect = 400'000, .seed = 7},
                                                .density = {.count = 0, .max_radius = radius}};
        return box.picture(aglow::photon_mapping{box.scene, box.scene.lights(), how, aglow::own_threads{}});
    };
    constexpr double own =
        25;  // of the box's 550: within it lie some hundreds of photons, and noise is the lesser error
    check_control(box, with(3 * own), with(own));
}

TEST_CASE("controls: a final gather into photons of one bounce is not certified, and into all of them it is") {
    const known_box box;
    const auto with = [&](std::uint32_t bounces) {
        aglow::final_gathering_options how{.rays = 16};
        how.photons.indirect = 50'000;
        how.photons.seed = 7;
        how.photons.most_bounces = bounces;
        return box.picture(aglow::final_gathering{box.scene, box.scene.lights(), how, aglow::own_threads{}});
    };
    check_control(box, with(1), with(0));
}

TEST_CASE("controls: 3 % too much light is not certified where the energy is asked for, and the truth is") {
    const known_box box;
    std::vector<float> bright = box.truth;
    for (float& x : bright) { x *= 1.03f; }
    const aglow::audit_options asked{.target = 0.1, .bias_target = 0.025};
    CHECK(box.certified(bright, asked) == 0);
    CHECK(box.certified(box.truth, asked) >= audits - 1);
}

TEST_CASE("caustic light: below the glass sphere of the box, and nowhere in the box without") {
    const auto light_of = [](const char* name) {
        const host::scene<float> scene{*host::scenes::find<float>(name)};
        const auto eye = [&](const aglow::vec2<float>& film) { return scene.view().through(film, side, side); };
        return aglow::caustic_light(scene, scene.lights(), eye, side, side, {}, aglow::own_threads{});
    };
    CHECK(light_of("cornell-diffuse").empty());
    const std::vector<float> light = light_of("cornell-glass");
    REQUIRE(light.size() == side * side);
    const host::picture whole = host::read_exr(std::filesystem::path{AGLOW_REFERENCES} / "cornell-glass.exr");
    std::size_t lit = 0;
    float caustic = 0, whole_light = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
        rgb all{};
        for (std::size_t k = 0; k < 16; ++k) {
            all += whole.pixels[(i / side * 4 + k / 4) * 4 * side + i % side * 4 + k % 4] / 16.0f;
        }
        const float most = std::max({all.x, all.y, all.z});
        caustic += light[i];
        whole_light += most;
        lit += light[i] > 0.1f * most ? 1u : 0u;
    }
    CHECK(caustic < 0.25f * whole_light);
    CHECK(lit > light.size() / 100);
    CHECK(lit < light.size() / 4);
}

TEST_CASE("a large picture's caustics are those of a small one, block by block") {
    const host::scene<float> scene{*host::scenes::find<float>("cornell-glass")};
    const auto caustics = [&](std::size_t width, std::size_t height, std::size_t blocks) {
        const auto eye = [&, width, height](const aglow::vec2<float>& film) {
            REQUIRE((film.x <= static_cast<float>(width) && film.y <= static_cast<float>(height)));
            return scene.view().through(film, width, height);
        };
        return aglow::caustic_light(scene, scene.lights(), eye, width, height, {.blocks = blocks});
    };
    const std::vector<float> small = caustics(side / 4, side / 4, 0);
    const std::vector<float> large = caustics(side, side, side * side / 16);
    REQUIRE(large.size() == side * side);
    for (std::size_t i = 0; i < large.size(); ++i) {
        REQUIRE(large[i] == small[i / side / 4 * (side / 4) + i % side / 4]);
    }
    CHECK(*std::max_element(small.begin(), small.end()) > 0);
    // Blocks that do not divide the picture end at its edge.
    const std::vector<float> odd = caustics(50, 30, 100);
    REQUIRE(odd.size() == 50 * 30);
    for (std::size_t i = 0; i < odd.size(); ++i) { REQUIRE(odd[i] == odd[i / 50 / 4 * 4 * 50 + i % 50 / 4 * 4]); }
}
