// A picture that takes samples: as many more as one likes, the same for any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/concepts/light.hpp>
#include <aglow/core/callback.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/estimators/estimate.hpp>

namespace aglow {

/// How a film is exposed.
struct film_options {
    std::uint32_t samples{16};  ///< samples per pixel to add; sets of a power of two are spread best
    std::uint64_t seed{0};
    std::uint64_t pass{0};
    bool fresh{false};  ///< the integrator's maps are new ones: what its samples have in common is not what earlier
                        ///< ones had. Of exposures of one sample each, the spread of samples then tells all noise
    callback<double> progress{};  ///< told the share done, from any thread; false stops early
};

/// How far the mean of a whole picture may be off, W/(m² sr): its pixels' errors do not average out where they have
/// them in common.
struct mean_error {
    double bias{0};   ///< by how much it may be too bright, with its sign
    double noise{0};  ///< one standard deviation: of the samples, and of what they have in common

    /// A guess of the whole error, the noise at so many standard deviations.
    [[nodiscard]] double within(double sigmas = 2) const { return std::abs(bias) + sigmas * noise; }
};

/// Pixels of mean radiance over a box of one pixel, row 0 on top. Samples without a finite value are left out and
/// counted. One thread at a time may expose it.
template <Spectrum S>
class film {
public:
    using B = band_of<S>;

    film(std::size_t width, std::size_t height) : width_{width}, height_{height}, pixels_(width * height) {}

    [[nodiscard]] std::size_t width() const { return width_; }
    [[nodiscard]] std::size_t height() const { return height_; }

    /// Samples that a pixel has taken; the next exposure goes on from there.
    [[nodiscard]] std::uint32_t samples() const { return samples_; }
    /// Samples left out because their value was NaN, infinite or negative. What is wrong in a host's answers is cut out
    /// of a path before that, and counted in `path_options::faults`.
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

    /// Mean radiance of a pixel, W/(m² sr).
    [[nodiscard]] S radiance(std::size_t x, std::size_t y) const {
        const pixel& p = pixels_[y * width_ + x];
        return p.count == 0 ? S{} : S(p.sum * (1 / static_cast<band_of<wide_sum>>(p.count)));
    }

    /// A guess of a pixel's error: the mean of what the integrator guessed, and the standard error of its samples.
    /// Where every exposure was fresh and of one sample, that error tells the maps' noise too: the bias, and twice that
    /// error.
    [[nodiscard]] B error(std::size_t x, std::size_t y) const {
        const pixel& p = pixels_[y * width_ + x];
        if (p.count == 0) { return B(0); }
        const double n = p.count;
        // One sample alone may be off by all of itself.
        const double error = p.count == 1 ? p.level : std::sqrt(p.variance());
        return static_cast<B>(fresh_ && p.count > 1 ? std::abs(p.bias) / n + 2 * error : p.guess / n + error);
    }

    /// A guess of the error of the mean of all pixels: what the integrator says that its estimates have in common, and
    /// the noise of the samples. Of the largest band.
    [[nodiscard]] mean_error error_of_mean() const {
        double count = 0;
        double bias = 0;
        double variance = 0;
        for (const pixel& p : pixels_) {
            count += p.count;
            bias += p.bias;
            variance += p.count > 1 ? square(static_cast<double>(p.count)) * p.variance() : square(p.level);
        }
        if (count == 0) { return {}; }
        return {bias / count, std::sqrt(variance + common2_ + square(common_)) / count};
    }

    /// Adds samples: `eye(film_point)` is the ray through a point in pixels, `integrator(ray, numbers)` an `estimate`
    /// of what comes back along it; its member type `scalar` is what points and rays are made of. What either throws
    /// comes out of here, and leaves a film that some pixels have more samples of than others: its errors of pixels are
    /// right, `error_of_mean` knows nothing of this exposure's errors in common.
    template <typename Eye, typename Integrator, Executor Run = in_sequence>
    void expose(const Eye& eye, const Integrator& integrator, const film_options& options = {}, const Run& run = {}) {
        std::atomic<std::size_t> rows{0};
        std::atomic<std::uint64_t> dropped{0};
        std::atomic<bool> stop{false};
        std::vector<double> common(height_);
        const std::uint32_t first = samples_;
        samples_ += options.samples;  // before the host may throw: no sample is to be taken twice
        run(height_, [&](std::size_t y) {
            if (stop) { return; }
            // Summed up here: rows next to one another share a line of memory, which threads would take from each
            // other.
            double in_common = 0;
            std::uint64_t left_out = 0;
            for (std::size_t x = 0; x < width_; ++x) {
                left_out += take(x, y, eye, integrator, first, options, in_common);
            }
            common[y] = in_common;
            dropped += left_out;
            const double share = static_cast<double>(++rows) / static_cast<double>(height_);
            if (options.progress && !options.progress(share)) { stop = true; }
        });
        double all = 0;
        for (const double row : common) { all += row; }
        (options.fresh ? common2_ : common_) += options.fresh ? square(all) : all;
        fresh_ = options.fresh && options.samples == 1 && (fresh_ || first == 0);
        dropped_ += dropped;
    }

private:
    using wide_sum = typename long_sum<S>::type;

    struct pixel {
        // In double: the last of a million samples would be rounded off, squares of faint light leave the range of
        // floats, and a mean far above its spread hides it.
        wide_sum sum{};
        double guess{0};
        double level{0};
        double level2{0};
        double bias{0};
        std::uint32_t count{0};

        /// Of the mean of more than one sample.
        [[nodiscard]] double variance() const {
            const double n = count;
            return std::max(0.0, level2 / n - square(level / n)) / (n - 1);
        }
    };

    template <typename Eye, typename Integrator>
    std::uint64_t take(std::size_t x, std::size_t y, const Eye& eye, const Integrator& integrator, std::uint32_t first,
                       const film_options& options, double& common) {
        using T = typename Integrator::scalar;
        pixel& p = pixels_[y * width_ + x];
        const std::uint32_t before = p.count;
        for (std::uint32_t i = first; i < first + options.samples; ++i) {
            const sobol_numbers<T> numbers{{options.seed, options.pass, y * width_ + x}, i};
            const vec2<T> u = numbers.at(0, purpose::camera).next_2d();
            const estimate<S> seen =
                integrator(eye(vec2<T>{static_cast<T>(x) + u.x, static_cast<T>(y) + u.y}), numbers);
            if (!is_radiance(seen.value)) { continue; }
            add(p, seen);
            common += is_finite(seen.common) ? static_cast<double>(seen.common) : 0.0;
        }
        return options.samples - (p.count - before);
    }

    static void add(pixel& p, const estimate<S>& seen) {
        const double level = static_cast<double>(max_component(seen.value));
        p.sum = p.sum + wide_sum(seen.value);
        p.guess += is_finite(seen.error) ? static_cast<double>(seen.error) : 0.0;
        p.level += level;
        p.level2 += level * level;
        p.bias += is_finite(seen.bias) ? static_cast<double>(seen.bias) : 0.0;
        ++p.count;
    }

    std::size_t width_;
    std::size_t height_;
    std::vector<pixel> pixels_;
    std::uint32_t samples_{0};
    std::uint64_t dropped_{0};
    double common_{0};   ///< sum of what samples have in common with all others
    double common2_{0};  ///< sum of squares of the same of fresh exposures
    bool fresh_{false};  ///< whether every exposure was, and of one sample
};

}  // namespace aglow
