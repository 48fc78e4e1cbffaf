// One remembered irradiance, in few bytes, and what it says about points near it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/stereographic.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/compact_gradients.hpp>
#include <aglow/estimators/irradiance_estimate.hpp>
#include <aglow/estimators/linear_light.hpp>
#include <aglow/estimators/record_reach.hpp>

namespace aglow {

/// What a record remembers beside place, normal, irradiance and radius. What is left out takes no room and no code.
struct record_features {
    bool gradients{true};  ///< first-order extrapolation
    bool ellipse{true};    ///< a reach that differs by direction
    bool noise{true};      ///< standard error and number of rays
    bool incident{false};  ///< where light comes from, for glossy surfaces

    friend constexpr bool operator==(const record_features&, const record_features&) = default;
};

namespace detail {

/// Stands in for a part that is left out; the number keeps two of them from being one type, and so from taking room.
template <int>
struct left_out {};

template <bool Kept, typename Part, int Number>
using part_or_nothing = std::conditional_t<Kept, Part, left_out<Number>>;

/// An ellipse without its size: the direction of its longer axis, as long as the root of 1 - (shorter/longer)².
class compact_ellipse {
public:
    compact_ellipse() = default;
    /// `axis` is the shorter one, unit. A ratio above `longest` counts as that.
    template <typename T>
    compact_ellipse(T ratio, const vec2<T>& axis) {
        const T flatness = std::sqrt(std::max(T(0), 1 - 1 / square(std::min(ratio, T(longest)))));
        codes_ = {code(-axis.y * flatness), code(axis.x * flatness)};
    }
    template <typename T>
    [[nodiscard]] vec2<T> value() const {
        return value<T>(codes_[0], codes_[1]);
    }
    template <typename T>
    [[nodiscard]] static vec2<T> value(int x, int y) {
        return {static_cast<T>(x) * T(step), static_cast<T>(y) * T(step)};
    }
    static constexpr float step = 0x1p-15f;
    static constexpr float longest = 9.9f;  ///< rounded, never above the 10 that `longest_radius` knows

private:
    template <typename T>
    static std::int16_t code(T x) {
        return static_cast<std::int16_t>(std::lround(std::clamp(x * T(32768), T(-32767), T(32767))));
    }
    std::array<std::int16_t, 2> codes_{};
};

/// A relative error x >= 0 as x / (1 + x) in 16 bits, and a count that stops at 65535.
class compact_noise {
public:
    compact_noise() = default;
    template <typename T>
    compact_noise(T noise, std::uint32_t rays)
        : noise_{static_cast<std::uint16_t>(std::lround(noise / (1 + noise) * T(65534)))},
          rays_{static_cast<std::uint16_t>(std::min(rays, 65535u))} {}
    template <typename T>
    [[nodiscard]] T noise() const {
        return noise<T>(noise_);
    }
    template <typename T>
    [[nodiscard]] static T noise(int code) {
        const int rest = 65534 - code;
        return static_cast<T>(code) / static_cast<T>(rest > 1 ? rest : 1);
    }
    [[nodiscard]] std::uint32_t rays() const { return rays_; }

private:
    std::uint16_t noise_{};
    std::uint16_t rays_{};
};

}  // namespace detail

/// Where a record may speak: its place, axes and reach.
template <std::floating_point T>
struct record_shape {
    vec3<T> position;
    T radius;
    tilt<T> facing;   ///< the normal
    vec2<T> stretch;  ///< direction of the longer axis, as long as the root of 1 - (shorter/longer)²

    /// What gradients and ellipse are given in.
    [[nodiscard]] frame<T> axes() const { return frame<T>{facing}; }

    /// Where a point of the world lies: in `axes`, from the position, in units of the radius.
    [[nodiscard]] vec3<T> local(const vec3<T>& point, const frame<T>& axes) const {
        return axes.to_local(point - position) * (1 / radius);
    }

