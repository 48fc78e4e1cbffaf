#include <aglow/containers/near_spheres.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
using block = sphere_lanes<T, simd::lanes>;

/// Spheres in and around the unit cube; every seventh lane is in no use.
template <typename T>
std::vector<block<T>> random_blocks(std::size_t count, T radius, random_sampler<T>& random) {
    std::vector<block<T>> blocks(count);
    std::uint32_t place = 0;
    for (auto& b : blocks) {
        for (std::uint32_t i = 0; i < simd::lanes; ++i, ++place) {
            const vec3<T> centre{random.next_1d(), random.next_1d(), random.next_1d()};
            const T own = radius * random.next_1d();
            place % 7 == 6 ? b.clear(i) : b.set(i, centre, own * own);
        }
    }
    return blocks;
}

template <typename T>
near_spheres<T> near_box(const std::vector<block<T>>& blocks, const bounds<T>& box) {
    std::vector<std::uint32_t> numbers(blocks.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    near_spheres<T> near;
    simd::run_best<T, detail::pick_near>(blocks.data(), numbers.data(), static_cast<std::uint32_t>(numbers.size()), box,
                                         near);
    return near;
}

template <typename T>
std::vector<std::uint32_t> brute_force(const std::vector<block<T>>& blocks, const vec3<T>& p) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t place = 0; place < blocks.size() * simd::lanes; ++place) {
        const block<T>& b = blocks[place / simd::lanes];
        const std::uint32_t i = place % simd::lanes;
        if (simd::distance2(b.centre(i), p) < b.limit2[i]) { found.push_back(place); }
    }
    return found;
}

/// Eight points within `width` of each other, the first ones in corners of their box.
template <typename T>
std::array<vec3<T>, 8> points_together(T width, random_sampler<T>& random) {
    const vec3<T> corner{random.next_1d(), random.next_1d(), random.next_1d()};
    std::array<vec3<T>, 8> points{corner, corner + width};
    for (std::size_t i = 2; i < 8; ++i) {
        points[i] = corner + vec3<T>{random.next_1d(), random.next_1d(), random.next_1d()} * width;
    }
    return points;
}

template <typename T>
void check_against_brute_force(T width) {
    random_sampler<T> random{1};
    std::size_t wrong = 0, found_in_all = 0, picked = 0;
    for (int turn = 0; turn < 200; ++turn) {
        const auto blocks = random_blocks<T>(10, T(0.4), random);
        const auto points = points_together<T>(width, random);
        bounds<T> box;
        for (const auto& p : points) { box.add(p); }
        auto near = near_box(blocks, box);
        REQUIRE(near.complete);
        picked += near.count;
        std::vector<std::uint32_t> found(8 * near.room + simd::lanes), ends(8);
        simd::run_best<T, detail::ask_near>(near, points.data(), points.size(), found.data(), ends.data());
        for (std::size_t i = 0, begin = 0; i < 8; begin = ends[i++]) {
            const std::vector<std::uint32_t> own(&found[begin], &found[0] + ends[i]);
            wrong += own != brute_force(blocks, points[i]);  // in the same order, too
            found_in_all += own.size();
        }
    }
    CHECK(wrong == 0);
    CHECK(found_in_all > 200 * 8);
    CHECK(picked < 200 * 100);
}

}  // namespace

TEST_CASE("near_spheres: points that lie together find what brute force finds for each, in the same order") {
    check_against_brute_force<float>(0.1f);
    check_against_brute_force<double>(0.1);
    check_against_brute_force<float>(0);
    check_against_brute_force<float>(0.3f);
}

TEST_CASE("near_spheres: where there is no room for all, that is told") {
    random_sampler<float> random{2};
    const bounds<float> everything{vec3<float>{0}, vec3<float>{1}};
    CHECK(near_box(random_blocks<float>(8, 1, random), everything).complete);
    const auto near = near_box(random_blocks<float>(20, 1, random), everything);
    CHECK_FALSE(near.complete);
    CHECK(near.count <= near.room);
}
