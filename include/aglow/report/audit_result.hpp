// What an audit is asked, and what it answers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <aglow/report/confidence.hpp>
#include <aglow/report/conformal.hpp>
#include <aglow/report/image_view.hpp>

namespace aglow {

/// A finished picture and what its maker knows of it.
template <std::floating_point T>
struct audited_picture {
    using scalar = T;

    image_view<T> image;
    /// A guess of each pixel's error, of the mean of its channels, in the picture's unit; empty: a share of the pixel's
    /// value. What is not positive or not finite is replaced by the dark floor.
    std::span<const T> guess{};
    /// A class for each pixel, such as feature × hard; each gets error bars that hold within it. Empty: one class.
    std::span<const std::uint32_t> classes{};
};

/// Light that the probe cannot sample, such as caustics of point lights; no statement holds for it.
struct unseen_transport {
    std::string what;
    double flux_share{0};  ///< its share of the light in the picture, as far as the caller knows
};

struct audit_options {
    /// The mean relative error that is to be certified: mean over pixels and channels of |B−I| / (I + δ), B the
    /// picture, I the truth, δ = `dark` times the mean value of the picture.
    double target = 0.05;
    /// Relative energy bias |Σ(B−I)/ΣI| that must be certified too; absent: the bias is told but not judged.
    std::optional<double> bias_target{};
    /// Certify by `clipped_error_bound`, which holds for every distribution of errors, instead of `mean_error_bound`,
    /// which is sharper but can miss errors far above 100 % in so few pixels that no probe finds them (below 3 /
    /// `probes` of them). For targets up to a half: of errors near 1 noise hides what lies above.
    bool distribution_free = false;
    /// Probability with which each statement by itself is meant to hold.
    double confidence = 0.95;
    /// Pixels that are looked at; at least 200.
    std::size_t probes = 400;
    /// Standard error that a probe shall have, as a share of `target`.
    double noise = 0.5;
    /// Most samples that all probes together may take, those extra for `class_probes` too. Where they are fewer than
    /// wanted there are fewer probes, down to 200 and 60 a class: bounds get wider, never wrong. 8 for each probe and
    /// 256 for a pilot are the least, and taken where it is less.
    std::size_t budget = std::numeric_limits<std::size_t>::max();
    /// Largest value that a sample of the probe can have, in the picture's unit, where the host knows one: noise that
    /// looks heavy-tailed is then only slow, and the bounds on the mean error and the energy are widened by what rare
    /// samples that were not met can add; the quantile and the error bars are not.
    std::optional<double> sample_bound{};
    /// Where noise looks heavy-tailed, probes are drawn anew with ever four times the samples, up to this many times
    /// what samples of relative variance 1 would take; noise that stays so is called by its name.
    double patience = 64;
    /// Which quantile of the relative error is bounded.
    double quantile = 0.95;
    /// δ above as a share of the picture's mean value: pixels far darker than that cannot spoil a mean.
    double dark = 0.02;
    /// Classes with fewer probes than this get extra ones of their own.
    std::size_t class_probes = 100;
    /// Seed of the numbers used by audits only, and which audit of that seed this is: never give the same pair twice.
    std::uint64_t seed = 0;
    std::uint64_t stream = 0;
    /// What the probe cannot see; carried into the statement.
    std::vector<unseen_transport> unseen{};
};

enum class audit_status { certified, not_certified, inconclusive };

/// The statements of an audit. `certified`: the bound on the mean relative error (and the bias, if asked) is within its
/// target. `not_certified`: it is not, or pixels are broken. `inconclusive`: the probes cannot tell; `reasons` say why,
/// first what can be helped.
struct audit_result {
    audit_status status{audit_status::inconclusive};
    std::vector<std::string> reasons{};
    double target{0};
    double confidence{0};
    double quantile{0};    ///< which quantile `quantile_bound` bounds
    double dark_floor{0};  ///< δ, in the picture's unit

