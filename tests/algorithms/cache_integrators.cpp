#include <aglow/algorithms/cache_integrators.hpp>

#include <cmath>

#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"

using namespace aglow;
using testing::furnace_light;
using testing::furnace_sphere;

namespace {

/// Some directions from inside the sphere: what a picture of 8 x 8 pixels would look along.
ray<float> eye_of(const vec2<float>& film) {
    return {{0.1f, 0.2f, -0.3f}, glm::normalize(vec3<float>{film.x - 4, film.y - 4, 4})};
}

struct seen {
    running_mean level{};
    running_mean guess{};
    running_mean common{};
    running_mean bias{};
};

template <typename Integrator>
seen look(const Integrator& integrator) {
    seen result;
    for (std::uint64_t i = 0; i < 64; ++i) {
        const random_numbers<float> numbers{{.seed = 3, .path = i}};
        const auto e = integrator(eye_of({float(i % 8) + 0.5f, float(i / 8) + 0.5f}), numbers);
        result.level.add(static_cast<double>(e.value));
        result.guess.add(static_cast<double>(e.error));
        result.common.add(static_cast<double>(e.common));
        result.bias.add(static_cast<double>(e.bias));
    }
    return result;
}

}  // namespace

TEST_CASE("cache_integrators: a furnace is 1 / (1 - rho) bright, its gather rays carried on by paths or by photons") {
    const furnace_light<float> light{.radius = 2, .glow = 1};
    const bounds<float> box{{-2, -2, -2}, {2, 2, 2}};
    caching_options caching;
    caching.fill.rays = 1024;
    caching.view = {.width = 8, .height = 8};
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) {
        const furnace_sphere<float> scene{.radius = 2, .albedo = albedo, .glow = 1};
        const double truth = 1 / (1 - static_cast<double>(albedo));
        const seen by_paths = look(irradiance_caching{scene, light, box, eye_of, caching});
        gather_caching_options classical;
        classical.photons = {.direct = 2000, .indirect = 200'000};
        classical.caching = caching;
        const gather_caching by_map{scene, light, box, eye_of, classical};
        const seen by_photons = look(by_map);
        CAPTURE(albedo, truth, by_paths.level.mean(), by_paths.guess.mean(), by_photons.level.mean(),
                by_photons.guess.mean());
        for (const seen& s : {by_paths, by_photons}) {
            const double common = s.common.mean();
            const double chance = 4 * (s.level.standard_error() + common) + 1e-5 * truth;
            CHECK(std::abs(s.level.mean() - truth) <= std::abs(s.bias.mean()) + chance);
            CHECK(s.guess.mean() >= 2 * common);
            CHECK(s.guess.mean() < 0.15 * truth);
        }
        // What all photons have in common: a path lands k times after its first landing with probability
        // (1 - rho) rho^k, so the sum's relative deviation is 1 / sqrt(rho paths). A gather reads a share rho of it.
        const auto& indirect = by_map.maps().indirect;
        if (albedo > 0) {
            const double share = 1 / std::sqrt(static_cast<double>(albedo) * static_cast<double>(indirect.paths));
            CHECK(indirect.common == Approx(share).epsilon(0.1));
            CHECK(by_photons.common.mean() > 0.9 * share * square(static_cast<double>(albedo)) * (truth - 1));
        }
    }
}

TEST_CASE("cache_integrators: a path-traced cache has caustic maps where something can mirror, and only there") {
    using glass = support::toy_scene<float, float>;
    using matte = furnace_sphere<float>;
    STATIC_REQUIRE(irradiance_caching<glass, furnace_light<float>>::has_maps);
    STATIC_REQUIRE(!irradiance_caching<glass, furnace_light<float>, record_features{.incident = true}>::has_maps);
    STATIC_REQUIRE(!irradiance_caching<matte, furnace_light<float>>::has_maps);
}
