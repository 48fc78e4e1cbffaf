// Rows 22 to 33: direct light by the formulas of the books, at every scale and angle.
#include <cmath>
#include <limits>
#include <vector>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/precompute_irradiance.hpp>
#include <aglow/core/sobol.hpp>

#include "../../examples/common/fresnel.hpp"
#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "support/catch.hpp"
#include "support/polygon.hpp"

using namespace aglow;
using namespace stability;
using statistics::sample_mean;
using gray_scene = support::toy_scene<double, double>;
using gray_bulb = support::bulb<double, double>;
using gray_panel = support::panel<double, double>;

namespace {

constexpr double pi_d = aglow::pi<double>;
const vec3<double> up{0, 0, 1};

/// A panel of radiance 1 at `corner`, along `u` and `v`.
gray_panel glowing(const vec3<double>& corner, const vec3<double>& u, const vec3<double>& v, const vec3<double>& n,
                   bool round = false) {
    return {{.corner = corner, .u = u, .v = v, .normal = n, .made_of = {.glow = 1}, .round = round}};
}

/// Irradiance at `x` with normal `n` by sampling, unhindered.
template <typename Light>
double sampled(const Light& light, const vec3<double>& x, const vec3<double>& n, std::uint32_t rays = 4096) {
    return direct_irradiance(gray_scene{}, light, x, n, 1e-12, rays, 7);
}

/// Mean over the unit square x, y in [0, 1], z = 0 of the share of its light that meets `light`.
double exchanged(const gray_panel& light) {
    double sum = 0;
    const int side = 32;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const vec3<double> x{(i + 0.5) / side, (j + 0.5) / side, 0};
            sum += direct_irradiance(gray_scene{}, light, x, up, 1e-12, 64, static_cast<std::uint64_t>(i * side + j));
        }
    }
    return sum / (side * side * pi_d);
}

template <typename T>
std::vector<corner<T>> square_at(double height, double half, double x = 0) {
    std::vector<corner<T>> p;
    for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        p.push_back({static_cast<T>(x + a * half), static_cast<T>(b * half), static_cast<T>(height)});
    }
    return p;
}

/// Whether `T` finds what long double finds, to `ulps` of the terms that are summed.
template <typename T>
bool agrees(const std::vector<corner<T>>& p, double ulps = 16) {
    std::vector<corner<long double>> exact;
    for (const auto& c : p) { exact.push_back({c[0], c[1], c[2]}); }
    const auto mine = lambert_polygon(p);
    const auto truth = lambert_polygon(exact);
    return std::abs(static_cast<long double>(mine.irradiance) - truth.irradiance) <=
           static_cast<long double>(ulps) * std::numeric_limits<T>::epsilon() * truth.magnitude;
}

/// The overcast sky of CIE: three times as bright at the zenith as at the horizon.
struct overcast_sky : support::no_light<double, double> {
    [[nodiscard]] double escaped(const vec3<double>& w) const { return w.z > 0 ? (1 + 2 * w.z) / 3 : 0; }
};

/// A plane across `axis`, from `low` to `high` along the other two.
quadric<double> piece(int axis, double at, const vec3<double>& low, const vec3<double>& high,
                      const material<double>& made_of = {}) {
    auto q = quadric<double>::plane(axis, at, made_of);
    q.low = low;
    q.high = high;
    q.low[axis] = -endless<double>;
    q.high[axis] = endless<double>;
    return q;
}

/// A black wall across `axis` with a hole from `low` to `high`.
std::vector<quadric<double>> wall_with_hole(int axis, double at, const vec3<double>& low, const vec3<double>& high) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    const double far = endless<double>;
    std::vector<quadric<double>> pieces;
    for (const bool above : {false, true}) {
        vec3<double> a{-far};
        vec3<double> b{far};
        (above ? a : b)[u] = above ? high[u] : low[u];
        pieces.push_back(piece(axis, at, a, b));
        a = vec3<double>{-far};
        b = vec3<double>{far};
        a[u] = low[u];
        b[u] = high[u];
        (above ? a : b)[v] = above ? high[v] : low[v];
        pieces.push_back(piece(axis, at, a, b));
    }
    return pieces;
}

