// Rows 34 to 42: mirrors that gather all light in one point, and densities without bound.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/estimators/photon_map.hpp>

#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "support/catch.hpp"

using namespace aglow;
using namespace stability;
using statistics::sample_mean;

namespace {

constexpr double pi_d = aglow::pi<double>;

template <typename T>
landed_photon<T, T> landed(const vec3<T>& at, T power) {
    const packed_direction<std::int16_t> up{vec3<T>{0, 0, 1}};
    return {at, {power, up, up}};
}

template <typename T>
photon_map<T, T> map_of(const std::vector<landed_photon<T, T>>& photons) {
    return photon_map<T, T>{std::span<const landed_photon<T, T>>{photons}};
}

/// All within `radius`, each the same.
density_options disc_of(double radius) { return {.count = 0, .max_radius = radius, .kernel = kernel_shape::constant}; }

/// A mirror ellipsoid of semi-axes 2 along z and sqrt(3) across: its foci are at z = ±1.
template <typename T>
quadric<T> mirror_ellipsoid(T reflectance) {
    return quadric<T>::ellipsoid(2, std::sqrt(T(3)), {.mirror = reflectance});
}

}  // namespace

TEMPLATE_TEST_CASE("stability 34: from one focus of an ellipsoid all light goes through the other, by the same length",
                   "", float, double) {
    using T = TestType;
    const quadric_scene<T> scene{{mirror_ellipsoid<T>(1)}, lobe_set::specular_reflection};
    const vec3<T> focus{0, 0, 1};
    const T eps = std::numeric_limits<T>::epsilon();
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const random_numbers<T> numbers{{.path = i}};
        auto emission = numbers.at(0, purpose::emission);
        const ray<T> out{-focus, uniform_sphere(emission.next_2d())};
        const auto hit = scene.intersect(out);
        REQUIRE(hit);
        auto scatter = numbers.at(1, purpose::scatter);
        const auto next = hit->sample(-out.direction, scatter, lobe_set::all);
        REQUIRE(next);
        const T length = glm::distance(hit->position, out.origin) + glm::distance(hit->position, focus);
        const T off = glm::length(glm::cross(focus - hit->position, next->wi));
        const bool right = std::abs(length - 4) <= 64 * eps * 4 && off <= 64 * eps * 4;
        if (!right) { FAIL_CHECK("length " << length << ", off " << off); }
    }
}

TEST_CASE("stability 34: in the focus of an ellipsoid the caustic is finite and has all the flux, at every radius") {
    quadric_scene<double> scene{{mirror_ellipsoid<double>(0.75)}};
    auto receiver = quadric<double>::plane(2, 1, {.diffuse = 0.5});
    receiver.low = {-0.01, -0.01, 0.5};
    receiver.high = {0.01, 0.01, 1.5};
    scene.shapes.push_back(receiver);
    const support::bulb<double, double> light{.position = {0, 0, -1}, .intensity = 1};
    const auto maps = trace_photons(
        scene, light, {.caustic = 20000, .pilot_paths = 1, .paths = {.caustic = 20000}, .most_bounces = 1});
    CHECK(std::abs(static_cast<double>(maps.caustic.size()) - 15000) < 4 * std::sqrt(20000 * 0.75 * 0.25));
    // What the receiver itself takes away on the way out: a solid angle of 1e-4 over 4 pi.
    const double flux = 0.75 * 4 * pi_d;
    for (const double r : {1e-9, 1e-6, 1e-3, 0.01}) {
        const auto above = maps.caustic.irradiance({0, 0, 1}, {0, 0, 1}, disc_of(r));
        const auto below = maps.caustic.irradiance({0, 0, 1}, {0, 0, -1}, disc_of(r));
        CAPTURE(r, above.value, below.value);
        CHECK((above.value + below.value) * pi_d * r * r == Approx(flux).epsilon(4 * std::sqrt(0.25 / 0.75 / 20000)));
        CHECK(is_radiance(above.value));
    }
    // Asked for k, with k in one point: spread over the least disc that positions can tell, and all there.
    const auto nearest = maps.caustic.irradiance({0, 0, 1}, {0, 0, 1}, {.count = 50, .max_radius = 0.01});
    CHECK(is_radiance(nearest.value));
    CHECK(nearest.radius > 0);
    CHECK(nearest.value > 1e6);
}

