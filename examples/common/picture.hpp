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

/// The same against a reference in two halves that share no random number: the mean of (a - first) (a - second) over
/// their mean squared + 0.01, to which the noise of the halves adds nothing in the mean. May come out below zero.
[[nodiscard]] inline double relative_square_error(const picture& a, const picture& first, const picture& second) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        for (int band = 0; band < 3; ++band) {
            const double one = static_cast<double>(first.pixels[i][band]);
            const double two = static_cast<double>(second.pixels[i][band]);
            const double value = static_cast<double>(a.pixels[i][band]);
            const double reference = (one + two) / 2;
            sum += (value - one) * (value - two) / (reference * reference + 0.01);
        }
    }
    return sum / (3.0 * static_cast<double>(a.pixels.size()));
}

/// Mean over pixels and bands of (first - second)^2 over their mean squared + 0.01: four times what the mean of both is
/// off by, where they are independent.
[[nodiscard]] inline double difference_of_halves(const picture& first, const picture& second) {
    picture mean = first;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
        mean.pixels[i] = (first.pixels[i] + second.pixels[i]) / 2.0f;
    }
    return 4 * relative_square_error(first, mean);
}

}  // namespace host
