#include <aglow/estimators/irradiance_record.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

// Not in the unnamed namespace: clang would ask for each of its operators to be used.
namespace record_test {

/// A spectrum of the host's own: no vector of GLM's, no access by band.
struct four_bands {
    float band[4]{};
    friend bool operator==(const four_bands&, const four_bands&) = default;
    friend four_bands operator+(four_bands a, const four_bands& b) {
        for (int i = 0; i < 4; ++i) { a.band[i] += b.band[i]; }
        return a;
    }
    friend four_bands operator*(four_bands a, const four_bands& b) {
        for (int i = 0; i < 4; ++i) { a.band[i] *= b.band[i]; }
        return a;
    }
    friend four_bands operator*(four_bands a, float k) {
        for (float& x : a.band) { x *= k; }
        return a;
    }
    friend float max_component(const four_bands& a) { return std::max({a.band[0], a.band[1], a.band[2], a.band[3]}); }
};

}  // namespace record_test

namespace {

using record_test::four_bands;

constexpr record_features bare{.gradients = false, .ellipse = false, .noise = false};
constexpr record_features plain{.gradients = false};

static_assert(sizeof(irradiance_record<vec3<float>>) == 64);
static_assert(sizeof(irradiance_record<float, float, plain>) == 32);
static_assert(sizeof(irradiance_record<float, float, bare>) == 24);
static_assert(sizeof(irradiance_record<vec3<float>, float, record_features{.incident = true}>) == 72);

template <typename S, typename T>
irradiance_estimate<S, T> estimate_at(const vec3<T>& position, const vec3<T>& normal, const S& irradiance) {
    irradiance_estimate<S, T> e;
    e.position = position;
    e.axes = frame<T>{glm::normalize(normal)};
    e.irradiance = irradiance;
    e.rays = 400;
    return e;
}

/// Irradiance that a record gives at a point of the world.
template <typename R, typename T>
auto at(const R& record, const vec3<T>& point, const vec3<T>& normal) {
    const frame<T> axes = record.axes();
    return record.extrapolate(record.local(point, axes), axes.to_local(normal));
}

}  // namespace

TEST_CASE("irradiance_record: place, light and radius are kept to the bit, the normal to 4e-5") {
    const auto e = estimate_at<vec3<float>, float>({1, -2, 3}, {0.3f, -0.5f, 0.7f}, {0.1f, 0.2f, 0.3f});
    const irradiance_record<vec3<float>> r{e, {.radius = 0.37f}};
    CHECK(r.position() == e.position);
    CHECK(r.irradiance() == e.irradiance);
    CHECK(r.radius() == 0.37f);
    CHECK(glm::length(r.normal() - e.axes.z) < 5e-5f);
    CHECK(r.rays() == 400);
}

TEMPLATE_TEST_CASE("irradiance_record: extrapolates by the gradients it was given, to 1e-4 of its irradiance", "",
                   float, double) {
    using T = TestType;
    random_sampler<T> random{1};
    for (int i = 0; i < 200; ++i) {
        const auto signed_unit = [&] { return random.next_1d() * 2 - 1; };
        const vec3<T> normal = glm::normalize(vec3<T>{signed_unit(), signed_unit(), signed_unit()});
        auto e = estimate_at<vec3<T>, T>({1, 2, 3}, normal, {1, 2, 4});
        const auto slope = [&] { return vec3<T>{signed_unit(), 2 * signed_unit(), 4 * signed_unit()}; };
        e.gradients.translation = {slope() * T(0.7), slope() * T(0.7)};
        e.gradients.rotation = {slope(), slope()};
        const irradiance_record<vec3<T>, T> r{e, {.radius = T(0.5)}};
        const vec2<T> move{signed_unit() * T(0.35), signed_unit() * T(0.35)};
        const vec2<T> turn{signed_unit() * T(0.1), signed_unit() * T(0.1)};
        // n x n' = turn, along the estimate's axes.
        const vec3<T> tilted = glm::normalize(e.axes.to_world({turn.y, -turn.x, std::sqrt(1 - glm::dot(turn, turn))}));
        const vec3<T> there = e.position + e.axes.to_world({move.x, move.y, 0});
        const vec3<T> exact = e.irradiance + e.gradients.translation.x * move.x + e.gradients.translation.y * move.y +
                              e.gradients.rotation.x * turn.x + e.gradients.rotation.y * turn.y;
        const vec3<T> got = at(r, there, tilted);
        for (int b = 0; b < 3; ++b) { CHECK(std::abs(got[b] - exact[b]) < T(2e-4) * e.irradiance[b]); }
    }
}