TEST_CASE("stability 35: a paraboloid sends out parallel light with the closed form's density") {
    const double f = 0.5;
    const double rim = 2;
    quadric_scene<double> scene{{quadric<double>::paraboloid(f, {.mirror = 1})}, lobe_set::specular_reflection};
    scene.shapes[0].high = {rim, rim, 100};
    scene.shapes[0].low = {-rim, -rim, -1};
    std::vector<double> counts(20);
    int reflected = 0;
    const int paths = 40000;
    for (int i = 0; i < paths; ++i) {
        const random_numbers<double> numbers{{.path = static_cast<std::uint64_t>(i)}};
        auto emission = numbers.at(0, purpose::emission);
        const ray<double> out{{0, 0, f}, uniform_sphere(emission.next_2d())};
        const auto hit = scene.intersect(out);
        if (!hit) { continue; }
        auto scatter = numbers.at(1, purpose::scatter);
        const auto next = hit->sample(-out.direction, scatter, lobe_set::all);
        REQUIRE(next);
        CHECK(std::hypot(next->wi.x, next->wi.y) < 1e-6);
        const double share = std::hypot(hit->position.x, hit->position.y) / rim;
        if (share < 1) {
            ++reflected;
            ++counts[static_cast<std::size_t>(share * 20)];
        }
    }
    std::vector<double> expected;
    for (int ring = 0; ring < 20; ++ring) {
        const double flux = paraboloid_flux(f, rim * (ring + 1) / 20) - paraboloid_flux(f, rim * ring / 20);
        expected.push_back(paths * flux / (4 * pi_d));
    }
    const double all = paths * paraboloid_flux(f, rim) / (4 * pi_d);
    CHECK(std::abs(reflected - all) < 4 * std::sqrt(all));
    CHECK(statistics::chi2_test(counts, expected).p > 1e-4);
}

TEST_CASE("stability 36: at a fold caustic the error falls as the root of the radius, and is told") {
    // Density 1 / (2 sqrt x): the flux within x is sqrt x. By chance, and as evenly as can be, without noise.
    const auto fold = [](bool even) {
        std::vector<landed_photon<double, double>> photons;
        const int count = 400'000;
        random_sampler<double> random{3};
        for (int i = 0; i < count; ++i) {
            const double u = (i + (even ? 0.5 : random.next_1d())) / count;
            const double v = even ? std::fmod(i * 0.6180339887498949, 1.0) : random.next_1d();
            photons.push_back(landed<double>({u * u, v * 2 - 0.5, 0}, 2.0 / count));
        }
        return map_of(photons);
    };
    const auto map = fold(false);
    const auto smooth = fold(true);
    const int places = 2000;
    int covered = 0;
    std::vector<double> errors;
    for (const double r : {0.08, 0.04, 0.02}) {
        double sum = 0;
        int near = 0;
        int near_covered = 0;
        for (int i = 0; i < places; ++i) {
            const double x = (i + 0.5) / places * 0.25;
            const double exact = 0.5 / std::sqrt(x);
            const auto e = map.irradiance({x, 0.5, 0}, {0, 0, 1}, disc_of(r));
            sum += std::abs(smooth.irradiance({x, 0.5, 0}, {0, 0, 1}, disc_of(r)).value - exact) / places;
            const int within = std::abs(e.value - exact) <= e.error ? 1 : 0;
            covered += within;
            near += x < r ? 1 : 0;
            near_covered += x < r ? within : 0;
        }
        errors.push_back(sum);
        // A sixth of a radius from the fold light grows without bound, and no disc can tell by how much.
        CAPTURE(r, near_covered, near);
        CHECK(near_covered >= 0.75 * near);
    }
    CAPTURE(covered);
    CHECK(covered >= 0.95 * 3 * places);
    for (const double slope : {std::log2(errors[0] / errors[1]), std::log2(errors[1] / errors[2])}) {
        CAPTURE(slope, errors[0], errors[1], errors[2]);
        CHECK(slope == Approx(0.5).margin(0.06));
    }
}

TEST_CASE("stability 37: a million photons in one point make a map, and all their light is there") {
    const std::vector<landed_photon<float, float>> photons(1'000'000, landed<float>({0.25f, 0.5f, 0.75f}, 0x1p-20f));
    const auto map = map_of(photons);
    CHECK(map.size() == 1'000'000);
    const auto all = map.irradiance({0.25f, 0.5f, 0.75f}, {0, 0, 1}, disc_of(0.125));
    CHECK(all.count == 1'000'000);
    CHECK(all.value * aglow::pi<float> / 64 == Approx(1e6 * 0x1p-20).epsilon(1e-3));
    const auto nearest = map.irradiance({0.25f, 0.5f, 0.75f}, {0, 0, 1}, {.count = 50});
    CHECK(is_finite(nearest.value));
    CHECK(nearest.value > 0);
    CHECK(nearest.radius > 0);
}

