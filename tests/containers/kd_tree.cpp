// The tree is compared with brute force: every distance computed, everything sorted.
#include <aglow/containers/kd_tree.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Clouds with the shapes that trees stumble over.
template <typename T>
std::vector<vec3<T>> cloud(const std::string& shape, std::size_t count, T scale = 1) {
    std::mt19937 random{12345};
    const auto u = [&] { return static_cast<T>(random() >> 8) / T(1 << 24); };
    std::vector<vec3<T>> points;
    std::vector<vec3<T>> stock;
    for (int i = 0; i < 37; ++i) { stock.push_back({u(), u(), u()}); }
    for (std::size_t i = 0; i < count; ++i) {
        vec3<T> p{u(), u(), u()};
        if (shape == "plane") { p.z = T(0.25); }
        if (shape == "tilted plane") { p.z = p.x * T(0.5) + p.y * T(0.25); }
        if (shape == "line") { p = {p.x, p.x, p.x}; }
        if (shape == "one point") { p = {T(0.5), T(-0.25), T(3)}; }
        if (shape == "repeated") { p = stock[random() % stock.size()]; }
        if (shape == "lattice") { p = {T(random() % 9), T(random() % 9), T(random() % 9)}; }
        for (const int axis : {0, 1, 2}) {  // a crowd at each of a few places in a row
            const std::string_view name{&"xyz"[axis], 1};
            if (shape != std::string{"row along "}.append(name)) { continue; }
            p = {T(0.5), T(0.5), T(0.5)};
            p[axis] = T(random() % 4) / 4;
        }
        if (shape == "walls" && i % 5 != 0) { p[static_cast<int>(random() % 3)] = T(random() % 2); }
        if (shape == "walls" && i % 5 == 0) { p = p * T(0.01) + vec3<T>(T(0.5), T(0.5), 0); }
        if (shape == "clusters") { p = stock[i % 5] + p * T(1e-4); }
        points.push_back(p * scale);
    }
    return points;
}

const std::vector<std::string> shapes{"cube",    "plane", "tilted plane", "line",        "one point",   "repeated",
                                      "lattice", "walls", "clusters",     "row along x", "row along y", "row along z"};
const std::vector<std::size_t> sizes{1, 2, 15, 16, 17, 31, 32, 33, 63, 64, 65, 100, 511, 512, 513, 1500, 8193, 9000};

/// Queries among the points, on them, beside them and far away.
template <typename T>
std::vector<vec3<T>> queries(const std::vector<vec3<T>>& points, T scale = 1) {
    std::mt19937 random{99};
    const auto u = [&] { return static_cast<T>(random() >> 8) / T(1 << 24); };
    std::vector<vec3<T>> all;
    for (int i = 0; i < 3; ++i) {
        const vec3<T> offset{u(), u(), u()};
        const vec3<T> near = points[random() % points.size()];
        all.push_back(near);
        all.push_back(near + offset * (T(0.01) * scale));
        all.push_back(offset * scale);
    }
    all.push_back(vec3<T>(-30, 2, 5) * scale);
    all.push_back(vec3<T>(T(1e5), T(-1e5), T(1e5)) * scale);
    return all;
}

template <typename T>
struct item {
    T distance2;
    std::uint32_t index;
    bool operator==(const item&) const = default;
    auto operator<=>(const item&) const = default;
};

template <typename T, typename Accept>
std::vector<item<T>> brute_force(const std::vector<vec3<T>>& points, vec3<T> q, std::size_t k, T radius2,
                                 Accept accept) {
    std::vector<item<T>> all;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const T d2 = simd::distance2(points[i], q);
        if (d2 < radius2 && accept(i)) { all.push_back({d2, i}); }
    }
    std::sort(all.begin(), all.end());
    if (all.size() > k) { all.resize(k); }
    return all;
}

