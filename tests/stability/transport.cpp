// Rows 1 to 21: light in rooms whose answer is a closed form.
#include <algorithm>
#include <array>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/trace_photons.hpp>

#include "../../examples/common/fresnel.hpp"
#include "../../examples/common/ggx.hpp"
#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"

using namespace aglow;
using namespace stability;
using statistics::sample_mean;
using shape = quadric<double>;
using room = quadric_scene<double>;

namespace {

constexpr double pi_d = aglow::pi<double>;

/// Radiance seen along `eye` in a scene of emitting walls.
sample_mean radiance(const room& scene, const ray<double>& eye, std::uint64_t paths, std::uint64_t seed = 1) {
    const blind<double> nobody;
    return looks_along(path_tracer{scene, nobody}, eye, paths, seed);
}

ray<double> from(const vec3<double>& origin, const vec3<double>& towards) { return {origin, glm::normalize(towards)}; }

template <typename World, typename Light>
energy_ledger<double> walk(const World& scene, const Light& light, std::uint64_t paths) {
    energy_ledger<double> ledger;
    for (std::uint64_t i = 0; i < paths; ++i) {
        walk_photon(scene, light, random_numbers<double>{{.path = i}}, 0, ledger,
                    [](const auto&, const vec3<double>&, double, photon_history) { return true; });
    }
    return ledger;
}

/// Mirror walls x, y = ±1 for 0 <= z <= 1.
void add_mirrors(room& scene) {
    for (const int axis : {0, 1}) {
        for (const double at : {-1.0, 1.0}) { scene.shapes.push_back(shape::plane(axis, at, {.mirror = 1})); }
    }
}

room plates(double e1, double r1, double e2, double r2) {
    room scene{{shape::plane(2, 0, {.diffuse = r1, .glow = e1}), shape::plane(2, 1, {.diffuse = r2, .glow = e2})}};
    add_mirrors(scene);
    return scene;
}

/// One beam from within a slab, beyond the critical angle.
template <typename T>
struct slanting {
    using scalar = T;
    template <Sampler R>
    [[nodiscard]] emission<T, T> emit(R&) const {
        return {{{0, 0, T(0.5)}, glm::normalize(vec3<T>{2, 0, 1})}, 1};
    }
};

}  // namespace

TEST_CASE("stability 1: a closed room of albedo rho glows 1 / (1 - rho), up to rho = 0.999999 and without a cap") {
    const testing::furnace_light<double, double> light{.radius = 2, .glow = 1};
    for (const double rho : {0.0, 0.5, 0.9, 0.99, 0.999999}) {
        const testing::furnace_sphere<double, double> scene{.radius = 2, .albedo = rho, .glow = 1};
        const auto mean = looks_along(path_tracer{scene, light}, from({0.1, 0.2, -0.3}, {1, 2, 3}),
                                      rho > 0.999  ? 10
                                      : rho > 0.95 ? 3000
                                                   : 20000);
        CAPTURE(rho, mean.mean(), mean.standard_error());
        if (rho == 0) {
            CHECK(mean.mean() == 1);
            CHECK(mean.variance() == 0);
        } else {
            CHECK(mean.agrees(furnace(rho)));
        }
    }
}

TEST_CASE("stability 5: indirect light in a matte sphere does not know where the light is") {
    for (const double rho : {0.3, 0.8}) {
        const room scene{{shape::sphere({}, 2, {.diffuse = rho})}, lobe_set::diffuse_reflection};
        const double exact = sphere_indirect(4 * pi_d, rho, 2);
        for (const vec3<double> at : {vec3<double>{0}, vec3<double>{1.5, 0.5, -1}}) {
            const support::bulb<double, double> light{.position = at, .intensity = 1};
            const path_tracer tracer{scene, light};
            sample_mean mean;
            for (std::uint64_t i = 0; i < 20000; ++i) {
                const random_numbers<double> numbers{{.path = i}};
                auto random = numbers.at(0, purpose::gather);
                const vec3<double> x{0, 0, -2 + 1e-9};
                const ray<double> gather{x, cosine_hemisphere(random.next_2d())};
                mean.add(pi_d * tracer.incoming(gather, numbers.fork(1)).radiance);
            }
            CAPTURE(rho, at.x, mean.mean(), exact);
            CHECK(mean.agrees(exact));
        }
    }
}

