// The laws accept what is lawful, and name the law that is broken: each by a type with that one flaw.
#include "support/laws.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <thread>

#include <aglow/concepts/lambert.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/sobol.hpp>

#include "support/archetypes.hpp"
#include "support/catch.hpp"

namespace {

using aglow::lobe_set;
using aglow::vec2;
using aglow::vec3;

void accepted(const laws::verdict& v) {
    INFO(v.message);
    CHECK(v.ok);
}
void refused(const laws::verdict& v, const std::string& words) {
    INFO(v.message << ", expected " << words);
    CHECK_FALSE(v.ok);
    CHECK(v.message.find(words) != std::string::npos);
}

/// What is wrong with a `painted` surface.
enum class flaw {
    none,
    not_reciprocal,
    too_bright,
    density_of_another,
    weight_of_one_lobe,
    lobe_not_asked,
    evaluates_all,
    hidden_lobe,
    samples_crooked,
    specular_evaluates,
    often_empty
};

/// Matte and Phong-glossy (Lafortune & Willems 1994) reflection, a mirror, and matte transmission, on both sides.
template <typename T>
struct painted {
    vec3<T> position{};
    vec3<T> normal{0, 0, 1};
    flaw wrong{flaw::none};

    static constexpr T exponent = 20;

    [[nodiscard]] lobe_set lobes() const {
        const lobe_set most = lobe_set::diffuse | lobe_set::specular_reflection;
        return wrong == flaw::hidden_lobe ? most : most | lobe_set::glossy_reflection;
    }

    [[nodiscard]] vec3<T> evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        if (wrong == flaw::evaluates_all) { asked = lobe_set::all; }
        const T tilt = wrong == flaw::not_reciprocal ? std::abs(wi.z) : T(1);
        const T bright = wrong == flaw::too_bright ? T(3) : T(1);
        vec3<T> f{};
        if (any(asked, lobe_set::diffuse_reflection) && wo.z * wi.z > 0) {
            f += vec3<T>{T(.3), T(.2), T(.1)} * (tilt * bright / aglow::pi<T>);
        }
        if (any(asked, lobe_set::diffuse_transmission) && wo.z * wi.z < 0) { f += vec3<T>(T(.1) / aglow::pi<T>); }
        if (any(asked, lobe_set::glossy_reflection) && wo.z * wi.z > 0) {
            f += vec3<T>(T(.2) * (exponent + 2) / (2 * aglow::pi<T>)*phong(wo, wi));
        }
        if (wrong == flaw::specular_evaluates && any(asked, lobe_set::specular)) { f += vec3<T>(T(.01)); }
        return f;
    }

    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        const T cosine = std::abs(wi.z);
        const bool same = wo.z * wi.z > 0;
        T sum = 0;
        if (any(asked, lobe_set::diffuse_reflection) && same) { sum += cosine / aglow::pi<T>; }
        if (any(asked, lobe_set::diffuse_transmission) && wo.z * wi.z < 0) { sum += cosine / aglow::pi<T>; }
        const T power = wrong == flaw::density_of_another ? T(0.5) : T(1);
        if (any(asked, lobe_set::glossy_reflection) && same) {
            sum += (exponent + 1) / (2 * aglow::pi<T>)*std::pow(phong(wo, wi), power);
        }
        return count(asked) > 0 ? sum / T(count(asked)) : T(0);
    }

    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::scatter_sample<vec3<T>, T>> sample(const vec3<T>& wo, R& random,
                                                                          lobe_set asked) const {
        const int n = count(asked);
        if (n == 0) { return std::nullopt; }
        int skip = static_cast<int>(random.next_1d() * T(n));
        lobe_set drawn = lobe_set::none;
        for (const lobe_set lobe : laws::detail::single_lobes) {
            if (any(lobe, asked & offered()) && skip-- == 0) { drawn = lobe; }
        }
        vec2<T> u = random.next_2d();
        if (wrong == flaw::often_empty && u.x < T(0.1)) { return std::nullopt; }
        if (wrong == flaw::samples_crooked) { u.x = u.x * u.x; }
        const T side = wo.z < 0 ? T(-1) : T(1);
        const vec3<T> mirrored{-wo.x, -wo.y, wo.z};
        if (drawn == lobe_set::specular_reflection) { return {{mirrored, vec3<T>(T(.2) * T(n)), T(0), drawn}}; }
        vec3<T> wi;
        if (drawn == lobe_set::glossy_reflection) {
            const T cosine = std::pow(1 - u.x, 1 / (exponent + 1));
            const T sine = std::sqrt(std::max(T(0), 1 - cosine * cosine));
            const T phi = 2 * aglow::pi<T> * u.y;
            wi = aglow::frame<T>{mirrored}.to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
            if (!(wi.z * wo.z > 0)) { return std::nullopt; }
        } else {
            wi = aglow::cosine_hemisphere(u) * (drawn == lobe_set::diffuse_transmission ? -side : side);
        }
        const lobe_set seen = wrong == flaw::weight_of_one_lobe ? drawn : asked;
        const T density = pdf(wo, wi, asked);
        const lobe_set named = wrong == flaw::lobe_not_asked ? lobe_set::glossy_transmission : drawn;
        return {{wi, evaluate(wo, wi, seen) * (std::abs(wi.z) / density), density, named}};
    }

