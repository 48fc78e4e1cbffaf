#include "common/bsdf.hpp"

#include <vector>

#include <aglow/core/sobol.hpp>

#include "support/catch.hpp"
#include "support/laws.hpp"

namespace {

using aglow::lobe_set;
using aglow::vec3;

template <typename T>
struct named_material {
    const char* name;
    host::material<T> made_of;
};

/// One of each kind, and the mixtures.
template <typename T>
std::vector<named_material<T>> kinds() {
    const auto gray = [](double x) { return vec3<T>{static_cast<T>(x)}; };
    return {{"black", {}},
            {"Lambert", {.diffuse = {T(0.8), T(0.5), T(0.1)}}},
            {"translucent", {.diffuse = gray(0.3), .translucent = {T(0.6), T(0.2), T(0)}}},
            {"rough metal", {.glossy = {T(0.9), T(0.6), T(0.3)}, .roughness = T(0.4)}},
            {"satin metal", {.glossy = gray(0.95), .roughness = T(0.15)}},
            {"diffuse and faint gloss", {.diffuse = gray(0.7), .glossy = gray(0.04), .roughness = T(0.25)}},
            {"diffuse and strong gloss", {.diffuse = gray(0.5), .glossy = gray(0.5), .roughness = T(0.7)}},
            {"mirror", {.mirror = {T(0.9), T(0.8), T(0.7)}}},
            {"diffuse and mirror", {.diffuse = gray(0.5), .mirror = gray(0.3)}},
            {"all that is flat", {.diffuse = gray(0.3), .translucent = gray(0.3), .mirror = gray(0.4)}},
            {"glass", {.index = T(1.5)}}};
}

template <typename T>
vec3<T> albedo(const host::bsdf<T>& b, const vec3<T>& wo, lobe_set asked) {
    constexpr std::uint32_t n = 1u << 14;
    vec3<T> sum{0};
    for (std::uint32_t i = 0; i < n; ++i) {
        aglow::sobol_sampler<T> random{9, i};
        if (const auto s = b.sample(vec3<T>{0, 0, 1}, wo, random, asked)) { sum += s->weight; }
    }
    return sum / T(n);
}

vec3<double> at(double cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }

}  // namespace

TEMPLATE_TEST_CASE("bsdf: every material keeps the laws of surfaces", "", float, double) {
    for (const auto& kind : kinds<TestType>()) {
        const host::bsdf<TestType> b{kind.made_of};
        const host::surface_hit<TestType> hit{.normal = glm::normalize(vec3<TestType>{1, -2, 3}), .scatterer = &b};
        laws::surface_options options{.samples = 6000, .grid = 96};
        if (kind.made_of.roughness < TestType(0.2)) { options.grid = 192; }
        const laws::verdict v = laws::surface(hit, options);
        INFO(kind.name << ": " << v.message);
        CHECK(v.ok);
    }
}

TEST_CASE("bsdf: albedo of Lambert, mirror and glass is what was asked for, from both sides") {
    const host::bsdf<double> sheet{{.diffuse = vec3<double>{0.25}, .translucent = vec3<double>{0.5}}};
    const host::bsdf<double> mirror{{.mirror = vec3<double>{0.9}}};
    const host::bsdf<double> glass{{.index = 1.5}};
    for (const double cosine : {0.05, 0.5, 1.0, -0.3, -0.9}) {
        CHECK(albedo(sheet, at(cosine), lobe_set::reflection).x == Approx(0.25));
        CHECK(albedo(sheet, at(cosine), lobe_set::transmission).x == Approx(0.5));
        CHECK(albedo(sheet, at(cosine), lobe_set::all).x == Approx(0.75));
        CHECK(albedo(mirror, at(cosine), lobe_set::all).x == Approx(0.9));
        CHECK(albedo(glass, at(cosine), lobe_set::all).x == Approx(1));
        const double eta = cosine > 0 ? 1.5 : 1 / 1.5;
        CHECK(albedo(glass, at(cosine), lobe_set::reflection).x == Approx(host::fresnel(std::abs(cosine), eta)));
    }
}

