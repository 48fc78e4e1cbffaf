#include <aglow/algorithms/photon_walk.hpp>

#include <limits>

#include <glm/vec3.hpp>

#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::bulb;
using support::toy_scene;

namespace {

using S = glm::vec3;

random_numbers<float> numbers_of(std::uint64_t path) { return random_numbers<float>{{.seed = 1, .path = path}}; }

/// All walks of `count` paths in one ledger.
template <typename World, typename Lights, typename Land>
auto walked(const World& scene, const Lights& light, std::uint64_t count, std::uint32_t most_bounces, Land&& land) {
    energy_ledger<spectrum_of<World>> ledger;
    for (std::uint64_t i = 0; i < count; ++i) { walk_photon(scene, light, numbers_of(i), most_bounces, ledger, land); }
    return ledger;
}

constexpr auto land_anywhere = [](const auto&...) { return true; };

template <typename L>
bool books_close(const L& l) {
    return l.emitted == l.escaped + l.absorbed + l.roulette + l.unneeded + l.capped + l.dropped;
}

toy_scene<S, float> sphere(float albedo) { return {.balls = {{.radius = 2, .made_of = {.diffuse = S{albedo}}}}}; }

const bulb<S, float> lamp{.position = {0.3f, 0.2f, 0.1f}, .intensity = {1, 2, 3}};

/// Matte walls, a mirror and a glass ball, and no ceiling.
toy_scene<S, float> open_room() {
    auto scene = support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, S{1}).scene;
    scene.rectangles.resize(5);
    return scene;
}

}  // namespace

TEST_CASE("photon_walk: a history is caustic until the first smooth bounce, reflected until the next, then indirect") {
    using enum photon_history;
    CHECK(after(direct, lobe_set::specular_reflection) == caustic);
    CHECK(after(caustic, lobe_set::specular_transmission) == caustic);
    CHECK(after(direct, lobe_set::diffuse_transmission) == indirect);
    CHECK(after(caustic, lobe_set::glossy_reflection) == reflected);
    CHECK(after(reflected, lobe_set::specular_reflection) == reflected);
    CHECK(after(reflected, lobe_set::diffuse_reflection) == indirect);
    CHECK(after(indirect, lobe_set::specular_reflection) == indirect);
}

TEST_CASE("photon_walk: a hit that is nowhere, behind or with a crooked normal is not sound") {
    struct plain_hit {
        vec3<float> position;
        vec3<float> normal;
    };
    const ray<float> r{{1, 1, 1}, {0, 0, 1}};
    const float broken = std::numeric_limits<float>::quiet_NaN();
    CHECK(is_sound(plain_hit{{1, 1, 3}, {0, 0, -1}}, r));
    CHECK(is_sound(plain_hit{{1, 1, 1}, {0, 0, -1}}, r));
    CHECK_FALSE(is_sound(plain_hit{{1, 1, 0.9f}, {0, 0, -1}}, r));
    CHECK_FALSE(is_sound(plain_hit{{broken, 1, 3}, {0, 0, -1}}, r));
    CHECK_FALSE(is_sound(plain_hit{{1, 1, std::numeric_limits<float>::infinity()}, {0, 0, -1}}, r));
    CHECK_FALSE(is_sound(plain_hit{{1, 1, 3}, {0, 0, -1.1f}}, r));
    CHECK_FALSE(is_sound(plain_hit{{1, 1, 3}, {0, 0, 0}}, r));
    CHECK_FALSE(is_sound(plain_hit{{1, 1, 3}, {0, broken, 1}}, r));
}

TEST_CASE("photon_walk: every particle is booked exactly once, and the watts balance") {
    const auto scene = open_room();
    sample_mean off;
    energy_ledger<S> all;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        energy_ledger<S> l;
        walk_photon(scene, lamp, numbers_of(i), 12, l, [&](const auto&, const auto& wi, const S& power, auto) {
            REQUIRE(std::abs(glm::length(wi) - 1) < 1e-4f);
            REQUIRE(is_radiance(power));
            return i % 16 != 0;
        });
        REQUIRE(books_close(l));
        const S kept = l.power_escaped + l.power_absorbed + l.power_unneeded + l.power_capped + l.power_dropped;
        off.add(static_cast<double>((l.power_emitted - kept).x / l.power_emitted.x));
        all += l;
    }
    CHECK(books_close(all));
    CHECK(all.emitted == 20000);
    CHECK((all.escaped > 0 && all.roulette > 0 && all.unneeded > 0 && all.capped > 0));
    CHECK(all.dropped == 0);
    CAPTURE(off.mean(), off.standard_error());
    CHECK(off.agrees(0));
}

TEST_CASE("photon_walk: a wall of albedo rho is met 1 / (1 - rho) times") {
    for (const float albedo : {0.0f, 0.5f, 0.9f, 0.99f}) {
        const auto l = walked(sphere(albedo), lamp, 4000, 0, land_anywhere);
        const double bounces = static_cast<double>(l.bounces) / 4000;
        // Geometric: its variance is rho / (1 - rho)².
        const double error = std::sqrt(double(albedo) / 4000) / (1 - double(albedo));
        CHECK(std::abs(bounces - 1 / (1 - double(albedo))) <= 4 * error + 1e-9);
    }
}

