#include <aglow/containers/packed_boxes.hpp>

#include <cstdint>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Up to half as wide as the room of corners along every axis.
template <typename T>
bounds<T> random_box(T size, random_sampler<T>& random) {
    bounds<T> box;
    const vec3<T> corner{random.next_1d(), random.next_1d(), random.next_1d()};
    box.add(corner * size);
    box.add((corner + vec3<T>{random.next_1d(), random.next_1d(), random.next_1d()} / T(2)) * size);
    return box;
}

template <typename T>
bool meet(const bounds<T>& a, const bounds<T>& b, const vec3<T>& gap) {
    return !bounds<T>{glm::max(a.low, b.low) - gap, glm::min(a.high, b.high)}.empty();
}

}  // namespace

TEMPLATE_TEST_CASE("packed_boxes: every box that meets another is told, and none a step away, at any scale", "", float,
                   double) {
    using T = TestType;
    random_sampler<T> random{1};
    int missed = 0, needless = 0, met = 0, apart = 0;
    for (int turn = 0; turn < 3000; ++turn) {
        const T size = turn % 3 == 0 ? T(1) : turn % 3 == 1 ? T(1e-9) : T(1e9);
        std::vector<bounds<T>> boxes(static_cast<std::size_t>(turn % 16) + 1);
        bounds<T> all;
        for (auto& box : boxes) { all.add(box = random_box(size, random)); }
        detail::packed_boxes<T> packed{};
        packed.pack(boxes, all);
        const vec3<T> step = all.extent() * T(1.001 / 255);
        const bounds<T> asked = random_box(size, random);
        const std::uint32_t told = packed.near(asked);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const bool is_told = (told >> i & 1u) != 0;
            const bool is_met = meet(boxes[i], asked, vec3<T>{0});
            missed += !is_told && is_met;
            needless += is_told && !meet(boxes[i], asked, step);
            ++(is_met ? met : apart);
        }
    }
    CHECK(missed == 0);
    CHECK(needless == 0);
    // Two such boxes meet with probability (5/12)^3: 1,845 of the 25,500 asked about.
    CHECK(met > 1500);
    CHECK(apart > 20'000);
}

TEST_CASE("packed_boxes: a box without extent is found where it is, and nothing far from them all") {
    const bounds<float> flat{{1, 2, 3}, {2, 2, 3}};
    detail::packed_boxes<float> packed{};
    packed.pack(std::vector{flat}, flat);
    CHECK((packed.near({{1, 2, 3}, {1, 2, 3}}) & 1u) == 1);
    CHECK(packed.near({{2.5f, 2, 3}, {3, 2, 3}}) == 0);
    CHECK(packed.near({{-1, 2, 3}, {0.5f, 2, 3}}) == 0);
    const float endless = std::numeric_limits<float>::infinity();
    CHECK((packed.near({vec3<float>{-endless}, vec3<float>{endless}}) & 1u) == 1);
}