private:
    static lobe_set offered() {
        return lobe_set::diffuse | lobe_set::specular_reflection | lobe_set::glossy_reflection;
    }
    static int count(lobe_set asked) {
        const auto& all = laws::detail::single_lobes;
        return static_cast<int>(
            std::count_if(all.begin(), all.end(), [&](lobe_set l) { return any(l, asked & offered()); }));
    }
    static T phong(const vec3<T>& wo, const vec3<T>& wi) {
        const vec3<T> mirrored{-wo.x, -wo.y, wo.z};
        return std::pow(std::max(T(0), glm::dot(mirrored, wi)), exponent);
    }
};

/// Smooth glass of index 1.5, radiance weights with the square of the indices, below the plane.
struct glass {
    vec3<double> position{};
    vec3<double> normal{0, 0, 1};
    bool squares_told{true};

    [[nodiscard]] lobe_set lobes() const { return lobe_set::specular; }
    [[nodiscard]] double evaluate(const vec3<double>&, const vec3<double>&, lobe_set) const { return 0; }
    [[nodiscard]] double pdf(const vec3<double>&, const vec3<double>&, lobe_set) const { return 0; }
    [[nodiscard]] double adjoint(const vec3<double>& wo, const vec3<double>& wi) const {
        if (!squares_told || wo.z * wi.z > 0) { return 1; }
        return wo.z > 0 ? 1.5 * 1.5 : 1 / (1.5 * 1.5);
    }
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::scatter_sample<double, double>> sample(const vec3<double>& wo, R& random,
                                                                              lobe_set asked) const {
        const bool reflects = any(asked, lobe_set::specular_reflection);
        const bool transmits = any(asked, lobe_set::specular_transmission);
        const double eta = wo.z > 0 ? 1 / 1.5 : 1.5;
        const double sine2 = eta * eta * (1 - wo.z * wo.z);
        const double r = sine2 >= 1 ? 1 : fresnel(std::abs(wo.z), std::sqrt(1 - sine2), eta);
        const double p = reflects ? (transmits ? r : 1) : 0;
        if (!reflects && !transmits) { return std::nullopt; }
        if (random.next_1d() < p) { return {{{-wo.x, -wo.y, wo.z}, r / p, 0, lobe_set::specular_reflection}}; }
        if (sine2 >= 1) { return std::nullopt; }
        const double z = std::copysign(std::sqrt(1 - sine2), -wo.z);
        return {{{-eta * wo.x, -eta * wo.y, z}, (1 - r) / (1 - p) * eta * eta, 0, lobe_set::specular_transmission}};
    }

    static double fresnel(double o, double i, double eta) {
        const double s = (eta * o - i) / (eta * o + i);
        const double p = (eta * i - o) / (eta * i + o);
        return (s * s + p * p) / 2;
    }
};

/// Matte around a shading normal that leans away from the geometric one.
struct bent {
    vec3<float> position{};
    vec3<float> normal{0, 0, 1};
    bool adjoint_told{true};

    static vec3<float> shading() { return glm::normalize(vec3<float>{0.2f, 0.1f, 1}); }
    static bool above(const vec3<float>& w) { return w.z > 0 && glm::dot(w, shading()) > 0; }

