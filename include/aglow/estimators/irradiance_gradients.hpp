// How irradiance changes when the point moves and the normal turns, from the same samples as irradiance itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/hemisphere.hpp>

namespace aglow {

/// A vector of the tangent plane, for every band.
template <Spectrum S>
struct tangent_vector {
    S x{};
    S y{};
    friend bool operator==(const tangent_vector&, const tangent_vector&) = default;
};

/// Derivatives of irradiance in local axes. To first order
/// E(p + d, n') = E + translation · d + rotation · (n × n'). `translation` is per unit of length, `rotation` per
/// radian.
template <Spectrum S>
struct irradiance_gradients {
    tangent_vector<S> translation{};
    tangent_vector<S> rotation{};
    friend bool operator==(const irradiance_gradients&, const irradiance_gradients&) = default;
};

/// The weights of Ward & Heckbert 1992, Irradiance Gradients, for one shape of hemisphere; made once, used for many.
template <std::floating_point T>
class gradient_weights {
public:
    explicit gradient_weights(const hemisphere_shape& shape) : shape_{shape} {
        for (std::uint32_t j = 0; j < shape.rings; ++j) { add_ring(j); }
        const T step = 2 * pi<T> / static_cast<T>(shape.sectors);
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            const T edge = step * static_cast<T>(k);
            const T centre = step * (static_cast<T>(k) + T(0.5));
            sectors_.push_back({{std::cos(centre), std::sin(centre)}, {-std::sin(edge), std::cos(edge)}});
        }
    }

    struct ring {
        T radial;  ///< of a border between this ring and the one before: (2 pi/N) sin cos², over the border's distance
        T turning;   ///< of a border between two sectors: the integral of cos/r along it, exact
        T rotation;  ///< mean of tan over the stratum, times pi / strata
    };
    struct sector {
        vec2<T> centre;    ///< direction of the sector's middle
        vec2<T> sideways;  ///< direction in which its first edge moves: 90 degrees ahead
    };

    [[nodiscard]] const hemisphere_shape& shape() const { return shape_; }
    [[nodiscard]] const std::vector<ring>& rings() const { return rings_; }
    [[nodiscard]] const std::vector<sector>& sectors() const { return sectors_; }

private:
    void add_ring(std::uint32_t j) {
        const double rings = shape_.rings;
        const double low = std::asin(std::sqrt(j / rings));
        const double high = std::asin(std::sqrt((j + 1) / rings));
        const double radial = (2 * pi<double> / shape_.sectors) * std::sin(low) * square(std::cos(low));
        // The sector's edge moves at 1/(r sin) per unit; cos sin / (r sin) integrates to the difference of sines.
        const double turning = std::sin(high) - std::sin(low);
        // Mean of tan over a stratum of equal sin²: finite at the horizon, where tan at a sample is not.
        const double tangent =
            rings * ((high - std::sin(high) * std::cos(high)) - (low - std::sin(low) * std::cos(low)));
        rings_.push_back(
            {static_cast<T>(radial), static_cast<T>(turning), static_cast<T>(tangent * pi<double> / shape_.count())});
    }

    hemisphere_shape shape_;
    std::vector<ring> rings_;
    std::vector<sector> sectors_;
};