TEST_CASE("irradiance_record: within the radius the change is at most the irradiance, however steep the gradient") {
    auto e = estimate_at<vec3<float>, float>({0, 0, 0}, {0, 0, 1}, {1, 2, 0});
    e.gradients.translation = {{100, -3, 5}, {-50, 0, 5}};
    const irradiance_record<vec3<float>> r{e, {.radius = 1}};
    for (const vec2<float> d : {vec2<float>{0.99f, 0}, {-0.99f, 0}, {-0.7f, 0.7f}, {0, 0.99f}}) {
        const vec3<float> moved = at(r, vec3<float>{d.x, d.y, 0}, vec3<float>{0, 0, 1});
        for (int b = 0; b < 3; ++b) {
            CHECK(moved[b] >= 0);
            CHECK(moved[b] <= 2.001f * e.irradiance[b]);
        }
    }
}

TEMPLATE_TEST_CASE("irradiance_record: along a diagonal, too, the change is at most the irradiance", "", float,
                   double) {
    using T = TestType;
    auto e = estimate_at<vec3<T>, T>({0, 0, 0}, {0, 0, 1}, {1, 1, 1});
    e.gradients.translation = {vec3<T>{30}, vec3<T>{30}};
    const irradiance_record<vec3<T>, T> r{e, {.radius = 1}};
    CHECK(at(r, vec3<T>{T(0.7), T(0.7), 0}, vec3<T>{0, 0, 1}).x == Approx(1 + std::sqrt(2) * 0.7).epsilon(1e-3));
}

TEMPLATE_TEST_CASE("irradiance_record: with another radius it has the same slopes", "", float, double) {
    using T = TestType;
    auto e = estimate_at<vec3<T>, T>({0, 0, 0}, {0, 0, 1}, {1, 2, 3});
    e.gradients.translation = {vec3<T>{T(0.5)}, vec3<T>{T(-0.25)}};
    const irradiance_record<vec3<T>, T> r{e, {.radius = 1}};
    const vec3<T> there{T(0.2), T(0.1), 0};
    const vec3<T> moved = at(r.with_radius(T(0.25)), there, vec3<T>{0, 0, 1});
    CHECK(glm::length(moved - at(r, there, vec3<T>{0, 0, 1})) < T(1e-3));
}

TEST_CASE("irradiance_record: gradients, ellipse and rays do not depend on the axes they are told in") {
    auto e = estimate_at<vec3<float>, float>({0, 0, 0}, {0.3f, -0.2f, 0.9f}, {1, 1, 1});
    e.gradients.translation = {vec3<float>{0.5f}, vec3<float>{0.1f}};
    e.gradients.rotation = {vec3<float>{0.2f}, vec3<float>{-0.4f}};
    e.rejected = 30;
    const vec2<float> shorter{0.6f, 0.8f};
    const irradiance_record<vec3<float>> r{e, {.radius = 0.5f, .ratio = 2, .axis = shorter}};
    CHECK(r.rays() == 370);
    auto turned = e;
    const float c = std::cos(1.1f);
    const float s = std::sin(1.1f);
    turned.axes.x = e.axes.x * c + e.axes.y * s;
    turned.axes.y = e.axes.y * c - e.axes.x * s;
    const auto in_turned = [&](const auto& v) {
        return std::remove_cvref_t<decltype(v)>{v.x * c + v.y * s, v.y * c + v.x * -s};
    };
    turned.gradients = {in_turned(e.gradients.translation), in_turned(e.gradients.rotation)};
    const irradiance_record<vec3<float>> q{turned, {.radius = 0.5f, .ratio = 2, .axis = in_turned(shorter)}};
    for (const vec3<float> way : {vec3<float>{0.3f, 0.1f, 0}, vec3<float>{-0.1f, 0.3f, 0}}) {
        const vec3<float> point = e.axes.to_world(way);
        const vec3<float> n = glm::normalize(e.axes.z + e.axes.x * 0.1f - e.axes.y * 0.05f);
        CHECK(glm::length(at(r, point, n) - at(q, point, n)) < 1e-3f);
        CHECK(r.distance2(r.local(point, r.axes())) == Approx(q.distance2(q.local(point, q.axes()))).epsilon(1e-3));
    }
}

