// Scenes made of quadrics clipped by boxes: spheres, cylinders, ellipsoids, paraboloids and planes, glowing or not.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "support/scenes.hpp"
#include "support/statistics.hpp"

namespace stability {

using aglow::lobe_set;
using aglow::ray;
using aglow::vec2;
using aglow::vec3;
using support::material;

/// A surface of the toy scenes that glows on both sides.
template <typename S, typename T>
struct glowing_hit : support::toy_hit<S, T> {
    [[nodiscard]] S emitted(const vec3<T>&) const { return this->made_of->glow; }
};

template <typename T>
inline constexpr T endless = std::numeric_limits<T>::max();

/// Where square · p² + linear · p + constant = 0 within a box.
template <typename T>
struct quadric {
    vec3<T> square{};
    vec3<T> linear{};
    T constant{};
    material<T> made_of{};
    vec3<T> low{-endless<T>};
    vec3<T> high{endless<T>};

    [[nodiscard]] static quadric sphere(const vec3<T>& centre, T radius, const material<T>& m) {
        return {vec3<T>{1}, centre * T(-2), aglow::length2(centre) - radius * radius, m};
    }
    /// Around the z axis.
    [[nodiscard]] static quadric cylinder(T radius, const material<T>& m) {
        return {{1, 1, 0}, {}, -radius * radius, m};
    }
    [[nodiscard]] static quadric plane(int axis, T at, const material<T>& m) {
        quadric q{{}, {}, -at, m};
        q.linear[axis] = 1;
        return q;
    }
    /// Around the z axis, centred at the origin, with that semi-axis along z and the other across.
    [[nodiscard]] static quadric ellipsoid(T along, T across, const material<T>& m) {
        const T a2 = across * across;
        return {{1, 1, a2 / (along * along)}, {}, -a2, m};
    }
    /// z = s² / 4f.
    [[nodiscard]] static quadric paraboloid(T f, const material<T>& m) { return {{1, 1, 0}, {0, 0, -4 * f}, 0, m}; }

    [[nodiscard]] bool holds(const vec3<T>& p) const {
        return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
    }
    /// Both roots along a ray; NaN where there is none.
    [[nodiscard]] std::pair<T, T> roots(const ray<T>& r) const {
        const T none = std::numeric_limits<T>::infinity();
        const T a = glm::dot(square, r.direction * r.direction);
        const T b = glm::dot(square, r.origin * r.direction) + glm::dot(linear, r.direction) / 2;
        const T c = glm::dot(square, r.origin * r.origin) + glm::dot(linear, r.origin) + constant;
        if (a == 0) { return b == 0 ? std::pair{none, none} : std::pair{-c / (2 * b), none}; }
        const T root2 = b * b - a * c;
        if (!(root2 > 0)) { return {none, none}; }
        const T q = -(b + std::copysign(std::sqrt(root2), b));
        const std::pair<T, T> both{q / a, q == 0 ? none : c / q};
        return both.first < both.second ? both : std::pair{both.second, both.first};
    }
    [[nodiscard]] vec3<T> normal(const vec3<T>& p) const { return glm::normalize(square * p * T(2) + linear); }
};

/// Any number of quadrics, gray.
template <typename T>
struct quadric_scene {
    using scalar = T;
    std::vector<quadric<T>> shapes{};
    lobe_set lobes{lobe_set::all};

    [[nodiscard]] lobe_set possible_lobes() const { return lobes; }

