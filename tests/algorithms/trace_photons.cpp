#include <aglow/algorithms/trace_photons.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>

#include "support/archetypes.hpp"
#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::bulb;
using support::toy_scene;

namespace {

using S = glm::vec3;

bool same(const photon_map<S, float>& a, const photon_map<S, float>& b) {
    if (a.size() != b.size()) { return false; }
    for (std::size_t i = 0; i < a.size(); ++i) {
        const bool equal = a.position(i) == b.position(i) && a.photons()[i].power == b.photons()[i].power &&
                           a.photons()[i].wi == b.photons()[i].wi && a.photons()[i].normal == b.photons()[i].normal;
        if (!equal) { return false; }
    }
    return true;
}

template <typename L>
bool books_close(const L& l) {
    return l.emitted == l.escaped + l.absorbed + l.roulette + l.unneeded + l.capped + l.dropped;
}

template <typename Map>
S total(const Map& map) {
    glm::dvec3 sum{};
    for (const auto& p : map.photons()) { sum += glm::dvec3(p.power); }
    return sum;
}

support::ball_room<S, float> room() { return support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14}); }

toy_scene<S, float> sphere(float albedo, float port = 2) {
    return {.balls = {{.radius = 2, .made_of = {.diffuse = S{albedo}}, .port = port}},
            .lobes = lobe_set::diffuse_reflection};
}

const bulb<S, float> lamp{.intensity = {1, 2, 3}};

/// A dark floor and a ball on it, far from all walls: little of what they reflect meets the other.
toy_scene<S, float> open_floor() {
    const support::material<S> dark{.diffuse = S{0.2f}};
    return {
        .balls = {{.centre = {0.5f, 0, -0.7f}, .radius = 0.3f, .made_of = dark}},
        .rectangles = {{.corner = {-1, -1, -1}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}, .made_of = dark}},
        .lobes = lobe_set::diffuse_reflection};
}

}  // namespace

TEST_CASE("trace_photons: 1, 2, 3 and 8 threads and any executor land the same photons") {
    const auto r = room();
    const photon_options options{.direct = 3000, .caustic = 1000, .indirect = 5000, .seed = 3};
    const auto one = trace_photons(r.scene, r.light, options);
    REQUIRE(one.caustic.size() > 500);
    const auto check = [&](const auto& run) {
        const auto other = trace_photons(r.scene, r.light, options, run);
        CHECK(same(one.direct, other.direct));
        CHECK(same(one.caustic, other.caustic));
        CHECK(same(one.indirect, other.indirect));
        CHECK(one.ledger.power_absorbed == other.ledger.power_absorbed);
        CHECK(one.ledger.bounces == other.ledger.bounces);
        CHECK(one.ledger.absorbed == other.ledger.absorbed);
    };
    for (const unsigned threads : {1u, 2u, 3u, 8u}) { check(own_threads{threads}); }
    check(archetypes::executor{});
}

TEST_CASE("trace_photons: the books close to the last particle for any number of threads") {
    const auto r = room();
    auto open = r.scene;
    open.rectangles.erase(open.rectangles.begin());
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        const auto maps =
            trace_photons(open, r.light, {.direct = 2000, .caustic = 500, .indirect = 4000}, own_threads{threads});
        CHECK(books_close(maps.ledger));
        const std::size_t most = std::max({maps.direct.paths, maps.caustic.paths, maps.indirect.paths});
        CHECK(maps.ledger.emitted == most);
        CHECK(maps.ledger.escaped > 0);
        CHECK(maps.ledger.dropped == 0);
    }
}

TEST_CASE("trace_photons: in a closed sphere every path lands once, and all its power is in the direct map") {
    const auto maps = trace_photons(sphere(0.5f), lamp, {.direct = 20000});
    CHECK(maps.direct.size() == maps.direct.paths);
    CHECK(maps.direct.status == map_status::full);
    const S power = lamp.intensity * (4 * pi<float>);
    CHECK(total(maps.direct).x == Approx(power.x).epsilon(1e-5));
    CHECK(total(maps.direct).z == Approx(power.z).epsilon(1e-5));
    CHECK(maps.indirect.status == map_status::left_out);
    // Nobody asked for more than the first landing.
    CHECK(maps.ledger.unneeded == maps.ledger.emitted);
    CHECK(maps.ledger.bounces == maps.ledger.emitted);
}

