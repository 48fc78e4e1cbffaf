// Every integrator against pictures that an independent renderer made.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/report/running_mean.hpp>

#include "common/image_io.hpp"
#include "common/scene.hpp"
#include "common/scenes/registry.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

using rgb = glm::vec3;
constexpr std::size_t size = 256;

host::scene<float> built_in(const std::string& name) { return host::scene<float>{*host::scenes::find<float>(name)}; }

host::picture reference(const std::string& name) {
    return host::read_exr(std::filesystem::path{AGLOW_REFERENCES} / (name + ".exr"));
}

auto eye_of(const host::scene<float>& scene, std::size_t pixels = size) {
    return [&scene, pixels](const vec2<float>& film) { return scene.view().through(film, pixels, pixels); };
}

template <typename Integrator>
film<rgb> shoot(const host::scene<float>& scene, const Integrator& integrator, std::uint32_t samples,
                std::uint64_t seed = 1) {
    film<rgb> result{size, size};
    result.expose(eye_of(scene), integrator, {.samples = samples, .seed = seed}, own_threads{});
    return result;
}

film<rgb> progressed(const host::scene<float>& scene, int count) {
    film<rgb> result{size, size};
    progressive_photon_mapping passes{scene, scene.lights(), {.caustic = 50'000, .indirect = 50'000}};
    for (int i = 0; i < count; ++i) { passes.pass(result, eye_of(scene), own_threads{}); }
    return result;
}

host::picture picture_of(const film<rgb>& exposed) {
    host::picture result{exposed.width(), exposed.height()};
    for (std::size_t y = 0; y < exposed.height(); ++y) {
        for (std::size_t x = 0; x < exposed.width(); ++x) { result.at(x, y) = exposed.radiance(x, y); }
    }
    return result;
}

double energy_ratio(const host::picture& a, const host::picture& b) {
    double ours = 0;
    double theirs = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        ours += static_cast<double>(a.pixels[i].x + a.pixels[i].y + a.pixels[i].z);
        theirs += static_cast<double>(b.pixels[i].x + b.pixels[i].y + b.pixels[i].z);
    }
    return ours / theirs;
}

/// Mean over the picture of each pixel's largest band: what `error_of_mean` speaks of.
double level_of(const host::picture& image) {
    double sum = 0;
    for (const rgb& p : image.pixels) { sum += static_cast<double>(max_component(p)); }
    return sum / static_cast<double>(image.pixels.size());
}

/// Whether a picture that had `scale` times its light would be as near to `truth` as the integrator says: nineteen in
/// twenty pixels within three times their errors, and the mean of all within the error of the mean.
bool holds(const film<rgb>& exposed, const host::picture& truth, float scale = 1) {
    std::size_t within = 0;
    for (std::size_t y = 0; y < truth.height; ++y) {
        for (std::size_t x = 0; x < truth.width; ++x) {
            const rgb off = glm::abs(exposed.radiance(x, y) * scale - truth.at(x, y));
            within += max_component(off) <= 3 * exposed.error(x, y) ? 1 : 0;
        }
    }
    const double off = level_of(picture_of(exposed)) * static_cast<double>(scale) - level_of(truth);
    return within >= truth.pixels.size() * 19 / 20 && std::abs(off) <= exposed.error_of_mean().within(2);
}

/// The statement holds, and would not if there were 3 % more or less light.
void check_statement(const film<rgb>& exposed, const host::picture& truth) {
    CAPTURE(level_of(picture_of(exposed)) / level_of(truth) - 1, exposed.error_of_mean().bias / level_of(truth),
            exposed.error_of_mean().noise / level_of(truth));
    CHECK(holds(exposed, truth));
    CHECK_FALSE(holds(exposed, truth, 1.03f));
    CHECK_FALSE(holds(exposed, truth, 0.97f));
}

/// Means of the picture's tiles of 8 x 8 pixels, all bands together.
std::vector<double> tiles_of(const host::picture& image) {
    constexpr std::size_t side = 8;
    std::vector<double> tiles((image.width / side) * (image.height / side));
    for (std::size_t y = 0; y < image.height; ++y) {
        for (std::size_t x = 0; x < image.width; ++x) {
            const rgb& p = image.at(x, y);
            tiles[y / side * (image.width / side) + x / side] += static_cast<double>(p.x + p.y + p.z) / (3 * 64);
        }
    }
    return tiles;
}

}  // namespace

TEST_CASE("references: path tracing differs from the diffuse box's picture by noise alone, in every tile") {
    const auto scene = built_in("cornell-diffuse");
    const std::vector<double> truth = tiles_of(reference("cornell-diffuse"));
    const path_tracer tracer{scene, scene.lights()};
    constexpr int renders = 16;
    std::vector<running_mean> tiles(truth.size());
    for (std::uint64_t seed = 0; seed < renders; ++seed) {
        const std::vector<double> seen = tiles_of(picture_of(shoot(scene, tracer, 2, seed)));
        for (std::size_t i = 0; i < seen.size(); ++i) { tiles[i].add(seen[i]); }
    }
    double squares = 0;
    double largest = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double t = (tiles[i].mean() - truth[i]) / (tiles[i].standard_error() + 1e-12);
        squares += t * t / static_cast<double>(truth.size());
        largest = std::max(largest, std::abs(t));
    }
    // Student's t of 15 degrees of freedom has variance 15/13 and, over 1024 tiles, a standard error of that of 0.058;
    // the reference's own noise adds a few per cent.
    CHECK(squares < 15.0 / 13 + 4 * 0.058 + 0.05);
    CHECK(squares > 15.0 / 13 - 4 * 0.058);
    // P(|t| > 6.5) = 1e-5.
    CHECK(largest < 6.5);
}