TEST_CASE("stability 4: a bulb of pi W/sr in a unit sphere of albedo 1/2 makes radiance 1") {
    const room scene{{shape::sphere({}, 1, {.diffuse = 0.5})}, lobe_set::diffuse_reflection};
    const support::bulb<double, double> light{.intensity = pi_d};
    // Direct and indirect together: rho I / (pi R² (1 - rho)) = 1.
    CHECK(looks_along(path_tracer{scene, light}, from({0.1, 0.1, 0}, {1, 0, 0}), 40000).agrees(1));
}

TEST_CASE("stability 6: an integrating sphere with a port has the closed form's radiance") {
    const double rho = 0.9;
    for (const double port : {0.01, 0.1, 0.3}) {
        auto wall = shape::sphere({}, 1, {.diffuse = rho});
        wall.high.z = 1 - 2 * port;
        const room scene{{wall}, lobe_set::diffuse_reflection};
        const support::bulb<double, double> light{.intensity = 1};
        const auto mean = looks_along(path_tracer{scene, light}, from({}, {0.6, 0, -0.8}), 40000);
        // All that struck the wall first: the light's power into the wall, 4 pi (1 - port), as a whole sphere's.
        CAPTURE(port, mean.mean());
        CHECK(mean.agrees(integrating_sphere(4 * pi_d, rho, 1, port)));
    }
}

TEST_CASE("stability 7: two plates between mirrors are two infinite plates") {
    const auto exact = enclosure(1, 0.5, 0.25, 0.8, 1);
    CHECK(exact.first == Approx((1 + 0.5 * 0.25) / (1 - 0.4)).epsilon(1e-14));
    const room scene = plates(1, 0.5, 0.25, 0.8);
    CHECK(radiance(scene, from({0.3, 0.2, 0.5}, {0.1, 0, -1}), 30000).agrees(exact.first));
    CHECK(radiance(scene, from({0.3, 0.2, 0.5}, {0.1, 0, 1}), 30000).agrees(exact.second));
}

TEST_CASE("stability 8: two plates of albedo 0.999999 are a million bright, and end") {
    const double rho = 0.999999;
    const auto exact = enclosure(1, rho, 1, rho, 1);
    CHECK(exact.first == Approx(1e6).epsilon(1e-9));
    const auto mean = radiance(plates(1, rho, 1, rho), from({0.3, 0.2, 0.5}, {0.1, 0, -1}), 5);
    CAPTURE(mean.mean(), mean.standard_error());
    CHECK(mean.agrees(exact.first));
}

TEST_CASE("stability 9: concentric spheres share their light by the square of their radii") {
    const double inner = 0.5;
    const room scene{
        {shape::sphere({}, inner, {.diffuse = 0.6, .glow = 1}), shape::sphere({}, 1, {.diffuse = 0.7, .glow = 0.1})},
        lobe_set::diffuse_reflection};
    const auto exact = enclosure(1, 0.6, 0.1, 0.7, inner * inner);
    CHECK(radiance(scene, from({0, 0, 0.75}, {0, 0.01, -1}), 30000).agrees(exact.first));
    CHECK(radiance(scene, from({0, 0, 0.75}, {0, 0.01, 1}), 30000).agrees(exact.second));
}

TEST_CASE("stability 10: coaxial cylinders between mirrors share their light by their radii") {
    room scene{{shape::cylinder(0.5, {.diffuse = 0.6, .glow = 1}), shape::cylinder(1, {.diffuse = 0.7, .glow = 0.1}),
                shape::plane(2, -1, {.mirror = 1}), shape::plane(2, 1, {.mirror = 1})}};
    const auto exact = enclosure(1, 0.6, 0.1, 0.7, 0.5);
    CHECK(radiance(scene, from({0.75, 0, 0}, {-1, 0.01, 0.1}), 30000).agrees(exact.first));
    CHECK(radiance(scene, from({0.75, 0, 0}, {1, 0.01, 0.1}), 30000).agrees(exact.second));
}

