// Analytic scenes of a few spheres and rectangles, with matte, glossy, mirror and glass surfaces and their lights.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/warp.hpp>

namespace support {

using aglow::lobe_set;
using aglow::max_component;
using aglow::ray;
using aglow::vec2;
using aglow::vec3;

/// What a surface is made of: shares of light by lobe, together at most one.
template <typename S>
struct material {
    S diffuse{};
    S transmit{};  ///< diffuse transmission
    S glossy{};    ///< around the mirror direction, by a cosine to the power `exponent`
    S mirror{};
    double glass{0};  ///< relative index of refraction; 0 for no glass
    S glow{};         ///< radiance on the side of the normal
    double exponent{20};
    double adjoint_factor{1};
};

/// A hit on such a surface.
template <typename S, typename T>
struct toy_hit {
    using B = aglow::band_of<S>;
    vec3<T> position{};
    vec3<T> normal{};
    const material<S>* made_of{};
    T position_error{};

    [[nodiscard]] lobe_set lobes() const {
        lobe_set has = lobe_set::none;
        const auto add = [&](const S& share, lobe_set lobe) { has = aglow::is_black(share) ? has : has | lobe; };
        add(made_of->diffuse, lobe_set::diffuse_reflection);
        add(made_of->transmit, lobe_set::diffuse_transmission);
        add(made_of->glossy, lobe_set::glossy_reflection);
        add(made_of->mirror, lobe_set::specular_reflection);
        return made_of->glass > 0 ? has | lobe_set::specular : has;
    }

    [[nodiscard]] S emitted(const vec3<T>& wo) const { return glm::dot(normal, wo) > 0 ? made_of->glow : S{}; }
    [[nodiscard]] T adjoint(const vec3<T>&, const vec3<T>&) const { return T(made_of->adjoint_factor); }

    [[nodiscard]] S evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        const bool reflected = same_side(wo, wi);
        S f{};
        if (reflected && any(asked, lobe_set::diffuse_reflection)) { f = f + made_of->diffuse * B(1 / aglow::pi<T>); }
        if (!reflected && any(asked, lobe_set::diffuse_transmission)) {
            f = f + made_of->transmit * B(1 / aglow::pi<T>);
        }
        if (reflected && any(asked, lobe_set::glossy_reflection)) {
            // Reciprocal: divided by the larger cosine, so that the albedo is at most one.
            const T larger = std::max(cosine(wo), cosine(wi));
            f = f + made_of->glossy * B(gloss_pdf(wo, wi) / larger);
        }
        return f;
    }

    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        const shares p = choose(wo, asked);
        const T lambert = aglow::cosine_hemisphere_pdf(cosine(wi));
        return same_side(wo, wi) ? p.diffuse * lambert + p.glossy * gloss_pdf(wo, wi) : p.transmit * lambert;
    }

    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::scatter_sample<S, T>> sample(const vec3<T>& wo, R& random,
                                                                    lobe_set asked) const {
        const shares p = choose(wo, asked);
        T pick = T(random.next_1d());
        const vec2<T> u = random.next_2d();
        if (p.sum() <= 0) { return std::nullopt; }
        const vec3<T> near = glm::dot(normal, wo) < 0 ? -normal : normal;
        if ((pick -= p.reflect) < 0) {
            return specular(mirrored(wo), p.reflect, reflectance(wo, asked), lobe_set::specular_reflection);
        }
        if ((pick -= p.refract) < 0) {
            return specular(refracted(wo), p.refract, aglow::white<S>() * B(1 - fresnel(wo)),
                            lobe_set::specular_transmission);
        }
        if ((pick -= p.diffuse) < 0) {
            return smooth(wo, aglow::frame<T>{near}.to_world(aglow::cosine_hemisphere(u)), asked,
                          lobe_set::diffuse_reflection);
        }
        if ((pick -= p.transmit) < 0) {
            return smooth(wo, aglow::frame<T>{-near}.to_world(aglow::cosine_hemisphere(u)), asked,
                          lobe_set::diffuse_transmission);
        }
        const vec3<T> wi = aglow::frame<T>{mirrored(wo)}.to_world(lobe_direction(u));
        if (!same_side(wo, wi)) { return std::nullopt; }
        return smooth(wo, wi, asked, lobe_set::glossy_reflection);
    }

