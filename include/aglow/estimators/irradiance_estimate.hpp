// What one hemisphere of samples tells about the light at a point.
#pragma once

#include <concepts>
#include <cstdint>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/hemisphere.hpp>
#include <aglow/estimators/irradiance_gradients.hpp>
#include <aglow/estimators/irradiance_hessian.hpp>
#include <aglow/estimators/linear_light.hpp>

namespace aglow {

/// Irradiance at a point with its derivatives, what is near, and how sure it is. In full precision: what records are
/// made from. A host that has irradiance from elsewhere fills in what it knows; zeros mean flat, open and sure.
template <Spectrum S, std::floating_point T>
struct irradiance_estimate {
    vec3<T> position{};
    frame<T> axes{};  ///< z is the normal; what follows is given along x and y
    S irradiance{};   ///< W/m²
    irradiance_gradients<S> gradients{};
    tangent_matrix<T> curvature{};  ///< second derivatives over irradiance, 1/length²
    T mean_inverse_distance{};      ///< one over the harmonic mean distance; 0 = open sky
    T nearest_inverse_distance{};   ///< one over the distance to the nearest thing seen
    vec3<T> incident{};             ///< mean direction to the light along `axes`; length tells concentration
    T misfit{};                     ///< what light linear in direction leaves out: see `linear_misfit`
    T relative_noise{};             ///< standard error over irradiance, of the largest band
    std::uint32_t rays{};           ///< samples taken
    std::uint32_t rejected{};       ///< of these, how many were no numbers
};

/// Which parts of an estimate to work out; the rest stay zero.
struct estimate_parts {
    bool gradients{true};  ///< needed by records with gradients, and to limit the reach
    bool curvature{true};  ///< needed where the Hessian sets the reach
    bool incident{false};  ///< needed by glossy surfaces
};

/// Tables for one shape of hemisphere, to make estimates from. Immutable; share it among threads.
template <std::floating_point T>
class irradiance_estimator {
public:
    explicit irradiance_estimator(const hemisphere_shape& shape, const estimate_parts& parts = {})
        : gradient_weights_{shape}, hessian_weights_{shape}, parts_{parts} {}

    [[nodiscard]] const hemisphere_shape& shape() const { return gradient_weights_.shape(); }
    [[nodiscard]] const estimate_parts& parts() const { return parts_; }

    /// Expects a grid of `shape()`, sampled in `axes`.
    template <Spectrum S>
    [[nodiscard]] irradiance_estimate<S, T> operator()(const hemisphere_grid<S, T>& grid, const vec3<T>& position,
                                                       const frame<T>& axes) const {
        irradiance_estimate<S, T> result;
        result.position = position;
        result.axes = axes;
        result.irradiance = grid.irradiance();
        if (parts_.gradients) { result.gradients = gradients(grid, gradient_weights_); }
        if (parts_.curvature) { result.curvature = relative_hessian(grid, hessian_weights_); }
        if (parts_.incident) {
            result.incident = incident_direction(grid);
            result.misfit = linear_misfit(grid, result.incident);
        }
        result.mean_inverse_distance = grid.mean_inverse_distance();
        result.nearest_inverse_distance = grid.nearest_inverse_distance();
        result.relative_noise = relative_noise(grid);
        result.rays = shape().count();
        result.rejected = grid.rejected();
        return result;
    }

private:
    gradient_weights<T> gradient_weights_;
    hessian_weights<T> hessian_weights_;
    estimate_parts parts_;
};

}  // namespace aglow