    /// Σ(B−I)/ΣI, of the mean of the channels.
    interval energy_bias{0, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    double mean_error{0};            ///< estimate of the mean relative error, slightly above on average
    double likely_error{0};          ///< the same for plans: as often below as above, and no bound is made of it
    double mean_error_deviation{0};  ///< standard deviation of one probe's contribution to it
    double mean_error_bound{std::numeric_limits<double>::infinity()};  ///< upper bound on it
    double mean_error_floor{0};                                        ///< lower bound on it
    double clipped_error_bound{1};  ///< upper bound where errors above 1 count as 1: holds for any distribution
    std::optional<double> quantile_bound{};  ///< upper bound on the `quantile` of the relative error of pixels
    std::vector<class_scale> scales{};       ///< error bar of a pixel = scale of its class times its guess

    double tail_index{0};     ///< 1/2 for noise of finite variance, above where it falls slower than samples^-1/2
    double unmet_error{0};    ///< what rare samples that were not met may add to the mean error, part of its bounds
    double largest_share{0};  ///< largest contribution of one probe to the error (or to the target, where that is more)
    std::size_t broken_pixels{0};
    std::size_t broken_samples{0};
    double lost_share{0};  ///< of the probes' light, by broken answers of their host (see `KnowsLoss`)
    std::size_t probes{0};
    std::size_t samples_per_probe{0};
    std::size_t samples{0};             ///< all samples spent, the pilot's included
    std::size_t samples_called_for{0};  ///< about how many it takes, where the budget did not allow them; else 0
    std::vector<unseen_transport> unseen{};
    bool distribution_free{false};  ///< whether `clipped_error_bound` is what was held to the target
};

/// Throws `std::invalid_argument` that names what is out of range or does not fit.
template <std::floating_point T>
void require_auditable(const audited_picture<T>& picture, const audit_options& options) {
    const auto require = [](bool holds, const char* what) {
        if (!holds) { throw std::invalid_argument(what); }
    };
    require_whole(picture.image, "image");
    const std::size_t pixels = picture.image.pixels();
    require(picture.guess.empty() || picture.guess.size() == pixels, "guess: not one number a pixel");
    require(picture.classes.empty() || picture.classes.size() == pixels, "classes: not one number a pixel");
    require(options.target > 0 && is_finite(options.target), "target: not positive");
    require(options.confidence > 0.5 && options.confidence < 1, "confidence: not in (0.5, 1)");
    require(options.probes >= 200, "probes: fewer than 200");
    require(options.noise > 0, "noise: not positive");
    require(!options.sample_bound || *options.sample_bound > 0, "sample_bound: not positive");
    require(options.patience >= 1, "patience: below 1");
    require(options.quantile > 0 && options.quantile < 1, "quantile: not in (0, 1)");
    require(options.dark > 0, "dark: not positive");
}

namespace detail {

/// The guess that is used for a pixel: the maker's where it is usable, else the pixel's value and the dark floor.
template <std::floating_point T>
[[nodiscard]] double usable_guess(const audited_picture<T>& picture, std::size_t pixel, double floor) {
    if (picture.guess.empty()) { return std::abs(picture.image.gray(pixel)) + floor; }
    const T guess = picture.guess[pixel];
    return is_finite(guess) && guess > 0 ? static_cast<double>(guess) : floor;
}

template <std::floating_point T>
[[nodiscard]] std::uint32_t class_of(const audited_picture<T>& picture, std::size_t pixel) {
    return picture.classes.empty() ? 0 : picture.classes[pixel];
}

}  // namespace detail

/// An error bar for each pixel's mean of channels, in the picture's unit: within each class the truth lies within it
/// for the audit's share of the pixels. Infinite where the audit could not say anything of the class.
template <std::floating_point T>
[[nodiscard]] std::vector<double> error_bars(const audited_picture<T>& picture, const audit_result& result) {
    std::vector<double> bars(picture.image.pixels());
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const auto scale = scale_of(result.scales, detail::class_of(picture, i));
        const double s = scale.value_or(std::numeric_limits<double>::infinity());
        bars[i] = is_finite(s) ? s * detail::usable_guess(picture, i, result.dark_floor) : s;  // of no guess either
    }
    return bars;
}

}  // namespace aglow
