// Rows 57 to 65: bad records, coincident points, empty maps, and powers at the ends of the scale.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/fill_cache.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/containers/octree.hpp>
#include <aglow/estimators/irradiance_cache.hpp>
#include <aglow/estimators/irradiance_points.hpp>
#include <aglow/estimators/photon_map.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

using namespace aglow;

namespace {

using rgb = glm::vec3;
constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

irradiance_estimate<float, float> flat(const rgb& at, float irradiance = 1, float inverse_distance = 1) {
    irradiance_estimate<float, float> e;
    e.position = at;
    e.irradiance = irradiance;
    e.mean_inverse_distance = inverse_distance;
    e.nearest_inverse_distance = inverse_distance;
    e.rays = 100;
    return e;
}

template <typename T>
landed_photon<T, T> landed(const vec3<T>& at, T power) {
    const packed_direction<std::int16_t> up{vec3<T>{0, 0, 1}};
    return {at, {power, up, up}};
}

template <typename T>
photon_map<T, T> map_of(const std::vector<landed_photon<T, T>>& photons, T scale = 1) {
    return photon_map<T, T>{std::span<const landed_photon<T, T>>{photons}, scale};
}

/// Whether the nearest of `points` are brute force's, from every tenth of them.
template <typename T>
bool nearest_are_right(const std::vector<vec3<T>>& points, std::size_t k) {
    const kd_tree<T> tree{points, [](const vec3<T>& p) { return p; }};
    kd_scratch<T> scratch;
    for (std::size_t q = 0; q < points.size(); q += 10) {
        std::vector<std::pair<T, std::uint32_t>> all;
        for (std::uint32_t i = 0; i < points.size(); ++i) { all.emplace_back(distance2(points[i], points[q]), i); }
        std::sort(all.begin(), all.end());
        const auto found = tree.nearest(points[q], k, scratch, {}, [](kd_slot) { return true; });
        if (found.size() != std::min(k, points.size())) { return false; }
        std::vector<std::pair<T, std::uint32_t>> mine;
        for (std::size_t i = 0; i < found.size(); ++i) {
            mine.emplace_back(found.distances2[i], tree.order()[found.slots[i]]);
        }
        std::sort(mine.begin(), mine.end());
        if (!std::equal(mine.begin(), mine.end(), all.begin())) { return false; }
    }
    return true;
}

}  // namespace

TEST_CASE("stability 57: spheres and records of no, negative, infinite or NaN reach are refused and change no answer") {
    octree<int, float> tree;
    REQUIRE(tree.insert(1, rgb{0}, 1.0f));
    for (const float r : {0.0f, -1.0f, inf_f, nan_f, -inf_f}) {
        CHECK(tree.insert(2, rgb{0}, r).status == octree_status::bad_radius);
    }
    int covering = 0;
    tree.visit_covering(rgb{0.1f}, [&](int i) { covering += i; });
    CHECK(covering == 1);

    irradiance_cache<float> cache{1.0f};
    REQUIRE(cache.insert(flat(rgb{0})) == record_status::inserted);
    const auto before = cache.lookup(rgb{0.01f, 0, 0}, {0, 0, 1});
    REQUIRE(before);
    for (const float bad : {nan_f, inf_f, -1.0f}) {
        CHECK(cache.insert(flat(rgb{0.01f, 0, 0}, bad)) == record_status::bad_estimate);
        CHECK(cache.insert(flat(rgb{0.01f, 0, 0}, 1, bad)) == record_status::bad_estimate);
    }
    CHECK(cache.insert(flat(rgb{nan_f, 0, 0})) == record_status::bad_estimate);
    CHECK(cache.refused() == 7);
    CHECK(cache.lookup(rgb{0.01f, 0, 0}, {0, 0, 1}).irradiance == before.irradiance);
}

