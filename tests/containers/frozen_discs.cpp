#include <aglow/containers/frozen_discs.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
std::vector<thick_disc<T>> random_discs(int count, T size, std::uint64_t seed) {
    random_sampler<T> random{seed};
    std::vector<thick_disc<T>> discs;
    for (int i = 0; i < count; ++i) {
        const vec3<T> centre{random.next_1d() * size, random.next_1d() * size, random.next_1d() * size};
        const T radius = size * (T(0.01) + T(0.2) * square(square(random.next_1d())));
        discs.push_back({centre, radius, uniform_sphere(random.next_2d()), radius * random.next_1d()});
    }
    return discs;
}

template <typename T>
bool covers(const thick_disc<T>& d, const vec3<T>& p) {
    return distance2(p, d.centre) <= square(d.radius) && std::abs(glm::dot(p - d.centre, d.normal)) <= d.height;
}

}  // namespace

TEMPLATE_TEST_CASE("frozen_discs: no disc that covers a point is missing, and the numbers rise", "", float, double) {
    using T = TestType;
    for (const T size : {T(1), T(1e-9), T(1e9)}) {
        const auto discs = random_discs<T>(500, size, 1);
        const frozen_discs<T> tree{discs};
        random_sampler<T> random{2};
        std::size_t shown = 0;
        std::size_t wanted = 0;
        bool complete = true;
        for (int i = 0; i < 3000; ++i) {
            const vec3<T> p = vec3<T>{random.next_1d(), random.next_1d(), random.next_1d()} * size;
            const auto found = tree.candidates(p);
            complete = complete && std::is_sorted(found.begin(), found.end());
            for (std::uint32_t k = 0; k < discs.size(); ++k) {
                const bool covered = covers(discs[k], p);
                wanted += covered;
                complete = complete && (!covered || std::binary_search(found.begin(), found.end(), k));
            }
            shown += found.size();
        }
        CHECK(complete);
        CHECK(wanted > 1000);
        // Lists are short beside 500 discs.
        CHECK(shown < 3000 * 40);
    }
}

TEST_CASE("frozen_discs: centres and borders are covered, at any place") {
    for (const float far : {0.f, 1000.f}) {
        auto discs = random_discs<float>(300, 1, 3);
        for (auto& d : discs) { d.centre += far; }
        const frozen_discs<float> tree{discs};
        for (std::uint32_t k = 0; k < discs.size(); ++k) {
            const auto at_centre = tree.candidates(discs[k].centre);
            CHECK(std::binary_search(at_centre.begin(), at_centre.end(), k));
        }
    }
}

TEST_CASE("frozen_discs: nothing covers anything in an empty one, far away, or at no place at all") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(frozen_discs<float>{}.candidates({0, 0, 0}).empty());
    CHECK(frozen_discs<float>{std::vector<thick_disc<float>>{}}.candidates({0, 0, 0}).empty());
    const frozen_discs<float> tree{random_discs<float>(100, 1, 4)};
    CHECK(tree.candidates({100, 0, 0}).empty());
    CHECK(tree.candidates({nan, 0, 0}).empty());
    CHECK(tree.candidates({0, nan, 0}).empty());
    CHECK(tree.candidates({0, 0, std::numeric_limits<float>::infinity()}).empty());
}

TEST_CASE("frozen_discs: a thousand discs at one place are one list, found without an endless descent") {
    const std::vector<thick_disc<float>> discs(1000, {{1, 2, 3}, 0.5f, {0, 0, 1}, 0.1f});
    const frozen_discs<float> tree{discs};
    CHECK(tree.candidates({1, 2, 3}).size() == 1000);
    CHECK(tree.bytes() < 100000);
}
