// Every integrator with the smallest host there is: it compiles, so it asks for no more than the concepts; and it finds
// the closed form, so the concepts say enough. Inside a matte unit sphere of albedo r, with a light of intensity I at
// the centre, the radiance is I r / (pi (1 - r)) everywhere: I / pi for r = 1/2.
#include "support/archetypes.hpp"

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/path_guide.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/algorithms/trace_photons.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

namespace {

using aglow::vec3;

static_assert(aglow::Emitter<archetypes::lamp<float>> && aglow::Illuminator<archetypes::lamp<double>>);

template <typename T>
archetypes::spectrum<T> intensity() {
    return archetypes::spectrum<T>::of(aglow::pi<T>, aglow::pi<T> / 4);
}

/// A ray from near the centre; the unit square goes around the whole sphere.
template <typename T>
aglow::ray<T> all_around(const aglow::vec2<T>& u) {
    return {{T(0.1), T(0.2), T(-0.1)}, aglow::uniform_sphere(glm::clamp(u, T(0), T(1)))};
}

/// Radiance in both bands along rays from near the centre; should be 1 and 1/4.
template <typename T, typename Integrator>
std::vector<statistics::sample_mean> radiance(const Integrator& integrator, std::uint64_t rays) {
    std::vector<statistics::sample_mean> bands(2);
    for (std::uint64_t i = 0; i < rays; ++i) {
        const archetypes::numbers<T> numbers{{1, 0, i}};
        aglow::random_sampler<T> random{aglow::mix(i)};
        const archetypes::spectrum<T> seen = integrator(all_around<T>(random.next_2d()), numbers).value;
        bands[0].add(double(seen.bands()[0]));
        bands[1].add(double(seen.bands()[1]));
    }
    return bands;
}

}  // namespace