private:
    struct shares {
        T reflect{};
        T refract{};
        T diffuse{};
        T transmit{};
        T glossy{};
        [[nodiscard]] T sum() const { return reflect + refract + diffuse + transmit + glossy; }
    };

    [[nodiscard]] T cosine(const vec3<T>& w) const { return std::abs(glm::dot(normal, w)); }
    [[nodiscard]] bool same_side(const vec3<T>& a, const vec3<T>& b) const {
        return glm::dot(normal, a) * glm::dot(normal, b) > 0;
    }
    [[nodiscard]] vec3<T> mirrored(const vec3<T>& wo) const { return normal * (2 * glm::dot(normal, wo)) - wo; }
    [[nodiscard]] T index_towards(const vec3<T>& wo) const {
        return glm::dot(normal, wo) > 0 ? T(made_of->glass) : 1 / T(made_of->glass);
    }
    [[nodiscard]] T refracted_cosine2(const vec3<T>& wo) const {
        const T c = cosine(wo);
        const T eta = index_towards(wo);
        return 1 - (1 - c * c) / (eta * eta);
    }
    [[nodiscard]] vec3<T> refracted(const vec3<T>& wo) const {
        const vec3<T> n = glm::dot(normal, wo) < 0 ? -normal : normal;
        const T eta = index_towards(wo);
        return glm::normalize(n * (cosine(wo) / eta - std::sqrt(std::max(T(0), refracted_cosine2(wo)))) - wo / eta);
    }
    [[nodiscard]] T fresnel(const vec3<T>& wo) const {
        const T ct2 = refracted_cosine2(wo);
        if (ct2 <= 0) { return 1; }
        const T ci = cosine(wo);
        const T ct = std::sqrt(ct2);
        const T eta = index_towards(wo);
        const T s = (ci - eta * ct) / (ci + eta * ct);
        const T p = (eta * ci - ct) / (eta * ci + ct);
        return (s * s + p * p) / 2;
    }
    [[nodiscard]] S reflectance(const vec3<T>& wo, lobe_set) const {
        return made_of->glass > 0 ? aglow::white<S>() * B(fresnel(wo)) : made_of->mirror;
    }
    [[nodiscard]] T gloss_pdf(const vec3<T>& wo, const vec3<T>& wi) const {
        const T c = glm::dot(mirrored(wo), wi);
        const T e = T(made_of->exponent);
        return c > 0 ? (e + 1) / (2 * aglow::pi<T>)*std::pow(c, e) : T(0);
    }
    [[nodiscard]] vec3<T> lobe_direction(const vec2<T>& u) const {
        const T z = std::pow(1 - u.x, 1 / (T(made_of->exponent) + 1));
        const T r = std::sqrt(std::max(T(0), 1 - z * z));
        return {r * std::cos(2 * aglow::pi<T> * u.y), r * std::sin(2 * aglow::pi<T> * u.y), z};
    }
    [[nodiscard]] shares choose(const vec3<T>& wo, lobe_set asked) const {
        const auto share = [&](const S& s, lobe_set lobe) { return any(asked, lobe) ? T(max_component(s)) : T(0); };
        shares p{.reflect = share(reflectance(wo, asked), lobe_set::specular_reflection),
                 .refract = any(asked, lobe_set::specular_transmission) && made_of->glass > 0 ? 1 - fresnel(wo) : T(0),
                 .diffuse = share(made_of->diffuse, lobe_set::diffuse_reflection),
                 .transmit = share(made_of->transmit, lobe_set::diffuse_transmission),
                 .glossy = share(made_of->glossy, lobe_set::glossy_reflection)};
        const T all = p.sum();
        if (all > 0) { p = {p.reflect / all, p.refract / all, p.diffuse / all, p.transmit / all, p.glossy / all}; }
        return p;
    }
    [[nodiscard]] static aglow::scatter_sample<S, T> specular(const vec3<T>& wi, T probability, const S& reflectance,
                                                              lobe_set lobe) {
        return {wi, reflectance * B(1 / probability), 0, lobe};
    }
    [[nodiscard]] std::optional<aglow::scatter_sample<S, T>> smooth(const vec3<T>& wo, const vec3<T>& wi,
                                                                    lobe_set asked, lobe_set lobe) const {
        const T density = pdf(wo, wi, asked);
        if (!(density > 0)) { return std::nullopt; }
        return aglow::scatter_sample<S, T>{wi, evaluate(wo, wi, asked) * B(cosine(wi) / density), density, lobe};
    }
};

