#include <aglow/containers/kd_build.hpp>
#include <aglow/containers/kd_kernels.hpp>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Points on three walls and in a cluster, some of them repeated, with ties along every axis.
template <typename T>
std::vector<vec3<T>> walls(std::size_t count) {
    std::mt19937 random{77};
    const auto u = [&] { return static_cast<T>(random() >> 8) * T(0x1p-24); };
    std::vector<vec3<T>> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        points[i] = {u(), u(), u()};
        if (i % 4 != 0) { points[i][static_cast<int>(i % 3)] = T(0.25); }
        if (i % 7 == 6) { points[i] = points[i / 2]; }
    }
    return points;
}

template <typename Runner, typename T>
detail::kd_storage<T> tree_of(const std::vector<vec3<T>>& points) {
    detail::kd_storage<T> tree;
    detail::kd_cloud<T> cloud{points.size()};
    detail::kd_cloud<T> spare{points.size()};
    const auto same = [](const vec3<T>& p) { return p; };
    tree.shape(static_cast<std::uint32_t>(detail::take(cloud, points, same, in_sequence{})));
    detail::kd_builder<T, Runner>{tree, cloud, spare}.build(in_sequence{});
    return tree;
}

template <typename T>
struct found {
    std::vector<std::uint32_t> slots;
    T farthest;
    bool operator==(const found&) const = default;
};

template <typename Runner, typename T>
found<T> search(const detail::kd_storage<T>& tree, const vec3<T>& point, std::uint32_t k) {
    detail::kd_probe<T> probe;
    probe.point = point;
    probe.enough = k;
    detail::kd_candidates<T> list;
    list.reserve(2 * k + 1024);
    const detail::kd_task<T> task{k, T(1e30), 0};
    const T farthest = detail::search<Runner>(tree, probe, task, list, detail::kd_filter<T>{});
    return {{list.slots.begin(), list.slots.begin() + list.count}, farthest};
}

template <typename T>
using best_runner = detail::kd_best_runner<T>;
template <typename T>
using avx2_runner = detail::kd_pack_runner<typename simd::packs_of<T>::avx2>;
template <typename T>
using any_runner = detail::kd_pack_runner<typename simd::packs_of<T>::any>;
template <typename T>
using plain_runner = detail::kd_pack_runner<simd::plain<T>>;

/// Whether a runner builds the plain one's tree and finds in it what the plain one finds.
template <typename T, typename Runner>
void compare_with_plain() {
    for (const std::size_t count : {1u, 33u, 512u, 5000u, 70'001u}) {
        const auto points = walls<T>(count);
        const auto one = tree_of<plain_runner<T>>(points);
        const auto other = tree_of<Runner>(points);
        REQUIRE(one.order == other.order);
        for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 50) {
            for (const std::uint32_t k : {1u, 30u, 300u}) {
                if (k > count) { continue; }
                const vec3<T> q = points[i] + vec3<T>(0, T(0.001), 0);
                REQUIRE(search<plain_runner<T>>(one, q, k) == search<Runner>(other, q, k));
            }
        }
    }
}

}  // namespace

TEMPLATE_TEST_CASE("kd_build: every instruction set builds the same tree and finds the same", "[kd_tree]", float,
                   double) {
    using T = TestType;
    compare_with_plain<T, best_runner<T>>();
    compare_with_plain<T, any_runner<T>>();
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("avx2")) { compare_with_plain<T, avx2_runner<T>>(); }
#endif
}

TEST_CASE("kd_build: boxes are tight and every leaf but the last is full") {
    const auto points = walls<float>(20'000);
    const auto tree = tree_of<best_runner<float>>(points);
    for (int level = 1; level <= tree.height; ++level) {
        const auto below = static_cast<std::uint32_t>(detail::kd_capacity(level - 1));
        for (std::uint32_t child = 0; child * below < tree.size; ++child) {
            bounds<float> box;
            for (std::uint32_t s = child * below; s < std::min(tree.size, (child + 1) * below); ++s) {
                box.add(tree.position(s));
            }
            const detail::kd_node<float>& node = tree.node(level, child / detail::kd_fan);
            const std::uint32_t i = child % detail::kd_fan;
            REQUIRE(box.low == vec3<float>(node.low_x[i], node.low_y[i], node.low_z[i]));
            REQUIRE(box.high == vec3<float>(node.high_x[i], node.high_y[i], node.high_z[i]));
        }
    }
    CHECK(tree.leaves.size() == 20'000 / detail::kd_leaf_size);
}
