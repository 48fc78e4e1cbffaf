#include <aglow/estimators/record_lanes.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/estimators/record_blend.hpp>

#include "support/catch.hpp"
#include "support/floor_record.hpp"

using namespace aglow;

namespace {

using rgb = vec3<float>;

float difference(float a, float b) { return std::abs(a - b); }
float difference(const rgb& a, const rgb& b) { return glm::length(a - b); }

/// How many of 2,000 places hear another answer from records taken eight at a time than from one after another.
template <typename S, record_features F>
int wrong_answers(error_metric metric, int& used) {
    const detail::lookup_limits<float> limits{record_lookup_options{}, metric};
    random_sampler<float> random{1};
    int wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        std::vector<support::floor_record<S, F>> items(static_cast<std::size_t>(i % 21));
        for (auto& one : items) { one = support::random_floor_record<S, F>(random); }
        const rgb point{random.next_1d() - 0.5f, random.next_1d() - 0.5f, 0};
        const rgb normal = support::random_floor_normal(random);
        record_blend<S, float> together{point, normal, limits}, alone{point, normal, limits};
        std::vector<detail::verdict> judged, expected;
        together.add(
            items.size(), [&](std::size_t k) -> const auto& { return items[k]; },
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
    const auto one = support::random_floor_record<rgb, record_features{}>(random);
    for (const auto& [point, normal] : {std::pair{rgb{nan, 0, 0}, rgb{0, 0, 1}}, std::pair{rgb{0}, rgb{0, nan, 1}}}) {
        record_blend<rgb, float> blend{point, normal, limits};
        blend.add(
            8, [&](std::size_t) -> const auto& { return one; },
            [](detail::verdict v) { CHECK(v != detail::verdict::used); });
        CHECK_FALSE(blend.answer());
    }
}
