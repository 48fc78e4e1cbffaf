#include <aglow/algorithms/path_walk.hpp>

#include <limits>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>

#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;
using support::met_panel;
using support::panel;
using support::toy_hit;
using support::toy_scene;

namespace {

using S = glm::vec3;

random_numbers<float> numbers_of(std::uint64_t path) { return random_numbers<float>{{.seed = 2, .path = path}}; }

/// A sky of even radiance that nobody looks at.
struct plain_sky : support::no_light<S, float> {
    [[nodiscard]] S escaped(const vec3<float>&) const { return S{1}; }
};

/// The same, looked at: uniformly over the sphere.
struct seen_sky : plain_sky {
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<S, float>> illuminate(const vec3<float>&, R& random) const {
        const vec3<float> d = uniform_sphere(vec2<float>(random.next_2d()));
        return illumination<S, float>{d, std::numeric_limits<float>::infinity(), S{4 * pi<float>}, 1 / (4 * pi<float>)};
    }
    [[nodiscard]] float escaped_pdf(const vec3<float>&, const vec3<float>&) const { return 1 / (4 * pi<float>); }
};

/// A floor under a square light of half-width `half` at height 1.
template <typename Light>
struct lit_floor {
    toy_scene<S, float> scene{};
    Light light{};

    lit_floor(const support::material<S>& floor, float half) {
        scene.rectangles = {
            {.corner = {-4, -4, 0}, .u = {8, 0, 0}, .v = {0, 8, 0}, .normal = {0, 0, 1}, .made_of = floor}};
        light.shape = {.corner = {-half, -half, 1},
                       .u = {2 * half, 0, 0},
                       .v = {0, 2 * half, 0},
                       .normal = {0, 0, -1},
                       .made_of = {.glow = S{1}}};
        scene.rectangles.push_back(light.shape);
    }
};

template <typename World, typename Lights>
sample_mean radiance(const World& scene, const Lights& light, const ray<float>& eye, std::uint64_t count,
                     const path_options& options = {}) {
    sample_mean mean;
    for (std::uint64_t i = 0; i < count; ++i) {
        mean.add(double(walk_path(scene, light, eye, numbers_of(i), emission_rule::all, options).radiance.x));
    }
    return mean;
}

const ray<float> slanted{{-0.8f, 0.1f, 0.7f}, glm::normalize(vec3<float>{1, 0, -1})};

bool agree(const sample_mean& a, const sample_mean& b) {
    return std::abs(a.mean() - b.mean()) <= 4 * std::hypot(a.standard_error(), b.standard_error());
}

}  // namespace

TEST_CASE("path_walk: with and without a share of scattered rays, small and large lights have one mean") {
    const support::material<S> matte{.diffuse = S{0.8f}};
    const support::material<S> mixed{.diffuse = S{0.3f}, .glossy = S{0.4f}, .mirror = S{0.2f}, .exponent = 60};
    for (const auto& floor : {matte, mixed}) {
        for (const float half : {0.02f, 0.3f, 3.0f}) {
            const lit_floor<met_panel<S, float>> both{floor, half};
            const lit_floor<panel<S, float>> one{floor, half};
            const auto shared = radiance(both.scene, both.light, slanted, 30000);
            const auto alone = radiance(one.scene, one.light, slanted, 30000);
            CAPTURE(half, shared.mean(), alone.mean(), shared.standard_error(), alone.standard_error());
            CHECK(agree(shared, alone));
            CHECK(shared.mean() > 0);
        }
    }
    // A large light behind gloss is what the sharing is for.
    const lit_floor<met_panel<S, float>> both{mixed, 3};
    const lit_floor<panel<S, float>> one{mixed, 3};
    CHECK(radiance(both.scene, both.light, slanted, 5000).variance() <
          radiance(one.scene, one.light, slanted, 5000).variance());
}

TEST_CASE("path_walk: a sky that is looked at and one that is not are equally bright") {
    toy_scene<S, float> scene;
    scene.rectangles = {{.corner = {-4, -4, 0},
                         .u = {8, 0, 0},
                         .v = {0, 8, 0},
                         .normal = {0, 0, 1},
                         .made_of = {.diffuse = S{0.3f}, .glossy = S{0.3f}, .mirror = S{0.2f}}}};
    const auto plain = radiance(scene, plain_sky{}, slanted, 20000);
    const auto seen = radiance(scene, seen_sky{}, slanted, 20000);
    CHECK(agree(plain, seen));
    toy_scene<S, float> matte = scene;
    matte.rectangles[0].made_of = {.diffuse = S{0.5f}};
    CHECK(radiance(matte, seen_sky{}, slanted, 20000).agrees(0.5));
    // Every path of the plain sky meets it with weight one half.
    CHECK(radiance(matte, plain_sky{}, slanted, 100).mean() == Approx(0.5).epsilon(1e-5));
}

