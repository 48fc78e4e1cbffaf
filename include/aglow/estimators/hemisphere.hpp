// A hemisphere of stratified, cosine-weighted samples: what one irradiance record is made of.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// How the hemisphere is cut: `rings` of equal sin², each of `sectors` equal angles, so that every stratum has the same
/// cosine-weighted solid angle pi / (rings sectors).
struct hemisphere_shape {
    std::uint32_t rings{16};
    std::uint32_t sectors{32};

    [[nodiscard]] constexpr std::uint32_t count() const { return rings * sectors; }
    friend bool operator==(const hemisphere_shape&, const hemisphere_shape&) = default;
};

/// The shape with about `rays` strata and pi times as many sectors as rings, which makes the strata about square
/// (Ward & Heckbert 1992). Never below 2 rings of 6 sectors.
[[nodiscard]] inline hemisphere_shape hemisphere_of(std::uint32_t rays) {
    const double rings = std::max(2.0, std::round(std::sqrt(rays / pi<double>)));
    const double sectors = std::max(6.0, std::round(rays / rings));
    return {static_cast<std::uint32_t>(rings), static_cast<std::uint32_t>(sectors)};
}

/// A direction around +z within stratum (ring, sector); `u` in [0,1)² places it there, cosine-weighted. Never below the
/// horizon nor on it.
template <typename T>
[[nodiscard]] vec3<T> hemisphere_direction(const hemisphere_shape& shape, std::uint32_t ring, std::uint32_t sector,
                                           const vec2<T>& u) {
    const T rings = static_cast<T>(shape.rings);
    const T sine2 = (static_cast<T>(ring) + u.x) / rings;
    const T cosine2 = (static_cast<T>(shape.rings - 1 - ring) + (1 - u.x)) / rings;
    const T angle = (2 * pi<T> / static_cast<T>(shape.sectors)) * (static_cast<T>(sector) + u.y);
    const T sine = std::sqrt(sine2);
    return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(cosine2)};
}

/// The tangent plane of what is seen in unit `direction`: its reciprocal distance there, and how that changes with the
/// direction, which for a plane is linear: u(d) = u + slope . (d - direction), exactly. Without slope: a sphere around
/// the eye, or nothing.
template <std::floating_point T>
struct seen_plane {
    vec3<T> direction{};
    vec3<T> slope{};
};

/// One sample per stratum: radiance and reciprocal hit distance. Knows no rays: whoever fills it decides where the
/// light comes from. Local axes: z is the normal, sector 0 begins at x.
template <Spectrum S, std::floating_point T>
class hemisphere_grid {
public:
    /// Throws `std::invalid_argument` for fewer than 2 rings or 3 sectors.
    explicit hemisphere_grid(const hemisphere_shape& shape) { reshape(shape); }

    /// Empties the grid and cuts it anew; keeps its memory.
    void reshape(const hemisphere_shape& shape) {
        if (shape.rings < 2 || shape.sectors < 3) {
            throw std::invalid_argument("aglow: a hemisphere of " + std::to_string(shape.rings) + " rings and " +
                                        std::to_string(shape.sectors) + " sectors; it needs 2 and 3 at least");
        }
        shape_ = shape;
        rejected_ = 0;
        radiance_.assign(shape.count(), S{});
        inverse_distance_.assign(shape.count(), T(0));
        planes_.assign(shape.count(), seen_plane<T>{});
    }

    [[nodiscard]] const hemisphere_shape& shape() const { return shape_; }

    /// Where in `radiance()` a stratum lies: sector by sector, from the zenith to the horizon.
    [[nodiscard]] std::size_t index(std::uint32_t ring, std::uint32_t sector) const {
        return std::size_t{sector} * shape_.rings + ring;
    }

    /// What was seen through a stratum, and how far away: infinite for nothing. A negative, infinite or NaN radiance,
    /// or a distance that is not above zero, is rejected: the stratum stays black and open, and the others stand in for
    /// it. Its borders are steps that are not there: of 3 % rejected, gradients are off by some 5 % of the irradiance.
    void set(std::uint32_t ring, std::uint32_t sector, const S& radiance, T distance) {
        const T inverse = reciprocal(distance);
        if (!is_radiance(radiance) || inverse < 0) {
            ++rejected_;
            return;
        }
        const std::size_t i = index(ring, sector);
        radiance_[i] = radiance;
        inverse_distance_[i] = inverse;
    }

    /// The same for a surface with that `normal`, seen in that unit `direction`; both along the local axes. A normal of
    /// zero is none.
    void set(std::uint32_t ring, std::uint32_t sector, const S& radiance, T distance, const vec3<T>& direction,
             const vec3<T>& normal) {
        set(ring, sector, radiance, distance);
        const std::size_t i = index(ring, sector);
        const T cosine = glm::dot(normal, direction);
        const vec3<T> slope = normal * (inverse_distance_[i] / cosine);
        const bool known = std::abs(cosine) > T(1e-4) && is_finite(slope.x + slope.y + slope.z);
        planes_[i] = {direction, known ? slope : vec3<T>{}};
    }

    [[nodiscard]] std::span<const S> radiance() const { return radiance_; }