    [[nodiscard]] lobe_set lobes() const { return lobe_set::diffuse_reflection; }
    [[nodiscard]] float evaluate(const vec3<float>& wo, const vec3<float>& wi, lobe_set asked) const {
        if (!any(asked, lobes()) || !above(wo) || !above(wi)) { return 0; }
        return 0.5f / aglow::pi<float> * glm::dot(wi, shading()) / wi.z;
    }
    [[nodiscard]] float pdf(const vec3<float>& wo, const vec3<float>& wi, lobe_set asked) const {
        if (!any(asked, lobes()) || !above(wo) || !above(wi)) { return 0; }
        return aglow::cosine_hemisphere_pdf(glm::dot(wi, shading()));
    }
    [[nodiscard]] float adjoint(const vec3<float>& wo, const vec3<float>& wi) const {
        if (!adjoint_told) { return 1; }
        return std::abs(glm::dot(wo, shading()) * wi.z / (wo.z * glm::dot(wi, shading())));
    }
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::scatter_sample<float, float>> sample(const vec3<float>& wo, R& random,
                                                                            lobe_set asked) const {
        const vec3<float> local = aglow::cosine_hemisphere(random.next_2d());
        const vec3<float> wi = aglow::frame<float>{shading()}.to_world(local);
        if (!any(asked, lobes()) || !above(wo) || !above(wi)) { return std::nullopt; }
        return {{wi, 0.5f, pdf(wo, wi, asked), lobes()}};
    }
};

void refused(flaw wrong, const std::string& words) { refused(laws::surface(painted<float>{.wrong = wrong}), words); }

}  // namespace

TEMPLATE_TEST_CASE("laws: a sampler that is uniform is accepted", "", float, double) {
    using T = TestType;
    accepted(laws::sampler([](std::uint64_t i) { return aglow::random_sampler<T>{aglow::mix(i)}; }));
    accepted(laws::sampler([](std::uint64_t i) { return aglow::sobol_sampler<T>{7, static_cast<std::uint32_t>(i)}; }));
    const aglow::halton_scrambling table{1};
    accepted(laws::sampler([&](std::uint64_t i) {
        return aglow::halton_numbers<T>{table, i}.at(0, aglow::purpose::emission);
    }));
    accepted(laws::sampler([](std::uint64_t i) { return archetypes::sampler<T>{aglow::mix(i)}; }));
}

TEST_CASE("laws: a sampler that reaches one, leans or repeats itself is refused") {
    struct reaches_one {
        double next_1d() { return 1; }
        vec2<double> next_2d() { return {1, 1}; }
    };
    refused(laws::sampler([](std::uint64_t) { return reaches_one{}; }), "not in [0, 1)");
    struct leans {
        aglow::random_sampler<double> random;
        double next_1d() { return std::pow(random.next_1d(), 1.02); }
        vec2<double> next_2d() { return {next_1d(), next_1d()}; }
    };
    refused(laws::sampler([](std::uint64_t i) { return leans{aglow::random_sampler<double>{aglow::mix(i)}}; }), "mean");
    struct repeats {
        aglow::random_sampler<double> random;
        double next_1d() { return random.next_1d(); }
        vec2<double> next_2d() { return vec2<double>(next_1d()); }
    };
    refused(laws::sampler([](std::uint64_t i) { return repeats{aglow::random_sampler<double>{aglow::mix(i)}}; }),
            "next_2d");
}

TEMPLATE_TEST_CASE("laws: lawful surfaces are accepted", "", float, double) {
    using T = TestType;
    const vec3<T> leaning = glm::normalize(vec3<T>{T(0.3), T(-0.5), T(-0.8)});
    accepted(laws::surface(aglow::lambert<vec3<T>, T>{{}, leaning, {T(0.9), T(0.5), T(0)}}));
    accepted(laws::surface(archetypes::surface<T>{{}, leaning}));
    accepted(laws::surface(painted<T>{}));
}

TEST_CASE("laws: glass and bent normals are lawful with their adjoint, and not without") {
    accepted(laws::surface(glass{}));
    refused(laws::surface(glass{.squares_told = false}), "albedo above one");
    accepted(laws::surface(bent{}));
    refused(laws::surface(bent{.adjoint_told = false}), "not reciprocal");
}

TEST_CASE("laws: a surface is refused for the law that it breaks") {
    refused(flaw::not_reciprocal, "not reciprocal");
    refused(flaw::too_bright, "albedo above one");
    refused(flaw::density_of_another, "mean weight is not");
    refused(flaw::weight_of_one_lobe, "sample and evaluate disagree");
    refused(flaw::lobe_not_asked, "was not asked for");
    refused(flaw::evaluates_all, "evaluate of no lobes is not black");
    refused(flaw::hidden_lobe, "which is not in lobes()");
    refused(flaw::samples_crooked, "directions do not follow pdf");
    refused(flaw::specular_evaluates, "evaluate of a specular lobe");
    refused(flaw::often_empty, "mean weight is not");
}