TEST_CASE("irradiance_record: extrapolation towards darkness stops above zero and keeps the hue") {
    auto e = estimate_at<vec3<float>, float>({0, 0, 0}, {0, 0, 1}, {4, 2, 1});
    e.gradients.rotation = {{-200, -100, -50}, {0, 0, 0}};
    const irradiance_record<vec3<float>> r{e, {.radius = 1}};
    const vec3<float> dark = at(r, vec3<float>{0}, glm::normalize(vec3<float>{0, -0.6f, 0.8f}));
    CHECK(dark.z > 0);
    CHECK(dark.x / dark.z == Approx(4).epsilon(1e-3));
    CHECK(dark.y / dark.z == Approx(2).epsilon(1e-3));
}

TEST_CASE("irradiance_record: a host's own spectrum keeps its gradients and never turns negative") {
    const four_bands light{{1, 2, 3, 4}};
    auto e = estimate_at<four_bands, float>({0, 0, 0}, {0, 0, 1}, light);
    e.gradients.translation.x = four_bands{{0.5f, -0.5f, 0, 1}};
    const irradiance_record<four_bands> r{e, {.radius = 1}};
    const four_bands moved = at(r, vec3<float>{0.5f, 0, 0}, vec3<float>{0, 0, 1});
    CHECK(moved.band[0] == Approx(1.25f));
    CHECK(moved.band[1] == Approx(1.75f));
    CHECK(moved.band[3] == Approx(4.5f));
    e.gradients.translation.x = four_bands{{-4, 0, 0, 4}};
    const irradiance_record<four_bands> steep{e, {.radius = 1}};
    const four_bands dark = at(steep, vec3<float>{0.9f, 0, 0}, vec3<float>{0, 0, 1});
    for (const float b : dark.band) { CHECK(b >= 0); }
    CHECK(dark.band[1] == 2);
}

TEST_CASE("irradiance_record: a scene 2^k larger and 2^m brighter gives the same record 2^k larger and 2^m brighter") {
    random_sampler<float> random{3};
    for (const int k : {-30, -7, 1, 20}) {
        for (int i = 0; i < 50; ++i) {
            const auto number = [&] { return random.next_1d() * 2 - 1; };
            const auto colour = [&] { return vec3<float>{number(), number(), number()}; };
            auto e = estimate_at<vec3<float>, float>(colour(), colour(), {1, 0.5f, 0.25f});
            e.gradients = {{colour(), colour()}, {colour(), colour()}};
            record_reach<float> reach{.radius = 0.3f, .ratio = 1.5f, .axis = {0.6f, 0.8f}};
            const irradiance_record<vec3<float>> one{e, reach};
            const float length = std::ldexp(1.f, k);
            const float light = std::ldexp(1.f, 3);
            auto large = e;
            large.position *= length;
            large.irradiance *= light;
            for (auto* v : {&large.gradients.translation.x, &large.gradients.translation.y}) { *v *= light / length; }
            for (auto* v : {&large.gradients.rotation.x, &large.gradients.rotation.y}) { *v *= light; }
            reach.radius *= length;
            const irradiance_record<vec3<float>> other{large, reach};
            const frame<float> axes = one.axes();
            const vec3<float> way{0.1f, -0.2f, 0.05f};
            const vec3<float> local = one.local(e.position + way, axes);
            const vec3<float> n = glm::normalize(vec3<float>{0.05f, 0.02f, 1});
            const vec3<float> same = other.local((e.position + way) * length, axes);
            CHECK(other.extrapolate(same, n) == one.extrapolate(local, n) * light);
            CHECK(other.distance2(same) == one.distance2(local));
            CHECK(other.longest_radius() == one.longest_radius() * length);
        }
    }
}

