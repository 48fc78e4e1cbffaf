// Which pixels an audit looks at: some of them anywhere, some where errors are to be feared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <aglow/report/audit_result.hpp>

namespace aglow {

namespace detail {

/// The second smallest and second largest of the numbers added; what a single outlier among them cannot move.
struct second_extremes {
    double lowest{std::numeric_limits<double>::max()};
    double low{std::numeric_limits<double>::max()};
    double highest{0};
    double high{0};

    /// Expects `x` not below 0.
    constexpr void add(double x) {
        low = std::min(low, std::max(lowest, x));
        lowest = std::min(lowest, x);
        high = std::max(high, std::min(highest, x));
        highest = std::max(highest, x);
    }
};

}  // namespace detail

/// How far each pixel lies beyond all but one of the up to eight pixels around it, relative to those: large for the
/// fireflies of a picture, which a few hundred random looks would miss, and 0 along edges. Expects a whole picture.
template <std::floating_point T>
[[nodiscard]] std::vector<double> standing_out(const image_view<T>& image, double floor) {
    std::vector<double> found(image.pixels());
    const std::size_t width = image.width;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const std::size_t x = i % width;
        const std::size_t y = i / width;
        detail::second_extremes around;
        for (std::size_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, image.height - 1); ++v) {
            for (std::size_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, width - 1); ++u) {
                if (u != x || v != y) { around.add(std::max(image.gray(v * width + u), 0.0)); }
            }
        }
        if (around.low > around.high) { continue; }  // fewer than two neighbours, or two that differ
        const double gray = image.gray(i);
        if (gray > around.high) { found[i] = (gray - around.high) / (around.high + floor); }
        if (gray < around.low) { found[i] = (around.low - gray) / (around.low + floor); }
    }
    return found;
}

namespace detail {

/// The largest value among each pixel and the up to eight around it.
[[nodiscard]] inline std::vector<double> largest_around(const std::vector<double>& values, std::size_t width) {
    std::vector<double> wide = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i % width > 0) { wide[i] = std::max(wide[i], values[i - 1]); }
        if (i % width + 1 < width) { wide[i] = std::max(wide[i], values[i + 1]); }
    }
    std::vector<double> all = wide;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i >= width) { all[i] = std::max(all[i], wide[i - width]); }
        if (i + width < values.size()) { all[i] = std::max(all[i], wide[i + width]); }
    }
    return all;
}

/// How often each pixel is drawn: a part uniformly, the rest in proportion to the relative error that is feared there,
/// by how far the pixel stands out, by the contrast around it and by the guess, which is scaled to the target on
/// average. Where the energy is judged too, half of the guess and the contrast counts as it is, in the dark as in
/// light. Weights make all of it one unbiased sample (Veach & Guibas 1995, balance heuristic).
class pixel_shares {
public:
    template <std::floating_point T>
    pixel_shares(const audited_picture<T>& picture, double floor, const audit_options& options)
        : uniform_part_{picture.guess.empty() ? 0.75 : 0.5} {
        const std::vector<double> outliers = standing_out(picture.image, floor);
        const auto light = [&](std::size_t i) { return std::max(picture.image.gray(i), 0.0) + floor; };
        std::vector<double> feared = feared_errors(picture, floor, options.target, light);
        if (options.bias_target) {
            const double mean = std::abs(mean_value(picture.image)) + floor;
            const std::vector<double> absolute =
                feared_errors(picture, floor, options.target, [mean](std::size_t) { return mean; });
            for (std::size_t i = 0; i < feared.size(); ++i) { feared[i] = (feared[i] + absolute[i]) / 2; }
        }
        double sum = 0;
        for (std::size_t i = 0; i < outliers.size(); ++i) { sums_.push_back(sum += outliers[i] + feared[i]); }
    }