TEST_CASE("bsdf: a diffuse part stays Lambert's beside gloss, and both never make more than 1") {
    const host::bsdf<double> b{{.diffuse = vec3<double>{0.6}, .glossy = vec3<double>{0.2}, .roughness = 0.1}};
    double before = 0;
    for (const double cosine : {1.0, 0.5, 0.2, 0.05}) {
        CHECK(albedo(b, at(cosine), lobe_set::diffuse).x == Approx(0.6));
        CHECK(b.evaluate({0, 0, 1}, at(cosine), at(0.3), lobe_set::diffuse).x == Approx(0.6 / aglow::pi<double>));
        const double gloss = albedo(b, at(cosine), lobe_set::glossy).x;
        CHECK(gloss <= 0.4);
        CHECK(gloss > before);
        before = gloss;
    }
    CHECK(before > 0.25);
}

TEST_CASE("bsdf: a smooth metal of reflectance 1 loses little, a rough one what quadrature says") {
    // Single scattering at normal incidence, by quadrature over the one angle that is left.
    const host::ggx<double> facets{1};
    const double quadrature = statistics::integral(0, aglow::pi<double> / 2, 400, [&](double theta) {
        const vec3<double> wi{std::sin(theta), 0, std::cos(theta)};
        const vec3<double> h = glm::normalize(wi + vec3<double>{0, 0, 1});
        const double f = facets.density(h) * facets.seen(vec3<double>{0, 0, 1}, wi) / (4 * wi.z);
        return 2 * aglow::pi<double> * std::sin(theta) * f * wi.z;
    });
    const host::bsdf<double> rough{{.glossy = vec3<double>{1}, .roughness = 1}};
    CHECK(albedo(rough, at(1), lobe_set::all).x == Approx(quadrature).epsilon(2e-3));
    const host::bsdf<double> smooth{{.glossy = vec3<double>{1}, .roughness = 0.02}};
    CHECK(albedo(smooth, at(0.8), lobe_set::all).x == Approx(1).epsilon(2e-3));
}

TEMPLATE_TEST_CASE("fresnel: exactly 1 at total reflection, exactly 0 at equal indices", "", float, double) {
    using T = TestType;
    for (int i = 0; i <= 64; ++i) { CHECK(host::fresnel(T(i) / 64, T(1)) == 0); }
    const T critical = std::sqrt(1 - T(1) / (T(1.5) * T(1.5)));
    for (int i = 0; i < 16; ++i) { CHECK(host::fresnel(critical * T(i) / 16, 1 / T(1.5)) == 1); }
    CHECK(host::fresnel(T(0), T(1.5)) == Approx(1));
    CHECK(host::fresnel(T(1), T(1.5)) == Approx(0.04));
}

TEST_CASE("fresnel: at Brewster's angle only light across the plane is reflected") {
    const double n = 1.5;
    const double cosine = 1 / std::sqrt(1 + n * n);
    // tan = n: the reflected and the bent ray are at right angles, r_s = (1 - n^2) / (1 + n^2).
    const double across = (1 - n * n) / (1 + n * n);
    CHECK(host::fresnel(cosine, n) == Approx(across * across / 2));
}

TEST_CASE("fresnel: the same from both sides along one bent ray") {
    for (const double cosine : {0.1, 0.4, 0.8, 1.0}) {
        const auto inside = host::refracted(at(cosine), vec3<double>{0, 0, 1}, 1.7);
        REQUIRE(inside);
        CHECK(std::abs(inside->x) == Approx(std::sqrt(1 - cosine * cosine) / 1.7).margin(1e-15));
        CHECK(host::fresnel(cosine, 1.7) == Approx(host::fresnel(-inside->z, 1 / 1.7)));
        const auto out = host::refracted(*inside, vec3<double>{0, 0, -1}, 1 / 1.7);
        REQUIRE(out);
        CHECK(glm::length(*out - at(cosine)) < 1e-12);
    }
}

TEST_CASE("material: one that gives out more than it gets is refused") {
    using m = host::material<float>;
    const auto gray = [](float x) { return vec3<float>{x}; };
    CHECK_THROWS_AS(host::bsdf<float>(m{.diffuse = gray(0.7f), .translucent = gray(0.7f)}), std::invalid_argument);
    CHECK_THROWS_AS(host::bsdf<float>(m{.diffuse = gray(0.7f), .mirror = gray(0.7f)}), std::invalid_argument);
    CHECK_THROWS_AS(host::bsdf<float>(m{.diffuse = gray(-0.1f)}), std::invalid_argument);
    CHECK_THROWS_AS(host::bsdf<float>(m{.glossy = gray(0.5f), .roughness = 0}), std::invalid_argument);
    CHECK_THROWS_AS(host::bsdf<float>(m{.diffuse = gray(0.5f), .index = 1.5f}), std::invalid_argument);
}