TEST_CASE("irradiance_record: its ellipse has the axes it was given, and no point beyond the longer one is inside") {
    const auto e = estimate_at<float, float>({0, 0, 0}, {0.2f, 0.3f, -0.9f}, 1);
    for (const float ratio : {1.f, 1.3f, 2.f}) {
        for (const float angle : {0.f, 0.4f, 1.5f, 3.f}) {
            const vec2<float> axis{std::cos(angle), std::sin(angle)};
            const irradiance_record<float> r{e, {.radius = 0.25f, .ratio = ratio, .axis = axis}};
            const frame<float> axes = r.axes();
            const auto reach2 = [&](float x, float y) {
                return r.distance2(r.local(e.position + e.axes.to_world({x, y, 0}), axes));
            };
            CHECK(reach2(0.25f * axis.x, 0.25f * axis.y) == Approx(1).epsilon(1e-3));
            CHECK(reach2(-0.25f * ratio * axis.y, 0.25f * ratio * axis.x) == Approx(1).epsilon(1e-3));
            CHECK(r.distance2({0, 0, 1}) == Approx(1));
            CHECK(r.longest_radius() == Approx(0.25f * ratio).epsilon(1e-3));
            for (float a = 0; a < 6.28f; a += 0.01f) {
                const float beyond = r.longest_radius();
                CHECK_FALSE(r.distance2({beyond * std::cos(a) / 0.25f, beyond * std::sin(a) / 0.25f, 0}) < 1 - 1e-6f);
            }
        }
    }
}

TEST_CASE("irradiance_record: nobody is inside beyond the longest radius, however long an ellipse is asked for") {
    const auto e = estimate_at<float, float>({0, 0, 0}, {0, 0, 1}, 1);
    for (const float ratio : {9.f, 9.9f, 10.f, 20.f, 1e3f, 1e30f}) {
        for (const float angle : {0.f, 0.7f, 0.785398f, 1.5f}) {
            const vec2<float> axis{std::cos(angle), std::sin(angle)};
            const irradiance_record<float> r{e, {.radius = 0.25f, .ratio = ratio, .axis = axis}};
            const frame<float> axes = r.axes();
            const float end = r.longest_radius();
            CAPTURE(ratio, angle, end);
            CHECK(end == Approx(0.25f * std::min(ratio, 9.9f)).epsilon(0.01));
            const vec3<float> tip = e.axes.to_world({-axis.y * end, axis.x * end, 0});
            CHECK_FALSE(r.distance2(r.local(e.position + tip, axes)) < 1 - 1e-3f);
        }
    }
}

TEST_CASE("irradiance_record: with_radius keeps light and slope, and the cap grows with the radius") {
    auto e = estimate_at<vec3<float>, float>({0, 0, 0}, {0, 0, 1}, {1, 1, 1});
    e.gradients.translation.x = {0.5f, 1, -0.25f};
    const irradiance_record<vec3<float>> r{e, {.radius = 1}};
    const irradiance_record<vec3<float>> small = r.with_radius(0.25f);
    CHECK(small.radius() == 0.25f);
    CHECK(small.irradiance() == r.irradiance());
    const vec3<float> a = r.extrapolate({0.1f, 0, 0}, {0, 0, 1});
    const vec3<float> b = small.extrapolate({0.4f, 0, 0}, {0, 0, 1});
    CHECK(glm::length(a - b) < 1e-4f);
}

TEST_CASE("irradiance_record: noise is kept to a hundredth of itself over four decades") {
    auto e = estimate_at<float, float>({0, 0, 0}, {0, 0, 1}, 1);
    for (const float noise : {0.f, 0.003f, 0.02f, 0.3f, 1.f, 20.f}) {
        e.relative_noise = noise;
        CHECK(irradiance_record<float>{e, {.radius = 1}}.relative_noise() == Approx(noise).epsilon(0.01));
    }
}

TEST_CASE("reach_of: split sphere takes the harmonic mean, nearest distance the nearest, within relative limits") {
    auto e = estimate_at<float, float>({0, 0, 0}, {0, 0, 1}, 1);
    e.mean_inverse_distance = 1 / 0.8f;
    e.nearest_inverse_distance = 1 / 0.2f;
    record_reach_options o{.metric = error_metric::split_sphere, .accuracy = 0.5};
    CHECK(reach_of(e, o, 10.f, 0.f).radius == Approx(0.4f));
    o.metric = error_metric::nearest_distance;
    CHECK(reach_of(e, o, 10.f, 0.f).radius == Approx(0.1f));
    o.minimum_radius = 0.05;
    CHECK(reach_of(e, o, 10.f, 0.f).radius == Approx(0.5f));
    CHECK(reach_of(e, o, 10.f, 0.f).own_radius == Approx(0.1f));
}

