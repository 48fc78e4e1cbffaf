// Mistakes that others have made: each is a test by the name in bugs.hpp, and those without a better place are here.
#include "stability/bugs.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/estimators/irradiance_cache.hpp>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace aglow;
using namespace stability;
using rgb = glm::vec3;
using photon_list = std::vector<landed_photon<rgb, float>>;

namespace {

std::string all_tests() {
    std::string all;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{AGLOW_ROOT "/tests"}) {
        if (entry.path().extension() != ".cpp") { continue; }
        std::ifstream file{entry.path()};
        all.append(std::istreambuf_iterator<char>{file}, {});
    }
    return all;
}

landed_photon<rgb, float> landed(const rgb& at, const rgb& power = rgb{1}) {
    const packed_direction<std::int16_t> up{rgb{0, 0, 1}};
    return {at, {power, up, up}};
}

/// A lattice of side x side photons of 1 W in all on the unit square at height 0.
photon_list even_floor(int side) {
    photon_list all;
    const float share = 1 / static_cast<float>(side * side);
    for (int i = 0; i < side * side; ++i) {
        const float x = (static_cast<float>(i % side) + 0.5f) / static_cast<float>(side);
        const float y = (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side);
        all.push_back(landed({x, y, 0}, rgb{share}));
    }
    return all;
}

photon_map<rgb, float> map_of(const photon_list& all) { return photon_map<rgb, float>{all}; }

/// A matte floor alone: nothing that leaves it comes back.
support::toy_scene<rgb, float> lone_floor() {
    return {.rectangles = {{.corner = {-1, -1, 0},
                            .u = {2, 0, 0},
                            .v = {0, 2, 0},
                            .normal = {0, 0, 1},
                            .made_of = {.diffuse = rgb{0.5f}}}}};
}

constexpr auto straight_down = [](const vec2<float>& film) {
    return ray<float>{{film.x * 0.01f, film.y * 0.01f, 1}, {0, 0, -1}};
};

}  // namespace

TEST_CASE("bugs: each of both lists is there once, in order, and the tests that it names exist") {
    const std::string tests = all_tests();
    const auto quoted = [](std::string_view name) {
        std::string text{'"'};
        text.append(name).push_back('"');
        return text;
    };
    int number = 0;
    technique in = technique::irradiance_cache;
    for (const known_bug& bug : known_bugs) {
        number = bug.in == in ? number + 1 : 1;
        in = bug.in;
        CAPTURE(bug.number, bug.where);
        CHECK(bug.number == number);
        CHECK_FALSE(bug.wrong.empty());
        CHECK(tests.find(quoted(bug.caught_by)) != std::string::npos);
        CHECK((bug.also.empty() || tests.find(quoted(bug.also)) != std::string::npos));
    }
    CHECK(known_bugs.size() == 13 + 32);
    CHECK(number == 32);
}

TEST_CASE("bugs: a gather without one good ray is black, refused as a record, and divides by nothing") {
    const auto broken = [](const ray<float>&, const auto&) {
        return incoming_light<float, float>{std::numeric_limits<float>::quiet_NaN(), 1};
    };
    const random_numbers<float> numbers{{.path = 4}};
    const irradiance_estimator<float> estimator{{8, 25}};
    gather_workspace<float, float> workspace;
    const auto e = gather_irradiance(broken, gather_point<float>{}, numbers, estimator, workspace);
    CHECK(e.rejected == 200);
    CHECK(e.irradiance == 0);
    CHECK(gather_once(broken, gather_point<float>{}, numbers, estimator.shape()) == 0);
    irradiance_cache<float> cache{1.0f};
    CHECK(cache.insert(e) != record_status::inserted);
    CHECK(cache.size() == 0);
}

TEST_CASE("bugs: a gather over maps in which nothing landed is direct light, by every gathering integrator") {
    const auto scene = lone_floor();
    const support::bulb<rgb, float> light{.position = {0, 0, 2}, .intensity = rgb{1}};
    bounds<float> box;
    box.add(rgb{-1});
    box.add(rgb{1});
    const photon_options wanted{.caustic = 100, .indirect = 100, .pilot_paths = 64};
    const final_gathering gathered{scene, light, {.photons = wanted, .rays = 16}};
    CHECK(gathered.maps().indirect.empty());
    const gather_caching cached{
        scene, light, box, straight_down, {.photons = wanted, .caching = {.fill = {.rays = 16}, .view = {2, 2}}}};
    const random_numbers<float> numbers{{}};
    // I cos / d2, spread by albedo / pi.
    const float exact = 0.25f * 0.5f / aglow::pi<float>;
    const ray<float> eye = straight_down({0, 0});
    CHECK(gathered(eye, numbers).value.x == Approx(exact).epsilon(1e-5));
    CHECK(cached(eye, numbers).value.x == Approx(exact).epsilon(1e-5));
}

TEST_CASE("bugs: passes over nothing, and over light in one point, end and are finite") {
    const support::bulb<rgb, float> light{.position = {0, 0, 2}, .intensity = rgb{1}};
    for (const auto& scene : {support::toy_scene<rgb, float>{}, lone_floor()}) {
        progressive_photon_mapping mapping{scene, light, {.caustic = 50, .indirect = 50}};
        film<rgb> picture{2, 2};
        for (int i = 0; i < 3; ++i) { mapping.pass(picture, straight_down); }
        CHECK(picture.dropped() == 0);
        CHECK((picture.radiance(0, 0).x > 0) == !scene.rectangles.empty());
    }
    const photon_list spot(100, landed({0.5f, 0.5f, 0}));
    for (const double radius : {0.0, 1e-30, 1.0}) {
        const auto e = map_of(spot).irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, {.count = 10, .max_radius = radius});
        CHECK(is_radiance(e.value));
        CHECK(is_finite(e.error));
    }
}

