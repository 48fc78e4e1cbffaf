// Pictures inside a page: PNG without compression, as a data URI.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace error_vs_time {

/// A PNG file of 8-bit RGB pixels, row by row. Throws `std::invalid_argument` where the sizes do not fit.
[[nodiscard]] std::vector<std::uint8_t> png(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height);

/// RFC 4648.
[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

/// "data:image/png;base64,…"
[[nodiscard]] std::string png_uri(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height);

/// Linear light as 8-bit sRGB; broken numbers are magenta, so that they are seen.
[[nodiscard]] std::vector<std::uint8_t> shown(std::span<const float> linear_rgb, double exposure = 1);

/// `|image - reference| / (reference + floor)` of each pixel's mean of channels in false colour: black at 0 over violet
/// and orange to pale yellow at `full` and beyond. Broken numbers are magenta.
[[nodiscard]] std::vector<std::uint8_t> shown_error(std::span<const float> image_rgb,
                                                    std::span<const float> reference_rgb, double floor,
                                                    double full = 0.2);

}  // namespace error_vs_time