TEST_CASE("stability 11: a dome sees half of itself and its floor nothing but the dome") {
    auto dome = shape::sphere({}, 1, {.diffuse = 0.7, .glow = 0.1});
    dome.low.z = 0;
    const room scene{{dome, shape::plane(2, 0, {.diffuse = 0.6, .glow = 1})}, lobe_set::diffuse_reflection};
    const auto exact = enclosure(1, 0.6, 0.1, 0.7, 0.5);
    CHECK(radiance(scene, from({0.1, 0.2, 0.4}, {0.1, 0, -1}), 30000).agrees(exact.first));
    CHECK(radiance(scene, from({0.1, 0.2, 0.4}, {0.1, 0, 1}), 30000).agrees(exact.second));
}

TEST_CASE("stability 12: kissing spheres through a port have the closed form's two levels") {
    struct {
        double rho, port;
        std::uint64_t paths;
    } const cases[] = {{0.5, 0.1, 20000}, {0.9, 0.01, 20000}, {0.9, 0.001, 100000}, {0.99, 0.001, 20000}};
    for (const auto& [rho, port, paths] : cases) {
        const auto exact = kissing_spheres(rho, port);
        const room scene = kissing(rho, port);
        const auto first = radiance(scene, from({0, 0, -0.9}, {1, 0.2, -0.5}), paths / 4);
        const auto second = radiance(scene, from({0, 0, 0.9}, {1, 0.2, 0.5}), paths);
        CAPTURE(rho, port, first.mean(), exact.first, second.mean(), exact.second);
        CHECK(first.agrees(exact.first));
        CHECK(second.agrees(exact.second));
    }
}

TEST_CASE("stability 13: spheres joined by a millionth still get their light") {
    const double port = 1e-6;
    SECTION("albedo 0.9: nine millionths pass") {
        const auto exact = kissing_spheres(0.9, port);
        CHECK(exact.second / exact.first == Approx(9.0e-6).epsilon(1e-4));
        const auto second = radiance(kissing(0.9, port), from({0, 0, 0.9}, {1, 0.2, 0.5}), 1'000'000);
        // Some nine paths of a million come through, so their number is Poisson's, each worth 10: 4 sigmas of that.
        CAPTURE(second.mean(), exact.second);
        CHECK(std::abs(second.mean() - exact.second) < 4 * exact.second / 3);
        CHECK(second.mean() > 0);
    }
    SECTION("albedo 0.999999: half passes") {
        const auto exact = kissing_spheres(0.999999, port);
        CHECK(exact.second / exact.first == Approx(0.5).epsilon(1e-3));
        const auto second = radiance(kissing(0.999999, port), from({0, 0, 0.9}, {1, 0.2, 0.5}), 8);
        CAPTURE(second.mean(), exact.second, second.standard_error());
        CHECK(second.agrees(exact.second));
    }
}

TEST_CASE("stability 14: fifty diffuse sheets pass one part in fifty-one, and the light falls evenly") {
    const stack_scene<double> scene{.count = 50, .sheet = {.diffuse = 0.5, .transmit = 0.5}};
    CHECK(stack_transmittance(0.5, 50) == Approx(1.0 / 51).epsilon(1e-14));
    std::array<double, 50> landed{};
    energy_ledger<double> ledger;
    const std::uint64_t paths = 20000;
    for (std::uint64_t i = 0; i < paths; ++i) {
        walk_photon(scene, lift_beam<double>{true}, random_numbers<double>{{.path = i}}, 0, ledger,
                    [&](const auto& hit, const vec3<double>&, double power, photon_history) {
                        landed[static_cast<std::size_t>(std::lround(hit.position.z))] += power;
                        return true;
                    });
    }
    const double n = static_cast<double>(paths);
    const double passed = static_cast<double>(ledger.escaped) / n;
    const double exact = stack_transmittance(0.5, 50);
    CHECK(std::abs(passed - exact) < 4 * std::sqrt(exact * (1 - exact) / n));
    CHECK(ledger.emitted == ledger.escaped + ledger.absorbed + ledger.roulette);
    // a_m = 2 (51 - m) / 51 arrive at sheet m; each path lands some 30 times with a spread of its own, here a third.
    for (std::size_t m = 1; m <= 50; m += 7) {
        const double arriving = 2 * (51.0 - static_cast<double>(m)) / 51;
        CAPTURE(m, landed[m - 1] / n, arriving);
        CHECK(landed[m - 1] / n == Approx(arriving).epsilon(0.1));
    }
}

