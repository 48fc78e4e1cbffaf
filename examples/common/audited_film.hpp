// A film as an audit wants to see it, with classes of pixels that error bars hold in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/algorithms/film.hpp>
#include <aglow/report/audited_film.hpp>

#include "common/picture.hpp"

namespace host {

using aglow::vec3;

/// The numbers of a film at one moment, and its classes.
class classified_film {
public:
    /// `feature` tells of each pixel whether another primitive is near; together with how large the guess is beside the
    /// light, and with the darkest tenth, it makes the classes that error bars hold in.
    /// `caustic` is the light that caustics add to each pixel: those that owe a tenth of theirs to them are one class
    /// more; empty where the scene has none.
    classified_film(const aglow::film<vec3<float>>& film, const std::vector<char>& feature,
                    const std::vector<float>& caustic)
        : numbers_{film} {
        const std::vector<float>& values = numbers_.values();
        const std::vector<float>& guess = numbers_.guess();
        std::vector<double> hardness;
        std::vector<double> light;
        for (std::size_t i = 0; i < guess.size(); ++i) {
            light.push_back(static_cast<double>(values[3 * i] + values[3 * i + 1] + values[3 * i + 2]));
            hardness.push_back(static_cast<double>(guess[i]) / std::max(1e-30, light.back()));
        }
        const double hard = quantile(hardness, 0.75);
        const double dark = quantile(light, 0.1);
        for (std::size_t i = 0; i < light.size(); ++i) {
            const std::uint32_t kind = (hardness[i] > hard ? 2u : 0u) + (feature[i] ? 1u : 0u);
            const float most = std::max({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
            const bool in_caustic = !caustic.empty() && caustic[i] > 0.1f * most;
            classes_.push_back(in_caustic ? 5u : light[i] <= dark ? 4u : kind);
        }
    }

    [[nodiscard]] aglow::audited_picture<float> view() const { return numbers_.view(classes_); }

private:
    static double quantile(std::vector<double> of, double share) {
        const auto at = of.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(of.size() - 1));
        std::nth_element(of.begin(), at, of.end());
        return *at;
    }

    aglow::audited_film<float> numbers_;
    std::vector<std::uint32_t> classes_{};
};

/// Of each pixel, whether `id(x, y)` is another one within two pixels.
template <typename Id>
[[nodiscard]] std::vector<char> feature_pixels(std::size_t width, std::size_t height, const Id& id) {
    std::vector<std::uint32_t> ids(width * height);
    for (std::size_t i = 0; i < ids.size(); ++i) { ids[i] = id(i % width, i / width); }
    std::vector<char> feature(ids.size(), 0);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const std::size_t x = i % width;
        const std::size_t y = i / width;
        for (std::size_t v = y < 2 ? 0 : y - 2; v <= std::min(height - 1, y + 2); ++v) {
            for (std::size_t u = x < 2 ? 0 : x - 2; u <= std::min(width - 1, x + 2); ++u) {
                if (ids[v * width + u] != ids[i]) { feature[i] = 1; }
            }
        }
    }
    return feature;
}

/// Error bars relative to the light, from black (none) over red to yellow and white (100 % and more).
[[nodiscard]] inline picture heat_map(const picture& image, const std::vector<double>& bars) {
    picture map{image.width, image.height};
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const vec3<float>& p = image.pixels[i];
        const float share = static_cast<float>(bars[i]) / std::max(1e-6f, (p.x + p.y + p.z) / 3);
        map.pixels[i] = glm::clamp(vec3<float>{3 * share, 3 * share - 1, 3 * share - 2}, 0.0f, 1.0f);
    }
    return map;
}

}  // namespace host