TEST_CASE("references: every integrator agrees with the diffuse box's picture within the error that it states") {
    const auto scene = built_in("cornell-diffuse");
    const host::picture truth = reference("cornell-diffuse");
    const auto check = [&](const char* method, const film<rgb>& exposed, double error, double energy) {
        const host::picture seen = picture_of(exposed);
        CAPTURE(method, host::relative_square_error(seen, truth), energy_ratio(seen, truth));
        CHECK(host::relative_square_error(seen, truth) < error);
        CHECK(std::abs(energy_ratio(seen, truth) - 1) < energy);
        check_statement(exposed, truth);
    };
    check("path", shoot(scene, path_tracer{scene, scene.lights()}, 16), 9e-3, 0.005);
    check("photon map", shoot(scene, photon_mapping{scene, scene.lights()}, 4), 4e-3, 0.015);
    check("final gather", shoot(scene, final_gathering{scene, scene.lights(), {.rays = 16}}, 4), 2e-3, 0.01);
    check("irradiance cache", shoot(scene, irradiance_caching{scene, scene.lights(), scene.bounds(), eye_of(scene)}, 4),
          1.2e-3, 0.005);
    check("gather cache", shoot(scene, gather_caching{scene, scene.lights(), scene.bounds(), eye_of(scene)}, 4), 1.2e-3,
          0.01);
    check("progressive", progressed(scene, 8), 4e-3, 0.015);
}

TEST_CASE("references: every integrator agrees with the glass box's picture within the error that it states") {
    const auto scene = built_in("cornell-glass");
    const host::picture truth = reference("cornell-glass");
    const auto check = [&](const char* method, const film<rgb>& exposed, double error, double energy) {
        const host::picture seen = picture_of(exposed);
        CAPTURE(method, host::relative_square_error(seen, truth), energy_ratio(seen, truth));
        CHECK(host::relative_square_error(seen, truth) < error);
        CHECK(std::abs(energy_ratio(seen, truth) - 1) < energy);
        check_statement(exposed, truth);
    };
    // Caustics by paths alone are rare and bright: the energy is right, the noise is not.
    check("path", shoot(scene, path_tracer{scene, scene.lights()}, 16), 0.3, 0.01);
    check("photon map", shoot(scene, photon_mapping{scene, scene.lights()}, 8), 5e-3, 0.015);
    check("final gather", shoot(scene, final_gathering{scene, scene.lights(), {.rays = 16}}, 4), 6e-3, 0.01);
    check("irradiance cache", shoot(scene, irradiance_caching{scene, scene.lights(), scene.bounds(), eye_of(scene)}, 8),
          8e-3, 0.015);
    check("gather cache", shoot(scene, gather_caching{scene, scene.lights(), scene.bounds(), eye_of(scene)}, 8), 5e-3,
          0.01);
    check("progressive", progressed(scene, 8), 4e-3, 0.015);
}

TEST_CASE("references: one thread and eight make the same picture, for every integrator") {
    constexpr std::size_t pixels = 32;
    const auto scene = built_in("cornell-glass");
    const auto eye = eye_of(scene, pixels);
    const auto picture = [&](const auto& integrator, const auto& run) {
        film<rgb> result{pixels, pixels};
        result.expose(eye, integrator, {.samples = 2}, run);
        return picture_of(result).pixels;
    };
    const photon_options photons{.direct = 500, .caustic = 3000, .indirect = 3000};
    const view_options view{.width = pixels, .height = pixels};
    const auto all = [&](const auto& run) {
        std::vector<std::vector<rgb>> pictures;
        pictures.push_back(picture(path_tracer{scene, scene.lights()}, run));
        pictures.push_back(picture(photon_mapping{scene, scene.lights(), {.photons = photons}, run}, run));
        pictures.push_back(picture(final_gathering{scene, scene.lights(), {.photons = photons, .rays = 8}, run}, run));
        caching_options caching;
        caching.fill.rays = 64;
        caching.view = view;
        pictures.push_back(picture(irradiance_caching{scene, scene.lights(), scene.bounds(), eye, caching, run}, run));
        gather_caching_options classical;
        classical.photons = photons;
        classical.caching = caching;
        pictures.push_back(picture(gather_caching{scene, scene.lights(), scene.bounds(), eye, classical, run}, run));
        film<rgb> progressive{pixels, pixels};
        progressive_photon_mapping passes{scene, scene.lights(), {.caustic = 1000, .indirect = 1000}};
        passes.pass(progressive, eye, run);
        passes.pass(progressive, eye, run);
        pictures.push_back(picture_of(progressive).pixels);
        return pictures;
    };
    const auto one = all(in_sequence{});
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        CAPTURE(threads);
        CHECK(all(own_threads{threads}) == one);
    }
}

TEST_CASE("references: a thin wall between two rooms lets no photon's light through") {
    constexpr std::size_t pixels = 48;
    const auto scene = built_in("two-rooms");
    const auto picture = [&](const auto& integrator, std::uint32_t samples) {
        film<rgb> result{pixels, pixels};
        result.expose(eye_of(scene, pixels), integrator, {.samples = samples}, own_threads{});
        return picture_of(result);
    };
    const host::picture truth = picture(path_tracer{scene, scene.lights()}, 256);
    gather_caching_options options;
    options.caching.view = {.width = pixels, .height = pixels};
    const host::picture seen = picture(
        gather_caching{scene, scene.lights(), scene.bounds(), eye_of(scene, pixels), options, own_threads{}}, 16);
    // What remains is lost near edges; photons of the bright room made it 15 % too bright.
    CHECK(energy_ratio(seen, truth) < 1.02);
    CHECK(energy_ratio(seen, truth) > 0.92);
}
