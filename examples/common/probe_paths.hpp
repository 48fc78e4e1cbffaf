// What pictures are held to: unbiased paths, guided by photons where light may come over mirrors; and what that costs.
#pragma once

#include <cstddef>
#include <cstdint>

#include <aglow/algorithms/path_guide.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/concepts/intersector.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>

#include "common/counted_scene.hpp"
#include "common/light_set.hpp"

namespace host {

/// How the paths of probes find light.
enum class probe_kind {
    guided,  ///< by photons, where there may be mirrors
    path     ///< by chance
};

/// Makes the integrators that look at pixels of one scene again. Keeps references, and so do these.
template <typename World>
class probe_paths {
    using T = typename World::scalar;

public:
    /// Whether materials of such a scene may mirror, so that there may be something to guide by.
    static constexpr bool may_guide = aglow::any(aglow::static_lobes<World>, aglow::lobe_set::specular);

    probe_paths(const World& scene, const light_set<T>& lights, std::uint64_t seed, const aglow::own_threads& run,
                probe_kind kind = probe_kind::guided)
        : scene_{scene}, lights_{lights} {
        if constexpr (may_guide) {
            if (kind == probe_kind::path) { return; }
            const std::uint64_t before = rays_so_far();
            guide_ = aglow::path_guide<T>{scene, lights, aglow::path_guide_options{.seed = seed}, run};
            made_of_ = guided() ? 3 * static_cast<double>(rays_so_far() - before) : 0;
        }
    }
    probe_paths(const probe_paths&) = delete;
    probe_paths& operator=(const probe_paths&) = delete;

    [[nodiscard]] auto tracer() const {
        if constexpr (may_guide) {
            return aglow::guided_path_tracer<World, light_set<T>>{scene_, lights_, guide_};
        } else {
            return aglow::path_tracer<World, light_set<T>>{scene_, lights_};
        }
    }

    [[nodiscard]] bool guided() const { return !guide_.empty(); }

    /// What making the guide cost, in rays: about three times those of its photons. 0 for scenes that count none.
    [[nodiscard]] double guide_cost() const { return made_of_; }

    /// What guiding costs a sample beside its rays: about as much as three more.
    [[nodiscard]] double guiding_cost() const { return guided() ? 3 : 0; }

private:
    static std::uint64_t rays_so_far() { return ray_count::all_nearest() + ray_count::all_shadow(); }

    const World& scene_;
    const light_set<T>& lights_;
    aglow::path_guide<T> guide_{};
    double made_of_{0};
};

/// Rays of a sample of `integrator`, by a few of a picture of `width` x `height`; what a clock tells would not be the
/// same again. Expects a scene that counts them.
template <typename Eye, typename Integrator>
[[nodiscard]] double rays_a_sample(const Eye& eye, const Integrator& integrator, std::size_t width, std::size_t height,
                                   std::uint64_t seed) {
    constexpr std::size_t looks = 1024;
    const aglow::pixel_probe look{eye, integrator, width};
    const auto rays = [] { return ray_count::here().nearest + ray_count::here().shadow; };
    const std::uint64_t before = rays();
    for (std::size_t i = 0; i < looks; ++i) { (void)look(aglow::mix(seed, i) % (width * height), seed, 1); }
    return static_cast<double>(rays() - before) / looks;
}

/// What the lookups of a picture's sample cost, in rays: about one in a cache, eight in each map of photons.
struct sample_lookups {
    std::size_t caches{0};
    std::size_t maps{0};

    [[nodiscard]] double cost() const { return static_cast<double>(caches) + 8 * static_cast<double>(maps); }
};

}  // namespace host
