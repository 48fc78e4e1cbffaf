// What a scene does not need: no bytes, no work, and no difference in the picture.
#include <cstdint>

#include <glm/vec3.hpp>

#include <aglow/algorithms/plan.hpp>
#include <aglow/estimators/compact_photon.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/photon.hpp>

#include "stability/integrators.hpp"
#include "support/catch.hpp"

using namespace aglow;
using namespace stability;

namespace {

template <typename S, record_features F>
constexpr std::size_t record_bytes = sizeof(irradiance_record<S, float, F>);

// A record of gray light with nothing but its reach; all that RGB can have but the incident direction.
static_assert(record_bytes<float, record_features{.gradients = false, .ellipse = false, .noise = false}> <= 32);
static_assert(record_bytes<float, record_features{.gradients = false}> <= 32);
static_assert(record_bytes<rgb, record_features{}> <= 64);
// Each part is paid for by itself, and a part left out by nobody.
static_assert(record_bytes<rgb, record_features{.gradients = false}> + 24 == record_bytes<rgb, record_features{}>);
static_assert(record_bytes<float, record_features{.gradients = false, .ellipse = false}> + 4 ==
              record_bytes<float, record_features{.gradients = false}>);
static_assert(record_bytes<float, record_features{.gradients = false, .noise = false}> + 4 ==
              record_bytes<float, record_features{.gradients = false}>);
static_assert(record_bytes<rgb, record_features{.incident = true}> == record_bytes<rgb, record_features{}> + 8);
static_assert(sizeof(photon<rgb>) <= 24);
static_assert(sizeof(photon<float>) <= 16);
static_assert(sizeof(compact_photon<rgb>) == 16);
static_assert(sizeof(compact_photon<float>) == 16);
// The same in double, where places take 24 bytes; light may still be float.
using drgb = glm::dvec3;
constexpr record_features least{.gradients = false, .ellipse = false, .noise = false};
template <typename S, record_features F>
constexpr std::size_t double_bytes = sizeof(irradiance_record<S, double, F>);
static_assert(double_bytes<float, least> <= 48);
static_assert(double_bytes<double, least> <= 48);
static_assert(double_bytes<rgb, least> <= 56);
static_assert(double_bytes<drgb, least> <= 64);
static_assert(double_bytes<rgb, record_features{}> <= 112);
static_assert(double_bytes<drgb, record_features{}> <= 168);
static_assert(sizeof(photon<double>) <= 24);
static_assert(sizeof(photon<drgb>) <= 40);

/// The matte room, which says at compile time that it is matte, or says nothing.
struct matte_scene : support::toy_scene<rgb, float> {
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
};

support::ball_room<rgb, float> matte_room() {
    auto room = support::room_with_balls<rgb, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
    for (auto& ball : room.scene.balls) { ball.made_of = {.diffuse = rgb{0.5f}}; }
    room.scene.lobes = lobe_set::all;
    return room;
}

std::uint64_t asked_too_much = 0;
std::uint64_t asked = 0;

/// Counts questions, and those for more than there can be.
struct watching_hit : support::toy_hit<rgb, float> {
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
    static void watch(lobe_set lobes) {
        ++asked;
        asked_too_much += any(lobes, ~lobe_set::diffuse_reflection) ? 1 : 0;
    }
    [[nodiscard]] rgb evaluate(const rgb& wo, const rgb& wi, lobe_set lobes) const {
        watch(lobes);
        return toy_hit::evaluate(wo, wi, lobes);
    }
    [[nodiscard]] float pdf(const rgb& wo, const rgb& wi, lobe_set lobes) const {
        watch(lobes);
        return toy_hit::pdf(wo, wi, lobes);
    }
    template <Sampler R>
    [[nodiscard]] auto sample(const rgb& wo, R& random, lobe_set lobes) const {
        watch(lobes);
        return toy_hit::sample(wo, random, lobes);
    }
};

struct watching_scene {
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
    support::toy_scene<rgb, float> inner;
    [[nodiscard]] std::optional<watching_hit> intersect(const ray<float>& r) const {
        const auto hit = inner.intersect(r);
        return hit ? std::optional{watching_hit{*hit}} : std::nullopt;
    }
    [[nodiscard]] bool occluded(const rgb& a, const rgb& b) const { return inner.occluded(a, b); }
};

}  // namespace