TEST_CASE("trace_photons: indirect light of a bulb in a matte sphere is P rho / (4 pi R2 (1 - rho)) everywhere") {
    const bulb<S, float> aside{.position = {0.9f, -0.4f, 0.7f}, .intensity = S{1}};
    for (const float albedo : {0.5f, 0.9f}) {
        const auto maps = trace_photons(sphere(albedo), aside, {.indirect = 200000});
        const double truth = double(albedo) / ((1 - double(albedo)) * 4);
        sample_mean mean;
        random_sampler<float> random{1};
        for (int i = 0; i < 300; ++i) {
            const vec3<float> n = uniform_sphere(random.next_2d());
            const auto e = maps.indirect.irradiance(n * 2.0f, -n, {.count = 400});
            mean.add(double(e.value.x));
            // Curved by the estimate's own disc, which the guess of its error must cover; two sigma and bias.
            CHECK(std::abs(double(e.value.x) - truth) <= 2 * double(e.error));
        }
        CAPTURE(albedo, mean.mean() / truth);
        CHECK(mean.mean() == Approx(truth).epsilon(0.01));
    }
}

TEST_CASE("trace_photons: an integrating sphere with a port keeps what the closed form says") {
    // A port of the share f: every wall point sees it under the share f.
    const float f = 0.1f;
    const float rho = 0.9f;
    const bulb<S, float> centre{.intensity = S{1}};
    const auto maps = trace_photons(sphere(rho, 1 - 2 * f), centre, {.indirect = 100000});
    const auto& l = maps.ledger;
    const double bounced = double(rho) * (1 - double(f));
    const double escaped = double(f) + (1 - double(f)) * double(rho) * double(f) / (1 - bounced);
    const double n = static_cast<double>(l.emitted);
    CHECK(std::abs(static_cast<double>(l.escaped) / n - escaped) <= 4 * std::sqrt(escaped * (1 - escaped) / n));
    const double truth = 4 * pi<double> * (1 - double(f)) * double(rho) / (1 - bounced) / (16 * pi<double>);
    sample_mean mean;
    random_sampler<float> random{1};
    for (int i = 0; i < 400; ++i) {
        const vec3<float> p = uniform_sphere(random.next_2d());
        if (p.z < 0.5f) { mean.add(double(maps.indirect.irradiance(p * 2.0f, -p, {.count = 400}).value.x)); }
    }
    CHECK(mean.mean() == Approx(truth).epsilon(0.015));
}

TEST_CASE("trace_photons: what the scene cannot have is left out, and no path is walked for it") {
    const auto maps = trace_photons(sphere(0.5f), lamp, {.caustic = 1000});
    CHECK(maps.caustic.status == map_status::left_out);
    CHECK(maps.caustic.why == "left out, no specular surface");
    CHECK(maps.ledger.emitted == 0);
    toy_scene<S, float> mirrors{.balls = {{.radius = 2, .made_of = {.mirror = S{1}}}}, .lobes = lobe_set::specular};
    const auto none = trace_photons(mirrors, lamp, {.direct = 10, .caustic = 10, .indirect = 10});
    CHECK(none.ledger.emitted == 0);
    CHECK(none.indirect.why == "left out, no diffuse or glossy surface");
    CHECK(none.size() == 0);
    const auto unasked = trace_photons(sphere(0.5f), lamp, {});
    CHECK(unasked.direct.status == map_status::left_out);
    CHECK(unasked.ledger.emitted == 0);
}

TEST_CASE("trace_photons: a scene that can store nothing ends soon and says so") {
    const photon_options options{.direct = 1000, .caustic = 1000, .indirect = 1000, .pilot_paths = 256};
    const auto nothing_in = [&](const auto& scene, const auto& light, std::size_t most_paths) {
        const auto maps = trace_photons(scene, light, options);
        CHECK(maps.size() == 0);
        for (const auto* map : {&maps.direct, &maps.caustic, &maps.indirect}) {
            CHECK(map->status == map_status::empty);
            CHECK(map->why.find("empty, nothing landed") == 0);
        }
        CHECK(maps.ledger.emitted <= most_paths);
        CHECK(books_close(maps.ledger));
    };
    // Light that leaves the scene; mirrors that lose nothing; mirrors that do; no power at all.
    nothing_in(toy_scene<S, float>{}, lamp, 32 * 256);
    nothing_in(toy_scene<S, float>{.balls = {{.radius = 2, .made_of = {.mirror = S{1}}}}}, lamp, 256);
    nothing_in(toy_scene<S, float>{.balls = {{.radius = 2, .made_of = {.mirror = S{0.9f}}}}}, lamp, 32 * 256);
    auto black = sphere(0.5f);
    black.lobes = lobe_set::all;
    nothing_in(black, support::no_light<S, float>{}, 32 * 256);
}

