// What to ask of a density estimate, and what comes back.
#pragma once

#include <cstdint>

#include <aglow/estimators/estimate.hpp>
#include <aglow/estimators/kernel.hpp>

namespace aglow {

/// How photons around a point become irradiance there.
struct density_options {
    std::uint32_t count{50};  ///< photons of an estimate: the noise is about 1.15 / sqrt(count); one alone tells no
                              ///< density, so at least 2; 0 for all within the radius
    double max_radius{0};     ///< search radius in scene units; 0 for one that the map finds from its own density
    double shrink{1};  ///< share of the k-th photon's distance, or of the search radius where that is nearer, that
                       ///< is used; below 1 for progressive passes, no bias added
    kernel_shape kernel{kernel_shape::epanechnikov};
    double plane_tolerance{0.2};  ///< how far off the tangent plane a photon may be, as a share of its distance
    double normal_cosine{0.7};    ///< least cosine between the normals here and at the photon
};

/// Irradiance or radiance from photons, the guess of its error (noise, and what two radii on the same photons differ
/// by), and what it was made of. `count` = 0 and black where no photon is within reach.
template <Spectrum S, std::floating_point T>
struct density_estimate : estimate<S> {
    std::uint32_t count{0};  ///< photons used
    T radius{0};             ///< radius that they were spread over

    /// From the same photons, each with so many times the power.
    [[nodiscard]] density_estimate times(band_of<S> factor) const {
        const estimate<S>& e = *this;
        return {{e.value * factor, e.error * factor, e.common * factor, e.bias * factor}, count, radius};
    }
};

}  // namespace aglow
