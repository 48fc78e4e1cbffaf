// Light over a hemisphere that changes linearly with direction: what irradiance and a mean direction can tell.
//
// The least-squares fit under the cosine. Exact under an even sky and a linear one; what it leaves out is measured when
// the hemisphere is known, and bounds the error of every lobe that is lit by it (Cauchy-Schwarz). Ward et al. 1988 take
// all light to come from the mean direction; the fit keeps how widely it is spread, too.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <span>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/octahedral.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/hemisphere.hpp>

namespace aglow {

/// Radiance over E / pi of irradiance E, as a function of direction in any axes: `level + slope . w`.
template <std::floating_point T>
class linear_light {
public:
    /// Even light.
    linear_light() = default;

    /// Of `mean`, the mean direction to the light weighed by radiance times cosine, around unit `normal`.
    linear_light(const vec3<T>& mean, const vec3<T>& normal) {
        // The moments of 1, x, y, z under the cosine: pi, 2 pi / 3 along the normal; squares pi / 2 along it and pi / 4
        // across.
        const T up = glm::dot(mean, normal);
        level_ = 9 - 12 * up;
        slope_ = (mean - normal * up) * T(4) + normal * (18 * up - 12);
    }

    [[nodiscard]] T operator()(const vec3<T>& direction) const { return level_ + glm::dot(slope_, direction); }

private:
    T level_{1};
    vec3<T> slope_{0};
};

/// What the linear fit of a sampled hemisphere leaves out: the root mean square under the cosine, of the band that
/// differs most, over E / pi of the largest band. Changes from stratum to stratum count as noise, as in
/// `relative_noise`, and not here. 0 for a black hemisphere.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T linear_misfit(const hemisphere_grid<S, T>& grid, const vec3<T>& mean) {
    const auto [rings, sectors] = grid.shape();
    const std::span<const S> radiance = grid.radiance();
    const S even = grid.irradiance() * (1 / pi<band_of<S>>);
    const double level = static_cast<double>(max_component(even));
    if (!(level > 0)) { return 0; }
    const linear_light<T> light{mean, vec3<T>{0, 0, 1}};
    double sum = 0;
    for (std::uint32_t k = 0; k < sectors; ++k) {
        for (std::uint32_t j = 0; j < rings; ++j) {
            const T shape = light(hemisphere_direction<T>(grid.shape(), j, k, vec2<T>{T(0.5)}));
            const S off = radiance[std::size_t{k} * rings + j] + even * static_cast<band_of<S>>(-shape);
            const double most = std::max(max_component(off), max_component(S(off * band_of<S>(-1))));
            sum += square(most);
        }
    }
    const double count = grid.shape().count();
    const double noise = static_cast<double>(relative_noise(grid));
    return static_cast<T>(std::sqrt(std::max(0.0, sum / count / square(level) - square(noise) * count)));
}

/// Mean direction with its length, and the misfit, in 8 bytes.
class compact_light {
public:
    compact_light() = default;
    template <typename T>
    compact_light(const vec3<T>& mean, T misfit)
        : towards_{mean},
          length_{static_cast<std::uint16_t>(std::lround(std::clamp(glm::length(mean), T(0), T(1)) * T(65535)))},
          misfit_{static_cast<std::uint16_t>(std::lround(misfit / (1 + misfit) * T(65534)))} {}

    template <typename T>
    [[nodiscard]] vec3<T> mean() const {
        return towards_.template direction<T>() * (static_cast<T>(length_) / T(65535));
    }
    template <typename T>
    [[nodiscard]] T misfit() const {
        const T x = static_cast<T>(misfit_) / T(65534);
        return x / std::max(T(1) / T(65534), 1 - x);
    }

private:
    octahedral towards_{vec3<float>{0, 0, 1}};
    std::uint16_t length_{};
    std::uint16_t misfit_{};
};

}  // namespace aglow
