#include <aglow/algorithms/preparation.hpp>

#include <cmath>
#include <optional>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"

using namespace aglow;
using testing::furnace_light;
using testing::furnace_sphere;

namespace {

using phase = preparation_phase;
using told = std::vector<preparation>;
using furnace = furnace_sphere<float>;
using lamp = furnace_light<float>;

const furnace room{.radius = 2, .albedo = 0.5f, .glow = 1};
const lamp glow{.radius = 2, .glow = 1};
const bounds<float> box{{-2, -2, -2}, {2, 2, 2}};
constexpr float truth = 2;  // 1 / (1 - albedo)

/// The furnace with a mirror for a side, which `eye` does not see; as bright as all else, since half of what it mirrors
/// is lost.
struct mirrored_wall : testing::furnace_wall<float, float> {
    bool mirrors{false};

    [[nodiscard]] lobe_set lobes() const { return mirrors ? lobe_set::specular_reflection : lambert::lobes(); }
    [[nodiscard]] float evaluate(const vec3<float>& wo, const vec3<float>& wi, lobe_set asked) const {
        return mirrors ? 0 : lambert::evaluate(wo, wi, asked);
    }
    [[nodiscard]] float pdf(const vec3<float>& wo, const vec3<float>& wi, lobe_set asked) const {
        return mirrors ? 0 : lambert::pdf(wo, wi, asked);
    }
    template <Sampler R>
    [[nodiscard]] std::optional<scatter_sample<float, float>> sample(const vec3<float>& wo, R& random,
                                                                     lobe_set asked) const {
        if (!mirrors) { return lambert::sample(wo, random, asked); }
        if (!any(asked, lobe_set::specular_reflection)) { return std::nullopt; }
        return scatter_sample<float, float>{normal * (2 * glm::dot(normal, wo)) - wo, albedo, 0,
                                            lobe_set::specular_reflection};
    }
};

struct mirrored_furnace {
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection | lobe_set::specular_reflection;