/// A black room behind the wall x = 0 with a window from `low` to `high`.
std::vector<quadric<double>> room_with_window(const vec3<double>& low, const vec3<double>& high) {
    const double far = endless<double>;
    auto pieces = wall_with_hole(0, 0, low, high);
    pieces.push_back(piece(0, -5, vec3<double>{-far}, vec3<double>{far}));
    for (const double z : {0.0, 3.0}) { pieces.push_back(piece(2, z, {-far, -far, 0}, {0, far, 0})); }
    for (const double y : {-4.0, 4.0}) { pieces.push_back(piece(1, y, {-far, 0, -far}, {0, 0, far})); }
    return pieces;
}

/// Irradiance at `at` by rays through the hole, carried on by path tracing.
sample_mean by_rays(const quadric_scene<double>& scene, const vec3<double>& at, const vec3<double>& n) {
    const overcast_sky sky;
    const path_tracer tracer{scene, sky};
    const auto incoming = [&](const ray<double>& r, const random_numbers<double>& numbers) {
        return tracer.incoming(r, numbers);
    };
    sample_mean mean;
    for (std::uint64_t i = 0; i < 512; ++i) {
        const gather_point<double> point{.position = at, .normal = n};
        mean.add(gather_once(incoming, point, random_numbers<double>{{.path = i}}, hemisphere_shape{24, 48}));
    }
    return mean;
}

/// The same by quadrature over the hole: `seen` tells the radiance from a direction through one of its points.
template <typename Seen>
double through_hole(int axis, double at, const vec3<double>& low, const vec3<double>& high, const vec3<double>& x,
                    const vec3<double>& n, const Seen& seen) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    return statistics::integral(low[u], high[u], 80, [&](double a) {
        return statistics::integral(low[v], high[v], 80, [&](double b) {
            vec3<double> p{};
            p[axis] = at;
            p[u] = a;
            p[v] = b;
            const double d2 = distance2(p, x);
            const vec3<double> w = (p - x) / std::sqrt(d2);
            const double cosine = glm::dot(w, n);
            return cosine > 0 ? seen(p, w) * cosine * std::abs(w[axis]) / d2 : 0.0;
        });
    });
}

}  // namespace

TEST_CASE("stability 22: unit squares a unit apart exchange 0.19982") {
    CHECK(parallel_squares(1) == Approx(0.19982489569838746).epsilon(1e-14));
    CHECK(exchanged(glowing({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1})) == Approx(0.19982489569838746).epsilon(2e-3));
}

TEST_CASE("stability 23: unit squares that share an edge exchange 0.20004, and a cube is closed") {
    CHECK(perpendicular_squares() == Approx(0.20004377607540316).epsilon(1e-14));
    CHECK(std::abs(parallel_squares(1) + 4 * perpendicular_squares() - 1) <= 1e-15);
    // Near the edge a few points see most of the light: no square root of n there.
    CHECK(exchanged(glowing({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0})) == Approx(0.20004377607540316).epsilon(1e-2));
}

TEST_CASE("stability 24: coaxial discs exchange what Howell's catalogue says") {
    CHECK(coaxial_discs(1, 1, 1) == Approx(0.3819660112501051).epsilon(1e-14));
    CHECK(coaxial_discs(1, 2, 1) == Approx(0.7639320225002102).epsilon(1e-14));
    for (const double r2 : {1.0, 2.0}) {
        const gray_panel light = glowing({-r2, -r2, 1}, {2 * r2, 0, 0}, {0, 2 * r2, 0}, {0, 0, -1}, true);
        sample_mean mean;
        for (std::uint32_t i = 0; i < 2048; ++i) {
            const vec2<double> u = sobol_sampler<double>{3, i}.next_2d();
            const vec2<double> d = concentric_disc(u);
            mean.add(direct_irradiance(gray_scene{}, light, vec3<double>{d.x, d.y, 0}, up, 1e-12, 16, i) / pi_d);
        }
        CHECK(mean.agrees(coaxial_discs(1, r2, 1)));
    }
}

