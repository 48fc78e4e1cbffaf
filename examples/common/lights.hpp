// Lights one by one: flat, round, without size, and the sky. Each can send particles out and be looked at from a point.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <aglow/concepts/light.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/warp.hpp>

#include "spherical_rectangle.hpp"

namespace host {

template <typename T>
using illumination = aglow::illumination<vec3<T>, T>;
template <typename T>
using emission = aglow::emission<vec3<T>, T>;

/// One look at `place`, which sends `radiance` out from a surface with unit `normal`, chosen with density `pdf` per
/// steradian. The far end is lifted off the light by `error`, so that the light does not shadow itself.
template <typename T>
[[nodiscard]] illumination<T> look(const vec3<T>& from, const vec3<T>& place, const vec3<T>& normal, T error,
                                   const vec3<T>& radiance, T pdf) {
    const vec3<T> to = place + normal * error - from;
    const T distance = glm::length(to);
    return {to / distance, distance, radiance / pdf, pdf};
}

/// A particle from `place` into the cosine-weighted hemisphere of `normal`, off a surface of `area` that shines evenly.
template <typename T>
[[nodiscard]] emission<T> send(const vec3<T>& place, const vec3<T>& normal, T error, const vec3<T>& radiance, T area,
                               const vec2<T>& u) {
    const vec3<T> out = aglow::frame<T>{normal}.to_world(aglow::cosine_hemisphere(u));
    return {{.origin = place + normal * error, .direction = out}, radiance * (aglow::pi<T> * area)};
}

/// A triangle that shines on the side of its normal; looked at uniformly by area.
template <typename T>
class triangle_light {
public:
    triangle_light(const vec3<T>& a, const vec3<T>& b, const vec3<T>& c, const vec3<T>& radiance, T error)
        : a_{a}, ab_{b - a}, ac_{c - a}, radiance_{radiance}, error_{error} {
        const vec3<T> n = glm::cross(ab_, ac_);
        area_ = glm::length(n) / 2;
        normal_ = glm::normalize(n);
    }

    [[nodiscard]] vec3<T> power() const { return radiance_ * (aglow::pi<T> * area_); }

    [[nodiscard]] emission<T> emit(const vec2<T>& where, const vec2<T>& along) const {
        return send(at(where), normal_, error_, radiance_, area_, along);
    }

    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, const vec2<T>& u) const {
        const vec3<T> place = at(u);
        const T p = pdf(point, place);
        if (!(p > 0)) { return std::nullopt; }
        return look(point, place, normal_, error_, radiance_, p);
    }

    /// Density of `illuminate`, per steradian, for a `place` on the light.
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& place) const {
        const vec3<T> to = point - place;
        const T height = glm::dot(to, normal_);
        if (!(height > 0)) { return 0; }
        const T d2 = aglow::length2(to);
        return d2 * std::sqrt(d2) / (height * area_);
    }

private:
    [[nodiscard]] vec3<T> at(const vec2<T>& u) const {
        const vec2<T> b = aglow::uniform_triangle(u);
        return a_ + ab_ * b.x + ac_ * b.y;
    }

    vec3<T> a_, ab_, ac_, normal_{}, radiance_;
    T error_, area_;
};

/// A rectangle that shines on the side of its normal; looked at by solid angle from near, by area from far.
template <typename T>
class rectangle_light {
public:
    rectangle_light(const rectangle<T>& shape, const vec3<T>& radiance, T error)
        : shape_{shape}, normal_{shape.normal()}, radiance_{radiance}, error_{error}, area_{shape.area()} {}

    [[nodiscard]] vec3<T> power() const { return radiance_ * (aglow::pi<T> * area_); }