TEST_CASE("stability 15: a hundred glass surfaces pass 0.1935, and nothing is lost between them") {
    const double r = normal_reflectance(1.5);
    CHECK(r == Approx(0.04).epsilon(1e-14));
    CHECK(stack_transmittance(r, 100) == Approx(0.1935484).epsilon(1e-6));
    CHECK(std::pow(1 - r, 100) == Approx(0.0168703).epsilon(1e-5));
    // Adding sheet by sheet, in float and double: R + T = 1.
    const auto together = [](auto one) {
        using T = decltype(one);
        T reflected = host::fresnel(T(1), T(1.5));
        const T again = reflected;
        T passed = 1 - reflected;
        for (int i = 1; i < 100; ++i) {
            const T between = 1 / (1 - reflected * again);
            const T next = reflected + passed * passed * again * between;
            passed = passed * (1 - again) * between;
            reflected = next;
        }
        return std::pair{reflected, passed};
    };
    const auto [r64, t64] = together(1.0);
    CHECK(std::abs(r64 + t64 - 1) <= 1e3 * 2.3e-16);
    CHECK(t64 == Approx(stack_transmittance(r, 100)).epsilon(1e-12));
    const auto [r32, t32] = together(1.0f);
    CHECK(std::abs(r32 + t32 - 1) <= 1e3f * 1.2e-7f);

    const stack_scene<double> scene{.count = 100, .sheet = {.glass = 1.5}, .alternate = true};
    const auto ledger = walk(scene, lift_beam<double>{}, 10000);
    const double passed = static_cast<double>(ledger.escaped) / 10000;
    CHECK(std::abs(passed - 0.1935484) < 4 * std::sqrt(0.1935484 * 0.806 / 10000));
    CHECK(ledger.emitted == ledger.escaped + ledger.absorbed);
    CHECK(ledger.roulette == 0);
    CHECK(ledger.power_absorbed + ledger.power_escaped == Approx(10000).epsilon(1e-12));
}

TEMPLATE_TEST_CASE("stability 16: a hundred total reflections lose nothing, exactly", "", float, double) {
    using T = TestType;
    for (const double degrees : {42.0, 60.0, 89.9}) {
        T power = 1;
        const T cosine = static_cast<T>(std::cos(degrees * pi_d / 180));
        for (int i = 0; i < 100; ++i) { power *= host::fresnel(cosine, T(1 / 1.5)); }
        CHECK(power == 1);
    }
    CHECK(host::fresnel(static_cast<T>(std::cos(41.7 * pi_d / 180)), T(1 / 1.5)) < 1);
    // A particle in a slab of glass, caught for good: what a walk of a hundred surfaces leaves of it.
    quadric_scene<T> slab{{quadric<T>::plane(2, 0, {.glass = 1.5}), quadric<T>::plane(2, 1, {.glass = 1.5})}};
    slab.shapes[0].linear.z = -1;
    energy_ledger<T> ledger;
    walk_photon(slab, slanting<T>{}, random_numbers<T>{{}}, 100, ledger,
                [](const auto&, const vec3<T>&, T, photon_history) { return true; });
    CHECK(ledger.capped == 1);
    CHECK(ledger.power_capped == 1);
    CHECK(ledger.power_absorbed == 0);
}