TEST_CASE("stability 25: a disc on the axis gives pi L R2 / (R2 + h2)") {
    for (const double h : {0.1, 1.0, 30.0}) {
        const gray_panel light = glowing({-1, -1, h}, {2, 0, 0}, {0, 2, 0}, {0, 0, -1}, true);
        CHECK(sampled(light, {0, 0, 0}, up, h < 0.5 ? 65536 : 4096) == Approx(under_disc(1, h)).epsilon(5e-3));
    }
}

TEST_CASE("stability 26: a ball above the horizon gives pi L (R / d)2 cos") {
    // By paths that meet the ball, gathered over the hemisphere's strata.
    const double d = 2;
    const double r = 0.8;
    for (const double degrees : {0.0, 30.0, 60.0}) {
        const double angle = degrees * pi_d / 180;
        const quadric_scene<double> ball{
            {quadric<double>::sphere(vec3<double>{std::sin(angle), 0, std::cos(angle)} * d, r, {.glow = 1})}};
        const blind<double> nobody;
        double sum = 0;
        const std::uint32_t n = 1 << 16;
        for (std::uint32_t i = 0; i < n; ++i) {
            const vec3<double> w = cosine_hemisphere(sobol_sampler<double>{3, i}.next_2d());
            sum += path_trace(ball, nobody, ray<double>{{}, w}, random_numbers<double>{{.path = i}});
        }
        CHECK(sum * pi_d / n == Approx(pi_d * (r / d) * (r / d) * std::cos(angle)).epsilon(5e-3));
    }
}

TEMPLATE_TEST_CASE("stability 27: Lambert's formula by atan2 is right to 16 ulp of its terms at any distance", "",
                   float, double) {
    using T = TestType;
    for (double h = 1e-6; h < 2e8; h *= 10) {
        CAPTURE(h);
        CHECK(agrees(square_at<T>(h, 0.5)));
        CHECK(agrees(square_at<T>(h, 0.5, 0.3)));
        CHECK(agrees(square_at<T>(1, 1e-6 * h)));
        CHECK(agrees(square_at<T>(1e-3, 0.5, h)));
    }
    // Upright and partly below the horizon.
    const std::vector<corner<T>> upright{{1, -1, T(-0.5)}, {1, 1, T(-0.5)}, {1, 1, 2}, {1, -1, 2}};
    CHECK(agrees(upright));
    CHECK(lambert_polygon(upright).irradiance > 0);
    CHECK(lambert_polygon(square_at<T>(-1, 1)).irradiance == 0);
    // Far below a small square: pi E = area / h², to the bit of the formula.
    CHECK(lambert_polygon(square_at<T>(1e6, 0.5)).irradiance == Approx(1e-12).epsilon(1e-5));
}

TEST_CASE("stability 28: an endless wall takes half of the sky, a corner three quarters") {
    quadric_scene<double> scene;
    const even_sky<double> sky;
    const auto irradiance = [&] {
        const path_tracer tracer{scene, sky};
        const auto incoming = [&](const ray<double>& r, const random_numbers<double>& n) {
            return tracer.incoming(r, n);
        };
        return gather_once(incoming, gather_point<double>{.position = {1e-9, 1e-9, 0}}, random_numbers<double>{{}},
                           hemisphere_shape{32, 512});
    };
    const double open = irradiance();
    CHECK(open == Approx(pi_d).epsilon(1e-12));
    scene.shapes.push_back(quadric<double>::plane(0, 0, {}));
    // At most one sector of 512 is cut by each border.
    CHECK(irradiance() == Approx(open / 2).epsilon(4.0 / 512));
    scene.shapes.push_back(quadric<double>::plane(1, 0, {}));
    CHECK(irradiance() == Approx(open / 4).epsilon(8.0 / 512));
}