template <typename S, typename T>
struct ball {
    vec3<T> centre{};
    T radius{1};
    material<S> made_of{};
    T port{2};  ///< a hole where the outward normal's z exceeds this
};

/// corner + s u + t v with s, t in [0, 1]; u and v along the world's axes.
template <typename S, typename T>
struct rectangle {
    vec3<T> corner{};
    vec3<T> u{};
    vec3<T> v{};
    vec3<T> normal{};
    material<S> made_of{};
    bool round{false};  ///< only the disc within
};

/// Balls and rectangles, as a host's ray tracer. Every length may be scaled by a power of two without any rounding.
template <typename S, typename T = float>
struct toy_scene {
    using scalar = T;
    std::vector<ball<S, T>> balls{};
    std::vector<rectangle<S, T>> rectangles{};
    lobe_set lobes{lobe_set::all};

    [[nodiscard]] lobe_set possible_lobes() const { return lobes; }

    [[nodiscard]] std::optional<toy_hit<S, T>> intersect(const ray<T>& r) const {
        std::optional<toy_hit<S, T>> nearest;
        T reach = r.reach;
        for (const ball<S, T>& b : balls) { meet(b, r, reach, nearest); }
        for (const rectangle<S, T>& q : rectangles) { meet(q, r, reach, nearest); }
        return nearest;
    }
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const {
        const T distance = glm::distance(a, b);
        return intersect({a, (b - a) / distance, distance}).has_value();
    }

    /// The same scene, every length times `k`.
    [[nodiscard]] toy_scene scaled(T k) const {
        toy_scene s = *this;
        for (auto& b : s.balls) { b.centre *= k, b.radius *= k; }
        for (auto& q : s.rectangles) { q.corner *= k, q.u *= k, q.v *= k; }
        return s;
    }

private:
    static void meet(const ball<S, T>& b, const ray<T>& r, T& reach, std::optional<toy_hit<S, T>>& nearest) {
        const vec3<T> o = r.origin - b.centre;
        const T half = glm::dot(o, r.direction);
        const T c = aglow::length2(o) - b.radius * b.radius;
        // The distance of the line from the centre, without cancellation for far origins.
        const T root2 = b.radius * b.radius - aglow::length2(o - r.direction * half);
        if (!(root2 > 0)) { return; }
        const T q = -(half + std::copysign(std::sqrt(root2), half));
        T roots[2] = {q, c / q};
        if (roots[0] > roots[1]) { std::swap(roots[0], roots[1]); }
        for (const T t : roots) {
            if (!(t > 0 && t < reach)) { continue; }
            const vec3<T> out = glm::normalize(o + r.direction * t);
            if (out.z > b.port) { continue; }
            reach = t;
            nearest = {b.centre + out * b.radius, out, &b.made_of,
                       aglow::position_error(aglow::max_abs(b.centre) + b.radius)};
            return;
        }
    }