TEST_CASE("stability 58: asked where a record is, the cache says what the record says, and two agree on their mean") {
    irradiance_cache<float> cache{1.0f, {.smoothing = false}};
    REQUIRE(cache.insert(flat({0.25f, 0, 0}, 3)) == record_status::inserted);
    const auto one = cache.lookup({0.25f, 0, 0}, {0, 0, 1});
    CHECK(std::abs(one.irradiance - 3) <= 8 * 1.2e-7f * 3);
    REQUIRE(cache.insert(flat({0.25f, 0, 0}, 5)) == record_status::inserted);
    const auto two = cache.lookup({0.25f, 0, 0}, {0, 0, 1});
    CHECK(two.records == 2);
    CHECK(std::abs(two.irradiance - 4) <= 8 * 1.2e-7f * 4);
    CHECK(is_finite(two.error));
    const auto frozen = cache.freeze();
    CHECK(std::abs(frozen.lookup({0.25f, 0, 0}, {0, 0, 1}).irradiance - 4) <= 8 * 1.2e-7f * 4);
}

TEST_CASE("stability 59: a crevice gets no more records than its area over the least reach") {
    // Two walls that meet at a right angle; everything near the edge is as near as it likes.
    irradiance_cache<float> cache{1.0f};
    std::vector<cache_candidate<float>> places;
    random_sampler<float> random{3};
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const float x = std::pow(10.0f, -6 * random.next_1d());
        places.push_back({{{x, random.next_1d(), 0}, {0, 0, 1}, 1e-9f}, 0, i});
    }
    struct edge {
        incoming_light<float, float> operator()(const ray<float>& r, const random_numbers<float>&) const {
            const float t = r.direction.x < 0 ? -r.origin.x / r.direction.x : inf_f;
            return {r.direction.x < 0 ? 1.0f : 0.0f, t};
        }
    };
    const auto result = fill_cache(cache, places, edge{}, {.rays = 32});
    const double least = 0.002 * 1.0;
    CHECK(cache.size() <= 1 / (pi<double> * least / 2 * least / 2));
    CHECK(result.records < 5000);
    CHECK(result.uncovered == 0);
}

TEST_CASE("stability 60: normals a hair longer than one neither break a look-up nor make NaN") {
    irradiance_cache<float> cache{1.0f};
    random_sampler<float> random{5};
    int longer = 0;
    for (int i = 0; i < 2000; ++i) {
        // Normalising leaves some a hair too long, which ones is the compiler's choice: here all are, by four ulp.
        const rgb n = glm::normalize(rgb{random.next_1d() - 0.5f, random.next_1d() - 0.5f, random.next_1d() - 0.5f}) *
                      (1 + 4 * std::numeric_limits<float>::epsilon());
        longer += glm::dot(n, n) > 1 ? 1 : 0;
        auto e = flat(rgb{static_cast<float>(i), 0, 0});
        e.axes = frame<float>{n};
        REQUIRE(cache.insert(e) == record_status::inserted);
        const auto answer = cache.lookup(e.position, n);
        REQUIRE(answer);
        CHECK(answer.irradiance == 1);
        CHECK(is_finite(answer.weight));
    }
    CHECK(longer == 2000);
}

TEMPLATE_TEST_CASE("stability 61: points on a plane, a line or one spot are no exception for the nearest", "", float,
                   double) {
    using T = TestType;
    random_sampler<T> random{7};
    for (int free = 0; free <= 3; ++free) {
        std::vector<vec3<T>> points;
        for (int i = 0; i < 600; ++i) {
            vec3<T> p{T(0.5)};
            for (int axis = 0; axis < free; ++axis) {
                // On a grid whose squares are exact, so that no fused multiplication rounds another way; and so tied.
                p[axis] = std::floor(random.next_1d() * 1024) / 1024;
            }
            points.push_back(p);
        }
        CAPTURE(free);
        CHECK(nearest_are_right(points, 20));
    }
}

