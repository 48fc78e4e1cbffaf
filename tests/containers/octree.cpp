#include <aglow/containers/octree.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.hpp"

namespace {

using aglow::octree;
using aglow::octree_status;
using aglow::vec3;

template <typename T>
struct ball {
    vec3<T> centre;
    T radius;
};

template <typename T>
using balls = std::vector<ball<T>>;

// An octree whose items are their own numbers.
template <typename T>
octree<int, T> octree_of(const balls<T>& spheres) {
    octree<int, T> tree;
    for (const ball<T>& s : spheres) { tree.insert(static_cast<int>(tree.size()), s.centre, s.radius); }
    return tree;
}

template <typename Tree, typename T>
std::vector<int> covering(const Tree& tree, const vec3<T>& p) {
    std::vector<int> found;
    tree.visit_covering(p, [&](int i) { found.push_back(i); });
    return found;
}

template <typename Tree, typename T>
std::vector<int> within(const Tree& tree, const vec3<T>& p, T distance) {
    std::vector<int> found;
    tree.visit_within(p, distance, [&](int i) { found.push_back(i); });
    return found;
}

// Brute force answers in the order of insertion. A sphere whose border passes the point at the last bits is unsure.
template <typename T>
struct truth {
    std::vector<int> sure, possible;
};

template <typename T, typename Limit>
truth<T> brute_force(const balls<T>& spheres, const vec3<T>& p, Limit&& limit) {
    truth<T> found;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        const vec3<long double> d = vec3<long double>(p) - vec3<long double>(spheres[i].centre);
        const long double excess = std::sqrt(aglow::length2(d)) / static_cast<long double>(limit(spheres[i]));
        const long double unsure = 4 * static_cast<long double>(std::numeric_limits<T>::epsilon());
        if (excess <= 1 - unsure) { found.sure.push_back(static_cast<int>(i)); }
        if (excess <= 1 + unsure) { found.possible.push_back(static_cast<int>(i)); }
    }
    return found;
}

bool is_sublist(const std::vector<int>& part, const std::vector<int>& whole) {
    return std::includes(whole.begin(), whole.end(), part.begin(), part.end());
}

template <typename T>
bool agrees(const std::vector<int>& found, const truth<T>& expected) {
    return std::is_sorted(found.begin(), found.end()) && is_sublist(expected.sure, found) &&
           is_sublist(found, expected.possible);
}

// How many of the queries around the spheres are answered otherwise than by brute force.
template <typename T, typename Tree>
int wrong_answers(const Tree& tree, const balls<T>& spheres, std::uint32_t seed, int queries = 200) {
    std::mt19937 random{seed};
    std::uniform_int_distribution<std::size_t> any{0, spheres.size() - 1};
    std::normal_distribution<T> normal;
    int wrong = 0;
    for (int q = 0; q < queries; ++q) {
        const ball<T>& near = spheres[any(random)];
        const T spread = q % 3 == 0 ? T(0) : near.radius;
        const vec3<T> p = near.centre + spread * vec3<T>{normal(random), normal(random), normal(random)};
        const T distance = spheres[any(random)].radius * 2;
        wrong += !agrees<T>(covering(tree, p), brute_force(spheres, p, [](const ball<T>& s) { return s.radius; }));
        wrong +=
            !agrees<T>(within(tree, p, distance), brute_force(spheres, p, [&](const ball<T>&) { return distance; }));
    }
    return wrong;
}

template <typename T, typename Make>
balls<T> make_balls(int count, std::uint32_t seed, Make&& make) {
    std::mt19937 random{seed};
    std::uniform_real_distribution<T> uniform;
    const auto u = [&] { return uniform(random); };
    balls<T> spheres;
    for (int i = 0; i < count; ++i) { spheres.push_back(make(u)); }
    return spheres;
}

template <typename T, typename U>
vec3<T> anywhere(U& u) {
    const T x = u(), y = u(), z = u();
    return {x, y, z};
}

template <typename T>
balls<T> uniform_balls(int count, std::uint32_t seed) {
    return make_balls<T>(count, seed, [](auto& u) { return ball<T>{anywhere<T>(u), T(0.02) + T(0.1) * u()}; });
}

template <typename T>
balls<T> multi_scale_balls(int count, std::uint32_t seed) {
    return make_balls<T>(count, seed, [](auto& u) {
        return ball<T>{anywhere<T>(u), std::pow(T(10), -T(0.5) - 3 * u())};
    });
}

