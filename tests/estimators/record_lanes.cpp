#include <aglow/estimators/record_lanes.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>
#include <aglow/estimators/record_blend.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using rgb = vec3<float>;

template <typename S, record_features F>
struct item {
    irradiance_record<S, float, F> record;
    float bend;
};

/// A record near the origin on a floor that is not quite flat.
template <typename S, record_features F>
item<S, F> random_item(random_sampler<float>& random) {
    const auto signed_unit = [&] { return random.next_1d() * 2 - 1; };
    const auto light = [&] {
        if constexpr (std::is_same_v<S, float>) {
            return random.next_1d();
        } else {
            return rgb{random.next_1d(), random.next_1d(), random.next_1d() * 10};
        }
    };
    irradiance_estimate<S, float> e;
    e.position = {signed_unit(), signed_unit(), 0.02f * signed_unit()};
    e.axes = frame<float>{glm::normalize(rgb{0.1f * signed_unit(), 0.1f * signed_unit(), 1})};
    e.irradiance = light();
    e.gradients.translation = {light() * 3.f, light() * -3.f};
    e.gradients.rotation = {light() * -1.f, light()};
    e.relative_noise = random.next_1d();
    e.rays = 100;
    const float angle = 7 * random.next_1d();
    const record_reach<float> reach{
        .radius = 0.3f + random.next_1d(), .ratio = 1 + random.next_1d(), .axis = {std::cos(angle), std::sin(angle)}};
    return {{e, reach}, random.next_1d()};
}

float difference(float a, float b) { return std::abs(a - b); }
float difference(const rgb& a, const rgb& b) { return glm::length(a - b); }

/// How many of 2,000 places hear another answer from records taken eight at a time than from one after another.
template <typename S, record_features F>
int wrong_answers(error_metric metric, int& used) {
    const detail::lookup_limits<float> limits{record_lookup_options{}, metric};
    random_sampler<float> random{1};
    int wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        std::vector<item<S, F>> items(static_cast<std::size_t>(i % 21));
        for (auto& one : items) { one = random_item<S, F>(random); }
        const rgb point{random.next_1d() - 0.5f, random.next_1d() - 0.5f, 0};
        const rgb normal = glm::normalize(rgb{0.1f * random.next_1d(), -0.05f * random.next_1d(), 1});
        record_blend<S, float> together{point, normal, limits}, alone{point, normal, limits};
        std::vector<detail::verdict> judged, expected;
        together.add(
            items.size(), [&](std::size_t k) -> const item<S, F>& { return items[k]; },
            [&](detail::verdict v) { judged.push_back(v); });
        for (const auto& one : items) { expected.push_back(alone.add(one.record, one.bend)); }
        const auto a = together.answer(), b = alone.answer();
        // Where hardly anything weighs, the division by it tells how well an error can be rounded.
        const float slack = b.weight < 0.01f ? 3e-5f * (1 + b.error) : 1e-4f;
        wrong += judged != expected || a.records != b.records || !(difference(a.weight, b.weight) <= 1e-5f) ||
                 !(difference(a.irradiance, b.irradiance) <= 1e-4f) || !(difference(a.error, b.error) <= slack);
        used += static_cast<int>(a.records);
    }
    return wrong;
}

}  // namespace

TEST_CASE("record_lanes: eight records at a time say what they say one by one, whatever they keep, by any metric") {
    constexpr record_features bare{.gradients = false, .ellipse = false, .noise = false};
    constexpr record_features no_noise{.noise = false};
    constexpr record_features with_light{.incident = true};
    for (const error_metric metric :
         {error_metric::split_sphere, error_metric::nearest_distance, error_metric::hessian}) {
        int used = 0;
        CHECK(wrong_answers<rgb, record_features{}>(metric, used) == 0);
        CHECK(wrong_answers<rgb, bare>(metric, used) == 0);
        CHECK(wrong_answers<rgb, no_noise>(metric, used) == 0);
        CHECK(wrong_answers<rgb, with_light>(metric, used) == 0);
        CHECK(wrong_answers<float, record_features{}>(metric, used) == 0);
        CHECK(wrong_answers<float, bare>(metric, used) == 0);
        CHECK(used > 10'000);
    }
}

TEST_CASE("record_lanes: a place at no number and a normal at no number are refused by all eight") {
    const detail::lookup_limits<float> limits{record_lookup_options{}, error_metric::hessian};
    random_sampler<float> random{2};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto one = random_item<rgb, record_features{}>(random);
    for (const auto& [point, normal] : {std::pair{rgb{nan, 0, 0}, rgb{0, 0, 1}}, std::pair{rgb{0}, rgb{0, nan, 1}}}) {
        record_blend<rgb, float> blend{point, normal, limits};
        blend.add(
            8, [&](std::size_t) -> const auto& { return one; },
            [](detail::verdict v) { CHECK(v != detail::verdict::used); });
        CHECK_FALSE(blend.answer());
    }
}
