// A fresh, independent look at one pixel: what an audit asks of an unbiased integrator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <aglow/algorithms/host_faults.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/core/sobol.hpp>

namespace aglow {

/// An unbiased estimate of pixels of the picture that `eye` and `Integrator` make, box-filtered as a `film` is; a
/// `Probe` of aglow/report/audit.hpp. Its numbers depend on (pixel, seed) alone, so the same call gives the same
/// answer. Keeps references; `const`, safe from many threads where the integrator is.
///
/// Where the integrator can be `watched`, as a `path_tracer` can, the light that its host's faults cost is counted, and
/// an audit is not fooled by it.
template <typename Eye, typename Integrator>
class pixel_probe {
public:
    using spectrum = typename Integrator::spectrum;
    static constexpr bool is_watched = requires(const Integrator& i, host_faults& faults) {
        i.watched(faults);
        i.faults();
    };

    pixel_probe(lasting<Eye> eye, lasting<Integrator> integrator, std::size_t width)
        : eye_{*eye}, integrator_{*integrator}, width_{width} {}

    /// Mean of `count` stratified samples of pixel number `pixel`, row by row from the top. Samples of different seeds
    /// are independent.
    [[nodiscard]] spectrum operator()(std::size_t pixel, std::uint64_t seed, std::size_t count) const {
        if constexpr (is_watched) {
            return mean_of(integrator_.watched(*faults_), pixel, seed, count);
        } else {
            return mean_of(integrator_, pixel, seed, count);
        }
    }

    /// Light that faults of the host have cost so far, as a number of samples (see `host_faults::lost`).
    [[nodiscard]] double lost() const requires is_watched {
        return (integrator_.faults() ? *integrator_.faults() : *faults_).lost();
    }

private:
    [[nodiscard]] spectrum mean_of(const Integrator& integrator, std::size_t pixel, std::uint64_t seed,
                                   std::size_t count) const {
        using T = typename Integrator::scalar;
        using wide_sum = typename long_sum<spectrum>::type;
        wide_sum sum{};
        for (std::uint32_t i = 0; i < count; ++i) {
            const sobol_numbers<T> numbers{{mix(seed, 1), seed, pixel}, i};
            const vec2<T> u = numbers.at(0, purpose::camera).next_2d();
            const vec2<T> film{static_cast<T>(pixel % width_) + u.x, static_cast<T>(pixel / width_) + u.y};
            sum = sum + wide_sum(integrator(eye_(film), numbers).value);
        }
        return spectrum(sum * (1 / static_cast<band_of<wide_sum>>(count)));
    }

    const Eye& eye_;
    const Integrator& integrator_;
    std::size_t width_;
    std::shared_ptr<host_faults> faults_{std::make_shared<host_faults>()};
};

template <typename Eye, typename Integrator>
pixel_probe(const Eye&, const Integrator&, std::size_t) -> pixel_probe<Eye, Integrator>;

}  // namespace aglow