TEST_CASE("stability 38: on a lattice, where all is tied, the nearest are brute force's, by distance and number") {
    std::vector<vec3<float>> points;
    for (int i = 0; i < 4096; ++i) {
        points.push_back({static_cast<float>(i % 16), static_cast<float>(i / 16 % 16), static_cast<float>(i / 256)});
    }
    const kd_tree<float> tree{points, [](const vec3<float>& p) { return p; }};
    kd_scratch<float> scratch;
    for (const vec3<float> at : {vec3<float>{8, 8, 8}, {7.5f, 7.5f, 7.5f}, {0, 0, 0}, {8, 7.5f, 15}}) {
        std::vector<std::pair<float, std::uint32_t>> all;
        for (std::uint32_t i = 0; i < points.size(); ++i) { all.emplace_back(distance2(points[i], at), i); }
        std::sort(all.begin(), all.end());
        const auto found = tree.nearest(at, 50, scratch, {}, [](kd_slot) { return true; });
        REQUIRE(found.size() == 50);
        std::vector<std::pair<float, std::uint32_t>> mine;
        for (std::size_t i = 0; i < 50; ++i) { mine.emplace_back(found.distances2[i], tree.order()[found.slots[i]]); }
        std::sort(mine.begin(), mine.end());
        CHECK(std::equal(mine.begin(), mine.end(), all.begin()));
    }
}

TEST_CASE("stability 39: k nearest of an even density have mean f and relative variance 1 / (k - 2)") {
    for (const std::uint32_t k : {3u, 10u, 50u}) {
        sample_mean mean;
        for (std::uint64_t run = 0; run < 4000; ++run) {
            random_sampler<double> random{mix(run, k)};
            std::vector<landed_photon<double, double>> photons;
            const int count = static_cast<int>(k) * 8;
            for (int i = 0; i < count; ++i) {
                photons.push_back(landed<double>({random.next_1d(), random.next_1d(), 0}, 1.0 / count));
            }
            // A Poisson field would need a Poisson count; within an eighth of it the difference is 1 in 8 k.
            mean.add(map_of(photons)
                         .irradiance({0.5, 0.5, 0}, {0, 0, 1},
                                     {.count = k, .max_radius = 0.5, .kernel = kernel_shape::constant})
                         .value);
        }
        CAPTURE(k, mean.mean(), mean.variance());
        CHECK(mean.agrees(1));
        if (k == 50) { CHECK(mean.variance() == Approx((1 - 1.0 / 8) / 48).epsilon(0.15)); }
    }
    const auto one = map_of<double>({landed<double>({0, 0, 0}, 1), landed<double>({1, 0, 0}, 1)})
                         .irradiance({0.1, 0, 0}, {0, 0, 1}, {.count = 1});
    CHECK(is_radiance(one.value));
}

TEST_CASE("stability 40: at the border of a surface an even disc sees the share that it covers") {
    std::vector<landed_photon<double, double>> photons;
    const int side = 1000;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side / 2; ++j) {
            photons.push_back(landed<double>({(j + 0.5) / side, (i + 0.5) / side, 0}, 1.0 / (side * side)));
        }
    }
    const auto map = map_of(photons);
    const double r = 0.2;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0, 1.2}) {
        const auto e = map.irradiance({t * r, 0.5, 0}, {0, 0, 1}, disc_of(r));
        CAPTURE(t, e.value);
        CHECK(e.value == Approx(share_at_border(t)).epsilon(0.01));
    }
    CHECK(share_at_border(0) == Approx(0.5).epsilon(1e-15));
    CHECK(share_at_border(0.5) == Approx(0.8044989).epsilon(1e-7));
}

TEST_CASE("stability 41: kernels have unit mass, and the bias that their second moment says") {
    const auto moment = [](auto kernel, int power) {
        // ∫ rho^power K(rho²) dA over the unit disc, in rho² so that no root is left for the cone.
        return statistics::integral(0, 1, 200, [&](double rho) {
            return 2 * pi_d * std::pow(rho, power + 1) * static_cast<double>(kernel(rho * rho));
        });
    };
    const auto check = [&](auto kernel, double second) {
        CHECK(std::abs(moment(kernel, 0) - 1) <= 1e-12);
        // f = x² + y², laplacian 4: the bias is the second moment, r² laplacian / 12 for Epanechnikov and / 8 for even.
        if (second > 0) { CHECK(std::abs(moment(kernel, 2) - second) <= 1e-12); }
    };
    check(constant_kernel{}, 4.0 / 8);
    check(epanechnikov_kernel{}, 4.0 / 12);
    check(cone_kernel{}, 3.0 / 10);
    check(biweight_kernel{}, 1.0 / 4);
    check(gaussian_kernel{}, 0);
}

TEST_CASE("stability 42: every particle ends in exactly one book, and the watts balance") {
    const auto room = support::room_with_balls<double, double>(0.6, 5);
    energy_ledger<double> ledger;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        walk_photon(room.scene, room.light, random_numbers<double>{{.path = i}}, 0, ledger,
                    [](const auto&, const vec3<double>&, double, photon_history) { return true; });
    }
    const auto& l = ledger;
    CHECK(l.emitted == 20000);
    CHECK(l.emitted == l.escaped + l.absorbed + l.roulette + l.unneeded + l.capped + l.dropped);
    CHECK(l.dropped == 0);
    CHECK(l.power_absorbed + l.power_escaped == Approx(l.power_emitted).epsilon(0.02));
}