    static void meet(const rectangle<S, T>& q, const ray<T>& r, T& reach, std::optional<toy_hit<S, T>>& nearest) {
        const T down = glm::dot(r.direction, q.normal);
        if (down == 0) { return; }
        const T t = glm::dot(q.corner - r.origin, q.normal) / down;
        if (!(t > 0 && t < reach)) { return; }
        const vec3<T> p = r.origin + r.direction * t;
        const T s = glm::dot(p - q.corner, q.u) / aglow::length2(q.u);
        const T w = glm::dot(p - q.corner, q.v) / aglow::length2(q.v);
        if (s < 0 || s > 1 || w < 0 || w > 1) { return; }
        if (q.round && (s - T(0.5)) * (s - T(0.5)) + (w - T(0.5)) * (w - T(0.5)) > T(0.25)) { return; }
        reach = t;
        // On the plane: the corner, and what lies along it.
        nearest = {q.corner + q.u * s + q.v * w, q.normal, &q.made_of,
                   aglow::position_error(std::max(aglow::max_abs(p), aglow::max_abs(r.origin)))};
    }
};

/// A point light.
template <typename S, typename T = float>
struct bulb {
    using scalar = T;
    vec3<T> position{};
    S intensity{};  ///< W/sr

    template <aglow::Sampler R>
    [[nodiscard]] aglow::emission<S, T> emit(R& random) const {
        const vec2<T> u = random.next_2d();
        return {{position, aglow::uniform_sphere(u)}, intensity * aglow::band_of<S>(4 * aglow::pi<T>)};
    }
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::illumination<S, T>> illuminate(const vec3<T>& point, R&) const {
        const vec3<T> across = position - point;
        const T distance = glm::length(across);
        return aglow::illumination<S, T>{across / distance, distance,
                                         intensity * aglow::band_of<S>(1 / (distance * distance)), 0};
    }
};

/// A rectangle or its inscribed disc, glowing on the side of its normal.
template <typename S, typename T = float>
struct panel {
    using scalar = T;
    rectangle<S, T> shape{};

    [[nodiscard]] T area() const {
        const T whole = glm::length(shape.u) * glm::length(shape.v);
        return shape.round ? whole * (aglow::pi<T> / 4) : whole;
    }
    [[nodiscard]] vec3<T> at(const vec2<T>& u) const {
        if (!shape.round) { return shape.corner + shape.u * u.x + shape.v * u.y; }
        const vec2<T> d = aglow::concentric_disc(u);
        return shape.corner + shape.u * ((d.x + 1) / 2) + shape.v * ((d.y + 1) / 2);
    }
    template <aglow::Sampler R>
    [[nodiscard]] aglow::emission<S, T> emit(R& random) const {
        const vec2<T> where = random.next_2d();
        const vec2<T> which = random.next_2d();
        const vec3<T> from = at(where);
        const vec3<T> d = aglow::frame<T>{shape.normal}.to_world(aglow::cosine_hemisphere(which));
        const T error = aglow::position_error(aglow::max_abs(from));
        return {{aglow::lift(from, shape.normal, d, error), d},
                shape.made_of.glow * aglow::band_of<S>(aglow::pi<T> * area())};
    }
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::illumination<S, T>> illuminate(const vec3<T>& point, R& random) const {
        const vec2<T> u = random.next_2d();
        const vec3<T> across = at(u) - point;
        const T distance = glm::length(across);
        const vec3<T> towards = across / distance;
        const T density = density_along(distance, towards);
        if (!(density > 0)) { return std::nullopt; }
        return aglow::illumination<S, T>{towards, distance, shape.made_of.glow * aglow::band_of<S>(1 / density),
                                         density};
    }
    [[nodiscard]] T density_along(T distance, const vec3<T>& towards) const {
        const T cosine = -glm::dot(shape.normal, towards);
        return cosine > 0 ? distance * distance / (cosine * area()) : T(0);
    }
};

