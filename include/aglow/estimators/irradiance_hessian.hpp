// How fast the gradient of irradiance changes, occlusion included: what says how far one record may reach.
//
// After Schwarzhaupt et al. 2012, Practical Hessian-Based Error Control, but without their mesh of samples: the same
// strata and the same borders between them as in the gradients tell it too, for a border is an edge, across which
// radiance steps, and the planes seen tell how far its ends are. In the corner of a room it lies where two planes meet,
// where a mesh cuts the corner. Tabulated in angular form, the same for every sector but for a rotation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/edge_derivatives.hpp>
#include <aglow/estimators/hemisphere.hpp>
#include <aglow/estimators/irradiance_gradients.hpp>

namespace aglow {

/// The two curvatures of a symmetric tangent matrix: eigenvalues, the one of larger magnitude first, and its direction.
template <std::floating_point T>
struct principal_curvatures {
    T major{};
    T minor{};
    vec2<T> axis{1, 0};  ///< unit direction of `major`; any where the two are equal
};

/// Closed form without thresholds: any scale, any ratio.
template <std::floating_point T>
[[nodiscard]] principal_curvatures<T> principal(const tangent_matrix<T>& h) {
    const T mean = (h.xx + h.yy) / 2;
    const T difference = (h.xx - h.yy) / 2;
    const T radius = std::hypot(difference, h.xy);
    const T sign = mean < 0 ? T(-1) : T(1);
    principal_curvatures<T> result{mean + sign * radius, mean - sign * radius, {1, 0}};
    if (radius > 0) {
        const T angle = std::atan2(sign * h.xy, sign * difference) / 2;
        result.axis = {std::cos(angle), std::sin(angle)};
    }
    return result;
}

/// The tabulated borders of one shape of hemisphere; made once, used for many.
template <std::floating_point T>
class hessian_weights {
public:
    explicit hessian_weights(const hemisphere_shape& shape) : shape_{shape} {
        const double step = 2 * pi<double> / shape.sectors;
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            rows_.push_back({tabulate(corner(j, 0), corner(j, step)), tabulate(corner(j, 0), corner(j + 1, 0))});
        }
        for (std::uint32_t k = 0; k < shape.sectors; ++k) {
            const auto turn = [&](double angle) {
                return vec2<T>{static_cast<T>(std::cos(angle)), static_cast<T>(std::sin(angle))};
            };
            turns_.push_back({turn(step * k), turn(2 * step * k)});
        }
    }

    /// The part of a border's second derivatives that goes with one product of its reciprocal distances, as
    /// trace / 2, (xx - yy) / 2 and xy.
    struct part {
        T mean{};
        T difference{};
        T mixed{};
    };
    /// A border: with reciprocal distances u - d and u + d at its ends, the parts that go with u², u d and d².
    struct edge {
        part level;
        part mixed;
        part slope;
        vec3<T> half;  ///< from its middle to its second end
    };
    /// The borders of a stratum of one ring in the first sector: to the ring before, none for the first, and to the
    /// sector before.
    struct row {
        edge along;
        edge out;
    };
    /// Cosine and sine of the azimuth at which a sector begins, and of twice as much: how its vectors turn, and its
    /// tangent matrices.
    struct sector {
        vec2<T> once;
        vec2<T> twice;
    };

    [[nodiscard]] const hemisphere_shape& shape() const { return shape_; }
    [[nodiscard]] const std::vector<row>& rows() const { return rows_; }
    [[nodiscard]] const std::vector<sector>& sectors() const { return turns_; }

private:
    [[nodiscard]] vec3<double> corner(std::uint32_t j, double angle) const {
        const double sine2 = static_cast<double>(j) / shape_.rings;
        const double sine = std::sqrt(sine2);
        return {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(1 - sine2)};
    }

    static edge tabulate(const vec3<double>& d0, const vec3<double>& d1) {
        const auto at = [&](double u, double d) { return edge_hessian<double>({d0, d1, u - d, u + d}); };
        const auto part_of = [](const tangent_matrix<double>& h) {
            return part{static_cast<T>((h.xx + h.yy) / 2), static_cast<T>((h.xx - h.yy) / 2), static_cast<T>(h.xy)};
        };
        const tangent_matrix<double> level = at(1, 0);
        const tangent_matrix<double> slope = at(0, 1);
        return {part_of(level), part_of(at(1, 1) + (level + slope) * -1.0), part_of(slope), vec3<T>{(d1 - d0) * 0.5}};
    }

