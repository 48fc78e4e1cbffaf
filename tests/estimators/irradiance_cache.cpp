#include <aglow/estimators/irradiance_cache.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using rgb = vec3<float>;
using cache = irradiance_cache<rgb>;
using estimate_rgb = irradiance_estimate<rgb, float>;

/// An estimate whose reach is `distance`, by the split-sphere rule at accuracy 1.
estimate_rgb estimate_at(const vec3<float>& position, const vec3<float>& normal, const rgb& irradiance,
                         float distance) {
    estimate_rgb e;
    e.position = position;
    e.axes = frame<float>{glm::normalize(normal)};
    e.irradiance = irradiance;
    e.mean_inverse_distance = 1 / distance;
    e.rays = 100;
    return e;
}

irradiance_cache_options by_distance(error_metric metric = error_metric::split_sphere) {
    irradiance_cache_options o;
    o.reach = {.metric = metric, .accuracy = 1, .minimum_radius = 1e-4, .maximum_radius = 1, .minimum_footprints = 0};
    return o;
}

constexpr vec3<float> up{0, 0, 1};

/// What a cache says about options that it refuses.
std::string refusal(const irradiance_cache_options& o) {
    try {
        const cache refused{1.f, o};
    } catch (const std::invalid_argument& e) { return e.what(); }
    return "";
}

}  // namespace

TEST_CASE("irradiance_cache: an empty one says nothing") {
    const cache c{10.f};
    CHECK_FALSE(c.lookup({0, 0, 0}, up));
    CHECK(c.lookup({0, 0, 0}, up).irradiance == rgb{0});
    CHECK_FALSE(cache::frozen{}.lookup({0, 0, 0}, up));
    CHECK_FALSE(c.freeze().lookup({0, 0, 0}, up));
}

TEST_CASE("irradiance_cache: at its own place a record returns what it was given") {
    for (const error_metric metric :
         {error_metric::split_sphere, error_metric::nearest_distance, error_metric::hessian}) {
        cache c{10.f, by_distance(metric)};
        const vec3<float> n = glm::normalize(vec3<float>{1, 2, 3});
        REQUIRE(c.insert(estimate_at({1, 2, 3}, n, {1, 2, 3}, 1)) == record_status::inserted);
        const auto a = c.lookup({1, 2, 3}, n);
        REQUIRE(a);
        CHECK(a.records == 1);
        CHECK(glm::length(a.irradiance - rgb{1, 2, 3}) < 1e-5f);
    }
}

TEST_CASE("irradiance_cache: two records at one place give their mean") {
    cache c{10.f, by_distance()};
    c.insert(estimate_at({0, 0, 0}, up, {1, 2, 3}, 1));
    c.insert(estimate_at({0, 0, 0}, up, {3, 2, 1}, 1));
    CHECK(glm::length(c.lookup({0, 0, 0}, up).irradiance - rgb{2, 2, 2}) < 1e-5f);
}

TEST_CASE("irradiance_cache: the normal limit is meant in radians") {
    auto o = by_distance(error_metric::hessian);
    o.reach.maximum_radius = 0.5;
    o.lookup.normal_limit = 10 * pi<double> / 180;
    cache c{10.f, o};
    c.insert(estimate_at({0, 0, 0}, up, {1, 1, 1}, 1));
    const auto leaning = [](double degrees) {
        const double a = degrees * pi<double> / 180;
        return vec3<float>{static_cast<float>(std::sin(a)), 0, static_cast<float>(std::cos(a))};
    };
    CHECK(c.lookup({0, 0, 0}, leaning(9.8)));
    CHECK_FALSE(c.lookup({0, 0, 0}, leaning(10.1)));
    CHECK_FALSE(c.lookup({0, 0, 0}, leaning(180)));
}

TEST_CASE("irradiance_cache: a weight is near zero where its record ends, so nothing jumps") {
    for (const error_metric metric :
         {error_metric::split_sphere, error_metric::nearest_distance, error_metric::hessian}) {
        cache c{10.f, by_distance(metric)};
        auto e = estimate_at({0, 0, 0}, up, {1, 1, 1}, 0.5f);
        e.nearest_inverse_distance = 2;
        e.curvature = {4000, 1000, 8000};
        REQUIRE(c.insert(e) == record_status::inserted);
        const auto frozen = c.freeze();
        bool falling = true;
        float highest_end = 0;
        for (float angle = 0; angle < 6.28f; angle += 0.1f) {
            float before = 2;
            for (float d = 0.0005f; d < 2; d += 0.0005f) {
                const vec3<float> p{d * std::cos(angle), d * std::sin(angle), 0};
                const float weight = frozen.lookup(p, up).weight;
                falling = falling && weight == c.lookup(p, up).weight && weight <= before;
                if (weight == 0 && before < 2) { highest_end = std::max(highest_end, before); }
                before = weight;
            }
            falling = falling && before == 0;
        }
        CHECK(falling);
        // Beyond the minimum weight it goes out in one small step.
        CHECK(highest_end < 0.01f);
        CHECK(highest_end > 0);
    }
}