TEMPLATE_TEST_CASE("archetypes: path tracing finds the closed form", "", float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    const archetypes::illuminator<T> light{intensity<T>()};
    const auto bands = radiance<T>(aglow::path_tracer{scene, light}, 20'000);
    INFO(bands[0].mean() << ", " << bands[1].mean());
    CHECK(bands[0].agrees(1, 4));
    CHECK(bands[1].agrees(0.25, 4));
}

TEMPLATE_TEST_CASE("archetypes: guided paths find the closed form", "", float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    const archetypes::lamp<T> light{intensity<T>()};
    const aglow::path_guide guide{scene, light, aglow::path_guide_options{}, archetypes::executor{}};
    const auto bands = radiance<T>(aglow::guided_path_tracer{scene, light, guide}, 20'000);
    CHECK(bands[0].agrees(1, 4));
    CHECK(bands[1].agrees(0.25, 4));
}

TEMPLATE_TEST_CASE("archetypes: photons keep the books of the closed form", "", float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    const archetypes::emitter<T> light{intensity<T>()};
    const archetypes::executor run;
    const auto maps = aglow::trace_photons(scene, light, {.direct = 5000, .indirect = 5000}, run);
    CHECK(maps.direct.status == aglow::map_status::full);
    CHECK(maps.indirect.status == aglow::map_status::full);
    CHECK(maps.ledger.escaped == 0);
    CHECK(maps.ledger.dropped == 0);
}

TEMPLATE_TEST_CASE("archetypes: the photon map, gathered and cached too, is within a hundredth of the closed form", "",
                   float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    const archetypes::lamp<T> light{intensity<T>()};
    const archetypes::executor run;
    const auto near_truth = [](const auto& integrator, std::uint64_t rays) {
        const auto bands = radiance<T>(integrator, rays);
        INFO(bands[0].mean() << ", " << bands[1].mean());
        CHECK(bands[0].mean() == Approx(1).epsilon(0.01));
        CHECK(bands[1].mean() == Approx(0.25).epsilon(0.01));
    };
    const auto eye = [](const aglow::vec2<T>& film) { return all_around<T>(film * (T(1) / 16)); };
    aglow::bounds<T> box;
    box.add({-1, -1, -1});
    box.add({1, 1, 1});
    const aglow::caching_options caching{.view = {.width = 16, .height = 16}};
    near_truth(aglow::irradiance_caching{scene, light, box, eye, caching, run}, 200);
    near_truth(
        aglow::gather_caching{
            scene, light, box, eye, {.photons = {.direct = 5000, .indirect = 20'000}, .caching = caching}, run},
        200);
    near_truth(aglow::photon_mapping{scene, light, {.photons = {.indirect = 20'000}}, run}, 1000);
    near_truth(aglow::final_gathering{scene, light, {.photons = {.direct = 5000, .indirect = 20'000}}, run}, 200);
}

TEMPLATE_TEST_CASE("archetypes: a room without mirrors has no caustics anywhere", "", float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    const archetypes::lamp<T> light{intensity<T>()};
    const auto eye = [](const aglow::vec2<T>& film) { return all_around<T>(film * (T(1) / 16)); };
    const auto seen = aglow::caustic_light(scene, light, eye, 16, 16, {.photons = 1000}, archetypes::executor{});
    REQUIRE(seen.size() == 16 * 16);
    for (const auto& level : seen) { CHECK(level == 0); }
}

namespace {

using world = archetypes::scene<float>;
using lamp = archetypes::lamp<float>;
using seen = aglow::spectrum_of<world>;
using camera = aglow::ray<float> (*)(const aglow::vec2<float>&);

/// Whether a `Kept` can be made of a scene, lights and the rest, but not where either is a temporary.
template <typename Kept, typename... Rest>
constexpr bool outlives_nothing =
    std::is_constructible_v<Kept, const world&, const lamp&, Rest...>&&
        std::is_constructible_v<Kept, world&, lamp&, Rest...> &&
    !std::is_constructible_v<Kept, world, lamp&, Rest...> &&
    !std::is_constructible_v<Kept, const world, const lamp&, Rest...> &&
    !std::is_constructible_v<Kept, const world&, lamp, Rest...> && !std::is_constructible_v<Kept, world, lamp, Rest...>;

}  // namespace

TEST_CASE("archetypes: what keeps a scene and lights takes no temporary ones") {
    using box = aglow::bounds<float>;
    CHECK(outlives_nothing<aglow::path_tracer<world, lamp>>);
    CHECK(outlives_nothing<aglow::path_tracer<world, lamp>, aglow::path_options>);
    CHECK(outlives_nothing<aglow::guided_path_tracer<world, lamp>, const aglow::path_guide<float>&>);
    CHECK(outlives_nothing<aglow::photon_mapping<world, lamp>>);
    CHECK(outlives_nothing<aglow::final_gathering<world, lamp>, aglow::final_gathering_options>);
    CHECK(outlives_nothing<aglow::irradiance_caching<world, lamp>, box, camera>);
    CHECK(outlives_nothing<aglow::gather_caching<world, lamp>, box, camera>);
    CHECK(outlives_nothing<aglow::progressive_photon_mapping<world, lamp>>);
    CHECK(outlives_nothing<aglow::photon_source<world, lamp>, const aglow::irradiance_points<seen, float>&>);
    CHECK(outlives_nothing<aglow::direct_layer<world, lamp>>);
    CHECK(outlives_nothing<aglow::layered_integrator<world, lamp, aglow::direct_layer<world, lamp>>,
                           aglow::direct_layer<world, lamp>>);
}

TEST_CASE("archetypes: what keeps a guide, a map, a cache, a camera or an integrator takes no temporary one") {
    using tracer = aglow::path_tracer<world, lamp>;
    using guided = aglow::guided_path_tracer<world, lamp>;
    CHECK_FALSE(std::is_constructible_v<guided, world&, lamp&, aglow::path_guide<float>>);
    using maps = aglow::photon_maps<seen, float>;
    using layer = aglow::map_layer<seen, float>;
    CHECK(std::is_constructible_v<layer, decltype((std::declval<maps&>().caustic))>);
    CHECK_FALSE(std::is_constructible_v<layer, decltype((std::declval<maps>().caustic))>);
    CHECK(std::is_constructible_v<layer, const aglow::photon_map<seen, float>&>);
    CHECK_FALSE(std::is_constructible_v<layer, aglow::photon_map<seen, float>>);
    using cache = aglow::frozen_irradiance_cache<seen, float>;
    using cached = aglow::cache_layer<cache, aglow::ray_reader<tracer>>;
    CHECK(std::is_constructible_v<cached, const cache&, aglow::ray_reader<tracer>>);
    CHECK_FALSE(std::is_constructible_v<cached, cache, aglow::ray_reader<tracer>>);
    using probe = aglow::pixel_probe<camera, tracer>;
    CHECK(std::is_constructible_v<probe, const camera&, const tracer&, std::size_t>);
    CHECK_FALSE(std::is_constructible_v<probe, const camera&, tracer, std::size_t>);
    CHECK_FALSE(std::is_constructible_v<probe, camera, const tracer&, std::size_t>);
}
