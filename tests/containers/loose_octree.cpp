#include <aglow/containers/loose_octree.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <aglow/core/random.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Radii over three decades, mostly small ones.
std::vector<stored_sphere<float>> random_spheres(std::uint32_t count) {
    random_sampler<float> random{1};
    std::vector<stored_sphere<float>> spheres;
    for (std::uint32_t i = 0; i < count; ++i) {
        const vec3<float> centre{random.next_1d() * 2 - 1, random.next_1d() * 2 - 1, random.next_1d() * 2 - 1};
        spheres.push_back({centre, limit2_of(0.3f * std::pow(10.f, -3 * random.next_1d())), i});
    }
    return spheres;
}

template <typename Question>
std::vector<std::uint32_t> found_by(const loose_octree<float>& tree, const Question& question) {
    sphere_hits<float> hits;
    tree.search(question, hits);
    std::vector<std::uint32_t> items(hits.items().begin(), hits.items().end());
    std::sort(items.begin(), items.end());
    return items;
}

template <typename Question>
std::vector<std::uint32_t> brute_force(const std::vector<stored_sphere<float>>& spheres, const Question& question) {
    std::vector<std::uint32_t> items;
    for (const auto& s : spheres) {
        if (simd::distance2(s.centre, question.point) < question.limit2(s.limit2)) { items.push_back(s.item); }
    }
    return items;
}

}  // namespace

TEST_CASE("loose_octree: what it finds after each insertion is what brute force finds") {
    const auto spheres = random_spheres(1500);
    loose_octree<float> tree;
    std::vector<stored_sphere<float>> so_far;
    random_sampler<float> random{2};
    int wrong = 0;
    for (const auto& s : spheres) {
        if (s.item % 50 == 0) {
            tree.insert_outside(s);
        } else {
            tree.insert(s, s.radius());
        }
        so_far.push_back(s);
        const vec3<float> p{random.next_1d() * 2 - 1, random.next_1d() * 2 - 1, random.next_1d() * 2 - 1};
        const covering_question<float> over{p};
        const within_question<float> near{p, 0.2f};
        wrong += found_by(tree, over) != brute_force(so_far, over);
        wrong += found_by(tree, near) != brute_force(so_far, near);
    }
    CHECK(wrong == 0);
}

TEST_CASE("loose_octree: it shows every sphere once, and moved, it leaves an empty one") {
    const auto spheres = random_spheres(500);
    loose_octree<float> tree;
    for (const auto& s : spheres) { tree.insert(s, s.radius()); }
    const loose_octree<float> taken{std::move(tree)};
    std::vector<int> shown(spheres.size());
    taken.visit_all([&](const stored_sphere<float>& s) { ++shown[s.item]; });
    CHECK(std::count(shown.begin(), shown.end(), 1) == 500);
    int left = 0;
    tree.visit_all([&](const stored_sphere<float>&) { ++left; });
    CHECK(left == 0);
    CHECK(found_by(tree, covering_question<float>{spheres[0].centre}).empty());
}