TEST_CASE(
    "irradiance_cache: what lies in front of a record or behind it is not covered, and a floor is, at any scale") {
    for (const float scale : {1e-6f, 1.f, 1e6f}) {
        cache c{10 * scale, by_distance()};
        c.insert(estimate_at({1 * scale, 2 * scale, 3 * scale}, up, {1, 1, 1}, 1 * scale));
        CHECK(c.lookup({1.3f * scale, 2 * scale, 3 * scale}, up));
        CHECK(c.lookup({1.3f * scale, 2 * scale, std::nextafter(3 * scale, 0.f)}, up));
        CHECK_FALSE(c.lookup({1 * scale, 2 * scale, 3.1f * scale}, up));
        CHECK_FALSE(c.lookup({1 * scale, 2 * scale, 2.9f * scale}, up));
    }
}

TEST_CASE("irradiance_cache: counters say why records were rejected") {
    cache c{10.f, by_distance()};
    c.insert(estimate_at({0, 0, 0}, up, {1, 1, 1}, 1));
    lookup_counters n;
    (void)c.lookup({0.1f, 0, 0}, up, n);
    (void)c.lookup({0.1f, 0, 0}, {1, 0, 0}, n);
    (void)c.lookup({0, 0, 0.5f}, up, n);
    (void)c.lookup({0.95f, 0, 0}, glm::normalize(vec3<float>{0, 0.15f, 1}), n);
    (void)c.lookup({5, 0, 0}, up, n);
    CHECK(n.lookups == 5);
    CHECK(n.used == 1);
    CHECK(n.normal == 1);
    CHECK(n.plane == 1);
    CHECK(n.distance == 1);
    CHECK(n.missed == 4);
}

TEST_CASE("irradiance_cache: refuses what is no record, counts it, and answers as before") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    cache c{10.f, by_distance()};
    c.insert(estimate_at({0, 0, 0}, up, {1, 2, 3}, 1));
    const auto before = c.lookup({0.2f, 0, 0}, up);
    auto black_sky = estimate_at({0, 0, 0}, up, {nan, 1, 1}, 1);
    CHECK(c.insert(black_sky) == record_status::bad_estimate);
    CHECK(c.insert(estimate_at({0, nan, 0}, up, {1, 1, 1}, 1)) == record_status::bad_estimate);
    CHECK(c.insert(estimate_at({0, 0, 0}, up, {1, -1, 1}, 1)) == record_status::bad_estimate);
    CHECK(c.insert(estimate_at({0, 0, inf}, up, {1, 1, 1}, 1)) == record_status::bad_estimate);
    CHECK(c.insert(estimate_at({0, 0, 0}, up, {1, 1, 1}, nan)) == record_status::bad_estimate);
    CHECK(c.refused() == 5);
    CHECK(c.size() == 1);
    CHECK(c.lookup({0.2f, 0, 0}, up).irradiance == before.irradiance);
    CHECK(c.lookup({nan, 0, 0}, up).irradiance == rgb{0});
    CHECK_FALSE(c.lookup({0, 0, 0}, {nan, 0, 1}));
}

TEST_CASE("irradiance_cache: records far outside the scene's bounds, and flat scenes, are as good as any") {
    bounds<float> flat;
    flat.add(vec3<float>{-1, -1, 0});
    flat.add(vec3<float>{1, 1, 0});
    cache c{flat, by_distance()};
    auto sky = estimate_at({0, 0, 0}, up, {1, 1, 1}, 1);
    sky.mean_inverse_distance = 0;
    REQUIRE(c.insert(sky) == record_status::inserted);
    CHECK(c[0].radius() <= flat.radius());
    sky.position = {1000, -2000, 0};
    REQUIRE(c.insert(sky) == record_status::inserted);
    CHECK(c.lookup({1000.5f, -2000, 0}, up));
}

