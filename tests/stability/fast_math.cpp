// Row 70: built with -ffast-math, beside the rows that are built so too.
#include <cmath>
#include <limits>

#include <glm/vec3.hpp>

#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/trace_photons.hpp>

#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace aglow;

TEST_CASE("stability 70: -ffast-math takes away neither the guards against NaN nor the light") {
    const auto room = support::room_with_balls<glm::vec3, float>(glm::vec3{0.6f}, glm::vec3{10});
    for (const support::flaw wrong : support::all_flaws) {
        const support::flawed_scene scene{room.scene, wrong};
        host_faults faults;
        const path_tracer tracer{scene, room.light, {.faults = &faults}};
        film<glm::vec3> picture{4, 4};
        picture.expose(
            [](const vec2<float>& f) {
                return ray<float>{{0, -0.9f, 0}, glm::normalize(glm::vec3{f.x / 2 - 1, 1, f.y / 2 - 1})};
            },
            tracer, {.samples = 16});
        CAPTURE(static_cast<int>(wrong));
        CHECK(faults.count() > 0);
        for (std::size_t p = 0; p < 16; ++p) { CHECK(is_radiance(picture.radiance(p % 4, p / 4))); }
    }
    const support::flawed_bulb light{
        {.position = {0, 0, 0.5f}, .intensity = glm::vec3{1}}, support::not_a_number, false};
    const auto maps = trace_photons(room.scene, light, {.direct = 500, .pilot_paths = 500});
    CHECK(maps.ledger.dropped > 200);
    CHECK(maps.ledger.faults[static_cast<std::size_t>(host_fault::power)] == maps.ledger.dropped);
    CHECK(maps.direct.size() > 0);
    for (const auto& p : maps.direct.photons()) { CHECK(is_radiance(p.power)); }
}