    [[nodiscard]] emission<T> emit(const vec2<T>& where, const vec2<T>& along) const {
        return send(shape_.at(where), normal_, error_, radiance_, area_, along);
    }

    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, const vec2<T>& u) const {
        if (!faces(point)) { return std::nullopt; }
        if (!near(point)) {
            const vec3<T> place = shape_.at(u);
            return look(point, place, normal_, error_, radiance_, area_pdf(point, place));
        }
        const spherical_rectangle<T> seen{shape_, point};
        if (!(seen.solid_angle() > 0)) { return std::nullopt; }
        return look(point, seen.at(u), normal_, error_, radiance_, 1 / seen.solid_angle());
    }

    /// Density of `illuminate`, per steradian, for a `place` on the light.
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& place) const {
        if (!faces(point)) { return 0; }
        if (!near(point)) { return area_pdf(point, place); }
        const T angle = spherical_rectangle<T>{shape_, point}.solid_angle();
        return angle > 0 ? 1 / angle : T(0);
    }

private:
    [[nodiscard]] T area_pdf(const vec3<T>& point, const vec3<T>& place) const {
        const vec3<T> to = point - place;
        const T d2 = aglow::length2(to);
        return d2 * std::sqrt(d2) / (glm::dot(to, normal_) * area_);
    }
    [[nodiscard]] bool faces(const vec3<T>& point) const { return glm::dot(point - shape_.corner, normal_) > error_; }
    /// Where the solid angle is worth its cost: about half a radian across, from the centre.
    [[nodiscard]] bool near(const vec3<T>& point) const {
        return aglow::distance2(point, shape_.at({T(0.5), T(0.5)})) < 4 * area_;
    }

    rectangle<T> shape_;
    vec3<T> normal_, radiance_;
    T error_, area_;
};

/// A sphere that shines outwards; looked at by the cone that it fills. Inside out, it shines inwards, and is looked at
/// by area.
template <typename T>
class sphere_light {
public:
    sphere_light(const vec3<T>& centre, T radius, bool inside_out, const vec3<T>& radiance, T error)
        : centre_{centre}, radius_{radius}, side_{inside_out ? T(-1) : T(1)}, radiance_{radiance}, error_{error} {}

    [[nodiscard]] T area() const { return 4 * aglow::pi<T> * radius_ * radius_; }
    [[nodiscard]] vec3<T> power() const { return radiance_ * (aglow::pi<T> * area()); }

    [[nodiscard]] emission<T> emit(const vec2<T>& where, const vec2<T>& along) const {
        const vec3<T> out = aglow::uniform_sphere(where);
        return send(centre_ + out * radius_, out * side_, error_, radiance_, area(), along);
    }

    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, const vec2<T>& u) const {
        const vec3<T> to = centre_ - point;
        const T d2 = aglow::length2(to);
        if (side_ < 0) { return from_inside(point, u); }
        if (!(d2 > aglow::square(radius_ + error_))) { return std::nullopt; }
        const T gap = one_minus_cosine(d2);
        const vec3<T> local = aglow::uniform_cone(u, gap);
        const T d = std::sqrt(d2);
        const T sine2 = local.x * local.x + local.y * local.y;
        const T t = d * local.z - std::sqrt(std::max(T(0), radius_ * radius_ - d2 * sine2));
        const vec3<T> towards = aglow::frame<T>{to / d}.to_world(local);
        const vec3<T> normal = glm::normalize(point + towards * t - centre_);
        return look(point, centre_ + normal * radius_, normal, error_, radiance_, aglow::uniform_cone_pdf(gap));
    }

    /// Density of `illuminate`, per steradian, for a `place` on the light.
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& place) const {
        const T d2 = aglow::distance2(point, centre_);
        if (side_ < 0) { return inside_pdf(point, place, glm::normalize(centre_ - place)); }
        return d2 > aglow::square(radius_ + error_) ? aglow::uniform_cone_pdf(one_minus_cosine(d2)) : T(0);
    }