TEST_CASE("irradiance_cache: neighbours clamp each other to the min-plus closure, whatever the order of insertion") {
    random_sampler<float> random{5};
    std::vector<estimate_rgb> estimates;
    for (int i = 0; i < 200; ++i) {
        const vec3<float> p{random.next_1d() * 3, random.next_1d() * 3, 0};
        estimates.push_back(estimate_at(p, up, {1, 1, 1}, 0.02f + square(random.next_1d()) * 3));
    }
    std::vector<float> expected(estimates.size());
    for (std::size_t i = 0; i < estimates.size(); ++i) {
        expected[i] = std::numeric_limits<float>::infinity();
        for (const estimate_rgb& e : estimates) {
            expected[i] =
                std::min(expected[i], 1 / e.mean_inverse_distance + glm::distance(e.position, estimates[i].position));
        }
    }
    bool any_clamped = false;
    for (int order = 0; order < 3; ++order) {
        std::vector<std::size_t> at(estimates.size());
        for (std::size_t i = 0; i < at.size(); ++i) {
            at[i] = order == 0 ? i : order == 1 ? at.size() - 1 - i : (i * 77) % at.size();
        }
        cache c{10.f, by_distance()};
        for (const std::size_t i : at) { REQUIRE(c.insert(estimates[i]) == record_status::inserted); }
        for (std::size_t k = 0; k < at.size(); ++k) {
            CHECK(c[static_cast<std::uint32_t>(k)].radius() == expected[at[k]]);
            any_clamped = any_clamped || expected[at[k]] < 1 / estimates[at[k]].mean_inverse_distance;
        }
    }
    CHECK(any_clamped);
}

TEST_CASE("irradiance_cache: constant light stays that light at every point between records") {
    random_sampler<float> random{6};
    cache c{10.f, by_distance()};
    for (int i = 0; i < 300; ++i) {
        c.insert(estimate_at({random.next_1d() * 3, random.next_1d() * 3, 0}, up, {3, 2, 1}, 0.1f + random.next_1d()));
    }
    const auto frozen = c.freeze();
    for (int i = 0; i < 500; ++i) {
        const auto a = frozen.lookup({random.next_1d() * 3, random.next_1d() * 3, 0}, up);
        if (a) { CHECK(glm::length(a.irradiance - rgb{3, 2, 1}) < 1e-5f); }
    }
}

TEST_CASE("irradiance_cache: growing and frozen, it blends the records that asking each of them one by one finds") {
    random_sampler<float> random{16};
    cache c{10.f, by_distance()};
    struct entry {
        cache::record record;
        float bend;
    };
    const auto agrees = [&](const auto& asked, const vec3<float>& p, const vec3<float>& normal) {
        const detail::lookup_limits<float> limits{c.options().lookup, c.options().reach.metric};
        record_blend<rgb, float> blend{p, normal, limits};
        for (std::uint32_t i = 0; i < asked.size(); ++i) {
            const entry one{asked[i], 0};
            blend.add(
                1, [&](std::size_t) -> const entry& { return one; }, [](detail::verdict) {});
        }
        const auto expected = blend.answer();
        const auto answer = asked.lookup(p, normal);
        // The order of summing is another.
        return answer.records == expected.records && std::abs(answer.weight - expected.weight) <= 1e-5f &&
               glm::length(answer.irradiance - expected.irradiance) <= 1e-4f;
    };
    // Sizes around those at which a growing cache settles; up to thirty records over a place.
    int wrong = 0;
    for (int i = 0; i < 300; ++i) {
        const vec3<float> at{random.next_1d() * 3, random.next_1d() * 3, 0};
        c.insert(estimate_at(at, i % 3 == 0 ? -up : up, rgb{1 + at.x, 1, 1 + at.y}, 0.1f + random.next_1d()));
        wrong += !agrees(c, {random.next_1d() * 3, random.next_1d() * 3, 0}, up);
    }
    const auto frozen = c.freeze();
    for (std::uint32_t i = 0; i < c.size(); ++i) { wrong += frozen[i].position() != c[i].position(); }
    std::uint32_t most = 0;
    for (int i = 0; i < 500; ++i) {
        const vec3<float> p{random.next_1d() * 3, random.next_1d() * 3, 0};
        wrong += !agrees(frozen, p, up);
        most = std::max(most, frozen.lookup(p, up).records);
    }
    CHECK(wrong == 0);
    CHECK(most > 8);
}

