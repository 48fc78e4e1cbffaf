// Pictures whose truth is known exactly, damaged in known ways, and probes with known noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/report/audit_result.hpp>
#include <aglow/report/audit_sample.hpp>

namespace synthetic {

/// Least share of R certificates that must hold at nominal 95 %: a right method falls below in 1 of 100 tests.
inline double least_coverage(int rounds) { return 0.95 - 2.33 * std::sqrt(0.95 * 0.05 / rounds); }

inline double normal(aglow::random_sampler<double>& random) {
    const double radius = std::sqrt(-2 * std::log(1 - random.next_1d()));
    return radius * std::cos(2 * aglow::pi<double> * random.next_1d());
}

inline double normal_of(std::uint64_t seed) {
    aglow::random_sampler<double> random{aglow::mix(seed)};
    return normal(random);
}

/// Mean of `count` independent exponential numbers of mean 1, at the cost of one (Marsaglia & Tsang 2000).
inline double exponential_mean(aglow::random_sampler<double>& random, std::size_t count) {
    const double d = static_cast<double>(count) - 1.0 / 3;
    for (;;) {
        const double x = normal(random);
        const double v = std::pow(1 + x / std::sqrt(9 * d), 3);
        if (v > 0 && std::log(1 - random.next_1d()) < 0.5 * x * x + d - d * v + d * std::log(v)) {
            return d * v / static_cast<double>(count);
        }
    }
}

/// Whether `act` throws `std::invalid_argument` with a message that begins with `name`.
template <typename Act>
bool refuses(const std::string& name, const Act& act) {
    try {
        act();
    } catch (const std::invalid_argument& error) { return std::string{error.what()}.find(name) == 0; }
    return false;
}

enum class damage { none, noise, too_bright, outliers, edges, waves, dark };

/// A picture of 64 x 64 gray pixels: a ramp, a disc in shadow with a rim (class 1), a nearly black stripe.
struct field {
    static constexpr std::size_t side = 64;
    static constexpr std::size_t pixels = side * side;
    std::vector<double> truth = std::vector<double>(pixels);
    std::vector<double> picture = std::vector<double>(pixels);
    std::vector<double> guess = std::vector<double>(pixels);
    std::vector<std::uint32_t> classes = std::vector<std::uint32_t>(pixels);

    explicit field(damage kind, std::uint64_t seed = 0) {
        for (std::size_t i = 0; i < pixels; ++i) {
            const double x = static_cast<double>(i % side) / side;
            const double y = static_cast<double>(i / side) / side;
            const double radius = std::hypot(x - 0.5, y - 0.5);
            truth[i] = y > 0.9 ? 0.001 * (x + 0.1) : (radius < 0.3 ? 0.05 : 1.0) * (0.2 + 0.8 * x);
            classes[i] = std::abs(radius - 0.3) < 0.03 ? 1 : 0;
            const double g = normal_of(aglow::mix(aglow::mix(seed, 1), i));
            const double h = normal_of(aglow::mix(aglow::mix(seed, 2), i));
            picture[i] = std::max(0.0, truth[i] * (1 + error_of(kind, i, x, y, g, h)));
            guess[i] = truth[i] * typical(kind, i) * std::exp(0.3 * normal_of(aglow::mix(aglow::mix(seed, 3), i)));
        }
    }

    [[nodiscard]] aglow::image_view<double> image() const { return {picture, side, side, 1}; }
    [[nodiscard]] aglow::audited_picture<double> all() const { return {image(), guess, classes}; }

    /// Mean relative error with the floor of an audit of this picture.
    [[nodiscard]] double mean_error() const {
        double sum = 0;
        for (const double e : errors()) { sum += e / pixels; }
        return sum;
    }

    [[nodiscard]] std::vector<double> errors() const {
        const double floor = aglow::audit_options{}.dark * aglow::mean_value(image());
        std::vector<double> all(pixels);
        for (std::size_t i = 0; i < pixels; ++i) { all[i] = std::abs(picture[i] - truth[i]) / (truth[i] + floor); }
        return all;
    }

    [[nodiscard]] double energy_bias() const {
        const double mean = aglow::mean_value(aglow::image_view<double>{truth, side, side, 1});
        return aglow::mean_value(image()) / mean - 1;
    }

    /// Samples with an exponential distribution around the truth: relative variance 1.
    [[nodiscard]] auto probe() const {
        return [this](std::size_t pixel, std::uint64_t seed, std::size_t count) {
            aglow::random_sampler<double> random{seed};
            return truth[pixel] * exponential_mean(random, count);
        };
    }

private:
    [[nodiscard]] double error_of(damage kind, std::size_t i, double x, double y, double g, double h) const {
        switch (kind) {
            case damage::noise: return 0.05 * g;
            case damage::too_bright: return 0.05;
            case damage::outliers: return 0.03 * g * std::exp(0.8 * h);
            case damage::edges: return 0.01 * g + (classes[i] == 1 ? 0.3 * std::abs(h) : 0.0);
            case damage::waves: return 0.08 * std::sin(7 * x) * std::cos(5 * y);
            case damage::dark: return (truth[i] < 0.1 ? 0.3 : 0.02) * g;
            default: return 0;
        }
    }

    [[nodiscard]] double typical(damage kind, std::size_t i) const {
        if (kind == damage::edges) { return classes[i] == 1 ? 0.25 : 0.01; }
        if (kind == damage::dark) { return truth[i] < 0.1 ? 0.25 : 0.02; }
        return 0.05;
    }
};

}  // namespace synthetic