template <typename T>
balls<T> clustered_balls(int count, std::uint32_t seed) {
    return make_balls<T>(count, seed, [](auto& u) {
        const vec3<T> cluster = std::floor(4 * u()) * vec3<T>{3, -2, 1};
        return ball<T>{cluster + T(1e-3) * anywhere<T>(u), T(1e-4) * (1 + u())};
    });
}

// The same with the items as they come, all of them settled, and some of them.
template <typename T>
int wrong_answers_in_any_state(const balls<T>& spheres, std::uint32_t seed, int queries = 200) {
    octree<int, T> tree = octree_of(spheres);
    int wrong = wrong_answers(tree, spheres, seed, queries);
    tree.settle();
    wrong += wrong_answers(tree, spheres, seed, queries);
    octree<int, T> partly;
    for (const ball<T>& s : spheres) {
        if (partly.size() == spheres.size() / 3 || partly.size() == spheres.size() / 2) { partly.settle(); }
        partly.insert(static_cast<int>(partly.size()), s.centre, s.radius);
    }
    octree<int, T> bit_by_bit;
    for (const ball<T>& s : spheres) {
        if (bit_by_bit.size() % 37 == 36) {
            bit_by_bit.settle_latest([](int) { return std::numeric_limits<T>::max(); });
        }
        bit_by_bit.insert(static_cast<int>(bit_by_bit.size()), s.centre, s.radius);
    }
    return wrong + wrong_answers(partly, spheres, seed, queries) + wrong_answers(bit_by_bit, spheres, seed, queries);
}

}  // namespace

TEMPLATE_TEST_CASE("octree: who covers a point and who is near are what brute force finds", "[octree]", float, double) {
    using T = TestType;
    CHECK(wrong_answers_in_any_state(uniform_balls<T>(3000, 1), 2) == 0);
    CHECK(wrong_answers_in_any_state(clustered_balls<T>(3000, 3), 4) == 0);
    CHECK(wrong_answers_in_any_state(multi_scale_balls<T>(3000, 5), 6) == 0);
}

TEMPLATE_TEST_CASE("octree: points on a plane, a line or one spot are no exception", "[octree]", float, double) {
    using T = TestType;
    const auto plane = make_balls<T>(2000, 7, [](auto& u) {
        return ball<T>{{u(), u(), T(0.5)}, T(0.05) * (u() + T(0.1))};
    });
    const auto line = make_balls<T>(2000, 8, [](auto& u) { return ball<T>{{u(), 0, 0}, T(0.05) * (u() + T(0.1))}; });
    const auto spot = make_balls<T>(500, 9, [](auto& u) { return ball<T>{{1, 2, 3}, u() + T(0.01)}; });
    const balls<T> copies(300, ball<T>{{-1, 0, 1}, T(0.25)});
    for (const balls<T>& spheres : {plane, line, spot, copies}) { CHECK(wrong_answers_in_any_state(spheres, 10) == 0); }
}

TEMPLATE_TEST_CASE("octree: a few giants among many dwarfs are found, whenever they come", "[octree]", float, double) {
    using T = TestType;
    balls<T> spheres = make_balls<T>(3000, 11, [](auto& u) { return ball<T>{anywhere<T>(u), T(1e-3) * (1 + u())}; });
    for (const int at : {0, 10, 100, 2000}) {
        spheres.insert(spheres.begin() + static_cast<std::ptrdiff_t>(at),
                       ball<T>{{T(0.5), T(0.5), T(0.2)}, T(1000) + T(at)});
    }
    CHECK(wrong_answers_in_any_state(spheres, 12) == 0);
}

TEMPLATE_TEST_CASE("octree: no item is lost for lying far outside the first bounds", "[octree]", float, double) {
    using T = TestType;
    balls<T> spheres = uniform_balls<T>(400, 13);
    for (int i = 0; i < 400; ++i) {
        const T scale = std::ldexp(T(1), i % 60);
        const T side = i % 2 == 0 ? T(1) : T(-1);
        spheres.push_back(
            {side * scale * spheres[static_cast<std::size_t>(i)].centre, T(0.1) * (i % 3 == 0 ? scale : T(1))});
    }
    const octree<int, T> tree = octree_of(spheres);
    CHECK(tree.size() == spheres.size());
    CHECK(wrong_answers_in_any_state(spheres, 14, 800) == 0);
}

