#include <aglow/containers/packed_spheres.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
std::vector<stored_sphere<T>> random_spheres(int count, T size, std::uint64_t seed) {
    random_sampler<T> random{seed};
    std::vector<stored_sphere<T>> spheres;
    for (int i = 0; i < count; ++i) {
        const vec3<T> centre{random.next_1d() * size, random.next_1d() * size, random.next_1d() * size};
        const T radius = size * (T(0.01) + T(0.2) * square(square(random.next_1d())));
        spheres.push_back({centre, limit2_of(radius), static_cast<std::uint32_t>(i)});
    }
    return spheres;
}

template <typename T>
std::vector<std::uint32_t> covering(const packed_spheres<T>& index, const vec3<T>& p) {
    sphere_hits<T> found;
    index.search(covering_question<T>{p}, found);
    std::vector<std::uint32_t> items(found.items().begin(), found.items().end());
    std::sort(items.begin(), items.end());
    return items;
}

template <typename T>
std::vector<std::uint32_t> brute_force(const std::vector<stored_sphere<T>>& spheres, const vec3<T>& p) {
    std::vector<std::uint32_t> items;
    for (const auto& s : spheres) {
        if (simd::distance2(s.centre, p) < s.limit2) { items.push_back(s.item); }
    }
    return items;
}

}  // namespace

TEMPLATE_TEST_CASE("packed_spheres: each sphere over a point is found once, and no other, at any scale", "", float,
                   double) {
    using T = TestType;
    for (const T size : {T(1), T(1e-9), T(1e9)}) {
        const auto spheres = random_spheres<T>(700, size, 1);
        const packed_spheres<T> index{spheres};
        random_sampler<T> random{2};
        int wrong = 0;
        std::size_t found = 0;
        for (int i = 0; i < 3000; ++i) {
            const vec3<T> p = vec3<T>{random.next_1d(), random.next_1d(), random.next_1d()} * size;
            const auto expected = brute_force(spheres, p);
            wrong += covering(index, p) != expected;
            found += expected.size();
        }
        CHECK(wrong == 0);
        CHECK(found > 1000);
    }
}

TEST_CASE("packed_spheres: centres are covered, far from the origin too") {
    for (const float far : {0.f, 1000.f}) {
        auto spheres = random_spheres<float>(300, 1, 3);
        for (auto& s : spheres) { s.centre += far; }
        const packed_spheres<float> index{spheres};
        for (const auto& s : spheres) {
            const auto found = covering(index, s.centre);
            CHECK(std::binary_search(found.begin(), found.end(), s.item));
        }
    }
}

TEST_CASE("packed_spheres: nothing covers anything in an empty one, far away, or at no place at all") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(covering(packed_spheres<float>{}, {0, 0, 0}).empty());
    CHECK(covering(packed_spheres<float>{std::vector<stored_sphere<float>>{}}, {0, 0, 0}).empty());
    const packed_spheres<float> index{random_spheres<float>(100, 1, 4)};
    CHECK(covering(index, {100, 0, 0}).empty());
    CHECK(covering(index, {nan, 0, 0}).empty());
    CHECK(covering(index, {0, nan, 0}).empty());
    CHECK(covering(index, {0, 0, std::numeric_limits<float>::infinity()}).empty());
}

TEST_CASE("packed_spheres: a thousand spheres at one place are found in few bytes") {
    std::vector<stored_sphere<float>> spheres;
    for (std::uint32_t i = 0; i < 1000; ++i) { spheres.push_back({{1, 2, 3}, 0.25f, i}); }
    const packed_spheres<float> index{spheres};
    CHECK(covering(index, {1, 2, 3}) == brute_force<float>(spheres, {1, 2, 3}));
    CHECK(index.bytes() < 100000);
}

TEST_CASE("packed_spheres: spheres farther apart than a number can be do no harm, few or many") {
    const float most = std::numeric_limits<float>::max();
    for (const std::uint32_t count : {2u, 3000u}) {
        std::vector<stored_sphere<float>> spheres;
        for (std::uint32_t i = 0; i < count; ++i) {
            const float end = i % 2 == 0 ? most : -most;
            spheres.push_back({{end, end * (float(i) / float(count)), 0}, limit2_of(1e15f), i});
        }
        const packed_spheres<float> index{spheres};
        int wrong = 0;
        for (const auto& s : spheres) {
            const auto found = covering(index, s.centre);
            const auto right = brute_force(spheres, s.centre);
            wrong += !std::includes(right.begin(), right.end(), found.begin(), found.end());
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("packed_spheres: places asked about in step get what brute force finds for each, in a crowd too") {
    auto crowd = random_spheres<float>(4000, 1, 6);
    for (auto& s : crowd) { s = {s.centre * 0.001f, 0.25f, s.item}; }
    for (const auto& spheres : {random_spheres<float>(700, 1, 6), crowd}) {
        const packed_spheres<float> index{spheres};
        random_sampler<float> random{7};
        std::vector<vec3<float>> places(200);
        for (std::size_t i = 0; i < places.size(); ++i) {  // first scattered, then some together
            const vec3<float> p{random.next_1d(), random.next_1d(), random.next_1d()};
            places[i] = i < 100 || i % 8 == 0 ? p : places[i - i % 8] + p * 0.001f;
        }
        std::size_t next = 0;
        int wrong = 0;
        index.search_each(
            places.size(), [&](std::size_t i) { return places[i]; },
            [&](std::size_t i, std::span<const std::uint32_t> found) {
                std::vector<std::uint32_t> items(found.begin(), found.end());
                std::sort(items.begin(), items.end());
                wrong += i != next++ || items != brute_force(spheres, places[i]);
            });
        CHECK(next == places.size());
        CHECK(wrong == 0);
    }
}

TEST_CASE("packed_spheres: found by place, neighbours have near places and answers are the same spheres") {
    const auto spheres = random_spheres<float>(1000, 1, 5);
    packed_spheres<float> index{spheres};
    const std::vector<std::uint32_t> by_place = index.hand_out_items();
    auto old = by_place;
    std::erase(old, packed_spheres<float>::none);
    CHECK(by_place.size() < old.size() + 200);
    auto sorted = old;
    std::sort(sorted.begin(), sorted.end());
    bool each_once = sorted.size() == spheres.size();
    double step = 0, any = 0;
    for (std::uint32_t i = 0; each_once && i < 1000; ++i) {
        each_once = sorted[i] == i;
        step += static_cast<double>(glm::distance(spheres[old[i]].centre, spheres[old[(i + 1) % 1000]].centre));
        any += static_cast<double>(glm::distance(spheres[i].centre, spheres[(i + 1) % 1000].centre));
    }
    CHECK(each_once);
    CHECK(step < 0.6 * any);
    int wrong = 0;
    for (const auto& s : spheres) {
        auto found = covering(index, s.centre);
        for (auto& i : found) { i = by_place[i]; }
        std::sort(found.begin(), found.end());
        wrong += found != brute_force(spheres, s.centre);
    }
    CHECK(wrong == 0);
}
