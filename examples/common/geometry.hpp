// A handful of polygons and spheres, and the nearest one along a ray: all of them are tested, a vector register at a
// time.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/vec.hpp>

namespace host {

using aglow::vec2;
using aglow::vec3;

/// Where a ray met which primitive.
template <typename T>
struct meeting {
    T distance{};
    std::uint32_t primitive{};
    vec3<T> position{};
    vec3<T> normal{};
};

/// Convex polygons of three or four corners, and spheres. For some tens of primitives this beats any tree. Edges
/// overlap by a few ulp of the largest coordinate, so that nothing slips through between neighbours. Primitives are
/// numbered in the order of their addition.
template <typename T>
class geometry {
public:
    /// A sphere, whose normals point outwards, or inwards where `inside_out`. Returns its number.
    std::uint32_t add_sphere(const vec3<T>& centre, T radius, bool inside_out = false) {
        bounds_.add(centre - vec3<T>{radius});
        bounds_.add(centre + vec3<T>{radius});
        spheres_.push_back({centre, radius, inside_out ? T(-1) : T(1), count_});
        return count_++;
    }

    /// A triangle, whose normal is on the side from which the corners turn left. Returns its number.
    std::uint32_t add_triangle(const vec3<T>& a, const vec3<T>& b, const vec3<T>& c) {
        return add_polygon({a, b, c, a}, 3);
    }

    /// A flat convex quad (see `is_flat_convex`). Returns its number.
    std::uint32_t add_quad(const vec3<T>& a, const vec3<T>& b, const vec3<T>& c, const vec3<T>& d) {
        return add_polygon({a, b, c, d}, 4);
    }

    /// To be called once after the last primitive: lays the polygons out for tracing.
    void finish();

    [[nodiscard]] const aglow::bounds<T>& bounds() const { return bounds_; }
    [[nodiscard]] std::uint32_t size() const { return count_; }

    /// How far a computed position may lie from its surface.
    [[nodiscard]] T position_error() const { return error_; }

    /// The nearest primitive in front of the origin and before `r.reach`; whether there is one. Expects `finish()`.
    [[nodiscard]] bool nearest(const aglow::ray<T>& r, meeting<T>& found) const;

    /// Whether anything lies strictly between two points; the same both ways.
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const;

private:
#if defined(__AVX__)
    static constexpr std::size_t width = 32 / sizeof(T);
#else
    static constexpr std::size_t width = 16 / sizeof(T);
#endif
    using integer = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
    using lanes [[gnu::vector_size(width * sizeof(T))]] = T;
    using marks [[gnu::vector_size(width * sizeof(T))]] = integer;

    struct polygon {
        std::array<vec3<T>, 4> corners;
        std::size_t count;
        std::uint32_t number;
    };
    struct sphere {
        vec3<T> centre;
        T radius;
        T side;
        std::uint32_t number;
    };
    struct plane {
        vec3<T> normal{};
        std::uint32_t number{};
        T offset{};
    };
    /// Polygons, one a lane: the plane normal · p = offset, and edges whose value at p is not below zero inside.
    struct block {
        lanes nx, ny, nz, offset;
        struct {
            lanes x, y, z, w;
        } edge[4];
    };

    /// Halves the lanes until the smallest distance, and the lane it came from, is in the first.
    template <std::size_t Half>
    static void bring_nearest_to_front(lanes& best, marks& which) {
        const lanes other = swapped<Half>(best, std::make_index_sequence<width>{});
        const marks other_which = swapped<Half>(which, std::make_index_sequence<width>{});
        const marks nearer = other < best;
        best = nearer ? other : best;
        which = nearer ? other_which : which;
        if constexpr (Half > 1) { bring_nearest_to_front<Half / 2>(best, which); }
    }
    template <std::size_t Half, typename V, std::size_t... Lane>
    static V swapped(V v, std::index_sequence<Lane...>) {
        return __builtin_shufflevector(v, v, static_cast<int>(Lane ^ Half)...);
    }

