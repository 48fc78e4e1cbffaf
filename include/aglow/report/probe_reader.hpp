// What one probe says of its pixel: of the light, of the picture's error there, and of its own noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <aglow/report/image_view.hpp>
#include <aglow/report/probe.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow::detail {

/// What an error probably is, and the standard error of that.
struct likely_error {
    double error{0};
    double deviation{0};
};

/// √(2F² − G²), F and G the means of `all` and `halves`: E|e+n|² is about e² + c·Var n, and that of halves twice as far
/// off. Where noise is nearly all that was seen, a third of it is left, and little is sure.
[[nodiscard]] inline likely_error without_noise(std::span<const double> all, std::span<const double> halves) {
    const double f = mean_of(all).mean();
    const double g = mean_of(halves).mean();
    const double error = std::sqrt(std::max(2 * f * f - g * g, f * f / 9));
    running_mean influence;
    for (std::size_t i = 0; i < all.size(); ++i) { influence.add((2 * f * all[i] - g * halves[i]) / error); }
    return {error, influence.standard_error()};
}

/// All batches of a probe.
inline constexpr unsigned every_batch = (1u << probe_batches) - 1;

/// Reads probes of `image`, relative to the light but at least to `floor`.
template <std::floating_point T>
struct probe_reader {
    image_view<T> image;
    double floor;

    /// The light by the chosen batches, averaged over channels.
    [[nodiscard]] double gray(const probe_record& r, unsigned chosen) const {
        double sum = 0;
        for (std::size_t c = 0; c < r.channels; ++c) { sum += r.mean(chosen, c); }
        return sum / static_cast<double>(r.channels);
    }

    /// Relative error by the chosen batches, over the best estimate of the truth: a few dark batches cannot blow it up.
    [[nodiscard]] double error(const probe_record& r, unsigned chosen) const {
        double sum = 0;
        for (std::size_t c = 0; c < r.channels; ++c) {
            const double gap = std::abs(image.at(r.pixel, c) - r.mean(chosen, c));
            sum += gap > 0 ? gap / below(r, c) : 0;
        }
        return sum / static_cast<double>(r.channels);
    }

    /// Relative error by each batch, with the sign that the other seven give it, averaged: these may get the sign
    /// wrong, so that the expectation is at most the error's size, whatever the law of the noise.
    [[nodiscard]] double error_by_others(const probe_record& r) const {
        double sum = 0;
        for (std::size_t c = 0; c < r.channels; ++c) {
            for (unsigned one = 1; one < every_batch; one *= 2) {
                const double gap = image.at(r.pixel, c) - r.mean(one, c);
                const bool is_dark = image.at(r.pixel, c) < r.mean(every_batch ^ one, c);
                sum += gap != 0 ? (is_dark ? -gap : gap) / below(r, c) : 0;
            }
        }
        return sum / static_cast<double>(probe_batches * r.channels);
    }

    [[nodiscard]] double below(const probe_record& r, std::size_t c) const { return std::max(r.mean(c), 0.0) + floor; }

    [[nodiscard]] double darkest(const probe_record& r) const {
        double least = std::numeric_limits<double>::max();
        for (std::size_t c = 0; c < r.channels; ++c) { least = std::min(least, below(r, c)); }
        return least;
    }

    /// Relative variance of the best estimate: what its noise in the denominator can take off the mean error at most.
    [[nodiscard]] double denominator_noise2(const probe_record& r) const {
        double sum = 0;
        for (std::size_t c = 0; c < r.channels; ++c) {
            const double variance = r.batch_variance(c) / probe_batches;
            sum += variance > 0 ? std::min(1.0, variance / square(below(r, c))) : 0;
        }
        return sum / static_cast<double>(r.channels);
    }

    /// Relative standard deviation of one batch, averaged over channels.
    [[nodiscard]] double spread(const probe_record& r) const {
        double sum = 0;
        for (std::size_t c = 0; c < r.channels; ++c) {
            const double deviation = std::sqrt(r.batch_variance(c));
            sum += deviation > 0 ? deviation / below(r, c) : 0;
        }
        return sum / static_cast<double>(r.channels);
    }

    /// Size of the noise: the mean distance between halves of the batches.
    [[nodiscard]] double apart(const probe_record& r) const {
        return mean_over_choices<4>(
            [&](unsigned half) { return std::abs(gray(r, half) - gray(r, half ^ every_batch)); });
    }

    /// What light is measured by here.
    [[nodiscard]] double scale(const probe_record& r) const { return std::max(gray(r, every_batch), 0.0) + floor; }
};

}  // namespace aglow::detail