TEST_CASE("path_walk: glass in an even sky cannot be seen, whatever its index and what it holds") {
    for (const double index : {1.0, 1.000001, 1.5, 2.4, 100.0}) {
        toy_scene<S, float> scene{
            .balls = {{.radius = 1, .made_of = {.glass = index}}, {.radius = 0.5f, .made_of = {.glass = 1.3}}}};
        for (std::uint64_t i = 0; i < 300; ++i) {
            random_sampler<float> random{mix(i)};
            const vec2<float> u = random.next_2d() * 2.0f - 1.0f;
            const ray<float> eye{{u.x, u.y, -3}, {0, 0, 1}};
            const auto light = walk_path(scene, plain_sky{}, eye, numbers_of(i));
            REQUIRE(light.radiance.x == Approx(1).epsilon(1e-4));
        }
    }
}

TEST_CASE("path_walk: an emission rule leaves to the asker exactly what he finds himself") {
    // The light ahead; and the light behind, seen in a mirror ahead.
    met_panel<S, float> light;
    light.shape = {
        .corner = {-1, -1, 2}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, -1}, .made_of = {.glow = S{3}}};
    toy_scene<S, float> scene;
    scene.rectangles = {light.shape};
    const ray<float> at_light{{0, 0, 1}, {0, 0, 1}};
    const auto seen = [&](const ray<float>& r, emission_rule rule) {
        return walk_path(scene, light, r, numbers_of(0), rule).radiance.x;
    };
    CHECK(seen(at_light, emission_rule::all) == 3);
    CHECK(seen(at_light, emission_rule::indirect) == 0);
    CHECK(seen(at_light, emission_rule::no_caustics) == 0);
    scene.rectangles.push_back(
        {.corner = {-1, -1, 0}, .u = {2, 0, 0}, .v = {0, 2, 0}, .normal = {0, 0, 1}, .made_of = {.mirror = S{0.5f}}});
    const ray<float> at_mirror{{0, 0, 1}, {0, 0, -1}};
    CHECK(seen(at_mirror, emission_rule::all) == 1.5f);
    CHECK(seen(at_mirror, emission_rule::indirect) == 1.5f);
    CHECK(seen(at_mirror, emission_rule::no_caustics) == 0);
}

TEST_CASE("path_walk: a sky that is looked at follows the same rules, one that is not is always met") {
    const toy_scene<S, float> empty;
    const ray<float> r{{0, 0, 0}, {0, 0, 1}};
    const auto with = [&](const auto& sky, emission_rule rule) {
        return walk_path(empty, sky, r, numbers_of(0), rule);
    };
    CHECK(with(plain_sky{}, emission_rule::all).radiance.x == 1);
    CHECK(with(plain_sky{}, emission_rule::indirect).radiance.x == 1);
    CHECK(with(seen_sky{}, emission_rule::all).radiance.x == 1);
    CHECK(with(seen_sky{}, emission_rule::indirect).radiance.x == 0);
    CHECK_FALSE(is_finite(with(plain_sky{}, emission_rule::all).distance));
}

TEST_CASE("path_walk: direct light and a gather ray together are all there is") {
    const auto room = support::room_with_balls<S, float>(S{0.6f}, S{5});
    const support::material<S> matte{.diffuse = S{0.6f}};
    const toy_hit<S, float> here{{0.1f, -0.6f, -1}, {0, 0, 1}, &matte, 1e-5f};
    const vec3<float> wo{0, 0, 1};
    sample_mean apart;
    sample_mean whole;
    for (std::uint64_t i = 0; i < 60000; ++i) {
        const auto numbers = numbers_of(i);
        const S direct = direct_light(room.scene, room.light, here, wo, 1e-5f, numbers.at(1, purpose::light),
                                      {.lit = lobe_set::smooth, .scattered = lobe_set::none});
        auto random = numbers.at(1, purpose::gather);
        const auto next = here.sample(wo, random, lobe_set::diffuse);
        const ray<float> r{lift(here.position, here.normal, next->wi, 1e-5f), next->wi};
        const auto gathered = walk_path(room.scene, room.light, r, numbers.fork(1), emission_rule::indirect);
        apart.add(double(direct.x + next->weight.x * gathered.radiance.x));
        const ray<float> eye{{0.1f, -0.6f, -0.9f}, {0, 0, -1}};
        whole.add(double(walk_path(room.scene, room.light, eye, numbers).radiance.x));
    }
    CAPTURE(apart.mean(), whole.mean(), apart.standard_error(), whole.standard_error());
    CHECK(agree(apart, whole));
}

TEST_CASE("path_walk: the distance is that of the first surface") {
    const lit_floor<met_panel<S, float>> f{{.diffuse = S{0.5f}}, 0.1f};
    const auto light = walk_path(f.scene, f.light, ray<float>{{2, 0, 3}, {0, 0, -1}}, numbers_of(0));
    CHECK(light.distance == 3);
}