TEST_CASE("stability 29: a bulb however near is 1 / d2, or black where that is no number, never infinite") {
    for (const double d : {1e-2, 1e-8, 1e-20, 1e-100}) {
        const gray_bulb light{.position = {0, 0, d}, .intensity = 1};
        random_sampler<double> random{1};
        const auto seen = light.illuminate(vec3<double>{0}, random);
        CHECK(seen->radiance_over_pdf == Approx(1 / (d * d)).epsilon(1e-14));
    }
    support::toy_scene<float, float> scene;
    support::toy_hit<float, float> hit;
    const support::material<float> white{.diffuse = 1};
    hit.normal = {0, 0, 1};
    hit.made_of = &white;
    for (const float d : {1e-2f, 1e-8f, 1e-20f, 1e-30f, 0.0f}) {
        const support::bulb<float, float> light{.position = {0, 0, d}, .intensity = 1};
        const float radiance =
            direct_light(scene, light, hit, {0, 0, 1}, 0.0f, random_sampler<float>{1}, {.scattered = lobe_set::none});
        CAPTURE(d, radiance);
        CHECK(is_radiance(radiance));
        if (d >= 1e-8f) { CHECK(radiance == Approx(1 / (aglow::pi<float> * d * d)).epsilon(1e-5)); }
    }
}

TEST_CASE("stability 30: light that grazes a surface is never negative, and exactly nothing from below") {
    const gray_scene empty;
    support::toy_hit<double, double> hit;
    const support::material<double> white{.diffuse = 1};
    hit.normal = up;
    hit.made_of = &white;
    const auto lit = [&](double cosine) {
        const gray_bulb light{.position = {std::sqrt(1 - cosine * cosine), 0, cosine}, .intensity = 1};
        return direct_light(empty, light, hit, up, 0.0, random_sampler<double>{1}, {.scattered = lobe_set::none});
    };
    CHECK(lit(1e-7) == Approx(1e-7 / pi_d).epsilon(1e-6));
    CHECK(lit(0) == 0);
    CHECK(lit(-1e-9) == 0);
    CHECK(lit(-1) == 0);
}

TEST_CASE("stability 31: a needle a hundred million times as long as wide shines as the formula says") {
    // A triangle of base 1e-8 and length 1, one above the floor, radiance 1.
    const vec3<double> a{0, 0, 1};
    const vec3<double> b{1, 0, 1};
    const vec3<double> c{0, 1e-8, 1};
    const double area = 0.5e-8;
    double sum = 0;
    std::vector<double> counts(16);
    const std::uint32_t n = 1 << 14;
    for (std::uint32_t i = 0; i < n; ++i) {
        const vec2<double> u = sobol_sampler<double>{5, i}.next_2d();
        const vec2<double> w = uniform_triangle(u);
        const vec3<double> p = a + (b - a) * w.x + (c - a) * w.y;
        const double d2 = length2(p);
        sum += area * (p.z / std::sqrt(d2)) * (p.z / std::sqrt(d2)) / d2 / n;
        // The area of the triangle beyond x is (1 - x)².
        ++counts[static_cast<std::size_t>((1 - p.x) * (1 - p.x) * 15.999)];
    }
    // By the width of the needle at x: the integral of 1e-8 (1 - x) / (1 + x²)².
    const double exact = 1e-8 * statistics::integral(0, 1, 8, [](double x) { return (1 - x) / square(1 + x * x); });
    CHECK(sum == Approx(exact).epsilon(1e-3));
    CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    const std::vector<corner<double>> needle{{0, 0, 1}, {1, 0, 1}, {0, 1e-8, 1}};
    CHECK(agrees(needle));
    CHECK(agrees(std::vector<corner<float>>{{0, 0, 1}, {1, 0, 1}, {0, 1e-8f, 1}}));
    // Two long terms that all but cancel: right to the ulp of those, not of what is left.
    CHECK(lambert_polygon(needle).irradiance == Approx(exact).margin(16 * 2.3e-16));
}

TEST_CASE("stability 32: lights without area give no light, are never chosen, and divide by nothing") {
    for (const auto& [u, v] : {std::pair{vec3<double>{0}, vec3<double>{0, 1, 0}}, {vec3<double>{0}, vec3<double>{0}}}) {
        const gray_panel light = glowing({0, 0, 1}, u, v, {0, 0, -1});
        CHECK(sampled(light, {0, 0, 0}, up, 64) == 0);
        random_sampler<double> random{1};
        CHECK(light.emit(random).power == 0);
    }
    // Degenerate polygons are black by the formula.
    CHECK(lambert_polygon(std::vector<corner<double>>{{0, 0, 1}, {1, 0, 1}, {0.5, 0, 1}}).irradiance == 0);
    CHECK(lambert_polygon(std::vector<corner<double>>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}).irradiance == 0);
}

