// Path tracing, irradiance caching and the classical combination, each given the same seconds.
#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/path_trace.hpp>

#include "common/scenes/registry.hpp"
#include "slides/slide.hpp"

namespace {

using world = host::diffuse_scene<float>;
using lights = host::light_set<float>;

/// One panel: everything from nothing to the last sample happens within `seconds`, what `make` does included.
template <typename Make>
host::picture panel(const host::slide& s, const world& scene, const char* name, double seconds, Make&& make) {
    const host::stopwatch clock;
    const auto integrator = make();
    std::uint32_t samples = 0;
    const host::picture image = s.expose_until(scene.view(), integrator, clock, seconds, samples);
    const double taken = clock.seconds();
    const double error = host::relative_square_error(image, s.reference("cornell-diffuse"));
    std::printf("%-17s %5.1f s  %4u samples a pixel  relMSE %.2e\n", name, taken, samples, error);
    const std::string words = host::text("%s, %.0f s, relMSE %.1e", name, taken, error);
    return host::captioned(image, s.tiny() ? "" : words);
}

}  // namespace

int main(int count, char** words) {
    return host::show_slide(count, words, [](const host::slide& s) {
        const world scene{host::scenes::cornell_diffuse<float>()};
        const lights& lit = scene.lights();
        const auto eye = s.eye(scene.view());
        const double seconds = s.tiny() ? 0.2 : 8;
        aglow::caching_options caching;
        caching.view.width = caching.view.height = s.side();

        s.save("equal_time", {panel(s, scene, "path tracing", seconds,
                                    [&] {
                                        return aglow::path_tracer<world, lights>{scene, lit};
                                    }),
                              panel(s, scene, "irradiance cache", seconds,
                                    [&] {
                                        return aglow::irradiance_caching<world, lights>{scene, lit,     scene.bounds(),
                                                                                        eye,   caching, s.run()};
                                    }),
                              panel(s, scene, "gather cache", seconds, [&] {
                                  return aglow::gather_caching<world, lights>{
                                      scene, lit, scene.bounds(), eye, {.caching = caching}, s.run()};
                              })});
    });
}
