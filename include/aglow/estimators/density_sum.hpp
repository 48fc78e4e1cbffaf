// Flux over a disc: the light that photons make there, and how far their own scatter lets that be off.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/density.hpp>

namespace aglow::detail {

/// Adds photons up, once over the whole disc and once over half its radius.
template <Spectrum S, std::floating_point T, typename Kernel>
struct density_sum {
    using B = band_of<S>;
    using wide_sum = typename long_sum<S>::type;
    [[no_unique_address]] Kernel kernel;
    T radius2;
    B unit;
    S wide{};
    S narrow{};
    wide_sum wide_before{};  ///< sums of earlier sets of 16: one long sum of floats stands still
    wide_sum narrow_before{};
    double noise2{0};  ///< squares of faint light leave the range of floats
    double mass{0};
    vec3<double> moment{};  ///< of `mass` around the point
    std::uint32_t count{0};

    /// A photon so far away in that direction, whose flux is what `weigh` makes of `p`.
    template <typename Item, typename Weigh>
    void add(T distance2, const vec3<T>& away, const Item& p, Weigh& weigh) {
        // The k-th lies on the rim and does not count: that is the unbiased rule. Asked of the squares themselves,
        // since -ffast-math may divide by multiplying.
        if (!(distance2 < radius2)) { return; }
        const T rho2 = distance2 / radius2;
        const S flux = weigh(p);
        const S share = flux * B(kernel(rho2));
        wide = wide + share;
        noise2 += square(static_cast<double>(max_component(share)));
        const double weight = static_cast<double>(max_component(flux));
        mass += weight;
        moment += vec3<double>(away) * weight;
        if (rho2 < T(0.25)) { narrow = narrow + flux * B(4 * kernel(4 * rho2)); }
        if (++count % 16 == 0) { close_set(); }
    }

    void close_set() {
        wide_before = wide_before + static_cast<wide_sum>(wide);
        narrow_before = narrow_before + static_cast<wide_sum>(narrow);
        wide = S{};
        narrow = S{};
    }

    /// What an uneven density may hide from two radii, as a share of the value. They see nothing of a border
    /// through the middle of the disc, and cross each other elsewhere; but it pulls the photons' mean off the
    /// centre: by `lean` quarters of the radius, 1 where light falls to nothing at the rim, 1.7 where half of the
    /// disc is dark, and then as much is missing as is there: 0.35 lean² (0.35 1.7² = 1).
    [[nodiscard]] double hidden() const {
        if (!(mass > 0)) { return 0; }
        const double lean2 = 16 * length2(moment / (mass * std::sqrt(static_cast<double>(radius2))));
        // Chance alone leans the photons of even light by 8 / count in the mean.
        return 0.35 * std::max(0.0, lean2 - 8.0 / count);
    }

    [[nodiscard]] density_estimate<S, T> result() {
        if (!(radius2 > 0)) { return {}; }
        close_set();
        const B scale = B(1 / radius2) * unit;
        // Bias goes as radius², so the wider estimate is off by 1 / (1 - 1/4) of what lies between both.
        const S value = static_cast<S>(wide_before);
        const S apart = static_cast<S>(wide_before + narrow_before * band_of<wide_sum>(-1)) * (B(4) / 3);
        const B above = max_component(apart);
        const B below = max_component(S(apart * B(-1)));
        const B noise = B(std::sqrt(noise2));
        const B border = B(hidden() * static_cast<double>(max_component(value)));
        // Across edges, where most of a picture's bias is, it goes as the radius: half of it lies between both.
        const B shared = B(1.5) * (above < below ? -below : above);
        return {{.value = value * scale,
                 .error = (std::max(above, below) + 2 * noise + border) * scale,
                 .bias = shared * scale},
                count,
                std::sqrt(radius2)};
    }
};

}  // namespace aglow::detail
