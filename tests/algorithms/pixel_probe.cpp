#include <aglow/algorithms/pixel_probe.hpp>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_guide.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/report/render_until.hpp>

#include "support/broken_host.hpp"
#include "support/catch.hpp"

using aglow::audit_status;
using support::flaw;
using support::flawed_scene;
using rgb = glm::vec3;

namespace {

constexpr std::size_t side = 16;
const auto room = support::room_with_balls<rgb, float>(rgb{0.6f}, rgb{10});

aglow::ray<float> eye(const aglow::vec2<float>& film) {
    const aglow::vec2<float> u = film / static_cast<float>(side) * 2.0f - 1.0f;
    return {{0, -0.9f, 0}, glm::normalize(rgb{u.x, 1, u.y})};
}

/// What the integrator itself makes of the scene: an audit by the same finds nothing wrong with the light.
template <typename Integrator>
std::vector<float> picture_by(const Integrator& integrator) {
    aglow::film<rgb> film{side, side};
    film.expose(eye, integrator, {.samples = 256});
    std::vector<float> values;
    for (std::size_t i = 0; i < side * side; ++i) {
        const rgb p = film.radiance(i % side, i / side);
        values.insert(values.end(), {p.x, p.y, p.z});
    }
    return values;
}

aglow::image_view<float> seen(const std::vector<float>& values) { return {values, side, side, 3}; }

bool blames_the_host(const aglow::audit_result& said) {
    return std::any_of(said.reasons.begin(), said.reasons.end(),
                       [](const std::string& why) { return why.find("broken answers") != std::string::npos; });
}

const aglow::audit_options loose{.target = 0.2, .probes = 200};
/// Where probes are broken, it does not matter how heavy-tailed their noise is besides.
const aglow::audit_options hasty{.target = 0.2, .probes = 200, .patience = 1};

}  // namespace

TEST_CASE("pixel_probe: an audit by a host whose answers are broken certifies nothing, and says why") {
    for (const flaw wrong : support::all_flaws) {
        CAPTURE(static_cast<int>(wrong));
        const flawed_scene scene{room.scene, wrong};
        const aglow::path_tracer tracer{scene, room.light};
        const auto said = audit(seen(picture_by(tracer)), aglow::pixel_probe{eye, tracer, side}, hasty);
        CHECK(said.lost_share > 0.02);
        CHECK(said.lost_share < 4);
        CHECK(said.status == audit_status::inconclusive);
        CHECK(blames_the_host(said));
    }
}

TEST_CASE("pixel_probe: a sound host loses nothing, and is certified") {
    const flawed_scene scene{room.scene, flaw::none};
    const aglow::path_tracer tracer{scene, room.light};
    const auto said = audit(seen(picture_by(tracer)), aglow::pixel_probe{eye, tracer, side}, loose);
    CHECK(said.lost_share == 0);
    CHECK_FALSE(blames_the_host(said));
    CHECK(said.status == audit_status::certified);
}

TEST_CASE("pixel_probe: faults are noted where the integrator's options say so, and count all the same") {
    const flawed_scene scene{room.scene, flaw::long_normal};
    aglow::host_faults own;
    const aglow::path_tracer tracer{scene, room.light, {.faults = &own}};
    const aglow::path_guide<float> none;
    const aglow::guided_path_tracer guided{scene, room.light, none, {.faults = &own}};
    const auto values = picture_by(tracer);
    const double before = own.lost();
    const auto said = audit(seen(values), aglow::pixel_probe{eye, tracer, side}, hasty);
    CHECK(blames_the_host(said));
    // Of the probes alone, not of the picture before.
    CHECK(said.lost_share == Approx((own.lost() - before) / static_cast<double>(said.samples)));
    CHECK(blames_the_host(audit(seen(values), aglow::pixel_probe{eye, guided, side}, hasty)));
}

TEST_CASE("host_faults: what gather rays of a cache or a final gather meet is noted where the picture's paths note") {
    const flawed_scene scene{room.scene, flaw::long_normal};
    aglow::host_faults cached;
    aglow::gather_caching_options options;
    options.photons = {.direct = 1000, .caustic = 1000, .indirect = 5000};
    options.caching.view = {.width = side, .height = side, .looks = 1};
    options.caching.fill.rays = 64;
    options.caching.paths.faults = &cached;
    const aglow::gather_caching classical{scene, room.light, aglow::bounds<float>{rgb{-1}, rgb{1}}, eye, options};
    CHECK(cached.count(aglow::host_fault::normal) > 100);
    aglow::host_faults gathered;
    const aglow::final_gathering_options smooth{.photons = options.photons, .rays = 64, .paths = {.faults = &gathered}};
    const aglow::final_gathering integrator{scene, room.light, smooth};
    // Straight at a sound wall: all that is broken is met by gather rays.
    (void)integrator(aglow::ray<float>{{-0.5f, 0, 0}, {-1, 0, 0}}, aglow::random_numbers<float>{{}});
    CHECK(gathered.count(aglow::host_fault::normal) > 4);
    CHECK_THROWS_AS((aglow::final_gathering{scene, room.light, {.rays = 0}}), std::invalid_argument);
}

TEST_CASE("host_faults: each kind is counted with what it carried, of one fault no more than 65536 samples") {
    using aglow::host_fault;
    aglow::host_faults faults;
    CHECK(statement(faults).empty());
    faults.note(host_fault::normal, 0.25);
    faults.note(host_fault::normal, 0.5);
    faults.note(host_fault::weight, 1e30);
    faults.note(host_fault::weight, -3);
    CHECK(faults.count(host_fault::normal) == 2);
    CHECK(faults.lost(host_fault::normal) == 0.75);
    CHECK(faults.lost(host_fault::weight) == 65536);
    CHECK(faults.lost(host_fault::place) == 0);
    CHECK(faults.count() == 4);
    CHECK(faults.lost() == 65536.75);
    CHECK(statement(faults).find("2 normals that are not unit, 0.75") == 0);
}

TEST_CASE("pixel_probe: the same light is lost for any number of threads") {
    const flawed_scene scene{room.scene, flaw::nan_weight};
    const aglow::path_tracer tracer{scene, room.light};
    const auto values = picture_by(tracer);
    const auto lost = [&](unsigned threads) {
        const aglow::own_threads run{threads};
        return audit(seen(values), aglow::pixel_probe{eye, tracer, side}, hasty, run).lost_share;
    };
    const double one = lost(1);
    CHECK(one > 0);
    CHECK(lost(2) == one);
    CHECK(lost(3) == one);
}

TEST_CASE("pixel_probe: rendering until an error is certified ends where the host's answers are broken") {
    const flawed_scene scene{room.scene, flaw::long_normal};
    const aglow::path_tracer tracer{scene, room.light};
    const auto values = picture_by(tracer);
    const auto advance = [&](double) { return aglow::audited_picture<float>{.image = seen(values)}; };
    const auto result =
        render_until(advance, aglow::pixel_probe{eye, tracer, side}, {.audit = hasty, .most_work = 1e9});
    CHECK(result.status == aglow::until_status::broken);
    CHECK(blames_the_host(result.certificate));
}
