// Direct, caustic and indirect photons in action: where they landed, and the light that their maps make of it.
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/trace_photons.hpp>

#include "common/scenes/registry.hpp"
#include "slides/slide.hpp"

namespace {

using world = host::scene<float>;
using map = aglow::traced_map<aglow::vec3<float>, float>;

host::picture landed(const host::slide& s, const world& scene, const map& photons) {
    host::picture image{s.side(), s.side()};
    host::add_photons(image, scene, scene.view(), photons, 0.3f);
    return image;
}

/// The radiance that one map alone makes on diffuse surfaces; mirrors and glass are looked through.
host::picture light_of(const host::slide& s, const world& scene, const map& photons) {
    const aglow::map_layer<aglow::vec3<float>, float> layer{photons};
    return s.expose(scene.view(), aglow::layered_integrator{scene, scene.lights(), layer}, s.tiny() ? 1 : 16);
}

}  // namespace

int main(int count, char** words) {
    return host::show_slide(count, words, [](const host::slide& s) {
        const world scene{host::scenes::cornell_glass<float>()};
        const std::size_t wanted = s.tiny() ? 2'000 : 100'000;
        const auto maps = aglow::trace_photons(scene, scene.lights(),
                                               {.direct = wanted, .caustic = wanted, .indirect = wanted}, s.run());
        std::vector<host::picture> dots;
        std::vector<host::picture> lit;
        const auto add = [&](const char* name, const map& photons) {
            std::printf("%-8s %6zu photons of %zu paths\n", name, photons.size(), photons.paths);
            dots.push_back(host::captioned(landed(s, scene, photons), name));
            lit.push_back(host::captioned(light_of(s, scene, photons), name));
        };
        add("direct", maps.direct);
        add("caustic", maps.caustic);
        add("indirect", maps.indirect);
        s.save("photons", dots);
        s.save("photon_light", lit);
    });
}