TEST_CASE("photon_walk: a depth cap reports the power that it loses") {
    // What still travels after n surfaces of albedo 1/2 is 2^-n.
    for (const std::uint32_t cap : {1u, 3u, 6u}) {
        const auto l = walked(sphere(0.5f), lamp, 40000, cap, land_anywhere);
        const double lost = double(l.power_capped.y / l.power_emitted.y);
        const double truth = std::ldexp(1.0, -static_cast<int>(cap));
        CHECK(std::abs(lost - truth) <= 4 * std::sqrt(truth * (1 - truth) / 40000));
        CHECK(l.capped > 0);
        CHECK(l.bounces <= 40000ull * (cap + 1));
    }
    CHECK(walked(sphere(0.5f), lamp, 1000, 0, land_anywhere).capped == 0);
}

TEST_CASE("photon_walk: the adjoint factor weighs light where it does not weigh importance") {
    auto scene = sphere(0.9f);
    scene.balls[0].made_of.adjoint_factor = 0.5;
    const auto l = walked(scene, lamp, 20000, 0, land_anywhere);
    CHECK(double(l.bounces) / 20000 == Approx(1 / (1 - 0.45)).epsilon(0.03));
}

TEST_CASE("photon_walk: saturated light keeps every band below what it started with") {
    // Roulette by luminance lets blue grow to 14 times; by the largest band it cannot grow at all.
    auto scene = sphere(0);
    scene.balls[0].made_of.diffuse = {0.1f, 0.1f, 0.9f};
    const bulb<S, float> blue{.intensity = {0.01f, 0.01f, 1}};
    float most = 0;
    const auto l = walked(scene, blue, 5000, 0, [&](const auto&, const auto&, const S& power, auto) {
        most = std::max(most, max_component(power));
        return true;
    });
    CHECK(l.bounces > 10000);
    CHECK(most <= 4 * pi<float> * (1 + 1e-4f));
}

TEST_CASE("photon_walk: a light of no power sends out nothing to follow") {
    const auto l = walked(sphere(0.9f), support::no_light<S, float>{}, 100, 0, [](const auto&...) {
        FAIL("nothing can land");
        return true;
    });
    CHECK(l.emitted == 100);
    CHECK(l.bounces == 0);
    CHECK(l.power_emitted == S{0});
    CHECK(books_close(l));
}

TEST_CASE("photon_walk: light between perfect mirrors ends") {
    toy_scene<S, float> scene{.balls = {{.radius = 2, .made_of = {.mirror = S{1}}}}};
    const auto l = walked(scene, lamp, 2, 0, land_anywhere);
    CHECK(l.roulette == 2);
    CHECK(l.bounces > 2 * 4096);
    CHECK(survival_ceiling<float>(endless_bounces - 1) == 1);
    CHECK(survival_ceiling<float>(endless_bounces) < 1);
}

TEST_CASE("photon_walk: a flawed host's particles are dropped and counted, never landed") {
    auto room = support::room_with_balls<S, float>(S{0.6f}, S{1});
    room.scene.balls.clear();
    for (const support::flaw wrong : support::all_flaws) {
        const support::flawed_scene scene{room.scene, wrong};
        const auto l = walked(scene, room.light, 2000, 0, [&](const auto& hit, const auto&, const S& power, auto) {
            REQUIRE(is_radiance(power));
            REQUIRE(is_finite(hit.position.x + hit.position.y + hit.position.z));
            REQUIRE(std::abs(glm::length(hit.normal) - 1) < 0.01f);
            return true;
        });
        CAPTURE(static_cast<int>(wrong));
        CHECK(books_close(l));
        CHECK(is_radiance(l.power_dropped));
        const bool seen_by_photons = wrong != support::flaw::nan_evaluate && wrong != support::flaw::nan_emitted;
        CHECK((l.dropped > 0) == seen_by_photons);
        CHECK((l.power_dropped.x > 0) == seen_by_photons);
    }
}

TEST_CASE("photon_walk: flawed emissions are dropped before they travel") {
    const float broken = std::numeric_limits<float>::quiet_NaN();
    for (const float factor : {broken, -1.0f, std::numeric_limits<float>::infinity()}) {
        const support::flawed_bulb light{{.intensity = S{1}}, factor, false};
        const auto l = walked(sphere(0.5f), light, 1000, 0, land_anywhere);
        CHECK((l.dropped > 400 && l.dropped < 600));
        CHECK(is_radiance(l.power_emitted));
        CHECK(books_close(l));
    }
    const auto l = walked(sphere(0.5f), support::flawed_bulb{{.intensity = S{1}}, 1, true}, 1000, 0, land_anywhere);
    CHECK((l.dropped > 400 && l.dropped < 600));
}

TEST_CASE("photon_walk: scaling the scene or the light by a power of two changes no path") {
    const auto scene = open_room();
    const auto here = walked(scene, lamp, 300, 0, land_anywhere);
    for (int k = -30; k <= 30; k += 5) {
        const float s = std::ldexp(1.0f, k);
        const float p = std::ldexp(1.0f, 2 * k);
        bulb<S, float> there = lamp;
        there.position *= s;
        there.intensity *= p;
        const auto l = walked(scene.scaled(s), there, 300, 0, land_anywhere);
        CAPTURE(k);
        CHECK(l.bounces == here.bounces);
        CHECK(l.escaped == here.escaped);
        CHECK(l.power_escaped == here.power_escaped * p);
        CHECK(l.power_absorbed == here.power_absorbed * p);
    }
}