TEST_CASE("stability 62: more asked for than there is, or nothing there, is an answer") {
    const photon_map<float> nothing;
    CHECK(nothing.irradiance({0, 0, 0}, {0, 0, 1}).value == 0);
    CHECK(nothing.irradiance({0, 0, 0}, {0, 0, 1}).count == 0);
    const auto three =
        map_of<float>({landed<float>({0, 0, 0}, 1), landed<float>({1, 0, 0}, 1), landed<float>({0, 1, 0}, 1)});
    const auto few = three.irradiance({0, 0, 0}, {0, 0, 1}, {.count = 50});
    CHECK(few.count == 3);
    CHECK(is_radiance(few.value));
    CHECK(nearest_are_right<float>({rgb{0}, rgb{1}, rgb{2}}, 50));
    irradiance_cache<float> cache{1.0f};
    CHECK_FALSE(cache.lookup(rgb{0}, {0, 0, 1}));
    CHECK_FALSE(cache.freeze().lookup(rgb{0}, {0, 0, 1}));
    CHECK_FALSE(irradiance_points<float>{}.nearest(rgb{0}, {0, 0, 1}));
    octree<int, float> tree;
    int found = 0;
    tree.visit_covering(rgb{0}, [&](int) { ++found; });
    CHECK(found == 0);
}

TEST_CASE("stability 63: coordinates of 1e12 and reaches of 1e-6 are answered as by brute force") {
    octree<int, double> tree;
    std::vector<vec3<double>> centres;
    random_sampler<double> random{9};
    for (int i = 0; i < 300; ++i) {
        const double sign = i % 2 ? 1 : -1;
        const vec3<double> c{sign * 1e12 + random.next_1d() * 1e-2, random.next_1d() * 1e-6, -sign * 1e12};
        centres.push_back(c);
        REQUIRE(tree.insert(i, c, 1e-6));
    }
    for (int q = 0; q < 300; q += 3) {
        const vec3<double> at = centres[static_cast<std::size_t>(q)];
        std::vector<int> expected;
        for (int i = 0; i < 300; ++i) {
            if (distance2(centres[static_cast<std::size_t>(i)], at) <= 1e-12) { expected.push_back(i); }
        }
        std::vector<int> found;
        tree.visit_covering(at, [&](int i) { found.push_back(i); });
        CHECK(found == expected);
    }
    std::vector<vec3<float>> points;
    for (int i = 0; i < 300; ++i) { points.push_back({i % 2 ? 1e12f : -1e12f, static_cast<float>(i) * 1e-6f, 0}); }
    CHECK(nearest_are_right(points, 5));
}

TEST_CASE("stability 64: beside a light 1e30 times as strong, a faint one keeps its own region to a hundredth") {
    std::vector<landed_photon<float, float>> photons;
    random_sampler<float> random{11};
    for (int i = 0; i < 4000; ++i) {
        photons.push_back(landed<float>({random.next_1d(), random.next_1d(), 0}, 1e-30f));
        photons.push_back(landed<float>({10 + random.next_1d(), random.next_1d(), 0}, 1.0f));
    }
    const auto map = map_of(photons);
    const auto all = [](double x) { return rgb{static_cast<float>(x), 0.5f, 0}; };
    const density_options disc{.count = 0, .max_radius = 2, .kernel = kernel_shape::constant};
    const float area = pi<float> * 4;
    CHECK(map.irradiance(all(0.5), {0, 0, 1}, disc).value * area == Approx(4000e-30).epsilon(1e-2));
    CHECK(map.irradiance(all(10.5), {0, 0, 1}, disc).value * area == Approx(4000).epsilon(1e-2));
}

TEST_CASE("stability 65: photons of 1e-42 watts each are a millionth of a light of 1e-36, to 4 ulp of the sum's") {
    std::vector<landed_photon<float, float>> photons;
    random_sampler<float> random{13};
    for (int i = 0; i < 10000; ++i) {
        photons.push_back(landed<float>({random.next_1d(), random.next_1d(), 0}, 1e-36f));
    }
    const density_options disc{.count = 0, .max_radius = 0.25};
    const float plain = map_of(photons).irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, disc).value;
    // Scaled to a millionth of the paths each photon is subnormal, the irradiance is not.
    const float scaled = map_of(photons, 1e-6f).irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, disc).value;
    CHECK(std::abs(scaled - plain * 1e-6f) <= 4 * 1.2e-7f * scaled);
}
