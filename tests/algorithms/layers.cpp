#include <aglow/algorithms/layers.hpp>

#include <vector>

#include <glm/vec3.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using support::material;
using support::toy_hit;

namespace {

using S = glm::vec3;
const vec3<float> up{0, 0, 1};

toy_hit<S, float> floor_of(const material<S>& m) { return {{0, 0, 0}, up, &m, 1e-6f}; }

/// Photons of the powers `above` and `below`, evenly over the floor.
photon_map<S, float> floor_map(const S& above, const S& below) {
    std::vector<landed_photon<S, float>> photons;
    random_sampler<float> random{1};
    for (int i = 0; i < 4000; ++i) {
        const vec2<float> u = random.next_2d() * 2.0f - 1.0f;
        const auto add = [&](const S& power, const vec3<float>& side) {
            photons.push_back(
                {{u.x, u.y, 0}, {power, packed_direction<std::int16_t>{side}, packed_direction<std::int16_t>{side}}});
        };
        add(above, up);
        add(below, -up);
    }
    return photon_map<S, float>{photons, 1.0f / 4000};
}

const random_numbers<float> numbers{{.seed = 1}};

}  // namespace

TEST_CASE("layers: the side of a hit is the one that is looked from") {
    const material<S> m;
    CHECK(side_of(floor_of(m), {0.6f, 0, 0.8f}) == up);
    CHECK(side_of(floor_of(m), {0.6f, 0, -0.8f}) == -up);
}

TEST_CASE("layers: reflection asks for the near side, transmission for the far one, and black lobes for none") {
    std::vector<vec3<float>> asked;
    const auto irradiance = [&](const vec3<float>& side) {
        asked.push_back(side);
        return estimate<S>{side.z > 0 ? S{2} : S{10}, 0.5f};
    };
    const material<S> both{.diffuse = S{0.25f}, .transmit = S{0.5f}};
    const auto from_above = diffuse_radiance(floor_of(both), up, irradiance);
    CHECK(asked == std::vector<vec3<float>>{up, -up});
    CHECK(from_above.value.x == Approx((0.25f * 2 + 0.5f * 10) / pi<float>));
    CHECK(from_above.error == Approx((0.25f + 0.5f) * 0.5f / pi<float>));
    const auto from_below = diffuse_radiance(floor_of(both), -up, irradiance);
    CHECK(from_below.value.x == Approx((0.25f * 10 + 0.5f * 2) / pi<float>));

    asked.clear();
    const material<S> matte{.diffuse = S{0.25f}};
    CHECK(diffuse_radiance(floor_of(matte), up, irradiance).value.x == Approx(0.5f / pi<float>));
    CHECK(asked == std::vector<vec3<float>>{up});
    asked.clear();
    // What a scene's type rules out is not even asked.
    static_cast<void>(diffuse_radiance<lobe_set::diffuse_reflection>(floor_of(both), up, irradiance));
    CHECK(asked == std::vector<vec3<float>>{up});
    asked.clear();
    const material<S> mirror{.mirror = S{1}};
    CHECK(diffuse_radiance(floor_of(mirror), up, irradiance).value == S{0});
    CHECK(asked.empty());
}

TEST_CASE("layers: a map is seen as albedo / pi times its irradiance, of both sides where light passes") {
    const auto map = floor_map({1, 2, 4}, {8, 8, 8});
    const density_options density{.count = 200};
    const map_layer<S, float> layer{map, density};
    const material<S> m{.diffuse = {0.5f, 0.25f, 0.5f}, .transmit = S{0.25f}};
    const auto seen = layer(floor_of(m), up, 1e-6f, numbers, 1);
    const auto near = map.irradiance({0, 0, 0}, up, density);
    const auto far = map.irradiance({0, 0, 0}, -up, density);
    for (int b = 0; b < 3; ++b) {
        CHECK(seen.value[b] == Approx((m.diffuse[b] * near.value[b] + 0.25f * far.value[b]) / pi<float>));
    }
    // The floor has four square metres.
    CHECK(near.value.x == Approx(0.25).epsilon(0.2));
    CHECK(far.value.x == Approx(2).epsilon(0.2));
    CHECK(seen.error > 0);
    CHECK(seen.bias == Approx((0.5f * near.bias + 0.25f * far.bias) / pi<float>));
    CHECK(seen.bias != 0);
    const photon_map<S, float> empty;
    CHECK(map_layer<S, float>{empty}(floor_of(m), up, 1e-6f, numbers, 1).value == S{0});
}

TEST_CASE("layers: direct light by one shadow ray is the bulb's, on the lobes asked for") {
    const support::toy_scene<S, float> empty;
    const support::bulb<S, float> lamp{.position = {3, 0, 4}, .intensity = {1, 2, 4}};
    const material<S> m{.diffuse = S{0.5f}, .glossy = S{0.25f}, .mirror = S{0.25f}};
    const vec3<float> wo = glm::normalize(vec3<float>{-1, 0, 1});
    const auto lit = [&](lobe_set lobes) {
        return direct_layer{empty, lamp, lobes}(floor_of(m), wo, 1e-6f, numbers, 1).value;
    };
    const float cosine_over_d2 = 0.8f / 25;
    CHECK(lit(lobe_set::diffuse).x == Approx(0.5f / pi<float> * cosine_over_d2));
    const vec3<float> wi = glm::normalize(lamp.position);
    const S gloss = floor_of(m).evaluate(wo, wi, lobe_set::glossy_reflection);
    CHECK(gloss.x > 0);
    CHECK(lit(lobe_set::glossy).y == Approx(2 * gloss.y * cosine_over_d2));
    CHECK(lit(lobe_set::smooth).z == Approx(lit(lobe_set::diffuse).z + lit(lobe_set::glossy).z));
    const material<S> mirror{.mirror = S{1}};
    CHECK(direct_layer{empty, lamp}(floor_of(mirror), wo, 1e-6f, numbers, 1).value == S{0});
}

TEST_CASE("layers: a sum of layers adds values and errors") {
    const auto constant = [](float value, float error) {
        return [=](const auto&, const vec3<float>&, float, const auto&, std::uint32_t) {
            return estimate<S>{S{value}, error};
        };
    };
    const layer_sum sum{constant(1, 0.5f), constant(2, 0.25f), constant(4, 0)};
    const material<S> m{.diffuse = S{0.5f}};
    const auto all = sum(floor_of(m), up, 1e-6f, numbers, 1);
    CHECK(all.value == S{7});
    CHECK(all.error == 0.75f);
}