TEMPLATE_TEST_CASE("octree: coordinates of 1e12 with radii of 1e-6 are answered as by brute force", "[octree]", float,
                   double) {
    using T = TestType;
    auto spheres = make_balls<T>(2000, 15, [](auto& u) {
        return ball<T>{T(2e12) * (anywhere<T>(u) - T(0.5)), T(1e-6) * (1 + u())};
    });
    const auto origin = make_balls<T>(2000, 16, [](auto& u) {
        return ball<T>{T(1e-5) * anywhere<T>(u), T(1e-6) * (1 + u())};
    });
    spheres.insert(spheres.begin(), origin.begin(), origin.begin() + 1000);
    spheres.insert(spheres.end(), origin.begin() + 1000, origin.end());
    CHECK(wrong_answers_in_any_state(spheres, 17, 400) == 0);
}

TEMPLATE_TEST_CASE("octree: spheres smaller than the last bit of their place are found there, alone or in a row", "",
                   float, double) {
    using T = TestType;
    const T lost = std::numeric_limits<T>::epsilon();
    const T endless = std::numeric_limits<T>::infinity();
    for (const int count : {1, 40, 400}) {
        octree<int, T> tree;
        std::vector<int> all;
        for (int i = 0; i < count; ++i) {
            tree.insert(i, {T(1000), T(1000 + i % 40), T(-1000)}, lost);
            all.push_back(i);
        }
        for (int i = 0; i < 2; ++i) {
            CAPTURE(count, i);
            CHECK(covering(tree, vec3<T>{1000, 1000, -1000}).size() == static_cast<std::size_t>((count + 39) / 40));
            CHECK(covering(tree, vec3<T>{1000, 999, -1000}).empty());
            CHECK(covering(tree, vec3<T>{0}).empty());
            CHECK(within(tree, vec3<T>{1000, 1000, -1000}, endless) == all);
            CHECK(within(tree, vec3<T>{0}, endless) == all);
            CHECK(within(tree, vec3<T>{1000, 1039, -1000}, T(39)) == all);
            tree.settle();
        }
    }
}

TEST_CASE("octree: the largest coordinates there are can be stored and found", "[octree]") {
    constexpr float most = std::numeric_limits<float>::max();
    octree<int> tree;
    const balls<float> spheres{
        {{most, most, -most}, 1e18f}, {{-most, 0, 0}, 1e-18f}, {{0, 0, 0}, 1}, {{most, most, -most}, 1}};
    for (const auto& s : spheres) { REQUIRE(tree.insert(static_cast<int>(tree.size()), s.centre, s.radius)); }
    for (int i = 0; i < 2; ++i) {
        CHECK(covering(tree, vec3<float>{most, most, -most}) == std::vector<int>{0, 3});
        CHECK(covering(tree, vec3<float>{-most, 0, 0}) == std::vector<int>{1});
        CHECK(covering(tree, vec3<float>{0.5f, 0, 0}) == std::vector<int>{2});
        CHECK(within(tree, vec3<float>{most, most, most}, 1.0f).empty());
        tree.settle();
    }
}

TEMPLATE_TEST_CASE("octree: bad spheres are refused, counted and change no answer", "[octree]", float, double) {
    using T = TestType;
    using limits = std::numeric_limits<T>;
    const balls<T> spheres = uniform_balls<T>(500, 18);
    octree<int, T> tree = octree_of(spheres);
    for (const T bad : {T(0), -T(0), T(-1), limits::infinity(), -limits::infinity(), limits::quiet_NaN(), limits::max(),
                        limits::denorm_min()}) {
        CHECK(tree.insert(-1, vec3<T>{T(0.5)}, bad).status == octree_status::bad_radius);
    }
    for (const T bad : {limits::infinity(), -limits::infinity(), limits::quiet_NaN()}) {
        CHECK(tree.insert(-1, {T(0.5), bad, T(0.5)}, T(1)).status == octree_status::bad_centre);
    }
    CHECK(tree.refused().radius == 8);
    CHECK(tree.refused().centre == 3);
    CHECK(tree.size() == 500);
    CHECK(wrong_answers(tree, spheres, 19) == 0);
    const auto next = tree.insert(500, vec3<T>{0}, T(0.5));
    CHECK((next && next.index == 500));
}

