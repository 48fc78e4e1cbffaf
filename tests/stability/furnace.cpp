// Row 1 for every ready integrator: a closed room that glows evenly is 1 / (1 - rho) bright, and each knows how far off
// it is.
#include <cmath>
#include <string>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/progressive.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"

using namespace aglow;
using namespace aglow::testing;

namespace {

constexpr std::size_t size = 16;

/// All round, from a place that is nowhere special.
constexpr auto all_round = [](const vec2<float>& film) {
    return ray<float>{{0.1f, 0.2f, -0.3f}, uniform_sphere(film * (1.0f / size))};
};

struct furnace_sphere_room {
    furnace_sphere<float> scene;
    furnace_light<float> light;
    explicit furnace_sphere_room(float albedo) : scene{.albedo = albedo, .glow = 1}, light{.glow = 1} {}
};

struct furnace_box_room {
    furnace_box<float> scene;
    furnace_box_light<float> light;
    explicit furnace_box_room(float albedo) : scene{.albedo = albedo, .glow = 1}, light{.glow = 1} {}
};

double mean_of(const film<float>& picture) {
    double sum = 0;
    for (std::size_t i = 0; i < size * size; ++i) {
        sum += static_cast<double>(picture.radiance(i % size, i / size)) / (size * size);
    }
    return sum;
}

/// The share of pixels that are off by no more than three times what they say.
double covered(const film<float>& picture, double truth) {
    double count = 0;
    for (std::size_t i = 0; i < size * size; ++i) {
        const double off = std::abs(static_cast<double>(picture.radiance(i % size, i / size)) - truth);
        const double says = static_cast<double>(picture.error(i % size, i / size));
        count += off <= 3 * says + 1e-5 * truth ? 1 : 0;
    }
    return count / (size * size);
}

void check(const std::string& by, const film<float>& picture, double albedo) {
    const double truth = 1 / (1 - albedo);
    const mean_error error = picture.error_of_mean();
    CAPTURE(by, albedo, truth, mean_of(picture), error.bias, error.noise, covered(picture, truth));
    if (albedo == 0) {
        for (std::size_t i = 0; i < size * size; ++i) { CHECK(picture.radiance(i % size, i / size) == 1); }
        CHECK(error.within() == 0);
        return;
    }
    CHECK(std::abs(mean_of(picture) - truth) <= error.within(4) + 1e-5 * truth);
    // A statement that would hold for anything is none.
    CHECK(error.within(4) < 0.1 * truth);
    CHECK(covered(picture, truth) > 0.95);
}

film<float> exposed(const auto& integrator, std::uint32_t samples) {
    film<float> picture{size, size};
    picture.expose(all_round, integrator, {.samples = samples});
    return picture;
}

template <typename Room>
void check_all(float albedo) {
    const Room room{albedo};
    const auto& [scene, light] = room;
    const bounds<float> box{{-1, -1, -1}, {1, 1, 1}};
    const double rho = static_cast<double>(albedo);
    const view_options view{.width = size, .height = size};
    check("path tracing", exposed(path_tracer{scene, light}, 64), rho);
    check("photon mapping", exposed(photon_mapping{scene, light, {.photons = {.indirect = 400'000}}}, 16), rho);
    const photon_options photons{.direct = 5'000, .indirect = 400'000};
    check("final gathering", exposed(final_gathering{scene, light, {.photons = photons, .rays = 16}}, 8), rho);
    caching_options caching{.fill = {.rays = 256}, .view = view};
    check("irradiance caching", exposed(irradiance_caching{scene, light, box, all_round, caching}, 16), rho);
    gather_caching_options classical{.photons = photons, .caching = caching};
    check("gather caching", exposed(gather_caching{scene, light, box, all_round, classical}, 16), rho);
    progressive_photon_mapping passes{scene, light, {.indirect = 50'000}};
    film<float> progressive{size, size};
    for (int i = 0; i < 8; ++i) { passes.pass(progressive, all_round); }
    check("progressive photon mapping", progressive, rho);
}

}  // namespace

TEST_CASE("stability 1: by every integrator a closed sphere glows 1 / (1 - rho) within what it says of its error") {
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) { check_all<furnace_sphere_room>(albedo); }
}

TEST_CASE("stability 1: by every integrator a closed box glows 1 / (1 - rho) within what it says of its error") {
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) { check_all<furnace_box_room>(albedo); }
}