TEST_CASE("reach_of: under an open sky, and over a flat void, the reach is the largest allowed, not infinite") {
    const auto e = estimate_at<float, float>({0, 0, 0}, {0, 0, 1}, 1);
    for (const error_metric metric :
         {error_metric::split_sphere, error_metric::nearest_distance, error_metric::hessian}) {
        const record_reach<float> r = reach_of(e, {.metric = metric, .maximum_radius = 0.25}, 8.f, 0.f);
        CHECK(r.radius == 2);
        CHECK(r.ratio == 1);
        CHECK(is_usable(e, r));
    }
}

TEST_CASE("reach_of: the Hessian's ellipse has the total error that was asked for, whatever the unit of length") {
    // 4 eps E / (pi lambda) = R⁴ with eps = pi accuracy⁴ scene² for a circle.
    auto e = estimate_at<double, double>({0, 0, 0}, {0, 0, 1}, 1);
    e.curvature = {3, 0, 0.75};
    const record_reach_options o{
        .accuracy = 0.1, .minimum_radius = 1e-6, .maximum_radius = 1e3, .geometric_limit = 1e6};
    const record_reach<double> r = reach_of(e, o, 5.0, 0.0);
    CHECK(r.radius == Approx(std::pow(4 * 1e-4 * 25 / 3, 0.25)));
    CHECK(r.ratio == Approx(std::pow(4.0, 0.25)));
    CHECK(std::abs(r.axis.x) == Approx(1));
    e.curvature = {3, 0, 1e-9};
    CHECK(reach_of(e, o, 5.0, 0.0).ratio == 2);
    // Millimetres or kilometres: an anisotropic record stays one.
    for (const int k : {-40, -20, 20, 40}) {
        auto scaled = e;
        scaled.curvature = {std::ldexp(3.0, -2 * k), 0, std::ldexp(0.75, -2 * k)};
        const record_reach<double> s = reach_of(scaled, o, std::ldexp(5.0, k), 0.0);
        CHECK(s.radius == std::ldexp(r.radius, k));
        CHECK(s.ratio == r.ratio);
    }
}

TEST_CASE("reach_of: no record reaches beyond where its gradient ends at zero, along each axis, by either rule") {
    auto e = estimate_at<vec3<double>, double>({0, 0, 0}, {0, 0, 1}, {1, 4, 2});
    // Relative to the largest band, 8 / 4 along x and 2 / 4 along y.
    e.gradients.translation = {{0, -8, 1}, {2, 0, 1}};
    record_reach_options o{.maximum_radius = 1, .maximum_ratio = 8};
    for (const double bend : {0.0, 1e-9}) {
        e.curvature = {0, 0, bend};
        const auto r = reach_of(e, o, 100.0, 0.0);
        CHECK(r.own_radius == Approx(0.5));
        CHECK(r.ratio == Approx(4));
        CHECK(std::abs(r.axis.x) == Approx(1));
    }
    o.metric = error_metric::split_sphere;
    CHECK(reach_of(e, o, 100.0, 0.0).own_radius == Approx(0.5));
    std::swap(e.gradients.translation.x, e.gradients.translation.y);
    CHECK(reach_of(e, o, 100.0, 0.0).own_radius == Approx(0.5));
}

TEST_CASE("reach_of: a huge footprint does not reach past the surroundings") {
    auto e = estimate_at<float, float>({0, 0, 0}, {0, 0, 1}, 1);
    e.mean_inverse_distance = 1 / 0.3f;
    e.curvature = {1000, 0, 1000};
    CHECK(reach_of(e, {}, 10.f, 0.1f).radius == Approx(0.15f));
    CHECK(reach_of(e, {}, 10.f, 1000.f).radius == Approx(0.3f));
}