    std::uint32_t add_polygon(const std::array<vec3<T>, 4>& corners, std::size_t count) {
        for (const vec3<T>& corner : corners) { bounds_.add(corner); }
        polygons_.push_back({corners, count, count_});
        return count_++;
    }
    void lay_out(const polygon& p, block& into, std::size_t lane);
    static bool meets(const sphere& s, const aglow::ray<T>& r, T reach, T& distance);

    std::vector<polygon> polygons_{};
    std::vector<sphere> spheres_{};
    std::vector<block> blocks_{};
    std::vector<plane> planes_{};
    aglow::bounds<T> bounds_{};
    std::uint32_t count_{0};
    T error_{0};
};

/// Twice the area of a polygon, along its normal (Newell's sum over a fan).
template <typename T>
[[nodiscard]] vec3<T> area_vector(const std::array<vec3<T>, 4>& c, std::size_t count) {
    const vec3<T> first = glm::cross(c[1] - c[0], c[2] - c[0]);
    return count == 3 ? first : first + glm::cross(c[2] - c[0], c[3] - c[0]);
}

/// Whether four corners lie in a plane, within rounding, and turn the same way at each.
template <typename T>
[[nodiscard]] bool is_flat_convex(const vec3<T>& a, const vec3<T>& b, const vec3<T>& c, const vec3<T>& d) {
    const std::array<vec3<T>, 4> p{a, b, c, d};
    const vec3<T> n = area_vector(p, 4);
    const T scale =
        std::max(std::max(aglow::max_abs(a), aglow::max_abs(b)), std::max(aglow::max_abs(c), aglow::max_abs(d)));
    const T slack = 4 * std::numeric_limits<T>::epsilon() * scale * glm::length(n);
    for (std::size_t i = 0; i < 4; ++i) {
        const vec3<T> next = p[(i + 1) % 4] - p[i];
        if (std::abs(glm::dot(n, next)) > slack) { return false; }
        if (!(glm::dot(n, glm::cross(next, p[(i + 2) % 4] - p[(i + 1) % 4])) > 0)) { return false; }
    }
    return true;
}

template <typename T>
void geometry<T>::finish() {
    const T extent = count_ == 0 ? T(0) : std::max(aglow::max_abs(bounds_.low), aglow::max_abs(bounds_.high));
    error_ = aglow::position_error(extent);
    blocks_.assign((polygons_.size() + width - 1) / width, block{});
    planes_.assign(blocks_.size() * width, plane{});
    for (block& b : blocks_) { b.offset -= 1; }  // an empty lane is met at infinity
    for (std::size_t i = 0; i < polygons_.size(); ++i) { lay_out(polygons_[i], blocks_[i / width], i % width); }
}

template <typename T>
void geometry<T>::lay_out(const polygon& p, block& into, std::size_t lane) {
    const vec3<T> n = glm::normalize(area_vector(p.corners, p.count));
    const T offset = (glm::dot(n, p.corners[0]) + glm::dot(n, p.corners[2])) / 2;
    planes_[static_cast<std::size_t>(&into - blocks_.data()) * width + lane] = {n, p.number, offset};
    into.nx[lane] = n.x;
    into.ny[lane] = n.y;
    into.nz[lane] = n.z;
    into.offset[lane] = offset;
    for (std::size_t i = 0; i < 4; ++i) {
        const vec3<T>& from = p.corners[i];
        const vec3<T>& to = p.corners[(i + 1) % p.count];
        const bool real = i < p.count;
        const vec3<T> inward = real ? glm::normalize(glm::cross(n, to - from)) : vec3<T>{0};
        into.edge[i].x[lane] = inward.x;
        into.edge[i].y[lane] = inward.y;
        into.edge[i].z[lane] = inward.z;
        into.edge[i].w[lane] = (real ? -glm::dot(inward, from) : error_) + error_ / 8;
    }
}

template <typename T>
bool geometry<T>::nearest(const aglow::ray<T>& r, meeting<T>& found) const {
    const vec3<T> o = r.origin;
    const vec3<T> d = r.direction;
    lanes best = lanes{} + r.reach;
    marks which = marks{} - 1;
    marks number{};
    for (integer i = 0; i < static_cast<integer>(width); ++i) { number[i] = i; }
    for (const block& b : blocks_) {
        const lanes t = (b.offset - (b.nx * o.x + b.ny * o.y + b.nz * o.z)) / (b.nx * d.x + b.ny * d.y + b.nz * d.z);
        const lanes x = o.x + t * d.x;
        const lanes y = o.y + t * d.y;
        const lanes z = o.z + t * d.z;
        // The sign bits say what is outside of an edge or behind the origin.
        marks outside = reinterpret_cast<marks>(t);
        for (const auto& e : b.edge) {
            const lanes inside = e.x * x + e.y * y + (e.z * z + e.w);
            outside |= reinterpret_cast<marks>(inside);
        }
        const marks take = (outside >= 0) & (t < best);
        best = take ? t : best;
        which = take ? number : which;
        number += static_cast<integer>(width);
    }
    bring_nearest_to_front<width / 2>(best, which);
    T distance = best[0];
    const integer lane = which[0];
    const sphere* round = nullptr;
    for (const sphere& s : spheres_) {
        if (meets(s, r, distance, distance)) { round = &s; }
    }
    if (round) {
        const vec3<T> out = glm::normalize(o + d * distance - round->centre);
        found = {distance, round->number, round->centre + out * round->radius, out * round->side};
        return true;
    }
    if (lane < 0) { return false; }
    const plane& p = planes_[static_cast<std::size_t>(lane)];
    const vec3<T> met = o + d * distance;
    // Back onto the plane, from which a long or grazing ray may have strayed.
    found = {distance, p.number, met + p.normal * (p.offset - glm::dot(p.normal, met)), p.normal};
    return true;
}

template <typename T>
bool geometry<T>::occluded(const vec3<T>& a, const vec3<T>& b) const {
    // Always from the same end, so that rounding is the same both ways.
    const bool swap = b.x != a.x ? b.x < a.x : b.y != a.y ? b.y < a.y : b.z < a.z;
    const vec3<T> o = swap ? b : a;
    const vec3<T> d = swap ? a - b : b - a;
    marks hit{};
    for (const block& k : blocks_) {
        const lanes t = (k.offset - (k.nx * o.x + k.ny * o.y + k.nz * o.z)) / (k.nx * d.x + k.ny * d.y + k.nz * d.z);
        const lanes x = o.x + t * d.x;
        const lanes y = o.y + t * d.y;
        const lanes z = o.z + t * d.z;
        marks outside = reinterpret_cast<marks>(t);
        for (const auto& e : k.edge) {
            const lanes inside = e.x * x + e.y * y + (e.z * z + e.w);
            outside |= reinterpret_cast<marks>(inside);
        }
        hit |= (outside >= 0) & (t < 1);
    }
    const auto words = std::bit_cast<std::array<std::uint64_t, width * sizeof(T) / 8>>(hit);
    std::uint64_t any = 0;
    for (const std::uint64_t w : words) { any |= w; }
    if (any != 0) { return true; }
    if (spheres_.empty()) { return false; }
    const T length = glm::length(d);
    const aglow::ray<T> r{o, d / length, length};
    for (const sphere& s : spheres_) {
        T distance{};
        if (meets(s, r, length, distance)) { return true; }
    }
    return false;
}

template <typename T>
bool geometry<T>::meets(const sphere& s, const aglow::ray<T>& r, T reach, T& distance) {
    const vec3<T> from = r.origin - s.centre;
    const T along = -glm::dot(from, r.direction);
    // The foot of the centre on the ray, not b^2 - 4ac: exact for small and far spheres (Haines et al. 2019, (7.5)).
    const T left = s.radius * s.radius - aglow::length2(from + r.direction * along);
    if (left < 0) { return false; }
    const T half = std::sqrt(left);
    const T beyond = aglow::length2(from) - s.radius * s.radius;
    const T far_root = along + (along < 0 ? -half : half);
    // The smaller root by Vieta, where subtraction would lose it.
    const T other = far_root == 0 ? T(0) : beyond / far_root;
    const T first = std::min(far_root, other);
    const T second = std::max(far_root, other);
    const T t = first > 0 ? first : second;
    if (!(t > 0) || !(t < reach)) { return false; }
    distance = t;
    return true;
}

}  // namespace host
