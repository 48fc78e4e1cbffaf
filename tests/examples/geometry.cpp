#include "common/geometry.hpp"

#include <array>
#include <optional>

#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "common/scenes/registry.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

namespace {

using aglow::vec3;

/// Distance to a triangle by Cramer's rule (Möller & Trumbore 1997); 0 where it is missed.
double triangle_hit(const vec3<double>& o, const vec3<double>& d, const std::array<vec3<double>, 3>& p) {
    const vec3<double> e = p[1] - p[0];
    const vec3<double> f = p[2] - p[0];
    const double det = glm::dot(e, glm::cross(d, f));
    if (det == 0) { return 0; }
    const vec3<double> s = o - p[0];
    const double u = glm::dot(s, glm::cross(d, f)) / det;
    const double v = glm::dot(d, glm::cross(s, e)) / det;
    if (u < 0 || v < 0 || u + v > 1) { return 0; }
    return glm::dot(f, glm::cross(s, e)) / det;
}

double sphere_hit(const vec3<double>& o, const vec3<double>& d, const vec3<double>& centre, double radius) {
    const vec3<double> from = o - centre;
    const double b = glm::dot(from, d);
    const double left = b * b - aglow::length2(from) + radius * radius;
    if (left < 0) { return 0; }
    const double first = -b - std::sqrt(left);
    return first > 0 ? first : -b + std::sqrt(left);
}

/// The nearest distance by trying everything in double; empty where nothing is met.
template <typename T>
std::optional<double> brute_force(const host::scene_description<T>& s, const vec3<double>& o, const vec3<double>& d) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto consider = [&](double t) {
        if (t > 0 && t < nearest) { nearest = t; }
    };
    for (const auto& q : s.quads) {
        const std::array<vec3<double>, 4> p{vec3<double>(q.corners[0]), vec3<double>(q.corners[1]),
                                            vec3<double>(q.corners[2]), vec3<double>(q.corners[3])};
        consider(triangle_hit(o, d, {p[0], p[1], p[2]}));
        consider(triangle_hit(o, d, {p[0], p[2], p[3]}));
    }
    for (const auto& ball : s.spheres) {
        consider(sphere_hit(o, d, vec3<double>(ball.centre), static_cast<double>(ball.radius)));
    }
    if (nearest == std::numeric_limits<double>::infinity()) { return std::nullopt; }
    return nearest;
}

template <typename T>
vec3<T> inside(const aglow::bounds<T>& box, aglow::random_sampler<T>& random) {
    const vec3<T> u{random.next_1d(), random.next_1d(), random.next_1d()};
    return box.low + box.extent() * u;
}

}  // namespace

TEMPLATE_TEST_CASE("geometry: every built-in scene is hit where brute force in double hits it", "", float, double) {
    using T = TestType;
    for (const auto& description : host::scenes::all<T>()) {
        const host::scene<T> scene{description};
        const T extent = std::max(aglow::max_abs(scene.bounds().low), aglow::max_abs(scene.bounds().high));
        aglow::random_sampler<T> random{11};
        int at_odds = 0;
        for (int i = 0; i < 20000; ++i) {
            const aglow::ray<T> r{inside(scene.bounds(), random), aglow::uniform_sphere(random.next_2d())};
            const auto hit = scene.intersect(r);
            const auto truth = brute_force(description, vec3<double>(r.origin), vec3<double>(r.direction));
            if (!hit || !truth) {
                at_odds += static_cast<bool>(hit) != truth.has_value();
                continue;
            }
            const double facing = std::abs(static_cast<double>(glm::dot(r.direction, hit->normal)));
            const double slack = 2 * static_cast<double>(aglow::position_error(extent)) / std::max(facing, 1e-3);
            at_odds += std::abs(static_cast<double>(hit->distance) - *truth) > slack;
        }
        INFO(description.name);
        // A ray may pass an edge within the overlap of neighbours.
        CHECK(at_odds <= 1);
    }
}

TEMPLATE_TEST_CASE("geometry: every built-in scene keeps the laws of intersectors", "", float, double) {
    for (const auto& description : host::scenes::all<TestType>()) {
        const host::scene<TestType> scene{description};
        const laws::verdict v = laws::intersector(scene, scene.bounds());
        INFO(description.name << ": " << v.message);
        CHECK(v.ok);
    }
}