    hemisphere_shape shape_;
    std::vector<row> rows_;
    std::vector<sector> turns_;
};

namespace detail {

/// Mean, half difference and mixed part of a tangent matrix, as sums.
template <std::floating_point T>
struct hessian_sum {
    T mean{};
    T difference{};
    T mixed{};

    void add(const typename hessian_weights<T>::part& p, T strength) {
        mean += p.mean * strength;
        difference += p.difference * strength;
        mixed += p.mixed * strength;
    }
};

/// All borders of one sector that begin in it, radiances taken times `scale`. The horizon is none.
template <Spectrum S, std::floating_point T>
class sector_hessian {
public:
    sector_hessian(const hessian_weights<T>& weights, const hemisphere_grid<S, T>& grid, std::uint32_t sector, T scale)
        : grid_{grid}, scale_{scale}, turn_{weights.sectors()[sector].once} {
        const auto [rings, sectors] = grid.shape();
        std::size_t here = std::size_t{rings} * sector;
        std::size_t before = std::size_t{rings} * (sector == 0 ? sectors - 1 : sector - 1);
        for (std::size_t j = 0; j < rings; ++j, ++here, ++before) {
            add(weights.rows()[j].out, before, here);
            if (j > 0) { add(weights.rows()[j].along, here, here - 1); }
        }
    }
    [[nodiscard]] const hessian_sum<T>& sum() const { return sum_; }

private:
    using edge = typename hessian_weights<T>::edge;

    /// The border between two strata, which the second lies to the left of.
    void add(const edge& e, std::size_t a, std::size_t b) {
        const T step = value(b) - value(a);
        const std::span<const T> u = grid_.inverse_distance();
        const auto [middle, slope] = border_between(u[a], grid_.planes()[a], u[b], grid_.planes()[b]);
        const vec3<T> half{turn_.x * e.half.x - turn_.y * e.half.y, turn_.y * e.half.x + turn_.x * e.half.y, e.half.z};
        // Ends that belong together are as far as each other, as near as the nearer stratum at the most.
        const T rise = glm::dot(slope, half);
        const T first = std::clamp(middle - rise, T(0), std::max(u[a], u[b]));
        const T second = std::clamp(middle + rise, T(0), std::max(u[a], u[b]));
        const T level = (first + second) / 2;
        const T d = (second - first) / 2;
        sum_.add(e.level, level * level * step);
        sum_.add(e.mixed, level * d * step);
        sum_.add(e.slope, d * d * step);
    }
    [[nodiscard]] T value(std::size_t i) const { return static_cast<T>(max_component(grid_.radiance()[i])) * scale_; }

    const hemisphere_grid<S, T>& grid_;
    T scale_;
    vec2<T> turn_;
    hessian_sum<T> sum_{};
};

/// One over the mean of the radiances' largest bands; 0 where all are black.
template <Spectrum S, std::floating_point T>
[[nodiscard]] T over_mean(const hemisphere_grid<S, T>& grid) {
    T sum{};
    for (const S& l : grid.radiance()) { sum += static_cast<T>(max_component(l)); }
    return sum > 0 ? static_cast<T>(grid.shape().count()) / sum : T(0);
}

}  // namespace detail

/// Second derivatives of irradiance over irradiance, in local axes, per length²; of the largest band, with occlusion.
/// Expects weights of the grid's shape.
template <Spectrum S, std::floating_point T>
[[nodiscard]] tangent_matrix<T> relative_hessian(const hemisphere_grid<S, T>& grid, const hessian_weights<T>& weights) {
    const T scale = detail::over_mean(grid);
    tangent_matrix<T> total;
    for (std::uint32_t k = 0; k < grid.shape().sectors; ++k) {
        const detail::hessian_sum<T> s = detail::sector_hessian<S, T>{weights, grid, k, scale}.sum();
        const vec2<T> turn = weights.sectors()[k].twice;
        const T difference = s.difference * turn.x - s.mixed * turn.y;
        const T mixed = s.difference * turn.y + s.mixed * turn.x;
        total = total + tangent_matrix<T>{s.mean + difference, mixed, s.mean - difference};
    }
    return total;
}

}  // namespace aglow