    /// Squared distance of a `local` point in units of the reach: below 1 inside the ellipsoid whose third semi-axis is
    /// the shorter one.
    [[nodiscard]] T distance2(const vec3<T>& p) const {
        const T along = stretch.x * p.x + stretch.y * p.y;
        const T flat = p.x * p.x + p.y * p.y - along * along;
        return (flat > 0 ? flat : T(0)) + p.z * p.z;
    }
};

/// Irradiance at a point and how it goes on around it. 64 bytes for RGB with all but `incident`, 32 for gray without
/// gradients. Trivially copyable; scaling its scene by a power of two scales it exactly.
template <Spectrum S, std::floating_point T = band_of<S>, record_features Features = record_features{}>
class irradiance_record {
public:
    static constexpr record_features features = Features;

    irradiance_record() = default;

    /// Expects what `is_usable(e, reach)` grants.
    irradiance_record(const irradiance_estimate<S, T>& e, const record_reach<T>& reach)
        : position_{e.position}, irradiance_{e.irradiance}, radius_{reach.radius}, normal_{e.axes.z} {
        const frame<T> own = axes();
        const auto turned = [&](const auto& v) {
            const T xx = glm::dot(own.x, e.axes.x), xy = glm::dot(own.x, e.axes.y);
            const T yx = glm::dot(own.y, e.axes.x), yy = glm::dot(own.y, e.axes.y);
            return std::remove_cvref_t<decltype(v)>{v.x * xx + v.y * xy, v.x * yx + v.y * yy};
        };
        if constexpr (Features.gradients) {
            const irradiance_gradients<S> g{turned(e.gradients.translation), turned(e.gradients.rotation)};
            gradients_ = compact_gradients<S, T>{g, irradiance_, radius_};
        }
        if constexpr (Features.ellipse) { ellipse_ = {reach.ratio, turned(reach.axis)}; }
        if constexpr (Features.noise) { noise_ = {e.relative_noise, e.rays - e.rejected}; }
        if constexpr (Features.incident) {
            const bool dark = !(length2(e.incident) > 0);
            incident_ = {dark ? e.axes.z * (T(2) / 3) : e.axes.to_world(e.incident), dark ? T(0) : e.misfit};
        }
    }

    [[nodiscard]] const vec3<T>& position() const { return position_; }
    [[nodiscard]] vec3<T> normal() const { return normal_.direction<T>(); }
    [[nodiscard]] const S& irradiance() const { return irradiance_; }

    /// The shorter semi-axis of the reach.
    [[nodiscard]] T radius() const { return radius_; }

    /// The longer semi-axis, rounded upwards: beyond it the record has no weight.
    [[nodiscard]] T longest_radius() const {
        if constexpr (Features.ellipse) {
            const vec2<T> e = ellipse_.template value<T>();
            return radius_ / std::sqrt(std::max(T(0.01), 1 - (e.x * e.x + e.y * e.y))) *
                   (1 + 8 * std::numeric_limits<T>::epsilon());
        } else {
            return radius_;
        }
    }

    /// Mean direction to the light, its length telling how concentrated it is; as of an even sky where it was black.
    [[nodiscard]] vec3<T> incident() const requires(Features.incident) { return incident_.template mean<T>(); }

    /// What light linear in direction leaves out (`linear_misfit`).
    [[nodiscard]] T misfit() const requires(Features.incident) { return incident_.template misfit<T>(); }

    /// Standard error over irradiance, of the largest band.
    [[nodiscard]] T relative_noise() const requires(Features.noise) { return noise_.template noise<T>(); }

    /// How many accepted rays it was made from; 65535 stands for that many or more.
    [[nodiscard]] std::uint32_t rays() const requires(Features.noise) { return noise_.rays(); }

    /// Where it may speak.
    [[nodiscard]] record_shape<T> shape() const {
        record_shape<T> s{position_, radius_, normal_.turned<T>(), {0, 0}};
        if constexpr (Features.ellipse) { s.stretch = ellipse_.template value<T>(); }
        return s;
    }
    [[nodiscard]] frame<T> axes() const { return shape().axes(); }
    [[nodiscard]] vec3<T> local(const vec3<T>& point, const frame<T>& axes) const { return shape().local(point, axes); }
    [[nodiscard]] T distance2(const vec3<T>& local) const { return shape().distance2(local); }