private:
    [[nodiscard]] T one_minus_cosine(T d2) const {
        const T sine2 = radius_ * radius_ / d2;
        return sine2 / (1 + std::sqrt(std::max(T(0), 1 - sine2)));
    }
    [[nodiscard]] std::optional<illumination<T>> from_inside(const vec3<T>& point, const vec2<T>& u) const {
        const vec3<T> out = aglow::uniform_sphere(u);
        const vec3<T> place = centre_ + out * radius_;
        const T p = inside_pdf(point, place, -out);
        if (!(p > 0)) { return std::nullopt; }
        return look(point, place, -out, error_, radiance_, p);
    }
    [[nodiscard]] T inside_pdf(const vec3<T>& point, const vec3<T>& place, const vec3<T>& normal) const {
        const vec3<T> to = point - place;
        const T height = glm::dot(to, normal);
        if (!(height > error_)) { return 0; }
        const T e2 = aglow::length2(to);
        return e2 * std::sqrt(e2) / (height * area());
    }

    vec3<T> centre_;
    T radius_, side_;
    vec3<T> radiance_;
    T error_;
};

/// A light without size, of `intensity` in watts per steradian, the same in all directions.
template <typename T>
class point_light {
public:
    point_light(const vec3<T>& position, const vec3<T>& intensity) : position_{position}, intensity_{intensity} {}

    [[nodiscard]] vec3<T> power() const { return intensity_ * (4 * aglow::pi<T>); }

    [[nodiscard]] emission<T> emit(const vec2<T>& where, const vec2<T>&) const {
        return {{.origin = position_, .direction = aglow::uniform_sphere(where)}, power()};
    }
    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, const vec2<T>&) const {
        const vec3<T> to = position_ - point;
        const T d2 = aglow::length2(to);
        if (!(d2 > 0)) { return std::nullopt; }
        const T d = std::sqrt(d2);
        return illumination<T>{to / d, d, intensity_ / d2, T(0)};
    }
    [[nodiscard]] T pdf(const vec3<T>&, const vec3<T>&) const { return 0; }

private:
    vec3<T> position_, intensity_;
};

/// Radiance from beyond the scene: `ground` below the horizon (y < 0), above it from `horizon` to `zenith` in
/// proportion to y. Where the scene sees the sky through one window alone, the window says where to look.
template <typename T>
struct sky {
    vec3<T> ground{0};
    vec3<T> horizon{1};
    vec3<T> zenith{1};
    /// The only opening, its normal pointing into the room; without it the sky is all around.
    std::optional<rectangle<T>> window{};
};

/// The sky as a light around a scene.
template <typename T>
class sky_light {
public:
    sky_light(const sky<T>& s, const aglow::bounds<T>& scene, T error)
        : ground_{s.ground},
          horizon_{s.horizon},
          zenith_{s.zenith},
          window_{s.window.value_or(rectangle<T>{})},
          has_window_{s.window.has_value()},
          centre_{scene.centre()},
          radius_{scene.radius()},
          error_{error} {
        const T low = aglow::max_component(s.ground);
        first_ = aglow::max_component(s.horizon);
        last_ = aglow::max_component(s.zenith);
        const T high = (first_ + last_) / 2;
        below_ = low + high > 0 ? low / (low + high) : T(0);
        lit_ = low + high > 0;
    }

    /// Watts that enter the scene's bounding sphere, or the window.
    [[nodiscard]] vec3<T> power() const {
        if (!has_window_) {
            const vec3<T> mean = ground_ + (horizon_ + zenith_) * T(0.5);
            return mean * (2 * aglow::pi<T> * aglow::pi<T> * radius_ * radius_);
        }
        return window_power();
    }

    [[nodiscard]] vec3<T> radiance(const vec3<T>& direction) const {
        const T y = direction.y;
        return y < 0 ? ground_ : horizon_ + (zenith_ - horizon_) * y;
    }

    [[nodiscard]] emission<T> emit(const vec2<T>& where, const vec2<T>& along) const {
        if (has_window_) {
            const vec3<T> n = window_.normal();
            const emission<T> e = send(window_.at(where), n, error_, vec3<T>{1}, window_.area(), along);
            return {e.path, e.power * radiance(-e.path.direction)};
        }
        const vec3<T> from = direction(along);
        const aglow::frame<T> disc{-from};
        const vec2<T> p = aglow::concentric_disc(where) * radius_;
        const vec3<T> origin = centre_ + (from + disc.x * (p.x / radius_) + disc.y * (p.y / radius_)) * radius_;
        return {{.origin = origin, .direction = -from},
                radiance(from) * (aglow::pi<T> * radius_ * radius_ / direction_pdf(from))};
    }