    [[nodiscard]] std::optional<mirrored_wall> intersect(const ray<float>& r) const {
        const auto wall = room.intersect(r);
        if (!wall) { return std::nullopt; }
        return mirrored_wall{*wall, wall->normal.x > 0.8f};
    }
    [[nodiscard]] bool occluded(const vec3<float>&, const vec3<float>&) const { return false; }
};

const mirrored_furnace mirrored_room;

ray<float> eye(const vec2<float>& film) {
    return {{0.1f, 0.2f, -0.3f}, glm::normalize(vec3<float>{film.x - 4, film.y - 4, 4})};
}

/// Each integrator once, as `make(run, progress)`.
template <typename Use>
void for_each_integrator(const Use& use) {
    const photon_options photons{.direct = 2000, .indirect = 20'000};
    const caching_options caching{.fill = {.rays = 256}, .view = {.width = 8, .height = 8}};
    use("photon map", std::vector{phase::photons}, [=](const auto& run, const auto& progress) {
        return photon_mapping{room, glow, {.photons = photons}, run, progress};
    });
    use("final gather", std::vector{phase::photons, phase::irradiance}, [=](const auto& run, const auto& progress) {
        return final_gathering{room, glow, {.photons = photons, .rays = 16}, run, progress};
    });
    use("irradiance cache", std::vector{phase::places, phase::records}, [=](const auto& run, const auto& progress) {
        return irradiance_caching{room, glow, box, eye, caching, run, progress};
    });
    use("irradiance cache beside caustics", std::vector{phase::photons, phase::places, phase::records},
        [=](const auto& run, const auto& progress) {
            caching_options options = caching;
            options.caustics.photons.caustic = 20'000;
            return irradiance_caching{mirrored_room, glow, box, eye, options, run, progress};
        });
    use("gather cache", std::vector{phase::photons, phase::irradiance, phase::places, phase::records},
        [=](const auto& run, const auto& progress) {
            gather_caching_options options;
            options.photons = photons;
            options.caching = caching;
            return gather_caching{room, glow, box, eye, options, run, progress};
        });
}

/// The map that most photons were wanted for.
template <typename Maps>
const auto& main_map(const Maps& maps) {
    return maps.indirect.wanted > 0 ? maps.indirect : maps.caustic;
}

/// What a few rays see.
template <typename Integrator>
std::vector<float> look(const Integrator& integrator, std::uint64_t rays = 64) {
    std::vector<float> seen;
    for (std::uint64_t i = 0; i < rays; ++i) {
        const random_numbers<float> numbers{{.seed = 3, .path = i}};
        seen.push_back(integrator(eye({float(i % 8) + 0.5f, float(i / 8 % 8) + 0.5f}), numbers).value);
    }
    return seen;
}

}  // namespace

TEST_CASE("preparation: every phase is told from its beginning to its end, in order, and never falls") {
    for_each_integrator([](const char* name, const std::vector<phase>& phases, const auto& make) {
        CAPTURE(name);
        told heard;
        (void)make(in_sequence{}, [&](const preparation& p) {
            heard.push_back(p);
            return true;
        });
        REQUIRE_FALSE(heard.empty());
        std::vector<phase> seen{heard.front().phase};
        CHECK(heard.front().share == 0);
        for (std::size_t i = 1; i < heard.size(); ++i) {
            if (heard[i].phase == heard[i - 1].phase) {
                CHECK(heard[i].share >= heard[i - 1].share);
                continue;
            }
            CHECK(heard[i - 1].share == 1);
            CHECK(heard[i].share == 0);
            seen.push_back(heard[i].phase);
        }
        CHECK(heard.back().share == 1);
        CHECK(seen == phases);
    });
}

TEST_CASE("preparation: photons are a phase of a cache only where the scene can have caustics, and some are wanted") {
    using scene_type = support::toy_scene<float, float>;
    const scene_type scene{.rectangles = {{{-2, -2, 1}, {4, 0, 0}, {0, 4, 0}, {0, 0, -1}, {.diffuse = 0.5f}}}};
    const support::bulb<float> bulb{{0, 0, 0}, 1};
    const auto phases_of = [&](lobe_set lobes, std::size_t caustic) {
        scene_type stated = scene;
        stated.lobes = lobes;
        std::vector<phase> phases;
        const caching_options options{.view = {.width = 8, .height = 8},
                                      .caustics = {.photons = {.caustic = caustic, .pilot_paths = 64}}};
        (void)irradiance_caching{stated, bulb, box, eye, options, in_sequence{}, [&](const preparation& p) {
                                     if (phases.empty() || phases.back() != p.phase) { phases.push_back(p.phase); }
                                     return true;
                                 }};
        return phases;
    };
    const std::vector with_photons{phase::photons, phase::places, phase::records};
    const std::vector without{phase::places, phase::records};
    CHECK(phases_of(lobe_set::all, 1000) == with_photons);
    CHECK(phases_of(lobe_set::all, 0) == without);
    CHECK(phases_of(lobe_set::diffuse, 1000) == without);
}

TEST_CASE("preparation: threads tell it one at a time, and no share falls") {
    for_each_integrator([](const char* name, const std::vector<phase>&, const auto& make) {
        CAPTURE(name);
        preparation last;
        std::size_t calls = 0;
        std::size_t fallen = 0;
        // Plain variables: two calls at once would be a race, which the thread sanitizer sees.
        (void)make(own_threads{4}, [&](const preparation& p) {
            fallen += p.phase < last.phase || (p.phase == last.phase && p.share < last.share) ? 1 : 0;
            last = p;
            ++calls;
            return true;
        });
        CHECK(calls > 2);
        CHECK(fallen == 0);
    });
}

TEST_CASE("preparation: being listened to changes no bit") {
    for_each_integrator([](const char* name, const std::vector<phase>&, const auto& make) {
        CAPTURE(name);
        const auto on = [](const preparation&) { return true; };
        CHECK(look(make(in_sequence{}, preparation_progress{})) == look(make(own_threads{3}, on)));
    });
}

TEST_CASE("preparation: a host that says no at once is asked once a phase, and gets a little of each") {
    for_each_integrator([](const char* name, const std::vector<phase>& phases, const auto& make) {
        CAPTURE(name);
        std::vector<phase> asked;
        const auto cut = make(in_sequence{}, [&](const preparation& p) {
            asked.push_back(p.phase);
            return false;
        });
        CHECK(asked == phases);
        const auto whole = make(in_sequence{}, preparation_progress{});
        if constexpr (requires { cut.maps(); }) {
            CHECK(main_map(cut.maps()).status == map_status::partly);
            CHECK_FALSE(main_map(cut.maps()).empty());
            CHECK(main_map(cut.maps()).size() < main_map(whole.maps()).size() / 4);
        }
        if constexpr (requires { cut.points(); }) {
            CHECK_FALSE(cut.points().empty());
            CHECK(cut.points().size() < whole.points().size() / 4);
        }
        if constexpr (requires { cut.filled(); }) {
            CHECK(cut.filled().records > 0);
            CHECK(cut.filled().cancelled);
        }
        for (const float value : look(cut)) { CHECK(value >= room.glow); }
    });
}

TEST_CASE("preparation: phases that are cut short in their midst leave the picture right in the mean") {
    for_each_integrator([](const char* name, const std::vector<phase>&, const auto& make) {
        CAPTURE(name);
        const auto cut = make(in_sequence{}, [&](const preparation& p) { return p.share < 0.5; });
        double common = 0;
        if constexpr (requires { cut.maps(); }) {
            const auto& map = main_map(cut.maps());
            CHECK(map.status == map_status::partly);
            CHECK(map.size() > 20'000 / 3);
            CHECK(map.size() < 20'000 * 2 / 3);
            // The photons' flux is common to all that is read: four standard deviations (see cache_integrators).
            common = 4 * (double{truth} - 1) / std::sqrt(0.5 * static_cast<double>(map.paths));
        }
        running_mean seen;
        for (const float value : look(cut, 512)) { seen.add(static_cast<double>(value)); }
        CAPTURE(seen.mean(), seen.standard_error(), common);
        CHECK(std::abs(seen.mean() - double{truth}) < common + 4 * seen.standard_error() + 0.01 * double{truth});
    });
}