TEST_CASE("bugs: a wide look into the dark changes neither photons nor light of a bright place") {
    // No structure is sized by the widest radius: what a place reads is its own, whoever asked before and how.
    photon_list all = even_floor(100);
    const auto map = map_of(all);
    const density_options near{.count = 50, .max_radius = 0.1};
    const auto alone = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, near);
    std::uint32_t asked = 0;
    const auto counting = [&](std::size_t) {
        ++asked;
        return true;
    };
    const auto told = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, near, counting);
    const std::uint32_t before = asked;
    const auto dark = map.irradiance({900, 900, 0}, {0, 0, 1}, {.count = 50, .max_radius = 500});
    asked = 0;
    const auto after = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, near, counting);
    CHECK(dark.count == 0);
    CHECK(asked == before);
    CHECK(before < 500);
    CHECK(after.value == alone.value);
    CHECK(told.value == alone.value);
}

TEST_CASE("bugs: a lamp in sight has its radiance from the first pass on") {
    auto scene = lone_floor();
    scene.rectangles.push_back({.corner = {-0.5f, -0.5f, 0.5f},
                                .u = {1, 0, 0},
                                .v = {0, 1, 0},
                                .normal = {0, 0, 1},
                                .made_of = {.glow = rgb{3}}});
    const support::panel<rgb, float> light{scene.rectangles.back()};
    progressive_photon_mapping mapping{scene, light, {.caustic = 500, .indirect = 500}};
    film<rgb> picture{2, 2};
    for (int i = 0; i < 4; ++i) {
        mapping.pass(picture, straight_down);
        CHECK(picture.radiance(1, 1) == rgb{3});
    }
}

TEST_CASE("bugs: each map is asked by its own options") {
    const auto scene = lone_floor();
    const auto all = even_floor(100);
    const auto map = map_of(all);
    const auto hit = scene.intersect(ray<float>{{0.5f, 0.5f, 1}, {0, 0, -1}});
    REQUIRE(hit);
    const random_numbers<float> numbers{{}};
    const density_options few{.count = 7};
    const density_options many{.count = 300};
    const map_layer first{map, few};
    const map_layer second{map, many};
    const auto seen = layer_sum{first, second}(*hit, rgb{0, 0, 1}, 0.0f, numbers, 1);
    const auto a = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, few);
    const auto b = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, many);
    CHECK(a.count < 7);
    CHECK(b.count > 200);
    CHECK(seen.value.x == Approx((a.value.x + b.value.x) * 0.5f / aglow::pi<float>).epsilon(1e-6));
    CHECK(seen.error == Approx((a.error + b.error) * 0.5f / aglow::pi<float>).epsilon(1e-6));
}

TEST_CASE("bugs: a lone photon lights no farther than it is looked for") {
    const auto map = map_of({landed({0, 0, 0})});
    for (const std::uint32_t k : {0u, 2u, 50u}) {
        const density_options options{.count = k, .max_radius = 0.1, .kernel = kernel_shape::constant};
        CHECK(map.irradiance({0.11f, 0, 0}, {0, 0, 1}, options).value == rgb{0});
        // Over the whole disc, not over that of the photon's own distance.
        CHECK(map.irradiance({0.05f, 0, 0}, {0, 0, 1}, options).value.x ==
              Approx(1 / (aglow::pi<float> * 0.01f)).epsilon(1e-5));
    }
}

TEST_CASE("bugs: an ulp above, below or beside all photons a floor is as bright as on it") {
    const auto all = even_floor(100);
    const auto map = map_of(all);
    const float ulp = std::numeric_limits<float>::epsilon();
    for (const std::uint32_t k : {0u, 50u}) {
        const density_options options{.count = k, .max_radius = 0.08};
        const auto on = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, options);
        CHECK(on.value.x == Approx(1).epsilon(0.05));
        for (const float off : {-ulp, ulp}) {
            CHECK(map.irradiance({0.5f, 0.5f, off}, {0, 0, 1}, options).value.x == Approx(on.value.x).epsilon(1e-4));
        }
        // At the border half of the disc lies on the floor.
        const auto border = map.irradiance({map.box().low.x, 0.5f, 0}, {0, 0, 1}, options);
        const auto beside = map.irradiance({map.box().low.x - ulp, 0.5f, 0}, {0, 0, 1}, options);
        CHECK(border.value.x > 0.4f);
        CHECK(beside.value.x == Approx(border.value.x).epsilon(1e-4));
    }
}

TEST_CASE("bugs: photons without any variance tell a finite error, the same each time") {
    const auto map = map_of(even_floor(200));
    for (const std::uint32_t k : {2u, 3u, 50u, 500u}) {
        const auto e = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, {.count = k});
        const auto again = map.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, {.count = k});
        CAPTURE(k, e.value.x, e.error);
        CHECK(is_finite(e.error));
        CHECK(e.error >= 0);
        CHECK(again.value == e.value);
        CHECK(again.error == e.error);
        CHECK(again.count == e.count);
    }
}