    [[nodiscard]] std::optional<illumination<T>> illuminate(const vec3<T>& point, const vec2<T>& u) const {
        constexpr T beyond = std::numeric_limits<T>::infinity();
        if (has_window_) {
            if (!inside(point)) { return std::nullopt; }
            const spherical_rectangle<T> seen{window_, point};
            if (!(seen.solid_angle() > 0)) { return std::nullopt; }
            const vec3<T> towards = glm::normalize(seen.at(u) - point);
            return illumination<T>{towards, beyond, radiance(towards) * seen.solid_angle(), 1 / seen.solid_angle()};
        }
        if (!lit_) { return std::nullopt; }
        const vec3<T> towards = direction(u);
        const T p = direction_pdf(towards);
        return illumination<T>{towards, beyond, radiance(towards) / p, p};
    }

    /// Density of `illuminate`, per steradian.
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& towards) const {
        if (!has_window_) { return direction_pdf(towards); }
        if (!inside(point) || !through(point, towards)) { return 0; }
        const T angle = spherical_rectangle<T>{window_, point}.solid_angle();
        return angle > 0 ? 1 / angle : T(0);
    }

private:
    /// Density over the sphere, in proportion to the brightest band.
    [[nodiscard]] T direction_pdf(const vec3<T>& d) const {
        if (!lit_) { return 0; }
        const T share = d.y < 0 ? below_ : (1 - below_) * 2 * (first_ + (last_ - first_) * d.y) / (first_ + last_);
        return share / (2 * aglow::pi<T>);
    }

    [[nodiscard]] vec3<T> direction(const vec2<T>& u) const {
        const T y = u.x < below_ ? u.x / below_ - 1 : rise((u.x - below_) / (1 - below_));
        const T radius = std::sqrt(std::max(T(0), 1 - y * y));
        const T angle = 2 * aglow::pi<T> * u.y;
        return {radius * std::cos(angle), y, radius * std::sin(angle)};
    }
    /// Height below which share `u` of a straight rise from `first_` to `last_` lies: (f + (l - f) y / 2) y = u (f + l)
    /// / 2.
    [[nodiscard]] T rise(T u) const {
        const T root = std::sqrt(first_ * first_ + u * (last_ * last_ - first_ * first_));
        return std::clamp(u * (first_ + last_) / (first_ + root), T(0), T(1));
    }

    [[nodiscard]] bool inside(const vec3<T>& point) const {
        return glm::dot(point - window_.corner, window_.normal()) > error_;
    }
    [[nodiscard]] bool through(const vec3<T>& point, const vec3<T>& towards) const {
        const vec3<T> n = window_.normal();
        const T fall = glm::dot(towards, n);
        if (!(fall < 0)) { return false; }
        const vec3<T> met = point + towards * (glm::dot(window_.corner - point, n) / fall) - window_.corner;
        const T x = glm::dot(met, window_.along);
        const T y = glm::dot(met, window_.across);
        return x >= 0 && y >= 0 && x <= window_.width && y <= window_.height;
    }
    [[nodiscard]] vec3<T> window_power() const {
        constexpr int grid = 64;
        vec3<T> sum{0};
        const aglow::frame<T> out{window_.normal()};
        for (int i = 0; i < grid * grid; ++i) {
            const vec2<T> u{(T(i % grid) + T(0.5)) / T(grid), (T(i / grid) + T(0.5)) / T(grid)};
            sum += radiance(-out.to_world(aglow::cosine_hemisphere(u)));
        }
        return sum * (aglow::pi<T> * window_.area() / T(grid * grid));
    }

    vec3<T> ground_, horizon_, zenith_;
    rectangle<T> window_;
    bool has_window_;
    vec3<T> centre_;
    T radius_, error_, first_{}, last_{}, below_{};
    bool lit_{};
};

}  // namespace host
