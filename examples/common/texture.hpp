// A picture on a surface: looked up by two coordinates, repeated, smooth between its pixels.
#pragma once

#include <cmath>
#include <cstddef>

#include "picture.hpp"

namespace host {

/// The colour of `image` at (u, v); v goes up from the lowest row, and both repeat with 1. White for an empty image or
/// coordinates that are no numbers.
[[nodiscard]] inline aglow::vec3<float> texture_colour(const picture& image, float u, float v) {
    if (image.pixels.empty() || !std::isfinite(u) || !std::isfinite(v)) { return aglow::vec3<float>{1}; }
    const auto wrapped = [](float x, std::size_t size) {
        const float n = static_cast<float>(size);
        return (x - std::floor(x)) * n - 0.5f;
    };
    const float x = wrapped(u, image.width);
    const float y = wrapped(1 - v, image.height);
    const auto index = [](float at, std::size_t size) {
        return (static_cast<std::size_t>(at + static_cast<float>(size))) % size;
    };
    const float left = std::floor(x);
    const float top = std::floor(y);
    const auto row = [&](float at) {
        const std::size_t r = index(at, image.height);
        const aglow::vec3<float> a = image.at(index(left, image.width), r);
        return a + (image.at(index(left + 1, image.width), r) - a) * (x - left);
    };
    const aglow::vec3<float> a = row(top);
    return a + (row(top + 1) - a) * (y - top);
}

}  // namespace host
