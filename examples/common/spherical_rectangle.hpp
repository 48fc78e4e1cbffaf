// A rectangle as it is seen from a point: its solid angle, and points uniform over it (Ureña et al. 2013).
#pragma once

#include <algorithm>
#include <cmath>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace host {

using aglow::vec2;
using aglow::vec3;

/// A flat rectangle: a corner and two edges at right angles, as unit directions with their lengths.
template <typename T>
struct rectangle {
    vec3<T> corner{};
    vec3<T> along{1, 0, 0};
    vec3<T> across{0, 1, 0};
    T width{1};
    T height{1};

    [[nodiscard]] T area() const { return width * height; }
    [[nodiscard]] vec3<T> at(const vec2<T>& u) const {
        return corner + along * (u.x * width) + across * (u.y * height);
    }
    [[nodiscard]] vec3<T> normal() const { return glm::cross(along, across); }
};

/// What a point sees of a rectangle. Expects a point off its plane.
template <typename T>
class spherical_rectangle {
public:
    spherical_rectangle(const rectangle<T>& r, const vec3<T>& eye) : r_{r} {
        const vec3<T> d = r.corner - eye;
        x0_ = glm::dot(d, r.along);
        y0_ = glm::dot(d, r.across);
        // Seen along -z, whichever side the point is on.
        z_ = -std::abs(glm::dot(d, r.normal()));
        x1_ = x0_ + r.width;
        y1_ = y0_ + r.height;
        const T z2 = z_ * z_;
        // The z of the four planes' normals through the eye and an edge; the other parts drop out of the products.
        b0_ = -y0_ / std::sqrt(z2 + y0_ * y0_);
        b1_ = y1_ / std::sqrt(z2 + y1_ * y1_);
        const T n3 = -x0_ / std::sqrt(z2 + x0_ * x0_);
        start_ = std::acos(std::clamp(b1_ * n3, T(-1), T(1))) + std::acos(std::clamp(n3 * b0_, T(-1), T(1)));
        // The four angles' sum less 2 pi, in a form that keeps its digits where the rectangle is far.
        solid_angle_ = std::max(T(0), corner(x1_, y1_) - corner(x0_, y1_) - corner(x1_, y0_) + corner(x0_, y0_));
    }

    [[nodiscard]] T solid_angle() const { return solid_angle_; }

    /// The point of the rectangle that `u` names; uniform by solid angle.
    [[nodiscard]] vec3<T> at(const vec2<T>& u) const {
        const T angle = u.x * solid_angle_ + start_;
        const T f = (std::cos(angle) * b0_ - b1_) / std::sin(angle);
        const T c = std::clamp(std::copysign(1 / std::sqrt(f * f + b0_ * b0_), f), T(-1), T(1));
        const T x = std::clamp(-(c * z_) / std::sqrt(std::max(T(0), 1 - c * c)), x0_, x1_);
        const T d2 = x * x + z_ * z_;
        const T h0 = y0_ / std::sqrt(d2 + y0_ * y0_);
        const T h1 = y1_ / std::sqrt(d2 + y1_ * y1_);
        const T h = h0 + u.y * (h1 - h0);
        const T rest = 1 - h * h;
        const T y = rest > 0 ? std::clamp(h * std::sqrt(d2 / rest), y0_, y1_) : y1_;
        return r_.corner + r_.along * (x - x0_) + r_.across * (y - y0_);
    }

private:
    /// Solid angle of the rectangle from the foot of the perpendicular to (x, y), with the sign of x y.
    [[nodiscard]] T corner(T x, T y) const { return std::atan2(x * y, -z_ * std::sqrt(x * x + y * y + z_ * z_)); }

    const rectangle<T>& r_;
    T x0_, x1_, y0_, y1_, z_, b0_, b1_, start_, solid_angle_;
};

}  // namespace host
