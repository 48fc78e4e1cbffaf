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

/// How often each pixel is drawn: a part uniformly, the rest in proportion to the relative error that is feared there,
/// by the guess and by how far the pixel stands out. Weights make all of it one unbiased sample (Veach & Guibas 1995,
/// balance heuristic).
class pixel_shares {
public:
    template <std::floating_point T>
    pixel_shares(const audited_picture<T>& picture, double floor, double target)
        : uniform_part_{picture.guess.empty() ? 0.75 : 0.5} {
        const std::vector<double> outliers = standing_out(picture.image, floor);
        const std::vector<double> guesses = scaled_guesses(picture, floor);
        double sum = 0;
        for (std::size_t i = 0; i < outliers.size(); ++i) { sums_.push_back(sum += outliers[i] + target * guesses[i]); }
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
    /// Guessed relative errors, scaled to a mean of 1.
    template <std::floating_point T>
    static std::vector<double> scaled_guesses(const audited_picture<T>& picture, double floor) {
        std::vector<double> relative(picture.image.pixels(), 1.0);
        double sum = 0;
        for (std::size_t i = 0; i < relative.size(); ++i) {
            const double guess = usable_guess(picture, i, floor);
            relative[i] = guess > 0 ? guess / (std::max(picture.image.gray(i), 0.0) + floor) : 0;
            sum += relative[i];
        }
        if (!(sum > 0) || !is_finite(sum)) { return std::vector<double>(relative.size(), 1.0); }
        for (double& x : relative) { x *= static_cast<double>(relative.size()) / sum; }
        return relative;
    }

    double uniform_part_;
    std::vector<double> sums_{};
};

}  // namespace detail

}  // namespace aglow