TEST_CASE("irradiance_cache: many places looked up in step get what each gets alone, to the bit") {
    struct place {
        vec3<float> position, normal;
    };
    random_sampler<float> random{17};
    for (const int records : {0, 1, 40, 600}) {
        auto o = by_distance();
        o.clamp_neighbours = false;
        cache c{10.f, o};
        for (int i = 0; i < records; ++i) {
            c.insert(estimate_at({random.next_1d() * 3, random.next_1d() * 3, 0}, up, rgb{1 + random.next_1d(), 1, 2},
                                 0.1f + random.next_1d()));
        }
        const auto frozen = c.freeze();
        std::vector<place> places;
        for (int i = 0; i < 333; ++i) {
            places.push_back({{random.next_1d() * 4 - 0.5f, random.next_1d() * 3, 0}, i % 5 == 0 ? -up : up});
        }
        places[100].position.x = std::numeric_limits<float>::quiet_NaN();
        std::vector<irradiance_answer<rgb, float>> answers(places.size());
        frozen.lookup_each(std::span<const place>{places}, std::span{answers});
        int different = 0, found = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto alone = frozen.lookup(places[i].position, places[i].normal);
            different += alone.irradiance != answers[i].irradiance || alone.error != answers[i].error ||
                         alone.weight != answers[i].weight || alone.records != answers[i].records;
            found += static_cast<int>(answers[i].records);
        }
        CHECK(different == 0);
        CHECK((records == 0 || found > 0));
        CHECK((records < 600 || found > 32 * 200));  // more than are kept in step
    }
}

TEST_CASE("irradiance_cache: with exact gradients a plane of light is reproduced, and its error is told as none") {
    // E = 2 + x - y/2 everywhere.
    const auto light = [](float x, float y) { return 2 + x - y / 2; };
    random_sampler<float> random{7};
    irradiance_cache<float> c{10.f, by_distance(error_metric::hessian)};
    for (int i = 0; i < 300; ++i) {
        const vec3<float> p{random.next_1d(), random.next_1d(), 0};
        irradiance_estimate<float, float> e;
        e.position = p;
        e.irradiance = light(p.x, p.y);
        e.gradients.translation = {1, -0.5f};
        e.mean_inverse_distance = 4;
        e.rays = 1;
        c.insert(e);
    }
    const auto frozen = c.freeze();
    for (int i = 0; i < 200; ++i) {
        const vec3<float> p{random.next_1d(), random.next_1d(), 0};
        const auto a = frozen.lookup(p, up);
        REQUIRE(a);
        CHECK(a.irradiance == Approx(light(p.x, p.y)).epsilon(1e-3));
        CHECK(a.error < 0.01f);
    }
}

TEST_CASE("irradiance_cache: the error guess covers a curved light's true error") {
    // E = 2 + x² with exact gradients: what is missed is d².
    random_sampler<float> random{8};
    irradiance_cache<float> c{1.f, by_distance()};
    for (int i = 0; i < 200; ++i) {
        const vec3<float> p{random.next_1d() * 2 - 1, random.next_1d() * 2 - 1, 0};
        irradiance_estimate<float, float> e;
        e.position = p;
        e.irradiance = 2 + p.x * p.x;
        e.gradients.translation = {2 * p.x, 0};
        e.mean_inverse_distance = 4;
        e.rays = 1;
        c.insert(e);
    }
    const auto frozen = c.freeze();
    int covered = 0;
    double told = 0;
    double happened = 0;
    for (int i = 0; i < 1000; ++i) {
        const vec3<float> p{random.next_1d() * 1.8f - 0.9f, random.next_1d() * 1.8f - 0.9f, 0};
        const auto a = frozen.lookup(p, up);
        REQUIRE(a);
        const float off = std::abs(a.irradiance - (2 + p.x * p.x));
        covered += off <= a.error;
        told += a.error;
        happened += off;
    }
    CHECK(covered > 950);
    CHECK(told < 4 * happened);
}

