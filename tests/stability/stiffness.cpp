// Rows 2, 3 and 13, and the meter that says how stiff a scene is.
#include <aglow/algorithms/stiffness.hpp>

#include <cmath>
#include <limits>

#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>

#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"

using namespace aglow;
using namespace stability;
using shape = quadric<double>;
using room = quadric_scene<double>;

namespace {

const support::bulb<double, double> bulb{.position = {0.1, 0.2, -0.5}, .intensity = 1};

room matte_ball(double rho) { return {{shape::sphere({}, 1, {.diffuse = rho})}, lobe_set::diffuse_reflection}; }

}  // namespace

TEST_CASE("stability 2: a room that takes nothing away ends, is finite, and is called not dissipative") {
    const auto told = measure_stiffness(matte_ball(1), bulb, {}, {.paths = 256});
    CHECK_FALSE(told.dissipative());
    REQUIRE_FALSE(told.warnings.empty());
    CHECK(told.warnings[0].find("not dissipative") != std::string::npos);
    CHECK(told.bounces == std::numeric_limits<double>::infinity());
    // By a cap, since without one a path has a million bounces before chance ends it.
    const double seen =
        path_trace(matte_ball(1), bulb, ray<double>{{}, {0, 0, 1}}, random_numbers<double>{{}}, {.most_bounces = 1000});
    CHECK(is_radiance(seen));
    const auto maps = trace_photons(matte_ball(1), bulb, {.indirect = 100'000, .pilot_paths = 50});
    CHECK(maps.ledger.capped == maps.ledger.emitted);
    CHECK(maps.size() > 0);
}

TEST_CASE("stability 3: an albedo above one is told, and one that is negative or NaN is dropped") {
    CHECK(measure_stiffness(matte_ball(1.1), bulb, {}, {.paths = 256}).dominant == Approx(1.1).epsilon(1e-9));
    CHECK_FALSE(measure_stiffness(matte_ball(1.1), bulb, {}, {.paths = 256}).dissipative());
    for (const double rho : {-0.5, std::numeric_limits<double>::quiet_NaN()}) {
        const testing::furnace_sphere<double, double> scene{.radius = 2, .albedo = rho, .glow = 1};
        const testing::furnace_light<double, double> light{.radius = 2, .glow = 1};
        host_faults faults;
        const double seen =
            path_trace(scene, light, ray<double>{{}, {0, 0, 1}}, random_numbers<double>{{}}, {.faults = &faults});
        CHECK(seen == 1);
        // A negative albedo has no lobe; a NaN is a broken look at the light and a broken weight.
        CHECK((rho < 0 || faults.count() > 0));
        energy_ledger<double> ledger;
        for (std::uint64_t i = 0; i < 100; ++i) {
            walk_photon(scene, light, random_numbers<double>{{.path = i}}, 0, ledger,
                        [](const auto&, const vec3<double>&, double, photon_history) { return true; });
        }
        CHECK(ledger.dropped + ledger.absorbed == 100);
    }
}

TEST_CASE("stiffness: a matte ball keeps rho a bounce and forgets at once where the light came from") {
    for (const double rho : {0.3, 0.9, 0.99}) {
        const auto told = measure_stiffness(matte_ball(rho), bulb, {}, {.paths = 4096, .most_bounces = 32});
        CAPTURE(rho, told.dominant, told.second);
        CHECK(told.dominant == Approx(rho).epsilon(1e-9));
        CHECK(told.second < 0.1 * rho);
        CHECK(told.dissipative());
        CHECK(told.bounces == Approx(std::log(0.01) / std::log(rho) - 1).epsilon(1e-6));
        CHECK(told.warnings.empty());
    }
}

TEST_CASE("stiffness: kissing spheres mix by rho (1 - 2 f), and at a millionth it says that nothing was seen to mix") {
    const auto eye = [](std::size_t i) {
        const random_numbers<double> numbers{{9, 9, i}};
        auto random = numbers.at(0, purpose::camera);
        return ray<double>{{0, 0, 0.9}, uniform_sphere(random.next_2d())};
    };
    const support::bulb<double, double> below{.position = {0, 0, -0.9}, .intensity = 1};
    for (const double port : {0.1, 0.01, 1e-6}) {
        const auto told = measure_stiffness(kissing(0.9, port), below, {}, {.paths = 2048}, eye);
        CAPTURE(port, told.dominant, told.second, told.resolution);
        CHECK(told.dominant == Approx(0.9).epsilon(1e-6));
        CHECK(told.second == Approx(kissing_spheres_second(0.9, port)).epsilon(0.02));
        const bool warned = !told.warnings.empty();
        CHECK(warned == (port < 1e-3));
    }
}

TEST_CASE("stiffness: a cap warns by the light that it loses, and path tracing loses just that") {
    const path_options capped{.most_bounces = 8};
    const auto told = measure_stiffness(matte_ball(0.9), bulb, capped, {.paths = 512});
    CHECK(told.lost_at_cap == Approx(std::pow(0.9, 9)).epsilon(1e-6));
    REQUIRE(told.warnings.size() == 1);
    CHECK(told.warnings[0].find("cap of 8") != std::string::npos);
    // The furnace: a cap of n keeps n + 1 terms of the sum of powers.
    const testing::furnace_sphere<double, double> scene{.radius = 1, .albedo = 0.9, .glow = 1};
    const testing::furnace_light<double, double> light{.radius = 1, .glow = 1};
    const auto mean = looks_along(path_tracer{scene, light, capped}, ray<double>{{}, {0, 0, 1}}, 20000);
    CHECK(mean.agrees(10 * (1 - told.lost_at_cap)));
    CHECK_THROWS_AS(measure_stiffness(matte_ball(0.5), bulb, {}, {.paths = 0}), std::invalid_argument);
}

TEST_CASE("stiffness: where a photon map saw nothing of a room behind a pinhole, its error covers what is there") {
    // The light is in the first sphere; the second gets nine millionths of its radiance.
    const room scene = kissing(0.9, 1e-6);
    const support::bulb<double, double> below{.position = {0, 0, -0.9}, .intensity = 1};
    const auto maps = trace_photons(scene, below, {.indirect = 20000, .pilot_paths = 1000});
    const double first = sphere_indirect(4 * stability::pi, 0.9, 1) / 0.9;
    const double truth = first * kissing_spheres(0.9, 1e-6).second / kissing_spheres(0.9, 1e-6).first;
    for (const vec3<double> n : {vec3<double>{0, 0, 1}, vec3<double>{1, 0, 0}, vec3<double>{0, 1, 0}}) {
        const vec3<double> at = vec3<double>{0, 0, 1 - 2e-6} + n;
        const auto e = maps.indirect.irradiance(at, -n);
        CAPTURE(e.value, e.error, truth, e.radius);
        CHECK(std::abs(e.value - truth) <= e.error);
    }
}

TEST_CASE("stability 13: where light mixes through a millionth, a gather and a photon map tell an error that covers") {
    const double port = 1e-6;
    const blind<double> nobody;
    SECTION("a record gathered in the second sphere, the first one glowing") {
        struct {
            double rho;
            hemisphere_shape rays;
        } const cases[] = {{0.9, {500, 1000}}, {0.999999, {3, 4}}};
        for (const auto& [rho, rays] : cases) {
            const room scene = kissing(rho, port);
            const auto incoming = [&](const ray<double>& r, const random_numbers<double>& n) {
                return walk_path(scene, nobody, r, n);
            };
            const gather_point<double> at{.position = {0, 0, 2 - 4e-6}, .normal = {0, 0, -1}};
            hemisphere_grid<double, double> grid{rays};
            (void)gather_hemisphere(incoming, at, random_numbers<double>{{.seed = 5}}, rays, grid);
            const double exact = stability::pi * kissing_spheres(rho, port).second;
            const double error = 2 * relative_noise(grid) * grid.irradiance();
            CAPTURE(rho, grid.irradiance(), error, exact);
            CHECK(grid.irradiance() > 0);
            CHECK(std::abs(grid.irradiance() - exact) <= error);
        }
    }
    SECTION("a photon map of the few paths that there is time for, each of them a million photons long") {
        const double rho = 0.999999;
        const support::bulb<double, double> below{.position = {0, 0, -0.9}, .intensity = 1};
        const room scene = kissing(rho, port);
        const double first = sphere_indirect(4 * stability::pi, rho, 1) / (1 - port);
        // What is emitted goes half to either sphere, but for what the first keeps longer: B of the closed form, with
        // the bulb's first strike as the walls' emission.
        const double strike = 1;  // E of 1 W/sr at 1 m
        const double in_first = kissing_spheres(rho, port).first * rho * strike;
        const double in_second = kissing_spheres(rho, port).second * rho * strike;
        CHECK(in_first + in_second == Approx(first).epsilon(1e-5));
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const auto maps = trace_photons(
                scene, below, {.indirect = 100, .pilot_paths = 1, .paths = {.indirect = 2}, .seed = seed});
            for (const vec3<double> n : {vec3<double>{0, 0, 1}, vec3<double>{1, 0, 0}, vec3<double>{0, -1, 0}}) {
                const auto here = maps.indirect.irradiance(vec3<double>{0, 0, -1 + 2e-6} - n, n);
                const auto there = maps.indirect.irradiance(vec3<double>{0, 0, 1 - 2e-6} + n, -n);
                // As every integrator takes it in: what the whole map may be off by, besides each look's own error.
                const shared_error shared{.common = maps.indirect.common};
                const double here_off = shared.on(here.value, here.error).error;
                const double there_off = shared.on(there.value, there.error).error;
                CAPTURE(seed, maps.indirect.size(), here.value, here_off, in_first, there.value, there_off, in_second);
                CHECK(std::abs(here.value - in_first) <= here_off);
                CHECK(std::abs(there.value - in_second) <= there_off);
            }
        }
    }
}