namespace detail {

/// The border between two neighbouring strata: one over its distance, and how that changes along it with direction.
template <std::floating_point T>
struct seen_border {
    T inverse_distance;
    vec3<T> slope;
};

/// Where the border between two neighbouring strata lies: what it moves by when the point does. Two planes that meet
/// between the strata, as in the corner of a room, have their border where they meet; else the nearer one hides the
/// other. Never nearer than the nearer stratum.
template <std::floating_point T>
[[nodiscard]] seen_border<T> border_between(T u, const seen_plane<T>& plane, T v, const seen_plane<T>& other) {
    const vec3<T> way = other.direction - plane.direction;
    const T u_there = u + glm::dot(plane.slope, way);
    const T v_here = v - glm::dot(other.slope, way);
    const T in_front = u - v_here;
    const T in_front_there = u_there - v;
    const T apart = in_front - in_front_there;
    const bool meet = (in_front < 0) != (in_front_there < 0);
    const bool alike = std::abs(in_front) + std::abs(in_front_there) < T(1e-3) * (u + v);
    if (alike) { return {(u + v) / 2, (plane.slope + other.slope) / T(2)}; }
    const T most = std::max(u, v);
    if (meet) {
        const T there = u + (u_there - u) * (in_front / apart);
        return {std::clamp(there, T(0), most), (plane.slope + other.slope) / T(2)};
    }
    if (in_front > 0) { return {std::clamp((u + u_there) / 2, T(0), most), plane.slope}; }
    return {std::clamp((v + v_here) / 2, T(0), most), other.slope};
}

/// The sums over one sector of Ward & Heckbert's gradients, before they get their directions.
template <Spectrum S>
struct sector_sums {
    S radial{};
    S turning{};
    S rotation{};
};

template <Spectrum S, std::floating_point T>
[[nodiscard]] sector_sums<S> sum_sector(const gradient_weights<T>& weights, const hemisphere_grid<S, T>& grid,
                                        std::size_t here, std::size_t before) {
    const S* l = grid.radiance().data() + here;
    const T* u = grid.inverse_distance().data() + here;
    const seen_plane<T>* plane = grid.planes().data() + here;
    const S* l_before = grid.radiance().data() + before;
    const T* u_before = grid.inverse_distance().data() + before;
    const seen_plane<T>* plane_before = grid.planes().data() + before;
    sector_sums<S> sums;
    const auto& rings = weights.rings();
    for (std::size_t j = 0; j < rings.size(); ++j) {
        const T turning =
            rings[j].turning * border_between(u[j], plane[j], u_before[j], plane_before[j]).inverse_distance;
        sums.turning = sums.turning + (l[j] + l_before[j] * T(-1)) * turning;
        sums.rotation = sums.rotation + l[j] * rings[j].rotation;
        if (j == 0) { continue; }
        const T radial = rings[j].radial * border_between(u[j], plane[j], u[j - 1], plane[j - 1]).inverse_distance;
        sums.radial = sums.radial + (l[j] + l[j - 1] * T(-1)) * radial;
    }
    return sums;
}

}  // namespace detail

/// Gradients of `grid.irradiance()` in local axes (Ward & Heckbert 1992, with the exact weights of both integrals).
/// Expects weights of the grid's shape. Occlusion counts: where something near hides something far, it moves faster.
template <Spectrum S, std::floating_point T>
[[nodiscard]] irradiance_gradients<S> gradients(const hemisphere_grid<S, T>& grid, const gradient_weights<T>& weights) {
    const auto [rings, sectors] = grid.shape();
    irradiance_gradients<S> sum;
    for (std::uint32_t k = 0; k < sectors; ++k) {
        const std::size_t here = std::size_t{k} * rings;
        const std::size_t before = std::size_t{k == 0 ? sectors - 1 : k - 1} * rings;
        const detail::sector_sums<S> s = detail::sum_sector(weights, grid, here, before);
        const auto& [centre, sideways] = weights.sectors()[k];
        sum.translation.x = sum.translation.x + (s.radial * centre.x + s.turning * sideways.x);
        sum.translation.y = sum.translation.y + (s.radial * centre.y + s.turning * sideways.y);
        sum.rotation.x = sum.rotation.x + s.rotation * -centre.y;
        sum.rotation.y = sum.rotation.y + s.rotation * centre.x;
    }
    if (grid.rejected() == 0) { return sum; }
    const T scale = grid.sample_weight() * static_cast<T>(grid.shape().count()) / pi<T>;
    const auto scaled = [scale](const tangent_vector<S>& v) { return tangent_vector<S>{v.x * scale, v.y * scale}; };
    return {scaled(sum.translation), scaled(sum.rotation)};
}

}  // namespace aglow