TEST_CASE("irradiance_cache: a scene 2^k larger gives the same answers to the bit") {
    const auto filled = [](int k) {
        const float length = std::ldexp(1.f, k);
        auto o = by_distance(error_metric::hessian);
        o.reach.accuracy = 0.1;
        cache c{10 * length, o};
        random_sampler<float> random{9};
        for (int i = 0; i < 200; ++i) {
            const auto colour = [&] { return rgb{random.next_1d(), random.next_1d(), random.next_1d()}; };
            auto e = estimate_at(vec3<float>{random.next_1d() * 3, random.next_1d() * 3, 0} * length, up, colour(),
                                 (0.5f + random.next_1d()) * length);
            e.gradients.translation = {colour() / length, colour() / length};
            e.gradients.rotation = {colour(), colour()};
            e.curvature = {8 * random.next_1d() / length / length, random.next_1d() / length / length,
                           -4 * random.next_1d() / length / length};
            e.relative_noise = 0.01f;
            c.insert(e, 0.01f * length);
        }
        return c;
    };
    const auto one = filled(0).freeze();
    for (const int k : {-20, -5, 1, 18}) {
        const float length = std::ldexp(1.f, k);
        const auto other = filled(k).freeze();
        random_sampler<float> random{10};
        for (int i = 0; i < 300; ++i) {
            const vec3<float> p{random.next_1d() * 3, random.next_1d() * 3, 0};
            const vec3<float> n = glm::normalize(vec3<float>{random.next_1d() * 0.1f, random.next_1d() * 0.1f, 1});
            const auto a = one.lookup(p, n);
            const auto b = other.lookup(p * length, n);
            CHECK(a.irradiance == b.irradiance);
            CHECK(a.error == b.error);
            CHECK(a.weight == b.weight);
        }
    }
}

TEST_CASE("irradiance_cache: permuted channels in, permuted channels out") {
    random_sampler<float> random{11};
    cache a{10.f, by_distance()};
    cache b{10.f, by_distance()};
    for (int i = 0; i < 100; ++i) {
        auto e = estimate_at({random.next_1d(), random.next_1d(), 0}, up,
                             {random.next_1d(), random.next_1d(), random.next_1d()}, 1);
        e.gradients.translation.x = {random.next_1d(), random.next_1d(), random.next_1d()};
        a.insert(e);
        for (rgb* s : {&e.irradiance, &e.gradients.translation.x}) { *s = {s->z, s->x, s->y}; }
        b.insert(e);
    }
    for (int i = 0; i < 100; ++i) {
        const vec3<float> p{random.next_1d(), random.next_1d(), 0};
        const rgb x = a.lookup(p, up).irradiance;
        CHECK(b.lookup(p, up).irradiance == rgb{x.z, x.x, x.y});
    }
}

TEST_CASE("irradiance_cache: refuses options that make no sense, by name") {
    CHECK_THROWS_AS(cache{0.f}, std::invalid_argument);
    CHECK_THROWS_AS(cache{std::numeric_limits<float>::infinity()}, std::invalid_argument);
    irradiance_cache_options o;
    o.reach.accuracy = 0;
    CHECK(refusal(o).find("accuracy") != std::string::npos);
    o = {};
    o.lookup.normal_limit = 10;
    CHECK(refusal(o).find("radians") != std::string::npos);
    o = {};
    o.reach.maximum_radius = 1e-9;
    CHECK(refusal(o).find("maximum_radius") != std::string::npos);
}

namespace {

/// A floor of records that are off by a relative noise of the given standard deviation.
template <typename Light>
irradiance_cache<float> noisy_floor(const Light& light, bool smoothing, float noise, std::uint64_t seed) {
    auto o = by_distance(error_metric::hessian);
    o.smoothing = smoothing;
    irradiance_cache<float> c{10.f, o};
    random_sampler<float> random{seed};
    for (int i = 0; i < 600; ++i) {
        irradiance_estimate<float, float> e;
        e.position = {random.next_1d() * 3, random.next_1d() * 3, 0};
        // Uniform noise of the given standard deviation.
        e.irradiance = light(e.position.x) * (1 + noise * std::sqrt(12.f) * (random.next_1d() - 0.5f));
        e.relative_noise = noise;
        e.mean_inverse_distance = 1 / 0.4f;
        e.rays = 100;
        c.insert(e);
    }
    return c;
}

/// Mean and standard deviation of a frozen floor's records relative to the light.
template <typename Light>
std::pair<double, double> spread(const irradiance_cache<float>::frozen& c, const Light& light) {
    double mean = 0;
    double square_mean = 0;
    for (std::uint32_t i = 0; i < c.size(); ++i) {
        const double ratio = c[i].irradiance() / light(c[i].position().x);
        mean += ratio / c.size();
        square_mean += ratio * ratio / c.size();
    }
    return {mean, std::sqrt(square_mean - mean * mean)};
}

}  // namespace