template <typename T>
std::vector<item<T>> sorted(const kd_tree<T>& tree, const kd_neighbours<T>& found) {
    std::vector<item<T>> all;
    for (std::size_t i = 0; i < found.size(); ++i) {
        all.push_back({found.distances2[i], tree.order()[found.slots[i]]});
    }
    std::sort(all.begin(), all.end());
    return all;
}

template <typename T>
kd_tree<T> tree_of(const std::vector<vec3<T>>& points) {
    return kd_tree<T>{points, [](const vec3<T>& p) { return p; }};
}

template <typename T>
std::tuple<T, T, T> place_of(const vec3<T>& p) {
    return {p.x, p.y, p.z};
}

const auto all_of_them = [](std::uint32_t) { return true; };

}  // namespace

TEMPLATE_TEST_CASE("kd_tree: k nearest are what brute force finds, ties by index", "[kd_tree]", float, double) {
    using T = TestType;
    kd_scratch<T> scratch;
    for (const std::string& shape : shapes) {
        for (const std::size_t n : sizes) {
            const auto points = cloud<T>(shape, n);
            const auto tree = tree_of(points);
            for (const vec3<T>& q : queries(points)) {
                for (const std::size_t k : {std::size_t{1}, std::size_t{8}, std::size_t{50}, std::size_t{200}, n}) {
                    const auto truth = brute_force(points, q, k, std::numeric_limits<T>::infinity(), all_of_them);
                    const auto found = tree.nearest(q, k, scratch);
                    CAPTURE(shape, n, k, q.x, q.y, q.z);
                    REQUIRE(sorted(tree, found) == truth);
                    REQUIRE(std::is_sorted(found.slots.begin(), found.slots.end()));
                    if (truth.size() == k) { REQUIRE(found.radius2 == truth.back().distance2); }
                }
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: k nearest within a radius are what brute force finds", "[kd_tree]", float, double) {
    using T = TestType;
    kd_scratch<T> scratch;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 3000);
        const auto tree = tree_of(points);
        for (const vec3<T>& q : queries(points)) {
            for (const T radius2 : {T(0), T(1e-6), T(1e-3), T(0.01), T(0.3), T(1e9), T(1e12)}) {
                CAPTURE(shape, radius2, q.x, q.y, q.z);
                const auto truth = brute_force(points, q, 70, radius2, all_of_them);
                const auto found = tree.nearest(q, 70, scratch, {radius2});
                REQUIRE(sorted(tree, found) == truth);
                if (truth.size() < 70) { REQUIRE(found.radius2 == radius2); }
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: a hint, good or bad, changes neither the items nor their order", "[kd_tree]", float,
                   double) {
    using T = TestType;
    kd_scratch<T> scratch;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 5000);
        const auto tree = tree_of(points);
        for (const vec3<T>& q : queries(points)) {
            const auto plain = tree.nearest(q, 20, scratch);
            const std::vector<kd_slot> slots(plain.slots.begin(), plain.slots.end());
            for (const T factor : {T(1e-30), T(1e-3), T(0.9), T(1), T(2), T(1e3), T(1e30)}) {
                const T hint2 = (plain.radius2 > 0 ? plain.radius2 : T(1e-3)) * factor;
                CAPTURE(shape, factor, q.x, q.y, q.z);
                const auto hinted = tree.nearest(q, 20, scratch, {.hint2 = hint2});
                REQUIRE(std::equal(slots.begin(), slots.end(), hinted.slots.begin(), hinted.slots.end()));
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: what is refused counts neither towards k nor the radius", "[kd_tree]", float, double) {
    using T = TestType;
    kd_scratch<T> scratch;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 4000);
        const auto tree = tree_of(points);
        for (const std::uint32_t every : {2u, 7u, 500u, 5000u}) {
            const auto odd = [&](std::uint32_t index) { return index % every == 1; };
            const auto accept = [&](kd_slot slot) { return odd(tree.order()[slot]); };
            for (const vec3<T>& q : queries(points)) {
                CAPTURE(shape, every, q.x, q.y, q.z);
                for (const std::size_t k : {std::size_t{5}, std::size_t{40}}) {
                    const auto truth = brute_force(points, q, k, T(1e12), odd);
                    REQUIRE(sorted(tree, tree.nearest(q, k, scratch, {T(1e12)}, accept)) == truth);
                }
                const auto one = brute_force(points, q, 1, T(0.01), odd);
                const auto found = tree.nearest_one(q, T(0.01), accept);
                REQUIRE(found.has_value() == !one.empty());
                if (found) { REQUIRE(item<T>{found->distance2, tree.order()[found->slot]} == one.front()); }
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: fetching the payload changes neither the items nor their order", "[kd_tree]", float,
                   double) {
    using T = TestType;
    kd_scratch<T> scratch;
    kd_scratch<T> other;
    const auto same = [](const auto& a, const auto& b) {
        return std::ranges::equal(a.slots, b.slots) && std::ranges::equal(a.distances2, b.distances2) &&
               a.radius2 == b.radius2;
    };
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 4000);
        const auto tree = tree_of(points);
        const std::vector<vec3<double>> payload(tree.size());
        const kd_accept_fetching<vec3<double>> fetching{payload};
        const auto where = queries(points);
        for (const std::size_t k : {std::size_t{5}, std::size_t{40}, std::size_t{700}}) {
            const auto check = [&](std::size_t i, const kd_neighbours<T>& found) {
                CAPTURE(shape, k, i);
                REQUIRE(same(found, tree.nearest(where[i], k, other)));
                REQUIRE(same(found, tree.nearest(where[i], k, scratch, {}, fetching)));
            };
            kd_scratch<T> batch;
            tree.nearest(where, k, batch, {}, check, fetching);
        }
        for (const vec3<T>& q : where) {
            const auto one = tree.nearest_one(q, T(0.01), fetching);
            const auto plain = tree.nearest_one(q, T(0.01));
            REQUIRE(one.has_value() == plain.has_value());
            if (one) { REQUIRE((one->slot == plain->slot && one->distance2 == plain->distance2)); }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: the nearest one is the first of brute force, ties by index", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& shape : shapes) {
        for (const std::size_t n : sizes) {
            const auto points = cloud<T>(shape, n);
            const auto tree = tree_of(points);
            for (const vec3<T>& q : queries(points)) {
                CAPTURE(shape, n, q.x, q.y, q.z);
                const auto truth = brute_force(points, q, 1, T(1e15), all_of_them);
                const auto found = tree.nearest_one(q);
                REQUIRE(found);
                REQUIRE(item<T>{found->distance2, tree.order()[found->slot]} == truth.front());
                REQUIRE_FALSE(tree.nearest_one(q, truth.front().distance2));
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: of points at one place the nearest is the one that came first", "[kd_tree]", float,
                   double) {
    using T = TestType;
    for (const std::string shape : {"one point", "repeated", "lattice", "walls"}) {
        const auto points = cloud<T>(shape, 5000);
        const auto tree = tree_of(points);
        std::map<std::tuple<T, T, T>, std::uint32_t> first;
        for (std::uint32_t i = 0; i < points.size(); ++i) { first.insert({place_of(points[i]), i}); }
        int wrong = 0;
        for (const vec3<T>& p : points) {
            const auto found = tree.nearest_one(p);
            wrong += !found || found->distance2 != 0 || tree.order()[found->slot] != first.at(place_of(p));
        }
        CAPTURE(shape);
        CHECK(wrong == 0);
    }
}

TEMPLATE_TEST_CASE("kd_tree: all strictly within a radius are visited once, in order", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 6000);
        const auto tree = tree_of(points);
        for (const vec3<T>& q : queries(points)) {
            for (const T radius2 : {T(0), T(1e-5), T(0.01), T(1), std::numeric_limits<T>::infinity()}) {
                CAPTURE(shape, radius2, q.x, q.y, q.z);
                const auto truth = brute_force(points, q, points.size(), radius2, all_of_them);
                std::vector<item<T>> found;
                std::vector<kd_slot> slots;
                tree.within(q, radius2, [&](kd_slot slot, T d2) {
                    found.push_back({d2, tree.order()[slot]});
                    slots.push_back(slot);
                });
                REQUIRE(std::is_sorted(slots.begin(), slots.end()));
                std::sort(found.begin(), found.end());
                REQUIRE(found == truth);
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: a batch finds what single queries find", "[kd_tree]", float, double) {
    using T = TestType;
    kd_scratch<T> scratch;
    kd_scratch<T> other;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 9000);
        const auto tree = tree_of(points);
        const auto where = queries(points);
        const auto accept = [](std::size_t i, kd_slot slot) { return (slot + i) % 3 != 0; };
        const std::vector<std::array<double, 16>> payload(tree.size());  // more than is held near by
        for (const T radius2 : {T(0), T(0.01), std::numeric_limits<T>::infinity()}) {
            std::size_t next = 0;
            tree.nearest(where, 30, scratch, {radius2}, [&](std::size_t i, const kd_neighbours<T>& found) {
                CAPTURE(shape, radius2, i);
                REQUIRE(i == next++);
                const auto single = tree.nearest(where[i], 30, other, {radius2});
                REQUIRE(std::equal(found.slots.begin(), found.slots.end(), single.slots.begin(), single.slots.end()));
                REQUIRE(found.radius2 == single.radius2);
            });
            REQUIRE(next == where.size());
            const auto check = [&](std::size_t i, const kd_neighbours<T>& found) {
                const auto single =
                    tree.nearest(where[i], 30, other, {radius2}, [&](kd_slot slot) { return accept(i, slot); });
                REQUIRE(std::equal(found.slots.begin(), found.slots.end(), single.slots.begin(), single.slots.end()));
            };
            tree.nearest(where, 30, scratch, {radius2}, check, accept);
            tree.nearest(where, 30, scratch, {radius2}, check, kd_accept_ahead{std::span{payload}, accept});
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: a batch announces the slots of its leaves before it asks about them", "[kd_tree]", float,
                   double) {
    using T = TestType;
    /// Knows what was announced, and how much was asked about that was not.
    struct listener {
        std::vector<char>& announced;
        std::size_t& wrong;
        std::size_t& surprises;
        void expect(kd_slot first, kd_slot last) const {
            wrong += first >= last || last > announced.size();
            for (kd_slot i = first; i < last && i < announced.size(); ++i) { announced[i] = 1; }
        }
        bool operator()(std::size_t, kd_slot slot) const {
            surprises += !announced[slot];
            return true;
        }
    };
    kd_scratch<T> scratch;
    for (const std::size_t n : {std::size_t{1}, std::size_t{31}, std::size_t{33}, std::size_t{9001}}) {
        const auto points = cloud<T>("cube", n);
        const auto tree = tree_of(points);
        const auto where = std::span<const vec3<T>>{points}.first(std::min<std::size_t>(n, 200));
        for (const T radius2 : {T(1e-6), T(0.01), std::numeric_limits<T>::infinity()}) {
            std::vector<char> announced(tree.size());
            std::size_t wrong = 0, surprises = 0, found = 0;
            tree.nearest(
                where, 4, scratch, {radius2}, [&](std::size_t, const auto& near) { found += near.size(); },
                listener{announced, wrong, surprises});
            CAPTURE(n, radius2, found);
            CHECK(wrong == 0);
            CHECK(surprises <= found / 4);  // a first radius that was too small is searched again, unannounced
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: any number of threads makes the same tree", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 50'001);
        const auto same = [](const vec3<T>& p) { return p; };
        const kd_tree<T> one{points, same};
        for (const unsigned threads : {2u, 3u, 8u}) {
            const kd_tree<T> many{points, same, own_threads{threads}};
            CAPTURE(shape, threads);
            REQUIRE(std::equal(one.order().begin(), one.order().end(), many.order().begin(), many.order().end()));
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: every item has one slot and keeps its position", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& shape : shapes) {
        for (const std::size_t n : sizes) {
            const auto points = cloud<T>(shape, n);
            const auto tree = tree_of(points);
            REQUIRE(tree.size() == n);
            std::vector<std::uint32_t> seen(tree.order().begin(), tree.order().end());
            bounds<T> box;
            for (kd_slot slot = 0; slot < n; ++slot) {
                REQUIRE(tree.position(slot) == points[tree.order()[slot]]);
                box.add(tree.position(slot));
            }
            REQUIRE(tree.box().low == box.low);
            REQUIRE(tree.box().high == box.high);
            std::sort(seen.begin(), seen.end());
            for (std::uint32_t i = 0; i < n; ++i) { REQUIRE(seen[i] == i); }
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: points at the same place keep the order they came in", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string shape : {"one point", "repeated", "lattice", "walls"}) {
        for (const std::size_t n : sizes) {
            const auto tree = tree_of(cloud<T>(shape, n));
            std::map<std::tuple<T, T, T>, std::uint32_t> last;
            bool in_order = true;
            for (kd_slot slot = 0; slot < n; ++slot) {
                const auto [known, is_new] = last.insert({place_of(tree.position(slot)), tree.order()[slot]});
                in_order = in_order && (is_new || known->second < tree.order()[slot]);
                known->second = tree.order()[slot];
            }
            CAPTURE(shape, n);
            CHECK(in_order);
        }
    }
}

TEMPLATE_TEST_CASE("kd_tree: scaling by a power of two scales the answer bit by bit", "[kd_tree]", float, double) {
    using T = TestType;
    kd_scratch<T> scratch;
    kd_scratch<T> other;
    for (const std::string& shape : shapes) {
        const auto points = cloud<T>(shape, 3000);
        const auto tree = tree_of(points);
        const auto where = queries(points);
        for (const int power : {-30, -7, 1, 30}) {
            const T scale = std::ldexp(T(1), power);
            const auto scaled = tree_of(cloud<T>(shape, 3000, scale));
            REQUIRE(std::equal(tree.order().begin(), tree.order().end(), scaled.order().begin(), scaled.order().end()));
            for (const vec3<T>& q : where) {
                CAPTURE(shape, power, q.x, q.y, q.z);
                const auto found = tree.nearest(q, 60, scratch);
                const auto again = scaled.nearest(q * scale, 60, other);
                REQUIRE(std::equal(found.slots.begin(), found.slots.end(), again.slots.begin(), again.slots.end()));
                REQUIRE(again.radius2 == found.radius2 * scale * scale);
            }
        }
    }
}

TEST_CASE("kd_tree: positions that are not finite are left out and counted", "[kd_tree]") {
    auto points = cloud<float>("cube", 1000);
    points[7].y = -1e30f;
    points[3].x = std::numeric_limits<float>::quiet_NaN();
    points[500].y = std::numeric_limits<float>::infinity();
    points[999].z = -std::numeric_limits<float>::infinity();
    const auto tree = tree_of(points);
    CHECK(tree.size() == 996);
    CHECK(tree.dropped() == 4);
    for (const std::uint32_t index : tree.order()) {
        CHECK((index != 3 && index != 7 && index != 500 && index != 999));
    }
    const std::vector<vec3<float>> bad(5, vec3<float>(std::numeric_limits<float>::quiet_NaN()));
    CHECK(tree_of(bad).empty());
    CHECK(tree_of(bad).dropped() == 5);
}

TEMPLATE_TEST_CASE("kd_tree: positions are kept and found as far out as squared distances are finite, and no farther",
                   "[kd_tree]", float, double) {
    using T = TestType;
    // Of two points at opposite corners the squared distance is 12/16 of the largest number.
    const T far = std::sqrt(std::numeric_limits<T>::max()) / 4;
    auto points = cloud<T>("cube", 200);
    for (int corner = 0; corner < 8; ++corner) {
        points.push_back({corner & 1 ? far : -far, corner & 2 ? far : -far, corner & 4 ? far : -far});
    }
    const auto tree = tree_of(points);
    CHECK(tree.dropped() == 0);
    kd_scratch<T> scratch;
    for (const vec3<T>& q : {points[0], points[200], points[207]}) {
        const auto truth = brute_force(points, q, points.size(), std::numeric_limits<T>::infinity(), all_of_them);
        CHECK(truth.size() == points.size());
        CHECK(sorted(tree, tree.nearest(q, points.size(), scratch)) == truth);
        CHECK(sorted(tree, tree.nearest(q, 3, scratch)) == std::vector<item<T>>(truth.begin(), truth.begin() + 3));
    }
    for (int axis = 0; axis < 3; ++axis) {
        points[static_cast<std::size_t>(axis)][axis] = -std::nextafter(far, far * 2);
    }
    CHECK(tree_of(points).dropped() == 3);
}

TEST_CASE("kd_tree: in an even crowd a search asks about few more than it wants, and seldom again", "[kd_tree]") {
    constexpr std::size_t searches = 1000;
    kd_scratch<float> scratch;
    for (const std::string shape : {"cube", "plane", "tilted plane"}) {
        const auto points = cloud<float>(shape, 20'000);
        const auto tree = tree_of(points);
        for (const std::size_t k : {std::size_t{5}, std::size_t{20}, std::size_t{50}}) {
            std::size_t asked = 0, begun_again = 0;
            std::vector<std::size_t> asked_by(points.size(), searches);
            for (std::size_t i = 0; i < searches; ++i) {
                bool twice = false;
                const auto accept = [&](kd_slot slot) {
                    ++asked;
                    twice = twice || asked_by[slot] == i;
                    asked_by[slot] = i;
                    return true;
                };
                REQUIRE(tree.nearest(points[i * 17], k, scratch, {}, accept).size() == k);
                begun_again += twice;
            }
            CAPTURE(shape, k);
            // Three deviations of the count more than asked for are wanted within the first radius.
            const double wanted = double(k) + 3 * std::sqrt(double(k)) + 1;
            CHECK(double(asked) / searches < 1.25 * wanted);
            CHECK(begun_again < searches / 5);
        }
    }
}

TEST_CASE("kd_tree: a tree of nothing finds nothing", "[kd_tree]") {
    kd_scratch<float> scratch;
    for (const kd_tree<float>& tree : {kd_tree<float>{}, tree_of(std::vector<vec3<float>>{})}) {
        CHECK(tree.empty());
        CHECK(tree.box().empty());
        CHECK(tree.nearest({0, 0, 0}, 5, scratch).empty());
        CHECK_FALSE(tree.nearest_one({0, 0, 0}));
        tree.within({0, 0, 0}, 1.0f, [](kd_slot, float) { FAIL("an item of nothing"); });
    }
    CHECK(tree_of(cloud<float>("cube", 10)).nearest({0, 0, 0}, 0, scratch).empty());
}

TEST_CASE("kd_tree: with the order forgotten ties go by slot", "[kd_tree]") {
    kd_scratch<float> scratch;
    auto tree = tree_of(cloud<float>("lattice", 2000));
    const auto before = tree.memory();
    tree.forget_order();
    CHECK(tree.order().empty());
    CHECK(before - tree.memory() == 4 * 2000);
    std::vector<item<float>> truth;
    for (kd_slot slot = 0; slot < 2000; ++slot) {
        truth.push_back({simd::distance2(tree.position(slot), {4, 4, 4}), slot});
    }
    std::sort(truth.begin(), truth.end());
    truth.resize(25);
    std::vector<item<float>> found;
    const auto neighbours = tree.nearest({4, 4, 4}, 25, scratch);
    for (std::size_t i = 0; i < 25; ++i) { found.push_back({neighbours.distances2[i], neighbours.slots[i]}); }
    std::sort(found.begin(), found.end());
    CHECK(found == truth);
}