TEST_CASE("path_walk: a terminal answers for diffuse lobes, or lets the path go on") {
    const toy_scene<S, float> sphere{.balls = {{.radius = 2, .made_of = {.diffuse = S{0.5f}, .mirror = S{0.25f}}}}};
    const support::bulb<S, float> lamp{.intensity = S{1}};
    const ray<float> eye{{0, 0, 0}, {0, 0, 1}};
    int asked = 0;
    const auto answer = [&](const auto& hit, const vec3<float>& wo, float travelled, float error, bool mirrored) {
        ++asked;
        CHECK(mirrored);
        CHECK(glm::distance(hit.position, {0, 0, travelled}) < 1e-5f);
        CHECK(wo == vec3<float>{0, 0, -1});
        CHECK(error > 0);
        return std::optional<estimate<S>>{{S{7}, 0.5f}};
    };
    const path_options once{.most_bounces = 1};
    const auto light = walk_path(sphere, lamp, eye, numbers_of(0), emission_rule::all, once, answer);
    // The diffuse lobe says 7; the mirror's second surface is beyond the cap.
    CHECK(light.radiance.x == 7);
    CHECK(light.error == 0.5f);
    CHECK(asked == 1);
    const auto never = [](const auto&...) { return std::optional<estimate<S>>{}; };
    for (std::uint64_t i = 0; i < 50; ++i) {
        const auto a = walk_path(sphere, lamp, eye, numbers_of(i), emission_rule::all, {}, never);
        CHECK(a.radiance == walk_path(sphere, lamp, eye, numbers_of(i)).radiance);
    }
}

TEST_CASE("path_walk: a terminal is told the whole way over mirrors, and after a matte surface the way from there") {
    // Down to a mirror, up to a matte ceiling, and from there to wherever.
    toy_scene<S, float> scene;
    scene.rectangles = {
        {.corner = {-9, -9, 0}, .u = {18, 0, 0}, .v = {0, 18, 0}, .normal = {0, 0, 1}, .made_of = {.mirror = S{1}}},
        {.corner = {-9, -9, 2}, .u = {18, 0, 0}, .v = {0, 18, 0}, .normal = {0, 0, 1}, .made_of = {.diffuse = S{1}}}};
    const ray<float> eye{{0, 0, 1}, {0, 0, -1}};
    for (std::uint64_t i = 0; i < 20; ++i) {
        std::vector<float> ways;
        std::vector<vec3<float>> places;
        const auto note = [&](const auto& hit, const auto&, float travelled, float, bool) {
            ways.push_back(travelled);
            places.push_back(hit.position);
            return std::optional<estimate<S>>{};
        };
        (void)walk_path(scene, support::no_light<S, float>{}, eye, numbers_of(i), emission_rule::all,
                        {.most_bounces = 4}, note);
        REQUIRE_FALSE(ways.empty());
        CHECK(ways[0] == Approx(3));
        // Ceiling, mirror, ceiling: both legs of a V, as long as the way to the mirror image.
        if (ways.size() < 2) { continue; }
        CHECK(ways[1] == Approx(std::hypot(glm::distance(places[0], places[1]), 4)));
    }
}

TEST_CASE("path_walk: a depth cap of n keeps n surfaces that scatter") {
    // Point light in a matte sphere: the k-th surface adds rho^k of the same brightness.
    const toy_scene<S, float> sphere{.balls = {{.radius = 1, .made_of = {.diffuse = S{0.5f}}}}};
    const support::bulb<S, float> lamp{.intensity = S{pi<float>}};
    const ray<float> eye{{0.1f, 0, 0}, {0, 0, 1}};
    for (const std::uint32_t cap : {1u, 2u, 5u}) {
        const auto mean = radiance(sphere, lamp, eye, 2000, {.most_bounces = cap, .roulette_from = 100});
        CHECK(mean.agrees(1 - std::ldexp(1.0, -static_cast<int>(cap)), 4, 1e-5));
    }
}

TEST_CASE("path_walk: between perfect mirrors a path ends") {
    const toy_scene<S, float> mirrors{.balls = {{.radius = 2, .made_of = {.mirror = S{1}}}}};
    const auto light = walk_path(mirrors, support::no_light<S, float>{}, slanted, numbers_of(0));
    CHECK(light.radiance == S{0});
}

TEST_CASE("path_walk: flawed hosts darken, and never break a sum") {
    auto room = support::room_with_balls<S, float>(S{0.6f}, S{1});
    room.scene.balls.clear();
    const ray<float> eye{{0, 0, 0}, glm::normalize(vec3<float>{0.1f, 0.2f, -1})};
    const support::flawed_scene sound{room.scene, support::flaw::none};
    const auto truth = radiance(sound, room.light, eye, 4000);
    for (const support::flaw wrong : support::all_flaws) {
        const support::flawed_scene scene{room.scene, wrong};
        sample_mean mean;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const auto light = walk_path(scene, room.light, eye, numbers_of(i));
            REQUIRE(is_radiance(light.radiance));
            mean.add(double(light.radiance.x));
        }
        CAPTURE(static_cast<int>(wrong), mean.mean(), truth.mean());
        CHECK(mean.mean() > 0.3 * truth.mean());
        CHECK(mean.mean() < truth.mean() * 1.001 + 4 * truth.standard_error());
    }
}