    /// Reciprocal distances, 0 where nothing was met.
    [[nodiscard]] std::span<const T> inverse_distance() const { return inverse_distance_; }

    /// What is seen through the strata, as planes.
    [[nodiscard]] std::span<const seen_plane<T>> planes() const { return planes_; }

    /// How many samples were turned away at `set`.
    [[nodiscard]] std::uint32_t rejected() const { return rejected_; }

    /// The cosine-weighted solid angle that one accepted sample stands for.
    [[nodiscard]] T sample_weight() const {
        const std::uint32_t accepted = shape_.count() - rejected_;
        return accepted > 0 ? pi<T> / static_cast<T>(accepted) : T(0);
    }

    /// Irradiance, W/m² when radiance is W/(m² sr).
    [[nodiscard]] S irradiance() const {
        S sum{};
        for (const S& l : radiance_) { sum = sum + l; }
        return sum * sample_weight();
    }

    /// Mean of the reciprocal distances: one over the harmonic mean distance. 0 under an open sky.
    [[nodiscard]] T mean_inverse_distance() const {
        T sum{};
        for (const T u : inverse_distance_) { sum += u; }
        return sum * sample_weight() / pi<T>;
    }

    /// One over the distance to the nearest thing seen, the outermost ring apart: what meets the surface itself at a
    /// grazing angle is not near it. 0 under an open sky.
    [[nodiscard]] T nearest_inverse_distance() const {
        T nearest{};
        for (std::uint32_t k = 0; k < shape_.sectors; ++k) {
            for (std::uint32_t j = 0; j + 1 < shape_.rings; ++j) {
                nearest = std::max(nearest, inverse_distance_[index(j, k)]);
            }
        }
        return nearest;
    }

private:
    /// Below zero for what is no distance. Compares so that NaN falls through.
    static T reciprocal(T distance) {
        if (!is_finite(distance)) { return is_infinite(distance) ? T(0) : T(-1); }
        const T inverse = distance > 0 ? 1 / distance : T(-1);
        return is_finite(inverse) ? inverse : T(-1);
    }

    /// Whether a number that is not finite is +infinity rather than -infinity or NaN, told from its bits.
    static bool is_infinite(T x) {
        using word = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
        return std::bit_cast<word>(x) == std::bit_cast<word>(std::numeric_limits<T>::infinity());
    }

    hemisphere_shape shape_{};
    std::uint32_t rejected_{0};
    std::vector<S> radiance_;
    std::vector<T> inverse_distance_;
    std::vector<seen_plane<T>> planes_;
};

/// Standard error of `grid.irradiance()` relative to it, for the largest band; 0 for a black hemisphere.
///
/// The variance within a stratum is told from second differences along the rings, so that a smooth change of radiance
/// from stratum to stratum does not count as noise; across a sharp edge it is overestimated.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T relative_noise(const hemisphere_grid<S, T>& grid) {
    const auto [rings, sectors] = grid.shape();
    const std::span<const S> radiance = grid.radiance();
    T sum{};
    double variance{};  // squares of faint light leave the range of floats
    for (std::uint32_t k = 0; k < sectors; ++k) {
        const S* here = &radiance[std::size_t{k} * rings];
        const S* left = &radiance[std::size_t{k == 0 ? sectors - 1 : k - 1} * rings];
        const S* right = &radiance[std::size_t{k + 1 == sectors ? 0 : k + 1} * rings];
        for (std::uint32_t j = 0; j < rings; ++j) {
            const T value = static_cast<T>(max_component(here[j]));
            const T beside = static_cast<T>(max_component(left[j])) + static_cast<T>(max_component(right[j]));
            sum += value;
            variance += square(static_cast<double>(value * 2 - beside));
        }
    }
    return sum > 0 ? static_cast<T>(std::sqrt(variance / 6)) / sum : T(0);
}

/// The mean direction that light comes from, in local axes, weighed by radiance times cosine. Its length tells how
/// concentrated the light is: 1 for a single direction, 2/3 for a uniform sky; 0 for a black hemisphere.
template <Spectrum S, std::floating_point T>
[[nodiscard]] vec3<T> incident_direction(const hemisphere_grid<S, T>& grid) {
    const auto [rings, sectors] = grid.shape();
    const S* radiance = grid.radiance().data();
    vec3<T> sum{};
    T total{};
    for (std::uint32_t k = 0; k < sectors; ++k) {
        const T angle = (2 * pi<T> / static_cast<T>(sectors)) * (static_cast<T>(k) + T(0.5));
        T outwards{};
        for (std::uint32_t j = 0; j < rings; ++j, ++radiance) {
            const T value = static_cast<T>(max_component(*radiance));
            const T sine2 = (static_cast<T>(j) + T(0.5)) / static_cast<T>(rings);
            outwards += value * std::sqrt(sine2);
            sum.z += value * std::sqrt(1 - sine2);
            total += value;
        }
        sum.x += outwards * std::cos(angle);
        sum.y += outwards * std::sin(angle);
    }
    return total > 0 ? sum / total : vec3<T>{};
}

}  // namespace aglow
