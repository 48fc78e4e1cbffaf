// Where the cache computed: the picture, the points of its records, and how far some of them reach.
#include <aglow/algorithms/cache_integrators.hpp>

#include "common/scenes/registry.hpp"
#include "slides/slide.hpp"

namespace {

using world = host::diffuse_scene<float>;
using integrator = aglow::gather_caching<world, host::light_set<float>>;

host::picture dimmed(host::picture image) {
    for (aglow::vec3<float>& pixel : image.pixels) { pixel *= 0.4f; }
    return image;
}

}  // namespace

int main(int count, char** words) {
    return host::show_slide(count, words, [](const host::slide& s) {
        const world scene{host::scenes::cornell_diffuse<float>()};
        aglow::gather_caching_options options;
        options.caching.view.width = options.caching.view.height = s.side();
        const integrator cached{scene, scene.lights(), scene.bounds(), s.eye(scene.view()), options, s.run()};
        const auto& cache = cached.cache();

        const host::picture image = s.expose(scene.view(), cached, s.tiny() ? 1 : 32);
        host::picture points = dimmed(image);
        host::paint_records(points, scene, scene.view(), cache);

        // All of them would hide the picture: every point is within several.
        host::picture reaches = dimmed(image);
        const std::uint32_t step = std::max(1u, cache.size() / 150);
        for (std::uint32_t i = 0; i < cache.size(); i += step) {
            host::paint_reach(reaches, scene, scene.view(), cache[i], 1, {0.1f, 0.6f, 1});
        }
        const std::string found = host::text("%u records", cache.size());
        std::printf("%s, %llu rays, for %zu pixels\n", found.c_str(),
                    static_cast<unsigned long long>(cached.filled().rays), s.side() * s.side());
        s.save("records", {host::captioned(image, s.tiny() ? "" : "gather cache"), host::captioned(points, found),
                           host::captioned(reaches, s.tiny() ? "" : host::text("reach of every %u", step))});
    });
}