TEST_CASE("irradiance_cache: freezing averages noise among neighbours and does not darken") {
    const auto constant = [](float) { return 2.f; };
    const auto [rough_mean, rough] = spread(noisy_floor(constant, false, 0.2f, 1).freeze(), constant);
    const auto [mean, smooth] = spread(noisy_floor(constant, true, 0.2f, 1).freeze(), constant);
    CHECK(rough == Approx(0.2).epsilon(0.1));
    CHECK(smooth < 0.5 * rough);
    CHECK(std::abs(mean - rough_mean) < 0.01);
}

TEST_CASE("irradiance_cache: records that few rays made too dark tell no endless errors once they are smoothed") {
    // Each of 64 rays finds the light with a chance of 3 %; all find a faint glow.
    constexpr float chance = 0.03f;
    double told = 0;
    double largest = 0;
    double rms = 0;
    int lookups = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        random_sampler<float> random{seed};
        irradiance_cache<float> c{10.f, by_distance(error_metric::hessian)};
        for (int i = 0; i < 300; ++i) {
            int met = 0;
            for (int k = 0; k < 64; ++k) { met += random.next_1d() < chance; }
            irradiance_estimate<float, float> e;
            e.position = {random.next_1d() * 3, random.next_1d() * 3, 0};
            e.irradiance = static_cast<float>(met) / (64 * chance) + 1e-3f;
            e.relative_noise = met > 0 ? 1 / std::sqrt(static_cast<float>(met)) : 0;
            e.mean_inverse_distance = 1 / 0.4f;
            e.rays = 64;
            c.insert(e);
        }
        const auto frozen = c.freeze();
        for (int i = 0; i < 200; ++i) {
            const auto a = frozen.lookup({0.5f + 2 * random.next_1d(), 0.5f + 2 * random.next_1d(), 0}, up);
            if (!a) { continue; }
            told += static_cast<double>(a.error);
            largest = std::max(largest, static_cast<double>(a.error));
            rms += square(static_cast<double>(a.irradiance) - 1);
            ++lookups;
        }
    }
    told /= lookups;
    rms = std::sqrt(rms / lookups);
    CAPTURE(told, largest, rms, lookups);
    CHECK(told > rms);
    CHECK(told < 6 * rms);
    CHECK(largest < 10);
}

TEST_CASE("irradiance_cache: records of 1e-35 beside others of 1e3 are smoothed to finite numbers") {
    for (const float bright : {1.f, 1e3f, 1e9f}) {
        for (const float dark : {1e-30f, 1e-35f, 1e-37f}) {
            irradiance_cache<float> c{10.f, by_distance(error_metric::hessian)};
            for (const float e : {dark, bright}) {
                irradiance_estimate<float, float> one;
                one.position = {e == dark ? 0.f : 0.5f, 0, 0};
                one.irradiance = e;
                one.relative_noise = 0.1f;
                one.mean_inverse_distance = 0.5f;
                one.rays = 100;
                c.insert(one);
            }
            const auto frozen = c.freeze();
            CAPTURE(bright, dark);
            CHECK(is_radiance(frozen[0].irradiance()));
            for (const float x : {0.1f, 0.4f}) {
                const auto a = frozen.lookup({x, 0, 0}, up);
                REQUIRE(a);
                CHECK(is_radiance(a.irradiance));
                CHECK(is_finite(a.error));
            }
        }
    }
}

TEST_CASE("irradiance_cache: the noise told after smoothing is the noise there is") {
    const auto constant = [](float) { return 2.f; };
    const auto frozen = noisy_floor(constant, true, 0.2f, 2).freeze();
    double told2 = 0;
    for (std::uint32_t i = 0; i < frozen.size(); ++i) {
        told2 += double{square(frozen[i].relative_noise())} / frozen.size();
    }
    CHECK(std::sqrt(told2) / spread(frozen, constant).second == Approx(1).epsilon(0.35));
}

TEMPLATE_TEST_CASE("irradiance_cache: smoothed records were made of the same rays, and blending them averages no more",
                   "", float, double) {
    using T = TestType;
    for (const bool smoothing : {false, true}) {
        auto o = by_distance();
        o.smoothing = smoothing;
        irradiance_cache<vec3<T>> c{T(10), o};
        for (int i = 0; i < 8; ++i) {
            irradiance_estimate<vec3<T>, T> e;
            e.axes = frame<T>{vec3<T>{0, 0, 1}};
            e.irradiance = vec3<T>{T(2) + T(0.1) * (i % 2 == 0 ? T(1) : T(-1))};
            e.relative_noise = T(0.2) * 2 / e.irradiance.x;
            e.mean_inverse_distance = 1;
            e.rays = 100;
            c.insert(e);
        }
        const auto a = c.freeze().lookup({0, 0, 0}, {0, 0, 1});
        CHECK(a.irradiance.x == Approx(2).epsilon(1e-3));
        CHECK(a.error == Approx(0.4 / std::sqrt(8)).epsilon(0.01));
    }
}