TEST_CASE("stability 17: glass balls within glass balls under an even sky are not there") {
    room scene{{shape::sphere({0, 0, 0}, 1, {.glass = 1.5}), shape::sphere({0.1, 0, 0}, 0.5, {.glass = 0.6})}};
    const even_sky<double> sky;
    sample_mean mean;
    int met = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const random_numbers<double> numbers{{.path = i}};
        auto random = numbers.at(0, purpose::camera);
        const auto u = random.next_2d();
        const ray<double> eye = from({0, 0, -3}, {u.x - 0.5, u.y - 0.5, 1});
        met += scene.intersect(eye) ? 1 : 0;
        mean.add(path_trace(scene, sky, eye, numbers));
    }
    CHECK(met > 500);
    CHECK(mean.agrees(1, 4, 50 * 2.3e-16 * 100));
}

TEMPLATE_TEST_CASE("stability 18: equal indices neither reflect nor bend", "", float, double) {
    using T = TestType;
    const vec3<T> n{0, 0, 1};
    for (const T cosine : {T(1), T(0.5), T(1e-3)}) {
        CHECK(host::fresnel(cosine, T(1)) == 0);
        const vec3<T> wo{std::sqrt(1 - cosine * cosine), 0, cosine};
        const auto through = host::refracted(wo, n, T(1));
        REQUIRE(through);
        CHECK(glm::length(*through + wo) <= 4 * std::numeric_limits<T>::epsilon());
    }
}

TEMPLATE_TEST_CASE("stability 19: rough mirrors never give more than they get, down to roughness 1e-6", "", float,
                   double) {
    using T = TestType;
    for (const double alpha : {1.0, 0.3, 0.03, 1e-3, 1e-4, 1e-6}) {
        const host::ggx<T> facets{static_cast<T>(alpha)};
        for (const double cosine : {1.0, 0.5, 0.01}) {
            const vec3<T> wo{static_cast<T>(std::sqrt(1 - cosine * cosine)), 0, static_cast<T>(cosine)};
            random_sampler<T> random{7};
            double sum = 0;
            bool sound = true;
            const int count = 2000;
            for (int i = 0; i < count; ++i) {
                const vec3<T> h = facets.facet(wo, random.next_2d());
                const vec3<T> wi = host::reflected(wo, h);
                if (!(wi.z > 0)) { continue; }
                const T weight = facets.seen(wo, wi) / facets.seen(wo);
                sound = sound && is_finite(weight) && weight >= 0 && weight <= 1 + T(1e-6) &&
                        is_finite(facets.density(h)) && is_finite(facets.reflection_pdf(wo, h));
                sum += static_cast<double>(weight);
            }
            CAPTURE(alpha, cosine, sum / count);
            CHECK(sound);
            CHECK(sum / count <= 1 + 1e-6);
            if (alpha <= 1e-4 && cosine > 0.1) { CHECK(sum / count >= 1 - 1e-4); }
        }
    }
}

TEMPLATE_TEST_CASE("stability 20: an empty scene under an even sky has irradiance pi L", "", float, double) {
    using T = TestType;
    const quadric_scene<T> nothing;
    const even_sky<T> sky{{}, T(3)};
    const path_tracer tracer{nothing, sky};
    const auto incoming = [&](const ray<T>& r, const random_numbers<T>& n) { return tracer.incoming(r, n); };
    const T e = gather_once(incoming, gather_point<T>{}, random_numbers<T>{{}}, hemisphere_shape{16, 32});
    CHECK(std::abs(e - 3 * aglow::pi<T>) <= 16 * std::numeric_limits<T>::epsilon() * e);
}

TEST_CASE("stability 21: in a room without loss all light ends on the one black patch") {
    support::toy_scene<double, double> scene{
        .rectangles = support::box_walls<double, double>(1, {.diffuse = 0.5, .mirror = 0.5})};
    support::rectangle<double, double> patch{
        .corner = {-0.75, -0.75, -0.9375}, .u = {1.5, 0, 0}, .v = {0, 1.5, 0}, .normal = {0, 0, 1}};
    scene.rectangles.push_back(patch);
    const auto ledger = walk(scene, support::bulb<double, double>{.position = {0, 0, 0.5}, .intensity = 1}, 5000);
    CHECK(ledger.absorbed == 5000);
    CHECK(ledger.emitted == 5000);
    CHECK(ledger.power_absorbed == Approx(ledger.power_emitted).epsilon(1e-12));
}