    /// Irradiance at a `local` point whose normal is `n`, along `axes()`; to first order, never negative. Within the
    /// reach the change is at most about the irradiance itself.
    [[nodiscard]] S extrapolate(const vec3<T>& p, const vec3<T>& n) const {
        if constexpr (Features.gradients) {
            // (0, 0, 1) x n
            return gradients_.extrapolate(irradiance_, {p.x, p.y, -n.y, n.x});
        } else {
            return irradiance_;
        }
    }

    /// The same record with another radius, the shape of the ellipse kept. Expects `radius` > 0.
    [[nodiscard]] irradiance_record with_radius(T radius) const {
        irradiance_record result = *this;
        result.radius_ = radius;
        if constexpr (Features.gradients) { result.gradients_ = gradients_.rescaled(radius_, radius); }
        return result;
    }

    /// The same record with another irradiance and noise; slopes relative to irradiance are kept. Expects usable
    /// numbers.
    [[nodiscard]] irradiance_record with_irradiance(const S& irradiance, T noise) const {
        irradiance_record result = *this;
        result.irradiance_ = irradiance;
        if constexpr (Features.gradients) {
            const band_of<S> before = max_component(irradiance_);
            result.gradients_ = gradients_.relit(before > 0 ? max_component(irradiance) / before : band_of<S>(0));
        }
        if constexpr (Features.noise) { result.noise_ = {noise, noise_.rays()}; }
        return result;
    }

    /// The same place and reach with the light of another estimate there. Expects one that `is_usable`.
    [[nodiscard]] irradiance_record with_light(const irradiance_estimate<S, T>& e) const {
        irradiance_record result{e, {.radius = radius_}};
        result.position_ = position_;
        result.normal_ = normal_;
        result.ellipse_ = ellipse_;
        return result;
    }

private:
    // `detail::record_lanes` knows the order of these.
    vec3<T> position_{};
    S irradiance_{};
    T radius_{};
    stereographic normal_{};
    [[no_unique_address]] detail::part_or_nothing<Features.ellipse, detail::compact_ellipse, 0> ellipse_{};
    [[no_unique_address]] detail::part_or_nothing<Features.noise, detail::compact_noise, 1> noise_{};
    [[no_unique_address]] detail::part_or_nothing<Features.gradients, compact_gradients<S, T>, 2> gradients_{};
    [[no_unique_address]] detail::part_or_nothing<Features.incident, compact_light, 3> incident_{};
};

/// Whether a record can be made: place, normal and light are numbers, the reach is a length, most rays were good.
template <Spectrum S, std::floating_point T>
[[nodiscard]] bool is_usable(const irradiance_estimate<S, T>& e, const record_reach<T>& reach) {
    const auto finite = [](const vec3<T>& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); };
    const auto finite_band = [](const S& s) {
        return is_finite(max_component(s)) && is_finite(max_component(S(s * band_of<S>(-1))));
    };
    const auto& [t, r] = e.gradients;
    const auto& [xx, xy, yy] = e.curvature;
    const T length = length2(e.axes.z);
    const bool known = is_finite(e.mean_inverse_distance) && e.mean_inverse_distance >= 0 &&
                       is_finite(e.nearest_inverse_distance) && e.nearest_inverse_distance >= 0 && is_finite(xx) &&
                       is_finite(xy) && is_finite(yy);
    const bool lit = finite(e.incident) && is_finite(e.misfit) && e.misfit >= 0;
    return known && lit && finite(e.position) && finite(e.axes.z) && length > T(0.99) && length < T(1.01) &&
           is_radiance(e.irradiance) && finite_band(t.x) && finite_band(t.y) && finite_band(r.x) && finite_band(r.y) &&
           is_finite(reach.radius) && reach.radius > 0 && is_finite(reach.ratio) && is_finite(e.relative_noise) &&
           e.relative_noise >= 0 && 2 * e.rejected <= e.rays;
}

}  // namespace aglow
