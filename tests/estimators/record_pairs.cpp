#include <aglow/estimators/record_pairs.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/core/simd.hpp>

#include "support/catch.hpp"
#include "support/floor_record.hpp"

using namespace aglow;

namespace {

using rgb = vec3<float>;

/// Records by number, and what they err by.
template <typename S, record_features F>
struct floor_records {
    std::vector<support::floor_record<S, F>> records;
    std::vector<float> bends;

    floor_records(std::size_t count, random_sampler<float>& random) {
        for (std::size_t i = 0; i < count; ++i) {
            records.push_back(support::random_floor_record<S, F>(random, i % 9 == 0 ? -1.f : 1.f));
            bends.push_back(records.back().bend);
        }
    }
};

struct question {
    rgb point, normal;
    std::vector<std::uint32_t> near;
    std::size_t count;
};

/// About every number of records near a place that there can be, none as well; and places at no number.
std::vector<question> questions(std::size_t records, std::size_t most, random_sampler<float>& random) {
    std::vector<question> made;
    for (std::size_t i = 0; i < 700; ++i) {
        question q{{random.next_1d() - 0.5f, random.next_1d() - 0.5f, 0},
                   support::random_floor_normal(random),
                   {},
                   i < 500 ? i * 7 % 13 : i % (most + 1)};
        if (i % 100 == 50) { q.point.y = std::numeric_limits<float>::quiet_NaN(); }
        for (std::size_t k = 0; k < q.count + simd::lanes; ++k) {
            q.near.push_back(static_cast<std::uint32_t>(random.next_1d() * static_cast<float>(records)));
        }
        made.push_back(q);
    }
    return made;
}

template <typename S>
bool same(const irradiance_answer<S, float>& a, const irradiance_answer<S, float>& b) {
    return a.irradiance == b.irradiance && a.error == b.error && a.weight == b.weight && a.records == b.records;
}

/// How many answers are other than those of a blend for each place alone.
template <typename S, record_features F>
int different(error_metric metric) {
    const detail::lookup_limits<float> limits{record_lookup_options{}, metric};
    random_sampler<float> random{1};
    const floor_records<S, F> all{200, random};
    detail::record_pairs<S, F, support::floor_record<S, F>> pairs{all.records.data(), all.bends.data(), limits};
    const auto asked = questions(all.records.size(), pairs.most, random);
    std::vector<irradiance_answer<S, float>> answers(asked.size());
    for (std::size_t i = 0; i < asked.size(); ++i) {
        pairs.add(asked[i].point, asked[i].normal, std::span{asked[i].near}.first(asked[i].count), answers[i]);
    }
    pairs.finish();
    int wrong = 0, found = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        record_blend<S, float> blend{asked[i].point, asked[i].normal, limits};
        blend.add(
            asked[i].count, [&](std::size_t k) -> const auto& { return all.records[asked[i].near[k]]; },
            [](detail::verdict) {});
        wrong += !same(answers[i], blend.answer());
        found += static_cast<bool>(answers[i]);
    }
    CHECK(found > 400);
    return wrong;
}

}  // namespace

TEST_CASE(
    "record_pairs: many places get what a blend for each says, to the bit, whatever records keep, by any metric") {
    constexpr record_features bare{.gradients = false, .ellipse = false, .noise = false};
    constexpr record_features with_light{.incident = true};
    for (const error_metric metric :
         {error_metric::split_sphere, error_metric::nearest_distance, error_metric::hessian}) {
        CHECK(different<rgb, record_features{}>(metric) == 0);
        CHECK(different<rgb, bare>(metric) == 0);
        CHECK(different<rgb, with_light>(metric) == 0);
        CHECK(different<float, record_features{}>(metric) == 0);
        CHECK(different<float, bare>(metric) == 0);
    }
}

TEST_CASE("record_pairs: a place gets the same answer whoever is asked about before and after it") {
    const detail::lookup_limits<float> limits{record_lookup_options{}, error_metric::hessian};
    random_sampler<float> random{1};
    const floor_records<rgb, record_features{}> all{200, random};
    using pairs_of = detail::record_pairs<rgb, record_features{}, support::floor_record<rgb, record_features{}>>;
    pairs_of pairs{all.records.data(), all.bends.data(), limits};
    const auto asked = questions(all.records.size(), pairs.most, random);
    std::vector<irradiance_answer<rgb, float>> forth(asked.size()), back(asked.size());
    for (std::size_t i = 0; i < asked.size(); ++i) {
        pairs.add(asked[i].point, asked[i].normal, std::span{asked[i].near}.first(asked[i].count), forth[i]);
    }
    pairs.finish();
    for (std::size_t i = asked.size(); i-- > 0;) {
        pairs.add(asked[i].point, asked[i].normal, std::span{asked[i].near}.first(asked[i].count), back[i]);
    }
    pairs.finish();
    CHECK(std::equal(forth.begin(), forth.end(), back.begin(), same<rgb>));
}