TEST_CASE("octree: an empty one answers nothing, and so do points and distances that are no numbers", "[octree]") {
    octree<int> tree;
    for (int i = 0; i < 2; ++i) {
        CHECK(tree.empty());
        CHECK(covering(tree, vec3<float>{0}).empty());
        CHECK(within(tree, vec3<float>{0}, 1e30f).empty());
        tree.settle();
    }
    tree.insert(0, vec3<float>{0}, 1.0f);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(covering(tree, vec3<float>{nan, 0, 0}).empty());
    CHECK(within(tree, vec3<float>{0}, nan).empty());
    CHECK(within(tree, vec3<float>{0}, -1.0f).empty());
    for (int i = 0; i < 2; ++i) {
        CHECK(within(tree, vec3<float>{0}, 0.0f) == std::vector<int>{0});
        CHECK(within(tree, vec3<float>{7}, std::numeric_limits<float>::infinity()) == std::vector<int>{0});
        CHECK(within(tree, vec3<float>{nan}, std::numeric_limits<float>::infinity()).empty());
        CHECK(covering(tree, vec3<float>{nan}).empty());
        tree.settle();
    }
}

TEST_CASE("octree: the border of a sphere belongs to it", "[octree]") {
    octree<int> tree;
    tree.insert(0, {1, 1, 1}, 0.5f);
    CHECK(covering(tree, vec3<float>{1.5f, 1, 1}).size() == 1);
    CHECK(covering(tree, vec3<float>{std::nextafter(1.5f, 2.0f), 1, 1}).empty());
}

TEMPLATE_TEST_CASE("octree: borders that lie on the grid of cubes belong to their spheres, fresh and settled",
                   "[octree]", float, double) {
    using T = TestType;
    // Centres, radii and points are sixteenths, so that distances along an axis are exact.
    std::mt19937 random{30};
    const auto sixteenth = [&](unsigned range) { return static_cast<T>(random() % range) / T(16); };
    balls<T> spheres;
    for (int i = 0; i < 1500; ++i) {
        const vec3<T> centre{sixteenth(64), sixteenth(64), sixteenth(64)};
        spheres.push_back({centre, sixteenth(6) + T(1) / T(16)});
    }
    octree<int, T> tree = octree_of(spheres);
    const auto radius_of = [&](int i) { return spheres[static_cast<std::size_t>(i)].radius; };
    for (int settled = 0; settled < 2; ++settled) {
        int wrong = 0;
        for (int q = 0; q < 600; ++q) {
            const ball<T>& s = spheres[static_cast<std::size_t>(q)];
            vec3<T> p = s.centre;
            p[q % 3] += q % 2 == 0 ? s.radius : -s.radius;
            std::vector<int> covers, near, shrunk;
            for (int i = 0; i < 1500; ++i) {
                const T distance2 = aglow::distance2(spheres[static_cast<std::size_t>(i)].centre, p);
                if (distance2 <= aglow::square(radius_of(i))) { covers.push_back(i); }
                if (distance2 <= aglow::square(s.radius)) { near.push_back(i); }
            }
            tree.visit_covering(p, radius_of, [&](int i) { shrunk.push_back(i); });
            wrong += covering(tree, p) != covers || shrunk != covers || within(tree, p, s.radius) != near;
        }
        CHECK(wrong == 0);
        // Of radii that have grown, which they must not, none is taken over.
        tree.settle([](int) { return T(2); });
    }
}