TEST_CASE("trace_photons: a map says what the host did wrong, not only that it came out thin") {
    const photon_options options{.direct = 1000, .pilot_paths = 256};
    const auto why_of = [&](const auto& scene, const auto& light) {
        return trace_photons(scene, light, options).direct.why;
    };
    CHECK(why_of(sphere(0.5f), lamp) == "full");
    const std::string dark = "empty, nothing landed in 8192 paths, the lights send out no power";
    CHECK(why_of(sphere(0.5f), support::no_light<S, float>{}) == dark);
    const auto has = [](const std::string& why, const std::string& words) {
        return why.find("full, ") == 0 && why.find(" particles dropped: " + words) != std::string::npos;
    };
    using support::flaw;
    CHECK(has(why_of(support::flawed_scene{sphere(0.5f), flaw::long_normal}, lamp), "normals that are not unit"));
    CHECK(has(why_of(support::flawed_scene{sphere(0.5f), flaw::nan_position}, lamp),
              "hits at no place or behind the ray"));
    CHECK(has(why_of(sphere(0.5f), support::flawed_bulb{lamp, support::not_a_number}),
              "particles whose power is no light"));
}

TEST_CASE("trace_photons: black walls absorb all, and nothing is divided by nothing") {
    auto scene = sphere(0);
    scene.lobes = lobe_set::all;
    const auto maps = trace_photons(scene, lamp, {.direct = 100, .indirect = 100, .pilot_paths = 64});
    CHECK(maps.size() == 0);
    CHECK(maps.ledger.absorbed == maps.ledger.emitted);
    CHECK(total(maps.direct) == S{0});
}

TEST_CASE("trace_photons: light too rare for its number of photons is kept, scaled by its own paths") {
    auto r = room();
    r.scene.balls.erase(r.scene.balls.begin());
    const auto maps = trace_photons(r.scene, r.light, {.caustic = 100000, .indirect = 1000, .most_paths = 20000});
    CHECK(maps.caustic.status == map_status::partly);
    CHECK(maps.caustic.paths == 20000);
    CHECK(maps.caustic.size() > 100);
    CHECK(maps.indirect.status == map_status::full);
    CHECK(maps.indirect.paths < 20000);
    // The power of the light that passes the ball does not depend on how many photons were asked for.
    const auto more = trace_photons(r.scene, r.light, {.caustic = 50000, .seed = 1});
    CHECK(more.caustic.status == map_status::full);
    CHECK(total(maps.caustic).x == Approx(total(more.caustic).x).epsilon(0.1));
}