TEST_CASE("irradiance_cache: smoothing stops at a step of light that is greater than the noise") {
    const auto step = [](float x) { return x < 1.5f ? 1.f : 3.f; };
    const auto frozen = noisy_floor(step, true, 0.02f, 3).freeze();
    int blurred = 0;
    for (std::uint32_t i = 0; i < frozen.size(); ++i) {
        const float ratio = frozen[i].irradiance() / step(frozen[i].position().x);
        blurred += std::abs(ratio - 1) > 0.15f;
    }
    CHECK(blurred < 15);
}

TEST_CASE("irradiance_cache: what is exact is not smoothed") {
    const auto wave = [](float x) { return 2 + std::sin(3 * x); };
    const auto frozen = noisy_floor(wave, true, 0, 4).freeze();
    for (std::uint32_t i = 0; i < frozen.size(); ++i) { CHECK(frozen[i].irradiance() == wave(frozen[i].position().x)); }
}

TEST_CASE("irradiance_cache: smoothing trusts a record of more rays more") {
    const auto agreed = [](std::uint32_t rays) {
        irradiance_cache<float> c{10.f, by_distance()};
        for (const float light : {1.f, 1.2f}) {
            irradiance_estimate<float, float> e;
            e.position = {light, 0, 0};
            e.axes = frame<float>{up};
            e.irradiance = light;
            e.rays = light > 1 ? rays : 100;
            e.relative_noise = 2 / std::sqrt(static_cast<float>(e.rays));
            e.mean_inverse_distance = 1;
            c.insert(e);
        }
        return c.freeze()[0].irradiance();
    };
    CHECK(agreed(100) == Approx(1.1).epsilon(0.01));
    CHECK(agreed(900) == Approx(1.18).epsilon(0.01));
}

TEST_CASE("irradiance_cache: a record whose light is replaced keeps its place and reach") {
    cache c{10.f, by_distance()};
    const auto first = estimate_at({1, 2, 0}, up, {1, 2, 3}, 2);
    REQUIRE(c.insert(first) == record_status::inserted);
    const cache::record before = c[0];
    auto second = estimate_at({5, 5, 5}, up, {4, 5, 6}, 0.1f);
    second.rays = 400;
    CHECK(c.replace(0, second));
    CHECK(c[0].irradiance() == rgb{4, 5, 6});
    CHECK(c[0].rays() == 400);
    CHECK(c[0].position() == before.position());
    CHECK(c[0].longest_radius() == before.longest_radius());
    second.irradiance.x = std::numeric_limits<float>::quiet_NaN();
    CHECK_FALSE(c.replace(0, second));
    CHECK(c[0].irradiance() == rgb{4, 5, 6});
}

TEST_CASE("irradiance_cache: scatter is told by the records around that face the same way, never by one's own") {
    cache c{10.f, by_distance()};
    const auto add = [&](const vec3<float>& at, const vec3<float>& normal, float noise) {
        auto e = estimate_at(at, normal, {1, 1, 1}, 1);
        e.relative_noise = noise;
        c.insert(e);
    };
    add({0, 0, 0}, up, 0.5f);
    CHECK(c.scatter_around(0) == 0);
    add({0, 0, 0}, -up, 0.5f);
    add({9, 0, 0}, up, 0.5f);
    CHECK(c.scatter_around(0) == 0);
    add({0.5f, 0, 0}, up, 0.1f);
    add({0, 1.5f, 0}, up, 0.2f);
    // A hundred rays each.
    CHECK(c.scatter_around(0) == Approx(10 * std::sqrt((0.01 + 0.04) / 2)).epsilon(0.01));
}

TEST_CASE("irradiance_cache: nearest finds a record where lookup finds none, on the right side") {
    cache c{10.f, by_distance()};
    c.insert(estimate_at({0, 0, 0}, up, {1, 1, 1}, 1));
    c.insert(estimate_at({3, 0, 0}, up, {2, 2, 2}, 1));
    c.insert(estimate_at({2, 0, 0}, -up, {7, 7, 7}, 1));
    const auto frozen = c.freeze();
    CHECK_FALSE(frozen.lookup({1.9f, 0, 0}, up));
    CHECK(frozen.nearest({1.9f, 0, 0}, up).irradiance.x == 2);
    CHECK(frozen.nearest({1.1f, 0, 0}, up).irradiance.x == 1);
    CHECK_FALSE(cache::frozen{}.nearest({0, 0, 0}, up));
}