TEST_CASE("stability 33: the rooms of CIE 171 have the light that their geometry says") {
    SECTION("5.8: in a closed room the mean indirect irradiance is power rho / (area (1 - rho))") {
        const double half = 2;
        for (const double rho : {0.3, 0.7}) {
            gray_scene room{.rectangles = support::box_walls<double, double>(half, {.diffuse = rho})};
            energy_ledger<double> ledger;
            double landed = 0;
            const std::uint64_t paths = 20000;
            for (std::uint64_t i = 0; i < paths; ++i) {
                walk_photon(room, gray_bulb{.intensity = 1 / (4 * pi_d)}, random_numbers<double>{{.path = i}}, 0,
                            ledger, [&](const auto&, const vec3<double>&, double power, photon_history h) {
                                landed += h == photon_history::direct ? 0 : power;
                                return true;
                            });
            }
            CHECK(landed / static_cast<double>(paths) == Approx(rho / (1 - rho)).epsilon(0.03));
        }
    }
    SECTION("5.6 and 5.7: a wall lit evenly lights a floor by its form factor, less what stands between") {
        const support::polygon wall{{2, -2, 0}, {2, 2, 0}, {2, 2, 4}, {2, -2, 4}};
        const support::polygon screen{{1, -0.5, 0}, {1, 0.5, 0}, {1, 0.5, 2}, {1, -0.5, 2}};
        const gray_panel light = glowing({2, -2, 0}, {0, 4, 0}, {0, 0, 4}, {-1, 0, 0});
        const gray_scene obstructed{
            .rectangles = {{.corner = {1, -0.5, 0}, .u = {0, 1, 0}, .v = {0, 0, 2}, .normal = {-1, 0, 0}}}};
        for (const double x : {-1.5, 0.0, 0.75}) {
            const vec3<double> at{x, 0.25, 0};
            const double open = support::irradiance(at, up, wall);
            const double hidden = support::irradiance(at, up, support::hidden(at, wall, screen));
            CHECK(sampled(light, at, up, 16384) == Approx(open).epsilon(0.01));
            CHECK(direct_irradiance(obstructed, light, at, up, 1e-9, 16384, 3) ==
                  Approx(open - hidden).epsilon(0.02).margin(1e-3));
        }
    }
    SECTION("5.9 and 5.10: an even sky through an opening lights a floor by the opening's form factor") {
        for (const bool roof : {true, false}) {
            const gray_panel opening = roof ? glowing({-0.5, -0.5, 3}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1})
                                            : glowing({2, -1, 1}, {0, 2, 0}, {0, 0, 1}, {-1, 0, 0});
            const auto& q = opening.shape;
            const support::polygon edge{q.corner, q.corner + q.u, q.corner + q.u + q.v, q.corner + q.v};
            for (const double x : {-1.0, 0.0, 1.5}) {
                const vec3<double> at{x, 0.5, 0};
                CHECK(sampled(opening, at, up) == Approx(support::irradiance(at, up, edge)).epsilon(5e-3));
            }
        }
    }
    const auto overcast = [](const vec3<double>& w) { return w.z > 0 ? (1 + 2 * w.z) / 3 : 0; };
    const auto clear = [&](const vec3<double>&, const vec3<double>& w) { return overcast(w); };
    // Of both polarisations, through both sides of a pane, with all that goes back and forth in it.
    const auto pane = [&](double cosine) {
        const double r = host::fresnel(cosine, 1.5);
        return (1 - r) / (1 + r);
    };
    SECTION("5.9 and 5.10: an overcast sky through a roof, open and glazed") {
        const vec3<double> low{-0.5, -0.5, 0};
        const vec3<double> high{0.5, 0.5, 0};
        quadric_scene<double> open{wall_with_hole(2, 3, low, high)};
        auto glazed = open;
        glazed.shapes.push_back(piece(2, 3, low, high, {.glass = 1.5}));
        glazed.shapes.push_back(piece(2, 3 + 1e-6, low, high, {.glass = 1.5}));
        glazed.shapes[4].linear.z = -1;
        glazed.shapes[4].constant = 3;
        for (const double x : {-1.0, 0.0, 1.5}) {
            const vec3<double> at{x, 0.25, 0};
            CHECK(by_rays(open, at, up).agrees(through_hole(2, 3, low, high, at, up, clear)));
            const auto dimmed = [&](const vec3<double>& p, const vec3<double>& w) { return pane(w.z) * clear(p, w); };
            CHECK(by_rays(glazed, at, up).agrees(through_hole(2, 3, low, high, at, up, dimmed), 4, 1e-4));
        }
    }
    SECTION("5.11 and 5.12: the same sky and the ground under it, through a window, open and glazed") {
        const vec3<double> low{0, -1, 1};
        const vec3<double> high{0, 1, 2};
        // The ground before an endless wall sees half of the sky, 7 pi / 18 of the zenith's radiance.
        const double far = endless<double>;
        const double rho = 0.3;
        auto shapes = room_with_window(low, high);
        shapes.push_back(piece(2, 0, {1e-9, -far, 0}, {far, far, 0}, {.diffuse = rho}));
        const quadric_scene<double> open{shapes};
        quadric_scene<double> glazed{shapes};
        glazed.shapes.push_back(piece(0, 0, low, high, {.glass = 1.5}));
        glazed.shapes.push_back(piece(0, 1e-6, low, high, {.glass = 1.5}));
        glazed.shapes[shapes.size()].linear.x = -1;
        const auto outside = [&](const vec3<double>&, const vec3<double>& w) {
            return w.z > 0 ? overcast(w) : rho * 7 / 18;
        };
        for (const auto& [at, n] :
             {std::pair{vec3<double>{-1, 0.25, 0.8}, up}, {{-2, 0, 2.5}, -up}, {{-1.5, 0.5, 1.2}, {1, 0, 0}}}) {
            const auto dimmed = [&](const vec3<double>& p, const vec3<double>& w) {
                return pane(std::abs(w.x)) * outside(p, w);
            };
            CHECK(by_rays(open, at, n).agrees(through_hole(0, 0, low, high, at, n, outside)));
            CHECK(by_rays(glazed, at, n).agrees(through_hole(0, 0, low, high, at, n, dimmed), 4, 1e-4));
        }
    }
    SECTION("5.13 and 5.14: through a window under a roof that juts out, and behind a lower house across the street") {
        const vec3<double> low{0, -1, 1};
        const vec3<double> high{0, 1, 2};
        const double far = endless<double>;
        auto jutting = room_with_window(low, high);
        jutting.push_back(piece(2, 2.2, {0, -far, 0}, {1, far, 0}));
        auto street = room_with_window(low, high);
        street.push_back(piece(0, 6, {0, -far, -far}, {0, far, 4}, {.glow = 0.2}));
        const auto under_roof = [&](const vec3<double>& p, const vec3<double>& w) {
            const double x = p.x + (2.2 - p.z) / w.z * w.x;
            return w.z > 0 && x < 1 ? 0.0 : overcast(w);
        };
        const auto across = [&](const vec3<double>& p, const vec3<double>& w) {
            return p.z + 6 / w.x * w.z < 4 ? 0.2 : overcast(w);
        };
        for (const auto& [at, n] :
             {std::pair{vec3<double>{-1, 0.25, 0.8}, up}, {{-3, 0, 0.8}, up}, {{-1.5, 0.5, 1.2}, {1, 0, 0}}}) {
            CHECK(by_rays({jutting}, at, n).agrees(through_hole(0, 0, low, high, at, n, under_roof), 4, 1e-3));
            // What glows is met by gather rays at their first hit, where the asker would have looked himself.
            const auto glow = [&](const vec3<double>& p, const vec3<double>& w) {
                return p.z + 6 / w.x * w.z < 4 ? 0.0 : overcast(w);
            };
            CHECK(by_rays({street}, at, n).agrees(through_hole(0, 0, low, high, at, n, glow), 4, 1e-3));
            CHECK(through_hole(0, 0, low, high, at, n, across) >= through_hole(0, 0, low, high, at, n, glow));
        }
    }
}
