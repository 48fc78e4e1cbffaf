// The same photons, looked at directly, through a final gather, and through a gather that a cache remembers.
#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/photon_integrators.hpp>

#include "common/scenes/registry.hpp"
#include "slides/slide.hpp"

namespace {

using world = host::scene<float>;
using lights = host::light_set<float>;

template <typename Make>
host::picture panel(const host::slide& s, const world& scene, const char* name, Make&& make) {
    const host::stopwatch clock;
    const auto integrator = make();
    const double ready = clock.seconds();
    const host::picture image = s.expose(scene.view(), integrator, s.tiny() ? 1 : 8);
    const double taken = clock.seconds();
    const double error = host::relative_square_error(image, s.reference("cornell-glass"));
    std::printf("%-13s ready after %5.1f s, done after %5.1f s  relMSE %.2e\n", name, ready, taken, error);
    const std::string words = host::text("%s, %.0f s, relMSE %.1e", name, taken, error);
    return host::captioned(image, s.tiny() ? "" : words);
}

}  // namespace

int main(int count, char** words) {
    return host::show_slide(count, words, [](const host::slide& s) {
        const world scene{host::scenes::cornell_glass<float>()};
        const lights& lit = scene.lights();
        const auto eye = s.eye(scene.view());
        aglow::photon_options gathered = aglow::gather_caching_options{}.photons;
        if (s.tiny()) { gathered.direct = gathered.caustic = gathered.indirect = gathered.reflected = 2'000; }
        aglow::photon_options photons = gathered;
        photons.direct = photons.reflected = 0;  // for gather rays alone
        aglow::caching_options caching;
        caching.view.width = caching.view.height = s.side();

        s.save("final_gather",
               {panel(s, scene, "photon map",
                      [&] {
                          return aglow::photon_mapping<world, lights>{scene, lit, {.photons = photons}, s.run()};
                      }),
                panel(s, scene, "final gather",
                      [&] {
                          return aglow::final_gathering<world, lights>{scene, lit, {.photons = gathered}, s.run()};
                      }),
                panel(s, scene, "gather cache", [&] {
                    return aglow::gather_caching<world, lights>{
                        scene, lit, scene.bounds(), eye, {.photons = gathered, .caching = caching}, s.run()};
                })});
    });
}