TEST_CASE("octree: a visitor that asks for it hears each item's number, in order", "[octree]") {
    octree<int> tree;
    for (int i = 0; i < 100; ++i) { tree.insert(i, {0.01f * static_cast<float>(i), 0, 0}, 0.3f); }
    std::vector<std::uint32_t> numbers;
    tree.visit_covering({0.5f, 0, 0}, [&](int item, std::uint32_t number) {
        CHECK(item == static_cast<int>(number));
        numbers.push_back(number);
    });
    CHECK(numbers.size() > 50);
    CHECK(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST_CASE("octree: a visitor that returns false ends the visit", "[octree]") {
    octree<int> tree;
    for (int i = 0; i < 200; ++i) { tree.insert(i, vec3<float>{float(i) * 1e-3f}, 1.0f); }
    std::vector<int> seen;
    tree.visit_covering(vec3<float>{0}, [&](int i) {
        seen.push_back(i);
        return i < 4;
    });
    CHECK(seen == std::vector<int>{0, 1, 2, 3, 4});
}

TEST_CASE("octree: items that have shrunk are judged by their present radius", "[octree]") {
    struct shrinking {
        int number;
        float radius;
    };
    balls<float> spheres = uniform_balls<float>(1000, 20);
    octree<shrinking> tree;
    for (const auto& s : spheres) { tree.insert({static_cast<int>(tree.size()), s.radius}, s.centre, s.radius); }
    for (std::uint32_t i = 0; i < tree.size(); i += 2) {
        spheres[i].radius *= 0.3f;
        std::atomic_ref{tree[i].radius}.store(spheres[i].radius, std::memory_order_relaxed);
    }
    const auto radius_of = [](const shrinking& item) { return item.radius; };
    int wrong = 0;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        const auto& s = spheres[i];
        if (i == spheres.size() / 3) { tree.settle(); }
        if (i == spheres.size() / 2) { tree.settle(radius_of); }
        std::vector<int> found;
        tree.visit_covering(s.centre + vec3<float>{0.01f, 0, 0}, radius_of,
                            [&](const shrinking& item) { found.push_back(item.number); });
        wrong += !agrees<float>(
            found, brute_force(spheres, s.centre + vec3<float>{0.01f, 0, 0}, [](const auto& b) { return b.radius; }));
    }
    CHECK(wrong == 0);
}

TEST_CASE("octree: of thousands of items at one place each is judged by its own present radius", "[octree]") {
    octree<int> tree;
    for (int i = 0; i < 5000; ++i) { tree.insert(i, {3, 0, 0}, 5); }
    for (int settled = 0; settled < 2; ++settled) {
        std::vector<int> found;
        tree.visit_covering(
            vec3<float>{0}, [](int i) { return i % 2 == 0 ? 4.0f : 1.0f; }, [&](int i) { found.push_back(i); });
        CHECK(found.size() == 2500);
        CHECK(std::all_of(found.begin(), found.end(), [](int i) { return i % 2 == 0; }));
        tree.settle();
    }
}

TEST_CASE("octree: items that settle one by one take little more memory than all at once", "[octree]") {
    octree<int> one_by_one, at_once;
    for (const ball<float>& s : uniform_balls<float>(1000, 31)) {
        one_by_one.insert(0, s.centre, s.radius);
        one_by_one.settle_latest([](int) { return 1.0f; });
        at_once.insert(0, s.centre, s.radius);
    }
    at_once.settle();
    CHECK(one_by_one.bytes() < 2 * at_once.bytes());
}

TEST_CASE("octree: every item is destroyed once, with the octree or with the one that took it", "[octree]") {
    const auto item = std::make_shared<int>(0);
    for (const int count : {0, 1, 5, 999}) {
        octree<std::shared_ptr<int>> tree;
        for (int i = 0; i < count; ++i) { tree.insert(item, vec3<float>{float(i)}, 1.0f); }
        CHECK(item.use_count() == count + 1);
        {
            octree<std::shared_ptr<int>> taken{std::move(tree)};
            taken.settle();
            CHECK(item.use_count() == count + 1);
        }
        CHECK(item.use_count() == 1);
    }
}

TEMPLATE_TEST_CASE("octree: scaling by powers of two changes neither what is found nor the order", "[octree]", float,
                   double) {
    using T = TestType;
    const balls<T> spheres = multi_scale_balls<T>(2000, 21);
    const octree<int, T> tree = octree_of(spheres);
    for (const int k : {-30, -7, 1, 30}) {
        balls<T> scaled = spheres;
        for (auto& s : scaled) { s = {s.centre * std::ldexp(T(1), k), std::ldexp(s.radius, k)}; }
        octree<int, T> other = octree_of(scaled);
        if (k > 0) { other.settle(); }
        int different = 0;
        for (std::size_t i = 0; i < spheres.size(); i += 7) {
            const vec3<T> p = spheres[i].centre + vec3<T>{spheres[i].radius, 0, 0};
            different += covering(tree, p) != covering(other, p * std::ldexp(T(1), k));
            const T distance = spheres[i].radius * 3;
            different += within(tree, p, distance) != within(other, p * std::ldexp(T(1), k), std::ldexp(distance, k));
        }
        CHECK(different == 0);
        CHECK((k > 0 || tree.bytes() == other.bytes()));
    }
}

TEST_CASE("octree: a crevice of ever smaller spheres fills neither memory nor time", "[octree]") {
    // Along a corner the harmonic mean distance goes to zero: radii shrink with the distance to the edge.
    octree<int> tree;
    balls<float> spheres;
    for (int i = 0; i < 4000; ++i) {
        const float along = float(i % 63) / 63.0f;
        const float from_edge = std::exp2(-0.004f * float(i));
        spheres.push_back({{along, from_edge, 0}, 0.5f * from_edge});
        tree.insert(i, spheres.back().centre, spheres.back().radius);
    }
    CHECK(wrong_answers(tree, spheres, 22) == 0);
    CHECK(tree.bytes() < 4000 * 100);
}

TEST_CASE("octree: a hundred thousand items of 64 bytes cost at most 96 bytes each, all in", "[octree]") {
    struct record {
        float values[16];
    };
    std::mt19937 random{23};
    std::uniform_real_distribution<float> u;
    octree<record> tree;
    const float radius = std::sqrt(6.0f / (3.14159f * 100'000));
    for (int i = 0; i < 100'000; ++i) {
        tree.insert({}, {u(random), u(random), 0}, radius * std::exp2(u(random) - 0.5f));
    }
    CHECK(tree.bytes() <= 96u * 100'000);
    tree.settle();
    CHECK(tree.bytes() <= 96u * 100'000);
}

TEST_CASE("octree: readers see every item of before, in order, while a writer inserts", "[octree]") {
    const balls<float> spheres = multi_scale_balls<float>(20'000, 24);
    octree<int> tree;
    std::atomic<bool> done{false};
    std::atomic<int> wrong{0};
    const auto read = [&](std::uint32_t seed) {
        std::mt19937 random{seed};
        std::uniform_real_distribution<float> u;
        while (!done) {
            const vec3<float> p{u(random), u(random), u(random)};
            const std::size_t before = tree.size();
            const std::vector<int> found = covering(tree, p);
            if (!std::is_sorted(found.begin(), found.end())) { ++wrong; }
            const balls<float> sure(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(before));
            const auto expected = brute_force(sure, p, [](const auto& s) { return s.radius; });
            const auto late = brute_force(spheres, p, [](const auto& s) { return s.radius; });
            if (!is_sublist(expected.sure, found) || !is_sublist(found, late.possible)) { ++wrong; }
        }
    };
    {
        std::vector<std::jthread> readers;
        for (std::uint32_t i = 0; i < 2; ++i) { readers.emplace_back(read, 25 + i); }
        for (const auto& s : spheres) { tree.insert(static_cast<int>(tree.size()), s.centre, s.radius); }
        done = true;
    }
    CHECK(wrong == 0);
    CHECK(wrong_answers(tree, spheres, 27, 100) == 0);
}

TEST_CASE("octree: an item stays where it is, whatever comes and settles") {
    octree<int> tree;
    tree.insert(7, vec3<float>{0}, 1.0f);
    const int* const first = &tree[0];
    for (int i = 0; i < 5000; ++i) { tree.insert(i, vec3<float>{float(i % 71), float(i % 13), 0}, 1.0f); }
    tree.settle();
    tree.insert(8, vec3<float>{0}, 1.0f);
    CHECK(&tree[0] == first);
    CHECK(covering(tree, vec3<float>{0}).front() == 7);
    CHECK(covering(tree, vec3<float>{0}).back() == 8);
}

TEST_CASE("octree: moved, it takes its items along and leaves an empty one", "[octree]") {
    const balls<float> spheres = uniform_balls<float>(300, 28);
    octree<int> from = octree_of(spheres);
    octree<int> to{std::move(from)};
    CHECK(wrong_answers(to, spheres, 29, 50) == 0);
    from = std::move(to);
    CHECK(wrong_answers(from, spheres, 29, 50) == 0);
    CHECK(to.empty());
    octree<int> other;
    other.insert(0, vec3<float>{5}, 1.0f);
    other = std::move(from);
    CHECK(wrong_answers(other, spheres, 29, 50) == 0);
    CHECK(from.empty());
    CHECK(covering(from, vec3<float>{5}).empty());
    from.insert(0, vec3<float>{5}, 1.0f);
    CHECK(covering(from, vec3<float>{5}) == std::vector<int>{0});
}
