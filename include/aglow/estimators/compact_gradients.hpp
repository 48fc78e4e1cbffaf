// Irradiance gradients in few bytes, relative to the irradiance they belong to.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_gradients.hpp>

namespace aglow {

/// Where a query lies as a record sees it: the way to it along the record's two axes, over the record's radius, and
/// record normal x query normal along the same axes.
template <std::floating_point T>
struct record_offset {
    T x{};
    T y{};
    T turn_x{};
    T turn_y{};
};

/// Gradients as they are kept for spectra of the host's own: as they are, but for the cap |translation| radius <=
/// irradiance.
template <Spectrum S, std::floating_point T>
class compact_gradients {
public:
    compact_gradients() = default;
    compact_gradients(const irradiance_gradients<S>& g, const S& irradiance, T radius)
        : translation_{g.translation.x * radius, g.translation.y * radius}, rotation_{g.rotation} {
        const auto high = [](const S& a) {
            return static_cast<T>(std::max(max_component(a), max_component(S(a * band_of<S>(-1)))));
        };
        const T steepest = std::hypot(high(translation_.x), high(translation_.y));
        const T most = static_cast<T>(max_component(irradiance));
        if (steepest > most) {
            translation_ = {translation_.x * (most / steepest), translation_.y * (most / steepest)};
        }
    }

    /// Irradiance at the offset, to first order; no band falls below zero, and hues are kept where one would.
    [[nodiscard]] S extrapolate(const S& irradiance, const record_offset<T>& at) const {
        const S change =
            translation_.x * at.x + translation_.y * at.y + (rotation_.x * at.turn_x + rotation_.y * at.turn_y);
        const S moved = irradiance + change;
        const T below = static_cast<T>(max_component(S(moved * band_of<S>(-1))));
        if (!(below > 0)) { return moved; }
        // The smallest band of E is at least `least`, so E + s change >= 0 for this s.
        const T least = std::max(T(0), -static_cast<T>(max_component(S(irradiance * band_of<S>(-1)))));
        // Not quite all is taken away: rounding would make it less than nothing.
        const T most = 1 - 8 * std::numeric_limits<T>::epsilon();
        return irradiance + change * (most * least / (least + below));
    }

    /// The same gradients for another radius.
    [[nodiscard]] compact_gradients rescaled(T from, T to) const {
        compact_gradients result = *this;
        result.translation_ = {translation_.x * (to / from), translation_.y * (to / from)};
        return result;
    }

    /// The same gradients relative to the irradiance, of one that is `factor` times as large.
    [[nodiscard]] compact_gradients relit(band_of<S> factor) const {
        const auto scaled = [factor](const tangent_vector<S>& v) {
            return tangent_vector<S>{v.x * factor, v.y * factor};
        };
        compact_gradients result;
        result.translation_ = scaled(translation_);
        result.rotation_ = scaled(rotation_);
        return result;
    }

private:
    tangent_vector<S> translation_{};  // times the radius
    tangent_vector<S> rotation_{};
};

namespace detail {

/// Bands of the spectra whose bands are known to be side by side.
template <typename S>
inline constexpr std::size_t packed_bands = 0;
template <>
inline constexpr std::size_t packed_bands<float> = 1;
template <>
inline constexpr std::size_t packed_bands<vec3<float>> = 3;

[[nodiscard]] inline float band(float a, std::size_t) { return a; }
[[nodiscard]] inline float band(const vec3<float>& a, std::size_t b) { return a[static_cast<int>(b)]; }

[[nodiscard]] inline float lowest_band(float a) { return a; }
[[nodiscard]] inline float lowest_band(const vec3<float>& a) { return std::min(std::min(a.x, a.y), a.z); }

/// A number in [-1, 1] as a 16-bit integer.
[[nodiscard]] inline std::int16_t packed_unit(float x) {
    return static_cast<std::int16_t>(std::lrint(std::clamp(x, -1.f, 1.f) * 32767.f));
}

}  // namespace detail

/// Gradients of gray and RGB in float: 16 bits a component, each band relative to its own irradiance, so steps are
/// below 2e-5 of the irradiance anywhere within the radius, and scaling by powers of two changes no bit.
template <Spectrum S>
    requires(detail::packed_bands<S> > 0)
class compact_gradients<S, float> {
public:
    compact_gradients() = default;
    compact_gradients(const irradiance_gradients<S>& g, const S& irradiance, float radius) {
        for (std::size_t b = 0; b < bands; ++b) {
            const float e = detail::band(irradiance, b);
            if (!(e > 0)) { continue; }
            set_translation(b, detail::band(g.translation.x, b) * radius / e,
                            detail::band(g.translation.y, b) * radius / e);
            codes_[2 * bands + b] = detail::packed_unit(detail::band(g.rotation.x, b) / (e * steepest_turn));
            codes_[3 * bands + b] = detail::packed_unit(detail::band(g.rotation.y, b) / (e * steepest_turn));
        }
    }

    [[nodiscard]] S extrapolate(const S& irradiance, const record_offset<float>& at) const {
        const std::array<float, 4> k = factors(at);
        S change{};
        if constexpr (bands == 1) {
            change = sum(0, k);
        } else {
            change = S{sum(0, k), sum(1, k), sum(2, k)};
        }
        return irradiance + irradiance * change * (lowest / drop(detail::lowest_band(change)));
    }

    /// What the codes of a band are weighed by at an offset: the sum is the change relative to the band's irradiance.
    [[nodiscard]] static std::array<float, 4> factors(const record_offset<float>& at) {
        return {at.x * step, at.y * step, at.turn_x * (steepest_turn * step), at.turn_y * (steepest_turn * step)};
    }

    /// The changes of all bands are multiplied by `lowest / drop`, given the lowest of them: one factor keeps their
    /// hue.
    [[nodiscard]] static float drop(float least) { return least < -lowest ? -least : lowest; }
    static constexpr float lowest = 0.95f;  ///< never takes all away

    [[nodiscard]] compact_gradients rescaled(float from, float to) const {
        compact_gradients result = *this;
        for (std::size_t b = 0; b < bands; ++b) {
            result.set_translation(b, static_cast<float>(codes_[b]) * step * (to / from),
                                   static_cast<float>(codes_[bands + b]) * step * (to / from));
        }
        return result;
    }

    /// These are relative to the irradiance.
    [[nodiscard]] compact_gradients relit(float) const { return *this; }

private:
    static constexpr std::size_t bands = detail::packed_bands<S>;
    static constexpr float step = 1 / 32767.f;
    static constexpr float steepest_turn = 4;  // a quarter radian may change everything

    /// Caps the length, so that the change within the radius never exceeds the irradiance, and keeps the direction.
    void set_translation(std::size_t b, float x, float y) {
        const float scale = 1 / std::max(1.f, std::hypot(x, y));
        codes_[b] = detail::packed_unit(x * scale);
        codes_[bands + b] = detail::packed_unit(y * scale);
    }

    [[nodiscard]] float sum(std::size_t b, const std::array<float, 4>& k) const {
        return static_cast<float>(codes_[b]) * k[0] + static_cast<float>(codes_[bands + b]) * k[1] +
               static_cast<float>(codes_[2 * bands + b]) * k[2] + static_cast<float>(codes_[3 * bands + b]) * k[3];
    }

    std::array<std::int16_t, 4 * bands> codes_{};
};

}  // namespace aglow