// Scenes.
namespace {

enum class scene_flaw { none, farthest, reach_ignored, long_normals, turned_normals, off_the_ray, one_way, one_thread };

/// Three balls, black and solid.
template <typename T>
struct balls {
    using scalar = T;
    scene_flaw wrong{scene_flaw::none};
    std::thread::id home{std::this_thread::get_id()};

    struct ball {
        vec3<T> centre;
        T radius;
    };
    static constexpr std::array<ball, 3> all{{{{0, 0, 0}, T(1)}, {{3, 0, 0}, T(0.5)}, {{0, 2, 2}, T(0.8)}}};

    [[nodiscard]] std::optional<archetypes::hit<T>> intersect(const aglow::ray<T>& r) const {
        T nearest = wrong == scene_flaw::farthest ? T(0) : std::numeric_limits<T>::infinity();
        const ball* met = nullptr;
        for (const ball& b : all) {
            for (const T t : roots(b, r)) {
                if (!(t > 0) || (wrong == scene_flaw::farthest ? t < nearest : t > nearest)) { continue; }
                nearest = t;
                met = &b;
            }
        }
        if (met == nullptr || (wrong != scene_flaw::reach_ignored && nearest >= r.reach)) { return std::nullopt; }
        if (wrong == scene_flaw::one_thread && std::this_thread::get_id() != home) { return std::nullopt; }
        const vec3<T> n = glm::normalize(r.origin + r.direction * nearest - met->centre);
        vec3<T> p = met->centre + n * met->radius;
        if (wrong == scene_flaw::off_the_ray) { p = p + vec3<T>(T(0.001)); }
        const bool turns = wrong == scene_flaw::turned_normals && glm::dot(n, r.direction) > 0;
        const T length = wrong == scene_flaw::long_normals ? T(1.01) : T(turns ? -1 : 1);
        return archetypes::hit<T>{{p.x, p.y, p.z}, archetypes::direction<T>{n * length}};
    }
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const {
        if (wrong == scene_flaw::one_way && a.x > b.x) { return false; }
        const T distance = glm::length(b - a);
        return intersect({a, (b - a) / distance, distance}).has_value();
    }

    static std::array<T, 2> roots(const ball& b, const aglow::ray<T>& r) {
        const vec3<T> o = r.origin - b.centre;
        const T along = glm::dot(o, r.direction);
        const T miss2 = aglow::length2(vec3<T>(o - r.direction * along));
        if (miss2 >= b.radius * b.radius) { return {T(-1), T(-1)}; }
        const T half = std::sqrt(b.radius * b.radius - miss2);
        return {-along - half, -along + half};
    }
};

template <typename T>
constexpr aglow::bounds<T> around_balls{{-4, -4, -4}, {4, 4, 4}};

}  // namespace

TEMPLATE_TEST_CASE("laws: lawful scenes are accepted", "", float, double) {
    using T = TestType;
    accepted(laws::intersector(balls<T>{}, around_balls<T>));
    accepted(laws::intersector(archetypes::scene<T>{}, {{-2, -2, -2}, {2, 2, 2}}));
}

TEST_CASE("laws: a scene is refused for the law that it breaks") {
    const auto check = [](scene_flaw wrong, const char* words) {
        refused(laws::intersector(balls<float>{.wrong = wrong}, around_balls<float>), words);
    };
    check(scene_flaw::farthest, "not the nearest");
    check(scene_flaw::reach_ignored, "not the nearest");
    check(scene_flaw::long_normals, "is not unit");
    check(scene_flaw::turned_normals, "must be the same from both sides");
    check(scene_flaw::off_the_ray, "off the ray");
    check(scene_flaw::one_way, "not symmetric");
    check(scene_flaw::one_thread, "from several threads");
    refused(laws::intersector(balls<float>{}, {{5000, 5000, 5000}, {5001, 5001, 5001}}), "nothing is shown");
}

// Lights.
namespace {

enum class light_flaw {
    none,
    forgets_cosine,
    tells_half_the_density,
    tells_half_the_distance,
    says_nothing_of_density
};

/// A glowing square of radiance 2, 1 x 1, a unit above the origin, facing down.
template <typename T>
struct panel {
    using scalar = T;
    light_flaw wrong{light_flaw::none};

    struct square : aglow::lambert<T, T> {
        [[nodiscard]] T emitted(const vec3<T>& wo) const { return wo.z < 0 ? T(2) : T(0); }
    };

