// A picture seen as plain numbers.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include <aglow/core/numbers.hpp>
#include <aglow/report/running_mean.hpp>

namespace aglow {

/// A picture that somebody else owns: `channels` numbers a pixel, pixel after pixel, row after row.
template <std::floating_point T>
struct image_view {
    std::span<const T> values;
    std::size_t width{0};
    std::size_t height{0};
    std::size_t channels{1};

    [[nodiscard]] constexpr std::size_t pixels() const { return width * height; }

    [[nodiscard]] constexpr double at(std::size_t pixel, std::size_t channel) const {
        return static_cast<double>(values[pixel * channels + channel]);
    }

    /// The pixel as one number: the plain mean of its channels, the one reduction of colour used in reports.
    [[nodiscard]] constexpr double gray(std::size_t pixel) const {
        double sum = 0;
        for (std::size_t c = 0; c < channels; ++c) { sum += at(pixel, c); }
        return sum / static_cast<double>(channels);
    }

    /// Whether no channel of the pixel is infinite or NaN.
    [[nodiscard]] constexpr bool finite(std::size_t pixel) const {
        for (std::size_t c = 0; c < channels; ++c) {
            if (!is_finite(values[pixel * channels + c])) { return false; }
        }
        return true;
    }
};

/// Throws `std::invalid_argument` that names `what` unless the view's sizes fit its numbers and at least one pixel is
/// there.
template <std::floating_point T>
void require_whole(const image_view<T>& image, const std::string& what) {
    if (image.channels == 0 || image.pixels() == 0 || image.values.size() != image.pixels() * image.channels) {
        throw std::invalid_argument(what + ": " + std::to_string(image.values.size()) + " values do not make " +
                                    std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels of " +
                                    std::to_string(image.channels) + " channels");
    }
}

/// Throws `std::invalid_argument` unless both pictures are whole and of one shape.
template <std::floating_point T, std::floating_point U>
void require_same_shape(const image_view<T>& image, const image_view<U>& other, const std::string& what) {
    require_whole(image, "image");
    require_whole(other, what);
    if (image.width == other.width && image.height == other.height && image.channels == other.channels) { return; }
    throw std::invalid_argument(what + ": not of the same width, height and channels as the image");
}

/// Pixels with an infinite or NaN channel.
template <std::floating_point T>
[[nodiscard]] std::size_t count_broken_pixels(const image_view<T>& image) {
    std::size_t broken = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) { broken += image.finite(i) ? 0 : 1; }
    return broken;
}

/// Mean of all finite values of all channels; 0 where there are none.
template <std::floating_point T>
[[nodiscard]] double mean_value(const image_view<T>& image) {
    running_mean all;
    for (const T x : image.values) { all.add(static_cast<double>(x)); }
    return all.mean();
}

}  // namespace aglow