TEST_CASE("omission: every part that a matte scene leaves out, forced back on, leaves every pixel as it was") {
    const auto room = matte_room();
    matte_scene stated;
    static_cast<support::toy_scene<rgb, float>&>(stated) = room.scene;
    bounds<float> box;
    box.add(rgb{-1});
    box.add(rgb{1});
    const auto all = by_every_integrator(room.scene, room.light, box, {});
    const auto few = by_every_integrator(stated, room.light, box, {});
    for (std::size_t i = 0; i < all.size(); ++i) {
        CAPTURE(all[i].by);
        CHECK(all[i].pixels == few[i].pixels);
    }
}

TEST_CASE("omission: each part that a scene says it has not, forced back on, leaves every pixel as it was") {
    bounds<float> box;
    box.add(rgb{-1});
    box.add(rgb{1});
    for (const lobe_set part : {lobe_set::specular, lobe_set::glossy, lobe_set::transmission, lobe_set::diffuse}) {
        // Every material but those with this part.
        auto room = support::room_with_balls<rgb, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14});
        const support::material<rgb> matte{.diffuse = rgb{0.5f}};
        const support::material<rgb> mirror{.mirror = rgb{0.9f}};
        const bool no_diffuse = part == lobe_set::diffuse;
        const auto without = [&](support::material<rgb> m) {
            if (any(part, lobe_set::diffuse_reflection)) { m.diffuse = rgb{0}; }
            if (any(part, lobe_set::diffuse_transmission)) { m.transmit = rgb{0}; }
            if (any(part, lobe_set::glossy_reflection)) { m.glossy = rgb{0}; }
            if (any(part, lobe_set::specular_reflection)) { m.mirror = rgb{0}; }
            if (any(part, lobe_set::specular)) { m.glass = 0; }
            if (any(part, lobe_set::specular_transmission) && m.glass > 0) { m = no_diffuse ? mirror : matte; }
            return m;
        };
        for (auto& ball : room.scene.balls) { ball.made_of = without(ball.made_of); }
        for (auto& wall : room.scene.rectangles) { wall.made_of = without(wall.made_of); }
        room.scene.balls[0].made_of.transmit = any(part, lobe_set::diffuse_transmission) ? rgb{0} : rgb{0.25f};
        room.scene.lobes = lobe_set::all;
        const auto all = by_every_integrator(room.scene, room.light, box, {});
        room.scene.lobes = ~part;
        const auto few = by_every_integrator(room.scene, room.light, box, {});
        CHECK(plan_for(room.scene).left_out.size() > 0);
        for (std::size_t i = 0; i < all.size(); ++i) {
            CAPTURE(static_cast<int>(part), all[i].by);
            CHECK(all[i].pixels == few[i].pixels);
        }
    }
}

TEST_CASE("omission: a matte scene walks no path for caustics and bends no ray, and the plan says why") {
    const auto room = matte_room();
    matte_scene stated;
    static_cast<support::toy_scene<rgb, float>&>(stated) = room.scene;
    const photon_options wanted{.direct = 500, .caustic = 500, .indirect = 500, .pilot_paths = 500};
    const auto maps = trace_photons(stated, room.light, wanted);
    CHECK(maps.caustic.paths == 0);
    CHECK(maps.caustic.size() == 0);
    CHECK(maps.caustic.status == map_status::left_out);
    CHECK(maps.caustic.why == "left out, no specular surface");
    // Silent, it searches for caustics, and finds none.
    CHECK(trace_photons(room.scene, room.light, wanted).caustic.paths > 0);

    const render_plan plan = plan_for(stated);
    CHECK_FALSE(plan.caustic_map);
    CHECK_FALSE(plan.transmission);
    CHECK_FALSE(plan.glossy);
    CHECK_FALSE(plan.specular);
    CHECK(plan.left_out.size() == 4);
    for (const auto& o : plan.left_out) { CHECK_FALSE(o.why.empty()); }
    CHECK(plan_for(room.scene).left_out.empty());
}

TEST_CASE("omission: nobody asks a host for a lobe that its scene cannot have") {
    const auto room = matte_room();
    bounds<float> box;
    box.add(rgb{-1});
    box.add(rgb{1});
    CHECK(by_every_integrator(watching_scene{room.scene}, room.light, box, {}).size() == 6);
    CHECK(asked > 1000);
    CHECK(asked_too_much == 0);
}