    [[nodiscard]] std::optional<square> intersect(const aglow::ray<T>& r) const {
        const T t = (1 - r.origin.z) / r.direction.z;
        const vec3<T> p = r.origin + r.direction * t;
        if (!(t > 0) || !(t < r.reach) || std::abs(p.x) > T(0.5) || std::abs(p.y) > T(0.5)) { return std::nullopt; }
        return square{{p, {0, 0, -1}, T(0)}};
    }
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const {
        const vec3<T> d = b - a;
        return intersect({a, d, T(1)}).has_value();
    }

    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::illumination<T, T>> illuminate(const vec3<T>& point, R& random) const {
        const auto u = random.next_2d();
        const vec3<T> on{T(u.x) - T(0.5), T(u.y) - T(0.5), 1};
        const T distance = glm::length(on - point);
        const vec3<T> towards = (on - point) / distance;
        if (!(towards.z > 0)) { return std::nullopt; }
        const T cosine = wrong == light_flaw::forgets_cosine ? T(1) : towards.z;
        const T density = distance * distance / cosine;
        const T told = wrong == light_flaw::tells_half_the_distance ? distance / 2 : distance;
        return {{towards, told, 2 / density, density}};
    }
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& towards, const square& met) const {
        const T cosine = wrong == light_flaw::forgets_cosine ? T(1) : towards.z;
        const T told = aglow::distance2(met.position, point) / cosine;
        return wrong == light_flaw::tells_half_the_density ? told / 2 : told;
    }
};

/// A matte scene that says that it has mirrors alone.
struct narrow_panel : panel<float> {
    static constexpr aglow::lobe_set possible_lobes = aglow::lobe_set::specular;

    [[nodiscard]] auto intersect(const aglow::ray<float>& r) const {
        auto found = panel<float>::intersect(r);
        if (found) { found->albedo = 0.5f; }
        return found;
    }
};

/// Irradiance of the origin by the panel: four times that of a quarter seen from its corner's foot (Howell 2010, C-4),
/// in closed form.
double panel_irradiance() {
    const double a = 0.5;
    const double root = std::sqrt(1 + a * a);
    return 2 * 4 * (a / root) * std::atan(a / root);
}

}  // namespace

TEMPLATE_TEST_CASE("laws: lawful lights are accepted", "", float, double) {
    using T = TestType;
    using colour = archetypes::spectrum<T>;
    const colour intensity = colour::of(T(2), T(0.5));
    const T sphere = 4 * aglow::pi<T>;
    accepted(laws::emitter(archetypes::emitter<T>{intensity}, intensity * sphere));

    const archetypes::scene<T> scene;
    const archetypes::illuminator<T> light{intensity};
    const vec3<T> point{T(0.5), 0, 0};
    accepted(laws::illuminator(light, scene, point, {-1, 0, 0}, intensity * T(4)));
    accepted(
        laws::illuminator(light, scene, point, glm::normalize(vec3<T>{-1, 1, 0}), intensity * T(2 * std::sqrt(2.0))));

    const panel<T> lamp;
    accepted(laws::illuminator(lamp, lamp, vec3<T>{}, {0, 0, 1}, T(panel_irradiance())));
    accepted(laws::illuminator_meets_rays(lamp, lamp, vec3<T>{}, {0, 0, 1}));
    accepted(laws::illuminator_meets_rays(lamp, lamp, vec3<T>{T(0.7), T(0.2), 0}, glm::normalize(vec3<T>{-1, 0, 1})));
}

TEST_CASE("laws: a scene is refused whose hits have lobes that it says it cannot have") {
    const aglow::bounds<float> box{{-1, -1, -1}, {1, 1, 2}};
    accepted(laws::intersector(panel<float>{}, box));
    refused(laws::intersector(narrow_panel{}, box), "lobes that the scene says it cannot have");
}

TEST_CASE("laws: a light is refused for the law that it breaks") {
    using colour = archetypes::spectrum<double>;
    const colour intensity = colour::of(2, 0.5);
    refused(laws::emitter(archetypes::emitter<double>{intensity}, intensity * (4.05 * aglow::pi<double>)),
            "mean power");
    refused(laws::illuminator(archetypes::illuminator<double>{intensity}, archetypes::scene<double>{},
                              vec3<double>{0.5, 0, 0}, {-1, 0, 0}, intensity * 4.1),
            "mean is not the direct irradiance");
    const auto check = [](light_flaw wrong, const char* words) {
        const panel<double> lamp{.wrong = wrong};
        refused(laws::illuminator_meets_rays(lamp, lamp, vec3<double>{}, {0, 0, 1}), words);
    };
    check(light_flaw::forgets_cosine, "mean is not what rays meet");
    check(light_flaw::tells_half_the_density, "asked for the same direction");
    check(light_flaw::tells_half_the_distance, "but the light is met after");
}