/// A panel that scattered rays may find as well.
template <typename S, typename T = float>
struct met_panel : panel<S, T> {
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& towards, const toy_hit<S, T>& hit) const {
        if (aglow::is_black(hit.made_of->glow)) { return 0; }
        return this->density_along(glm::distance(hit.position, point), towards);
    }
};

/// Whatever the light: black.
template <typename S, typename T = float>
struct no_light {
    using scalar = T;
    template <aglow::Sampler R>
    [[nodiscard]] aglow::emission<S, T> emit(R& random) const {
        const vec2<T> u = random.next_2d();
        return {{vec3<T>{}, aglow::uniform_sphere(u)}, S{}};
    }
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::illumination<S, T>> illuminate(const vec3<T>&, R&) const {
        return std::nullopt;
    }
};

/// The inside of the cube [-size, size]³.
template <typename S, typename T>
[[nodiscard]] std::vector<rectangle<S, T>> box_walls(T size, const material<S>& made_of) {
    std::vector<rectangle<S, T>> walls;
    for (int axis = 0; axis < 3; ++axis) {
        for (const T sign : {T(-1), T(1)}) {
            rectangle<S, T> wall{.corner = vec3<T>{-size}, .made_of = made_of};
            wall.corner[axis] = sign * size;
            wall.u[(axis + 1) % 3] = 2 * size;
            wall.v[(axis + 2) % 3] = 2 * size;
            wall.normal[axis] = -sign;
            walls.push_back(wall);
        }
    }
    return walls;
}

/// A room [-1, 1]³ of matte walls under a square light of half-width `light`, with a mirror and a glass ball.
template <typename S, typename T>
struct ball_room {
    toy_scene<S, T> scene{};
    met_panel<S, T> light{};
};
template <typename S, typename T>
[[nodiscard]] ball_room<S, T> room_with_balls(const S& albedo, const S& glow, T light = T(0.25)) {
    ball_room<S, T> room;
    room.scene.rectangles = box_walls<S, T>(T(1), {.diffuse = albedo});
    const T height = T(0.96875);
    room.light.shape = {.corner = {-light, -light, height},
                        .u = {2 * light, 0, 0},
                        .v = {0, 2 * light, 0},
                        .normal = {0, 0, -1},
                        .made_of = {.glow = glow}};
    room.scene.rectangles.push_back(room.light.shape);
    room.scene.balls = {
        {.centre = {T(-0.5), T(0.25), T(-0.625)}, .radius = T(0.3125), .made_of = {.mirror = aglow::white<S>()}},
        {.centre = {T(0.4375), T(-0.25), T(-0.5)}, .radius = T(0.34375), .made_of = {.glass = 1.5}}};
    room.scene.lobes = lobe_set::diffuse_reflection | lobe_set::specular;
    return room;
}

/// A spectrum of the host's own with N bands.
template <std::size_t N>
struct bands {
    float of[N]{};
    friend bool operator==(const bands&, const bands&) = default;
    friend bands operator+(bands a, const bands& b) {
        for (std::size_t i = 0; i < N; ++i) { a.of[i] += b.of[i]; }
        return a;
    }
    friend bands operator*(bands a, const bands& b) {
        for (std::size_t i = 0; i < N; ++i) { a.of[i] *= b.of[i]; }
        return a;
    }
    friend bands operator*(bands a, float k) {
        for (std::size_t i = 0; i < N; ++i) { a.of[i] *= k; }
        return a;
    }
    friend float max_component(const bands& a) {
        float m = a.of[0];
        for (const float x : a.of) {
            if (!aglow::is_finite(x)) { return x; }
            m = std::max(m, x);
        }
        return m;
    }
    friend bands white(std::type_identity<bands>) {
        bands w;
        for (float& x : w.of) { x = 1; }
        return w;
    }
};

}  // namespace support