TEMPLATE_TEST_CASE("geometry: no ray slips between neighbours", "", float, double) {
    using T = TestType;
    host::scene_description<T> box{.name = "box", .about = ""};
    const std::size_t white = box.add({.diffuse = vec3<T>{T(0.5)}});
    host::scenes::add_room<T>(box, {T(-1.1), T(0.3), T(2.7)}, {T(3.3), T(1.9), T(7.1)}, white);
    const host::scene<T> scene{box};
    const aglow::bounds<T>& b = scene.bounds();
    aglow::random_sampler<T> random{5};
    int escaped = 0;
    for (int i = 0; i < 200000; ++i) {
        const vec3<T> from = inside(b, random);
        // At a point of an edge of the box, or at a corner of it, or where two walls' diagonals meet.
        vec3<T> at = inside(b, random);
        const int axis = i % 3;
        at[(axis + 1) % 3] = i & 4 ? b.low[(axis + 1) % 3] : b.high[(axis + 1) % 3];
        at[(axis + 2) % 3] = i & 8 ? b.low[(axis + 2) % 3] : b.high[(axis + 2) % 3];
        if (i % 5 == 0) { at[axis] = i & 16 ? b.low[axis] : b.high[axis]; }
        escaped += !scene.intersect({from, glm::normalize(at - from)});
        escaped += !scene.occluded(from, from + (at - from) * T(3));
    }
    CHECK(escaped == 0);
}

TEST_CASE("geometry: the camera meets the Cornell box without holes") {
    const host::scene<float> scene{host::scenes::cornell_diffuse<float>()};
    aglow::random_sampler<float> random{5};
    int holes = 0;
    for (int i = 0; i < 300000; ++i) {
        // The opening is 122.3 rows high to either side of the middle: all rays within it end on a wall.
        const aglow::vec2<float> film = random.next_2d() * 244.0f + 6.0f;
        holes += !scene.intersect(scene.view().through(film, 256, 256));
    }
    CHECK(holes == 0);
}

TEMPLATE_TEST_CASE("geometry: occluded answers the same both ways, for any two points", "", float, double) {
    using T = TestType;
    const host::scene<T> scene{host::scenes::cornell_glass<T>()};
    aglow::random_sampler<T> random{3};
    int differing = 0;
    for (int i = 0; i < 100000; ++i) {
        const vec3<T> a = inside(scene.bounds(), random);
        const vec3<T> b = inside(scene.bounds(), random);
        differing += scene.occluded(a, b) != scene.occluded(b, a);
    }
    CHECK(differing == 0);
}

TEMPLATE_TEST_CASE("geometry: a scene 1024 times as large is hit at exactly 1024 times the distance", "", float,
                   double) {
    using T = TestType;
    auto small = host::scenes::cornell_glass<T>();
    auto large = small;
    for (auto& q : large.quads) {
        for (auto& corner : q.corners) { corner *= T(1024); }
    }
    for (auto& s : large.spheres) { s = {s.centre * T(1024), s.radius * T(1024), s.material}; }
    const host::scene<T> a{small};
    const host::scene<T> b{large};
    aglow::random_sampler<T> random{3};
    for (int i = 0; i < 20000; ++i) {
        const vec3<T> o = inside(a.bounds(), random);
        const vec3<T> d = aglow::uniform_sphere(random.next_2d());
        const auto near = a.intersect({o, d});
        const auto far = b.intersect({o * T(1024), d});
        REQUIRE(static_cast<bool>(near) == static_cast<bool>(far));
        if (!near) { continue; }
        REQUIRE(near->position * T(1024) == far->position);
        REQUIRE(near->normal == far->normal);
    }
}

TEST_CASE("geometry: the reach of a ray ends it") {
    host::geometry<double> g;
    g.add_sphere({0, 0, 5}, 1);
    g.add_triangle({-1, -1, 2}, {1, -1, 2}, {0, 1, 2});
    g.finish();
    host::meeting<double> m;
    CHECK(g.nearest({{0, 0, 0}, {0, 0, 1}}, m));
    CHECK(m.distance == Approx(2));
    CHECK_FALSE(g.nearest({{0, 0, 0}, {0, 0, 1}, 1.5}, m));
    CHECK(g.nearest({{0, 0, 3}, {0, 0, 1}}, m));
    CHECK(m.distance == Approx(1));
    CHECK(m.primitive == 0);
    CHECK_FALSE(g.nearest({{0, 0, 3}, {0, 0, 1}, 0.5}, m));
    CHECK_FALSE(g.nearest({{0, 0, 7}, {0, 0, 1}}, m));
}

TEST_CASE("geometry: an empty one is never hit") {
    host::geometry<float> g;
    g.finish();
    host::meeting<float> m;
    CHECK_FALSE(g.nearest({{0, 0, 0}, {0, 0, 1}}, m));
    CHECK_FALSE(g.occluded({0, 0, 0}, {1, 2, 3}));
}

TEST_CASE("geometry: the red wall's four corners are no flat quad, the other walls' are") {
    int bent = 0;
    for (const auto& q : host::scenes::cornell_diffuse<float>().quads) {
        bent += !host::is_flat_convex(q.corners[0], q.corners[1], q.corners[2], q.corners[3]);
    }
    CHECK(bent == 1);
}