TEST_CASE("reach_of: a lower limit raises the axes that are below it, and takes none beyond the largest reach") {
    auto e = estimate_at<double, double>({0, 0, 0}, {0, 0, 1}, 1);
    record_reach_options o{.accuracy = 0.1, .minimum_radius = 1e-6, .maximum_radius = 1, .geometric_limit = 1e6};
    e.curvature = {3, 0, 0.75};
    const record_reach<double> own = reach_of(e, o, 1.0, 0.0);
    REQUIRE(own.ratio == Approx(std::sqrt(2)));
    const auto raised = [&](double lowest) {
        o.minimum_radius = lowest;
        return reach_of(e, o, 1.0, 0.0);
    };
    const record_reach<double> between = raised(1.2 * own.radius);
    CHECK(between.radius == Approx(1.2 * own.radius));
    CHECK(between.radius * between.ratio == Approx(own.radius * own.ratio));
    CHECK(between.own_radius == own.radius);
    CHECK(raised(1.5 * own.radius).ratio == 1);
}

TEST_CASE("is_usable: refuses whatever is not a number, and estimates from mostly bad rays") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const auto good = estimate_at<vec3<float>, float>({0, 0, 0}, {0, 0, 1}, {1, 1, 1});
    const record_reach<float> reach{.radius = 1};
    CHECK(is_usable(good, reach));
    for (const float bad : {nan, inf, -inf, -1.f}) {
        auto e = good;
        e.irradiance.y = bad;
        CHECK_FALSE(is_usable(e, reach));
        CHECK_FALSE(is_usable(good, record_reach<float>{.radius = bad}));
        if (bad == -1.f) { continue; }
        e = good;
        e.position.z = bad;
        CHECK_FALSE(is_usable(e, reach));
        e = good;
        e.gradients.rotation.x.x = bad;
        CHECK_FALSE(is_usable(e, reach));
        e = good;
        e.axes.z.x = bad;
        CHECK_FALSE(is_usable(e, reach));
    }
    CHECK_FALSE(is_usable(good, record_reach<float>{.radius = 0}));
    auto e = good;
    e.axes.z = {0, 0, 0};
    CHECK_FALSE(is_usable(e, reach));
    e = good;
    e.relative_noise = -0.5f;
    CHECK_FALSE(is_usable(e, reach));
    e = good;
    e.rejected = 201;
    CHECK_FALSE(is_usable(e, reach));
}

TEST_CASE(
    "irradiance_record: the mean incident direction comes back in the world's axes, and is an even sky's in the dark") {
    using record = irradiance_record<vec3<float>, float, record_features{.incident = true}>;
    auto e = estimate_at<vec3<float>, float>({0, 0, 0}, {0.3f, -0.5f, 0.7f}, {1, 1, 1});
    const vec3<float> towards = glm::normalize(vec3<float>{0.5f, 0.1f, 0.4f});
    e.incident = e.axes.to_local(towards) * 0.8f;
    CHECK(glm::length(record{e, {.radius = 1}}.incident() - towards * 0.8f) < 1e-4f);
    e.incident = {0, 0, 0};
    CHECK(glm::length(record{e, {.radius = 1}}.incident() - e.axes.z * (2 / 3.0f)) < 1e-4f);
}

TEMPLATE_TEST_CASE("irradiance_record: another irradiance keeps the slopes relative to it", "", float, double) {
    using T = TestType;
    irradiance_estimate<T, T> e;
    e.irradiance = 10;
    e.gradients.translation = {10, 0};
    e.rays = 100;
    const auto dim = irradiance_record<T, T>{e, {.radius = 1}}.with_irradiance(T(1), T(0.1));
    for (const T x : {T(0.5), T(0.9), T(-0.5)}) {
        CHECK(dim.extrapolate({x, 0, 0}, {0, 0, 1}) == Approx(1 + x).epsilon(1e-3));
    }
}

TEST_CASE("irradiance_record: what falls to nothing is no less than that, of spectra of the host's too") {
    random_sampler<double> random{4};
    for (int i = 0; i < 20'000; ++i) {
        irradiance_estimate<double, double> e;
        e.irradiance = random.next_1d();
        e.gradients.rotation = {9 * (random.next_1d() - 0.5), 9 * (random.next_1d() - 0.5)};
        e.rays = 1;
        const irradiance_record<double, double> record{e, {.radius = 1}};
        const vec3<double> n = glm::normalize(vec3<double>{random.next_1d() - 0.5, random.next_1d() - 0.5, 1});
        REQUIRE(record.extrapolate({0, 0, 0}, n) >= 0);
    }
}