    [[nodiscard]] std::optional<glowing_hit<T, T>> intersect(const ray<T>& r) const {
        const quadric<T>* found = nullptr;
        T reach = r.reach;
        for (const quadric<T>& q : shapes) {
            const auto [near, far] = q.roots(r);
            for (const T t : {near, far}) {
                if (t > 0 && t < reach && q.holds(r.origin + r.direction * t)) {
                    reach = t;
                    found = &q;
                    break;
                }
            }
        }
        if (!found) { return std::nullopt; }
        const vec3<T> p = r.origin + r.direction * reach;
        return glowing_hit<T, T>{{p, found->normal(p), &found->made_of,
                                  2 * aglow::position_error(std::max(aglow::max_abs(p), aglow::max_abs(r.origin)))}};
    }
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const {
        const T distance = glm::distance(a, b);
        return intersect({a, (b - a) / distance, distance}).has_value();
    }
};

/// Emission that nobody looks for: paths meet it by themselves.
template <typename S, typename T = S>
struct blind : support::no_light<S, T> {
    template <typename H>
    [[nodiscard]] T pdf(const vec3<T>&, const vec3<T>&, const H&) const {
        return 0;
    }
};

/// An even sky of radiance `glow`, met by paths alone.
template <typename S, typename T = S>
struct even_sky : support::no_light<S, T> {
    S glow{aglow::white<S>()};
    [[nodiscard]] S escaped(const vec3<T>&) const { return glow; }
};

/// Two unit spheres along z that share a cap, a fraction `port` of each; the first, below z = 0, glows.
template <typename T>
[[nodiscard]] quadric_scene<T> kissing(T albedo, T port) {
    const T centre = 1 - 2 * port;
    auto first = quadric<T>::sphere({0, 0, -centre}, 1, {.diffuse = albedo, .glow = 1});
    auto second = quadric<T>::sphere({0, 0, centre}, 1, {.diffuse = albedo});
    first.high.z = 0;
    second.low.z = 0;
    return {{first, second}, lobe_set::diffuse_reflection};
}

/// Planes z = 0 … count - 1 between perfect mirrors x, y = ±1, over a black floor at z = -1; open above z = count.
template <typename T>
struct stack_scene {
    using scalar = T;
    int count{};
    material<T> sheet{};
    bool alternate{false};  ///< every second normal points down, so that glass lies between pairs
    material<T> mirror{.mirror = 1};
    material<T> floor{};

    [[nodiscard]] std::optional<support::toy_hit<T, T>> intersect(const ray<T>& r) const {
        T reach = r.reach;
        std::optional<support::toy_hit<T, T>> hit;
        for (int axis = 0; axis < 2; ++axis) {
            if (r.direction[axis] == 0) { continue; }
            const T side = std::copysign(T(1), r.direction[axis]);
            const T t = (side - r.origin[axis]) / r.direction[axis];
            if (!(t > 0 && t < reach)) { continue; }
            vec3<T> p = r.origin + r.direction * t;
            if (p.z > T(count)) { continue; }
            reach = t;
            p[axis] = side;
            vec3<T> n{};
            n[axis] = -side;
            hit = {p, n, &mirror, aglow::position_error(T(count + 1))};
        }
        if (r.direction.z != 0) { meet_sheet(r, reach, hit); }
        return hit;
    }
    [[nodiscard]] bool occluded(const vec3<T>&, const vec3<T>&) const { return true; }

private:
    void meet_sheet(const ray<T>& r, T reach, std::optional<support::toy_hit<T, T>>& hit) const {
        const bool up = r.direction.z > 0;
        const T z = up ? std::floor(r.origin.z) + 1 : std::ceil(r.origin.z) - 1;
        const T at = std::max(z, T(-1));
        if (at > T(count - 1) && up) { return; }
        const T plane = up ? std::max(at, T(0)) : std::min(at, T(count - 1));
        const T t = (plane - r.origin.z) / r.direction.z;
        if (!(t > 0 && t < reach)) { return; }
        vec3<T> p = r.origin + r.direction * t;
        p.z = plane;
        const bool down = alternate && std::lround(plane) % 2 == 0;
        const material<T>* made_of = plane < 0 ? &floor : &sheet;
        hit = {p, {0, 0, down ? T(-1) : T(1)}, made_of, aglow::position_error(T(count + 1))};
    }
};

/// A beam of 1 W straight up, or spread by the cosine, from below the first sheet.
template <typename T>
struct lift_beam {
    using scalar = T;
    bool spread{false};
    template <aglow::Sampler R>
    [[nodiscard]] aglow::emission<T, T> emit(R& random) const {
        const vec2<T> u = random.next_2d();
        return {{{0, 0, T(-0.5)}, spread ? aglow::cosine_hemisphere(u) : vec3<T>{0, 0, 1}}, 1};
    }
};

/// The mean radiance along one ray over `paths` paths of `integrator`.
template <typename Integrator, typename T = typename Integrator::scalar>
[[nodiscard]] statistics::sample_mean looks_along(const Integrator& integrator, const ray<T>& eye, std::uint64_t paths,
                                                  std::uint64_t seed = 1) {
    statistics::sample_mean mean;
    for (std::uint64_t i = 0; i < paths; ++i) {
        const aglow::random_numbers<T> numbers{{.seed = seed, .path = i}};
        mean.add(static_cast<double>(aglow::max_component(integrator(eye, numbers).value)));
    }
    return mean;
}

}  // namespace stability