    /// The pixel at `place` in [0, 1) of the feared shares laid end to end.
    [[nodiscard]] std::size_t pixel_at(double place) const {
        const auto found = std::upper_bound(sums_.begin(), sums_.end(), place * sums_.back());
        return std::min(sums_.size() - 1, static_cast<std::size_t>(found - sums_.begin()));
    }

    /// Uniform density over that of the pixel's drawing; never above 2.
    [[nodiscard]] double weight(std::size_t pixel) const {
        const double share = sums_[pixel] - (pixel > 0 ? sums_[pixel - 1] : 0);
        const double relative = share / sums_.back() * static_cast<double>(sums_.size());
        return 1 / (uniform_part_ + (1 - uniform_part_) * relative);
    }

    [[nodiscard]] double uniform_part() const { return uniform_part_; }

private:
    /// What the guess says, on average the target, and a hundredth of the contrast; relative to `unit(i)`.
    template <std::floating_point T, typename Unit>
    static std::vector<double> feared_errors(const audited_picture<T>& picture, double floor, double target,
                                             const Unit& unit) {
        std::vector<double> feared = feared_guesses(picture, floor, unit);
        const double level = target / mean_or_one(feared);
        const std::vector<double> contrasts = contrast_around(picture.image);
        for (std::size_t i = 0; i < feared.size(); ++i) {
            feared[i] = level * feared[i] + std::min(10.0, contrasts[i] / unit(i)) / 100;
        }
        return feared;
    }

    /// The guess of each pixel relative to `unit`, and the largest of it and those around it: where all samples of a
    /// pixel missed the rim of a lamp, only its neighbours know. A guess of 0 is believed here, as half of the pixels
    /// are drawn whatever was guessed.
    template <std::floating_point T, typename Unit>
    static std::vector<double> feared_guesses(const audited_picture<T>& picture, double floor, const Unit& unit) {
        std::vector<double> guess(picture.image.pixels());
        for (std::size_t i = 0; i < guess.size(); ++i) {
            const bool none = !picture.guess.empty() && picture.guess[i] == 0;
            guess[i] = none ? 0 : usable_guess(picture, i, floor) / unit(i);
        }
        const std::vector<double> around = largest_around(guess, picture.image.width);
        for (std::size_t i = 0; i < guess.size(); ++i) { guess[i] += around[i]; }
        return guess;
    }

    /// How far apart the lightest and the darkest pixel lie among each one and those around it: what a rim may hide.
    template <std::floating_point T>
    static std::vector<double> contrast_around(const image_view<T>& image) {
        std::vector<double> light(image.pixels());
        std::vector<double> shade(image.pixels());
        for (std::size_t i = 0; i < light.size(); ++i) {
            light[i] = image.gray(i);
            shade[i] = -light[i];
        }
        light = largest_around(light, image.width);
        shade = largest_around(shade, image.width);
        for (std::size_t i = 0; i < light.size(); ++i) { light[i] += shade[i]; }
        return light;
    }

    /// The mean of `values`; 1 where it is of no use, and then all pixels are drawn alike.
    static double mean_or_one(std::vector<double>& values) {
        double sum = 0;
        for (const double x : values) { sum += x; }
        if (sum > 0 && is_finite(sum)) { return sum / static_cast<double>(values.size()); }
        std::fill(values.begin(), values.end(), 1.0);
        return 1;
    }

    double uniform_part_;
    std::vector<double> sums_{};
};

/// What an audit knows of a picture before it looks; made once for all looks at it. Expects a whole picture.
template <std::floating_point T>
struct audit_ground {
    audited_picture<T> picture;
    double mean;   ///< value of the picture
    double floor;  ///< of what errors are relative to
    pixel_shares shares;

    audit_ground(const audited_picture<T>& seen, const audit_options& options)
        : picture{seen},
          mean{mean_value(seen.image)},
          floor{options.dark * std::abs(mean)},
          shares{seen, floor, options} {}
};

}  // namespace detail

}  // namespace aglow