TEST_CASE("trace_photons: indirect light that is a small share of all gets as many photons as its noise is worth") {
    const auto open = open_floor();
    const photon_options wanted{.direct = 2000, .indirect = 100'000};
    photon_options all = wanted;
    all.full_share = 0;
    all.most_paths = 4'000'000;
    const auto maps = trace_photons(open, lamp, wanted);
    const auto sought = trace_photons(open, lamp, all);
    CHECK(sought.indirect.paths == all.most_paths);
    CHECK(maps.indirect.paths < sought.indirect.paths / 8);
    CHECK(maps.indirect.status == map_status::partly);
    CHECK(maps.indirect.why.find("partly filled, one part in ") == 0);
    CHECK(sought.indirect.why.find("partly filled, all ") == 0);
    CHECK(maps.direct.status == map_status::full);
    CHECK(same(maps.direct, sought.direct));
    // What all light strays by on account of the map is no more than where it is full and just worth it.
    const double direct = double(total(sought.direct).x);
    const double indirect = double(total(sought.indirect).x);
    const double share = indirect / (direct + indirect);
    REQUIRE(share < wanted.full_share / 4);
    const double worth = wanted.full_share / std::sqrt(double(wanted.indirect));
    CHECK(share / std::sqrt(double(maps.indirect.size())) < worth);
    // As many paths as where the pilot finds nothing, even where fewer would do.
    CHECK(maps.indirect.paths >= 32 * wanted.pilot_paths);
}

TEST_CASE("trace_photons: the power of indirect photons that were not all sought is right in the mean") {
    const auto open = open_floor();
    const photon_options all{.indirect = 1, .full_share = 0, .paths = {.indirect = 2'000'000}};
    const auto truth = trace_photons(open, lamp, all).indirect;
    sample_mean mean;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        const auto maps = trace_photons(open, lamp, {.indirect = 20'000, .pilot_paths = 512, .seed = seed});
        REQUIRE(maps.indirect.status == map_status::partly);
        mean.add(double(total(maps.indirect).x));
    }
    CAPTURE(mean.mean(), mean.standard_error(), total(truth).x, truth.common);
    CHECK(std::abs(mean.mean() - double(total(truth).x)) <=
          4 * std::hypot(mean.standard_error(), truth.common * double(total(truth).x)));
}

TEST_CASE("trace_photons: rare indirect light is sought by the same paths on 1, 2, 3 and 8 threads") {
    const photon_options options{.direct = 500, .indirect = 20'000, .pilot_paths = 1024};
    const auto one = trace_photons(open_floor(), lamp, options);
    REQUIRE(one.indirect.status == map_status::partly);
    REQUIRE(one.indirect.size() > 10);
    for (const unsigned threads : {2u, 3u, 8u}) {
        CHECK(same(one.indirect, trace_photons(open_floor(), lamp, options, own_threads{threads}).indirect));
    }
}

TEST_CASE("trace_photons: where indirect light has its share, the maps are those of a search for all photons") {
    const auto r = room();
    photon_options options{.direct = 500, .caustic = 500, .indirect = 2000, .reflected = 500};
    const auto maps = trace_photons(r.scene, r.light, options);
    options.full_share = 0;
    const auto all = trace_photons(r.scene, r.light, options);
    CHECK(same(maps.direct, all.direct));
    CHECK(same(maps.caustic, all.caustic));
    CHECK(same(maps.indirect, all.indirect));
    CHECK(same(maps.reflected, all.reflected));
}

TEST_CASE("trace_photons: reflected caustics are worth their share of the caustics, not of all light") {
    // In the room caustics are rare, but what they light up sends them on as brightly as any wall.
    const auto r = room();
    const photon_options options{.caustic = 5000, .reflected = 2500, .full_share = 0.2};
    const auto maps = trace_photons(r.scene, r.light, options);
    const double reflected = double(total(maps.reflected).x);
    const double caustic = double(total(maps.caustic).x);
    REQUIRE(reflected / (reflected + caustic) > 0.2);
    CHECK(maps.reflected.status == map_status::full);
    photon_options choosy = options;
    choosy.full_share = 4 * reflected / (reflected + caustic);
    choosy.pilot_paths = 128;
    const auto fewer = trace_photons(r.scene, r.light, choosy);
    CHECK(fewer.reflected.status == map_status::partly);
    CHECK(fewer.reflected.paths < maps.reflected.paths / 4);
}

TEST_CASE("trace_photons: the power of a few photons is right in the mean, however few were asked for") {
    // Storing until k are full would be k / (k - 1) too bright: a third at 4.
    toy_scene<S, float> floor;
    floor.rectangles = {
        {.corner = {-1, -1, 0}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}, .made_of = {.diffuse = S{0.5f}}}};
    const bulb<S, float> above{.position = {0, 0, 1}, .intensity = S{1 / (4 * pi<float>)}};
    // A side of a cube around the bulb: one sixth of its light.
    sample_mean mean;
    for (std::uint64_t seed = 0; seed < 800; ++seed) {
        const auto maps = trace_photons(floor, above, {.direct = 4, .pilot_paths = 64, .seed = seed});
        mean.add(double(total(maps.direct).x));
    }
    CAPTURE(mean.mean() * 6, mean.standard_error() * 6);
    CHECK(mean.agrees(1.0 / 6));
}

TEST_CASE("trace_photons: caustic light without a map of its own goes with the indirect light") {
    const auto r = room();
    const auto apart = trace_photons(r.scene, r.light, {.caustic = 20000, .indirect = 50000});
    const auto joined = trace_photons(r.scene, r.light, {.indirect = 50000});
    CHECK(joined.caustic.status == map_status::left_out);
    const float caustic = total(apart.caustic).x;
    const float indirect = total(apart.indirect).x;
    CHECK(caustic > 0.03f * indirect);
    CHECK(total(joined.indirect).x == Approx(caustic + indirect).epsilon(0.02));
}

TEST_CASE("trace_photons: reflected caustics are some of the indirect photons once more, and need a caustic map") {
    const auto r = room();
    const photon_paths paths{.caustic = 50000, .indirect = 50000, .reflected = 50000};
    const auto maps = trace_photons(r.scene, r.light, {.caustic = 1, .indirect = 1, .reflected = 1, .paths = paths});
    std::vector<std::array<float, 3>> indirect;
    for (std::size_t i = 0; i < maps.indirect.size(); ++i) {
        const auto p = maps.indirect.position(i);
        indirect.push_back({p.x, p.y, p.z});
    }
    std::sort(indirect.begin(), indirect.end());
    REQUIRE(maps.reflected.size() > 100);
    CHECK(maps.reflected.size() < maps.indirect.size());
    std::size_t found = 0;
    for (std::size_t i = 0; i < maps.reflected.size(); ++i) {
        const auto p = maps.reflected.position(i);
        found += std::binary_search(indirect.begin(), indirect.end(), std::array<float, 3>{p.x, p.y, p.z}) ? 1 : 0;
    }
    CHECK(found == maps.reflected.size());
    CHECK(trace_photons(r.scene, r.light, {.indirect = 100, .reflected = 100}).reflected.status ==
          map_status::left_out);
}

TEST_CASE("trace_photons: every wall of a room of balls takes in as much light as path tracing says") {
    const auto r = room();
    const auto maps = trace_photons(r.scene, r.light, {.direct = 100000, .caustic = 40000, .indirect = 200000});
    const support::material<S> white{.diffuse = S{1}};
    for (std::size_t wall = 0; wall < 6; ++wall) {
        const auto& q = r.scene.rectangles[wall];
        double landed = 0;
        for (const auto* map : {&maps.direct, &maps.caustic, &maps.indirect}) {
            for (std::size_t i = 0; i < map->size(); ++i) {
                const float height = glm::dot(map->position(i) - q.corner, q.normal);
                if (std::abs(height) < 1e-4f) { landed += double(map->photons()[i].power.x); }
            }
        }
        sample_mean flux;
        for (std::uint64_t i = 0; i < 30000; ++i) {
            const random_numbers<float> numbers{{.seed = 9, .path = i}};
            const vec2<float> u = numbers.at(0, purpose::camera).next_2d();
            const support::toy_hit<S, float> here{q.corner + q.u * u.x + q.v * u.y, q.normal, &white, 1e-5f};
            auto random = numbers.at(1, purpose::gather);
            const auto next = here.sample(q.normal, random, lobe_set::diffuse);
            const ray<float> gather{lift(here.position, q.normal, next->wi, 1e-5f), next->wi};
            const S direct = direct_light(r.scene, r.light, here, q.normal, 1e-5f, numbers.at(1, purpose::light),
                                          {.lit = lobe_set::smooth, .scattered = lobe_set::none});
            const S rest = walk_path(r.scene, r.light, gather, numbers.fork(1), emission_rule::indirect).radiance;
            flux.add(4 * pi<double> * double(direct.x + rest.x));
        }
        CAPTURE(wall, landed, flux.mean(), flux.standard_error());
        // One part in a hundred is four standard errors of the photons.
        CHECK(std::abs(landed - flux.mean()) <= 4 * flux.standard_error() + 0.01 * flux.mean());
    }
}

TEST_CASE("trace_photons: only maps without a given number of paths ask the pilot") {
    const auto r = room();
    const auto maps = trace_photons(r.scene, r.light, {.direct = 2000, .indirect = 3000, .paths = {.indirect = 777}});
    CHECK(maps.indirect.paths == 777);
    CHECK(maps.direct.paths > 1000);
    CHECK(maps.direct.size() > 1000);
    const auto capped = trace_photons(r.scene, r.light, {.indirect = 10, .most_paths = 99, .paths = {.indirect = 777}});
    CHECK(capped.indirect.paths == 99);
}

TEST_CASE("trace_photons: stopped early, the power is that of the paths that were walked") {
    std::atomic<int> calls{0};
    const auto maps = trace_photons(sphere(0.5f), lamp, {.direct = 100000, .progress = [&](double share) {
                                                             CHECK((share > 0 && share <= 1));
                                                             return ++calls < 3;
                                                         }});
    CHECK(calls == 3);
    CHECK(maps.direct.size() == 3 * 1024);
    CHECK(maps.direct.paths == 3 * 1024);
    CHECK(maps.direct.status == map_status::partly);
    CHECK(total(maps.direct).y == Approx(8 * pi<float>).epsilon(1e-4));
}

TEST_CASE("trace_photons: a scene without loss is cut at a depth, and the loss is told") {
    auto scene = sphere(1);
    const auto maps = trace_photons(scene, lamp, {.indirect = 100000, .pilot_paths = 16});
    CHECK(maps.ledger.capped == maps.ledger.emitted);
    // 4096 roundings of a weight of one.
    CHECK(maps.ledger.power_capped.x == Approx(maps.ledger.power_emitted.x).epsilon(1e-3));
    CHECK(maps.most_bounces == 4096);
    // Another pass of as many paths has no pilot: it is told.
    const auto next = trace_photons(
        scene, lamp,
        {.indirect = 100000, .paths = {.indirect = maps.indirect.paths}, .most_bounces = maps.most_bounces, .pass = 1});
    CHECK(next.ledger.capped == next.ledger.emitted);
    CHECK(trace_photons(sphere(0.5f), lamp, {.indirect = 1000}).most_bounces == 0);
}

TEST_CASE("trace_photons: geometry by a power of two scales the maps exactly") {
    const auto r = room();
    const photon_options options{.direct = 300, .caustic = 50, .indirect = 300, .pilot_paths = 512};
    const auto here = trace_photons(r.scene, r.light, options);
    for (int k = -30; k <= 30; k += 4) {
        const float s = std::ldexp(1.0f, k);
        auto light = r.light;
        light.shape.corner *= s;
        light.shape.u *= s;
        light.shape.v *= s;
        const auto there = trace_photons(r.scene.scaled(s), light, options);
        REQUIRE(there.indirect.size() == here.indirect.size());
        REQUIRE(there.caustic.size() == here.caustic.size());
        bool exact = true;
        for (std::size_t i = 0; i < here.indirect.size(); ++i) {
            exact = exact && there.indirect.position(i) == here.indirect.position(i) * s &&
                    there.indirect.photons()[i].power == here.indirect.photons()[i].power * (s * s);
        }
        CHECK(exact);
        const vec3<float> p{0.2f, 0.1f, -1};
        CHECK(there.indirect.irradiance(p * s, {0, 0, 1}).value == here.indirect.irradiance(p, {0, 0, 1}).value);
    }
}

TEST_CASE("trace_photons: a brighter light by a power of two brightens the maps exactly") {
    const auto r = room();
    const photon_options options{.indirect = 500, .pilot_paths = 512};
    const auto here = trace_photons(r.scene, r.light, options);
    const auto e = here.indirect.irradiance({0.2f, 0.1f, -1}, {0, 0, 1});
    for (int k = -60; k <= 60; k += 6) {
        auto light = r.light;
        light.shape.made_of.glow *= std::ldexp(1.0f, k);
        const auto there = trace_photons(r.scene, light, options);
        const auto brighter = there.indirect.irradiance({0.2f, 0.1f, -1}, {0, 0, 1});
        CAPTURE(k);
        CHECK(brighter.value == e.value * std::ldexp(1.0f, k));
        CHECK(brighter.error == e.error * std::ldexp(1.0f, k));
    }
}

TEST_CASE("trace_photons: permuted bands give permuted maps") {
    const auto r = room();
    auto turned = r;
    const auto turn = [](S& s) { s = {s.y, s.z, s.x}; };
    for (auto& q : turned.scene.rectangles) { turn(q.made_of.diffuse); }
    turn(turned.light.shape.made_of.glow);
    const auto a = trace_photons(r.scene, r.light, {.indirect = 2000});
    const auto b = trace_photons(turned.scene, turned.light, {.indirect = 2000});
    REQUIRE(a.indirect.size() == b.indirect.size());
    bool exact = true;
    for (std::size_t i = 0; i < a.indirect.size(); ++i) {
        S p = a.indirect.photons()[i].power;
        turn(p);
        exact = exact && p == b.indirect.photons()[i].power && a.indirect.position(i) == b.indirect.position(i);
    }
    CHECK(exact);
}

TEST_CASE("trace_photons: bands of the host's own and gray in double tell the same light") {
    using five = support::bands<5>;
    toy_scene<five, float> scene{.balls = {{.radius = 2, .made_of = {.diffuse = {{0.5f, 0.5f, 0.5f, 0, 1}}}}},
                                 .lobes = lobe_set::diffuse_reflection};
    scene.balls[0].made_of.diffuse.of[4] = 0.25f;
    const bulb<five, float> light{.intensity = {{1, 2, 1, 1, 1}}};
    const auto maps = trace_photons(scene, light, {.direct = 4000, .indirect = 4000});
    toy_scene<double, double> gray{.balls = {{.radius = 2, .made_of = {.diffuse = 0.5}}}};
    const auto same_maps = trace_photons(gray, bulb<double, double>{.intensity = 1.0}, {.indirect = 4000});
    double bands = 0;
    double double_gray = 0;
    for (const auto& p : maps.indirect.photons()) { bands += double(p.power.of[0]); }
    for (const auto& p : same_maps.indirect.photons()) { double_gray += p.power; }
    CHECK(bands == Approx(4 * pi<double>).epsilon(0.05));
    CHECK(double_gray == Approx(4 * pi<double>).epsilon(0.05));
    for (const auto& p : maps.indirect.photons()) { REQUIRE(p.power.of[3] == 0); }
}

TEST_CASE("trace_photons: a flawed light spoils only its own particles") {
    const float broken = std::numeric_limits<float>::quiet_NaN();
    const auto scene = sphere(0.5f);
    const support::flawed_bulb flawed{{.intensity = S{1}}, broken, false};
    const auto maps = trace_photons(scene, flawed, {.direct = 2000, .indirect = 2000});
    CHECK(maps.ledger.dropped > 0);
    for (const auto& p : maps.indirect.photons()) { REQUIRE(is_radiance(p.power)); }
    // Half of the sphere is lit, as by the sound half of the particles.
    CHECK(total(maps.direct).x == Approx(2 * pi<float>).epsilon(0.02));
}

TEST_CASE("trace_photons: an empty pilot is refused") {
    CHECK_THROWS_AS(trace_photons(sphere(0.5f), lamp, {.indirect = 1, .pilot_paths = 0}), std::invalid_argument);
}

TEST_CASE("trace_photons: the flux of a map strays from seed to seed no farther than the map says") {
    const testing::furnace_light<float> light{.radius = 2, .glow = 1};
    for (const float albedo : {0.5f, 0.9f}) {
        const testing::furnace_sphere<float> scene{.radius = 2, .albedo = albedo, .glow = 1};
        constexpr std::size_t paths = 1500;
        sample_mean flux;
        sample_mean said;
        for (std::uint64_t seed = 0; seed < 128; ++seed) {
            const auto maps = trace_photons(scene, light, {.indirect = 1, .paths = {.indirect = paths}, .seed = seed});
            double sum = 0;
            for (const auto& p : maps.indirect.photons()) { sum += double(p.power); }
            flux.add(sum);
            said.add(maps.indirect.common);
        }
        const double strays = std::sqrt(flux.variance()) / flux.mean();
        CAPTURE(albedo, strays, said.mean());
        // By algebra: a path lands k times more with probability (1 - rho) rho^k.
        CHECK(said.mean() == Approx(1 / std::sqrt(double(albedo) * paths)).epsilon(0.05));
        // Halton's points stray less than chance, above all where paths are short. A standard deviation of 128 is
        // known to 6 %.
        CHECK(strays < 1.25 * said.mean());
        CHECK(strays > said.mean() / 3);
    }
    // Straight from the light all power lands, always.
    const testing::furnace_sphere<float> black{.radius = 2, .glow = 1};
    CHECK(trace_photons(black, light, {.direct = 1000}).direct.common < 1e-6);
}