TEST_CASE("irradiance_cache: no neighbour clamps a record below its own lower limit") {
    for (const float footprint : {0.01f, 0.05f, 0.2f}) {
        auto o = by_distance();
        o.reach.minimum_footprints = 1.5;
        cache c{10.f, o};
        const auto wide = estimate_at({0, 0, 0}, up, {1, 1, 1}, 1);
        const float lowest = c.reach(wide, footprint).lowest;
        CHECK(lowest == Approx(1.5f * footprint));
        c.insert(wide, footprint);
        c.insert(estimate_at({0.001f, 0, 0}, up, {1, 1, 1}, 0.002f));
        CHECK(c[0].radius() >= lowest);
        CHECK(c[0].radius() < 1.06f * lowest);  // one of 256 lengths
    }
}

TEMPLATE_TEST_CASE("irradiance_cache: a lookup's error is the rule's bend at its distance, and the record's noise", "",
                   float, double) {
    using T = TestType;
    irradiance_cache_options o = by_distance(error_metric::hessian);
    o.reach.accuracy = 0.08;
    irradiance_cache<vec3<T>, T> c{T(1), o};
    irradiance_estimate<vec3<T>, T> e;
    e.axes = frame<T>{vec3<T>{0, 0, 1}};
    e.irradiance = {1, 2, 1};
    e.curvature = {T(0.5), 0, T(0.5)};
    e.rays = 100;
    for (const T noise : {T(0), T(0.1)}) {
        e.relative_noise = noise;
        e.position.x += 100;
        REQUIRE(c.insert(e) == record_status::inserted);
        for (const T d : {T(0), T(0.03), T(0.06)}) {
            const auto a = c.lookup(e.position + vec3<T>{d, 0, 0}, vec3<T>{0, 0, 1});
            REQUIRE(a);
            // Half of the curvature times the distance squared.
            CHECK(a.error == Approx(2 * (0.25 * d * d + noise)).epsilon(0.01).margin(1e-6));
        }
    }
}

TEMPLATE_TEST_CASE("irradiance_cache: where weights are below the least, nothing is covered", "", float, double) {
    using T = TestType;
    irradiance_cache_options o = by_distance();
    o.lookup.minimum_weight = 0.3;
    irradiance_cache<vec3<T>, T> c{T(10), o};
    irradiance_estimate<vec3<T>, T> e;
    e.axes = frame<T>{vec3<T>{0, 0, 1}};
    e.irradiance = {1, 1, 1};
    e.mean_inverse_distance = 1;
    c.insert(e);
    // One minus the distance.
    CHECK(c.lookup({T(0.69), 0, 0}, {0, 0, 1}));
    CHECK_FALSE(c.lookup({T(0.71), 0, 0}, {0, 0, 1}));
    CHECK_FALSE(c.freeze().lookup({T(0.71), 0, 0}, {0, 0, 1}));
}

TEST_CASE("irradiance_cache: the nearest tells how wrong it may be, and what faces away never speaks") {
    cache c{10.f, by_distance()};
    c.insert(estimate_at({0, 0, 0}, up, {1, 2, 1}, 1));
    const auto frozen = c.freeze();
    CHECK(frozen.nearest({0.5f, 0, 0}, up).error == Approx(2 * 0.25f));
    CHECK(frozen.nearest({5, 0, 0}, up).error == 2);
    CHECK_FALSE(frozen.nearest({0.5f, 0, 0}, -up));
}

TEST_CASE("irradiance_cache: light from two sides is linear in direction no more, and the misfit says so") {
    constexpr record_features features{.incident = true};
    irradiance_cache<rgb, float, features> c{10.f, by_distance()};
    auto e = estimate_at({0, 0, 0}, up, {1, 1, 1}, 1);
    for (const float side : {0.3f, -0.3f}) {
        e.incident = {side, 0, 0.6f};
        c.insert(e);
    }
    const auto both = c.freeze().light({0, 0, 0}, up);
    REQUIRE(both);
    CHECK(std::abs(both.incident.x) < 1e-3f);
    CHECK(both.incident.z == Approx(0.6).epsilon(1e-3));
    // Each is off by 0.3, which sqrt(18) times makes the light wrong at the most.
    CHECK(both.misfit == Approx(std::sqrt(18.0) * 0.3).epsilon(0.01));
}
