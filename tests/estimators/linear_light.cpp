#include <aglow/estimators/linear_light.hpp>

#include <cmath>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

constexpr hemisphere_shape shape{24, 96};

/// A hemisphere under the sky `radiance(direction)`, one look through the middle of each stratum.
template <typename Sky>
hemisphere_grid<float, float> under(Sky&& radiance) {
    hemisphere_grid<float, float> grid{shape};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            grid.set(j, k, radiance(hemisphere_direction<float>(shape, j, k, {0.5f, 0.5f})), 1);
        }
    }
    return grid;
}

linear_light<float> fit(const hemisphere_grid<float, float>& grid) {
    return {incident_direction(grid), vec3<float>{0, 0, 1}};
}

}  // namespace

TEST_CASE("linear_light: even skies and linear ones come back as they were, with nothing left out") {
    for (const vec3<float>& slope : {vec3<float>{0}, vec3<float>{0.5f, 0, 0}, vec3<float>{-0.3f, 0.2f, 0.6f}}) {
        const auto sky = [&](const vec3<float>& w) { return 2 + 2 * glm::dot(slope, w); };
        const auto grid = under(sky);
        const auto light = fit(grid);
        const float even = grid.irradiance() / pi<float>;
        for (const vec3<float>& w : {vec3<float>{0, 0, 1}, vec3<float>{0.6f, 0, 0.8f}, vec3<float>{0, -0.8f, 0.6f}}) {
            CHECK(light(w) * even == Approx(sky(w)).epsilon(0.01));
        }
        CHECK(linear_misfit(grid, incident_direction(grid)) < 0.01f);
    }
}

TEST_CASE("linear_light: of a half-lit sky it leaves out what algebra says, and of darkness nothing") {
    const auto grid = under([](const vec3<float>& w) { return w.x > 0 ? 2.0f : 0.0f; });
    // Mean square 2, of which 1 is even and 4 (4 / 3 pi)² the slope: E = pi, mean of |x| under the cosine 4 / 3 pi.
    // Beside each of the two edges lie two strata in 96 whose second difference of 2 counts as noise, (2)² / 6.
    const double slope = 4 / (3 * pi<double>);
    const double left_out = 1 - 4 * slope * slope - 4 * 4.0 / 6 / 96;
    CHECK(linear_misfit(grid, incident_direction(grid)) == Approx(std::sqrt(left_out)).epsilon(0.01));
    const auto dark = under([](const vec3<float>&) { return 0.0f; });
    CHECK(linear_misfit(dark, incident_direction(dark)) == 0);
}

TEST_CASE("linear_light: change from stratum to stratum counts as noise and not as a misfit") {
    random_sampler<float> random{3};
    const auto grid = under([&](const vec3<float>&) { return random.next_1d() < 0.5f ? 2.0f : 0.0f; });
    CHECK(linear_misfit(grid, incident_direction(grid)) < 0.4f);
    CHECK(relative_noise(grid) == Approx(1 / std::sqrt(24.0 * 96)).epsilon(0.2));
}

TEST_CASE("linear_light: eight bytes keep direction, length and misfit") {
    static_assert(sizeof(compact_light) == 8);
    const vec3<float> mean{0.3f, -0.2f, 0.5f};
    for (const float misfit : {0.0f, 0.1f, 1.0f, 30.0f}) {
        const compact_light kept{mean, misfit};
        CHECK(glm::length(kept.mean<float>() - mean) < 1e-4f);
        CHECK(kept.misfit<float>() == Approx(misfit).epsilon(1e-3).margin(1e-4));
    }
}
