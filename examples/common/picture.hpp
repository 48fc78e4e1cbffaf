// A picture in memory, and its difference to another.
#pragma once

#include <cstddef>
#include <vector>

#include <aglow/core/vec.hpp>

namespace host {

/// Linear RGB, row by row from the top.
struct picture {
    std::size_t width{0};
    std::size_t height{0};
    std::vector<aglow::vec3<float>> pixels{};

    picture() = default;
    picture(std::size_t w, std::size_t h) : width{w}, height{h}, pixels(w * h, aglow::vec3<float>{0}) {}

    [[nodiscard]] aglow::vec3<float>& at(std::size_t column, std::size_t row) { return pixels[row * width + column]; }
    [[nodiscard]] const aglow::vec3<float>& at(std::size_t column, std::size_t row) const {
        return pixels[row * width + column];
    }
};

/// Mean over pixels and bands of (a - b)^2 / (b^2 + 0.01), `b` being the reference. Expects equal sizes.
[[nodiscard]] inline double relative_square_error(const picture& a, const picture& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (int band = 0; band < 3; ++band) {
            const double reference = static_cast<double>(b.pixels[i][band]);
            const double difference = static_cast<double>(a.pixels[i][band]) - reference;
            sum += difference * difference / (reference * reference + 0.01);
        }
    }
    return sum / (3.0 * static_cast<double>(a.pixels.size()));
}

}  // namespace host
