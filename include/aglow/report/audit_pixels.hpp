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

/// How often each pixel is drawn: a part uniformly, the rest in proportion to the error that is feared there, by the
/// guess and by how far the pixel stands out. Half of the guess is taken relative to the light, for the mean relative
/// error, and half as it is, for the energy: else a few pixels at the rim of a lamp, met in one audit of ten, would
/// decide on it. Weights make all of it one unbiased sample (Veach & Guibas 1995, balance heuristic).
class pixel_shares {
public:
    template <std::floating_point T>
    pixel_shares(const audited_picture<T>& picture, double floor, double target)
        : uniform_part_{picture.guess.empty() ? 0.75 : 0.5} {
        const std::vector<double> outliers = standing_out(picture.image, floor);
        std::vector<double> absolute = widened_guesses(picture, floor);
        std::vector<double> relative(absolute.size());
        for (std::size_t i = 0; i < relative.size(); ++i) {
            relative[i] =
                std::max(0.0, usable_guess(picture, i, floor)) / (std::max(picture.image.gray(i), 0.0) + floor);
        }
        const double level = target / 2 / mean_or_one(absolute);
        const double relative_level = target / 2 / mean_or_one(relative);
        double sum = 0;
        for (std::size_t i = 0; i < outliers.size(); ++i) {
            sums_.push_back(sum += outliers[i] + relative_level * relative[i] + level * absolute[i]);
        }
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
    /// The largest guess of each pixel and those around it, and a thirtieth of their contrast: where all samples of a
    /// pixel missed the rim of a lamp, only its neighbours know.
    template <std::floating_point T>
    static std::vector<double> widened_guesses(const audited_picture<T>& picture, double floor) {
        std::vector<double> guess(picture.image.pixels());
        std::vector<double> light = guess;
        std::vector<double> shade = guess;
        for (std::size_t i = 0; i < guess.size(); ++i) {
            guess[i] = std::max(0.0, usable_guess(picture, i, floor));
            light[i] = picture.image.gray(i);
            shade[i] = -light[i];
        }
        std::vector<double> all = largest_around(guess, picture.image.width);
        light = largest_around(light, picture.image.width);
        shade = largest_around(shade, picture.image.width);
        for (std::size_t i = 0; i < all.size(); ++i) { all[i] += (light[i] + shade[i]) / 30; }
        return all;
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
          shares{seen, floor, options.target} {}
};

}  // namespace detail

}  // namespace aglow
