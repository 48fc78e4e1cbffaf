#include "common/probe_paths.hpp"

#include <cstddef>
#include <cstdint>

#include <glm/vec3.hpp>

#include "common/scene.hpp"
#include "common/scenes/registry.hpp"
#include "support/catch.hpp"

namespace {

using rgb = glm::vec3;
using host::probe_kind;
using host::probe_paths;
template <typename Scene>
using counted = host::counted_scene<Scene>;
constexpr std::size_t side = 16;

template <typename World>
auto eye_of(const World& world) {
    return [&world](const aglow::vec2<float>& film) { return world.view().through(film, side, side); };
}

/// Pixels in which a few samples of the two differ.
template <typename World, typename A, typename B>
std::size_t differing(const World& world, const A& a, const B& b) {
    const auto eye = eye_of(world);
    const aglow::pixel_probe first{eye, a, side};
    const aglow::pixel_probe second{eye, b, side};
    std::size_t count = 0;
    for (std::size_t i = 0; i < side * side; ++i) { count += first(i, 3, 8) != second(i, 3, 8) ? 1 : 0; }
    return count;
}

/// Sends `rays` of them, and shadow rays half as often, for each sample.
template <typename World>
struct ray_sender {
    using spectrum = rgb;
    using scalar = float;
    const World& world;
    int rays;

    template <typename N>
    aglow::estimate<rgb> operator()(const aglow::ray<float>& eye, const N&) const {
        for (int i = 0; i < rays; ++i) {
            (void)world.intersect(eye);
            if (i % 2 == 1) { (void)world.occluded(eye.origin, {278, 278, 278}); }
        }
        return {};
    }
};

}  // namespace

TEST_CASE("probe_paths: paths are guided in the box with glass alone, and are plain ones, bit by bit, where not") {
    const counted<host::scene<float>> glass{*host::scenes::find<float>("cornell-glass")};
    const counted<host::scene<float>> matte{*host::scenes::find<float>("cornell-diffuse")};
    const counted<host::diffuse_scene<float>> known{*host::scenes::find<float>("cornell-diffuse")};
    const aglow::own_threads run{2};
    const probe_paths in_glass{glass, glass.lights(), 0, run};
    const probe_paths by_chance{glass, glass.lights(), 0, run, probe_kind::path};
    const probe_paths in_matte{matte, matte.lights(), 0, run};
    const probe_paths in_known{known, known.lights(), 0, run};
    CHECK(in_glass.guided());
    CHECK_FALSE(by_chance.guided());
    CHECK_FALSE(in_matte.guided());
    CHECK_FALSE(in_known.guided());
    const aglow::path_tracer plain_in_glass{glass, glass.lights()};
    CHECK(differing(glass, in_glass.tracer(), plain_in_glass) > side * side / 4);
    CHECK(differing(glass, by_chance.tracer(), plain_in_glass) == 0);
    CHECK(differing(matte, in_matte.tracer(), aglow::path_tracer{matte, matte.lights()}) == 0);
    CHECK(differing(known, in_known.tracer(), aglow::path_tracer{known, known.lights()}) == 0);
}

TEST_CASE("probe_paths: costs are the rays that are sent, those of threads of a guide too, and no others") {
    const counted<host::scene<float>> glass{*host::scenes::find<float>("cornell-glass")};
    CHECK(host::rays_a_sample(eye_of(glass), ray_sender<counted<host::scene<float>>>{glass, 4}, side, side, 1) == 6);
    const probe_paths alone{glass, glass.lights(), 0, aglow::own_threads{1}};
    const probe_paths together{glass, glass.lights(), 0, aglow::own_threads{3}};
    const probe_paths by_chance{glass, glass.lights(), 0, aglow::own_threads{1}, probe_kind::path};
    CHECK(alone.guide_cost() > 10'000);  // 17,500 photons, each at the end of a ray
    CHECK(alone.guide_cost() == together.guide_cost());
    CHECK(alone.guiding_cost() > 0);
    CHECK(by_chance.guide_cost() == 0);
    CHECK(by_chance.guiding_cost() == 0);
    CHECK(host::sample_lookups{.caches = 1, .maps = 2}.cost() == 17);
}
