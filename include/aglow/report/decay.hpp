// An error that falls with work towards a floor: a + b · work^-p, and what it promises.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace aglow {

/// An error measured after some work, with the standard error of the measurement.
struct measured_error {
    double work{0};
    double error{0};
    double deviation{0};
};

/// error = `floor` + `amplitude` · work^-`exponent`.
struct decay_fit {
    double floor{0};
    double amplitude{0};
    double exponent{0.5};
    double floor_low{0};  ///< smallest floor that the measurements allow (three and a half standard deviations)
    double misfit{0};     ///< χ² of the fit

    [[nodiscard]] double at(double work) const { return floor + amplitude * std::pow(work, -exponent); }

    /// The work after which the error is `target`; infinite where the floor is above it.
    [[nodiscard]] double work_to(double target) const {
        if (target <= floor) { return std::numeric_limits<double>::infinity(); }
        return std::pow(amplitude / (target - floor), 1 / exponent);
    }
};

namespace detail {

struct decay_candidate {
    decay_fit fit{};
    decay_fit floorless{};
    double floor_deviation{0};
};

[[nodiscard]] inline double misfit(const decay_fit& fit, std::span<const measured_error> points) {
    double sum = 0;
    for (const measured_error& m : points) { sum += std::pow((m.error - fit.at(m.work)) / m.deviation, 2); }
    return sum;
}

/// Weighted least squares of floor and amplitude, neither below 0, for one exponent.
[[nodiscard]] inline decay_candidate fit_decay_at(std::span<const measured_error> points, double exponent) {
    double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const measured_error& m : points) {
        const double weight = 1 / (m.deviation * m.deviation);
        const double x = std::pow(m.work, -exponent);
        w += weight;
        wx += weight * x;
        wy += weight * m.error;
        wxx += weight * x * x;
        wxy += weight * x * m.error;
    }
    const double determinant = w * wxx - wx * wx;
    decay_fit floorless{.amplitude = std::max(0.0, wxy / wxx), .exponent = exponent};
    floorless.misfit = misfit(floorless, points);
    decay_fit fit = floorless;
    if (determinant > 0) {
        fit.floor = (wxx * wy - wx * wxy) / determinant;
        fit.amplitude = (w * wxy - wx * wy) / determinant;
    }
    if (fit.floor <= 0) { fit = floorless; }
    if (fit.amplitude <= 0) {
        fit.floor = wy / w;
        fit.amplitude = 0;
    }
    fit.misfit = misfit(fit, points);
    return {fit, floorless, determinant > 0 ? std::sqrt(wxx / determinant) : fit.floor};
}

}  // namespace detail

/// The best fit over exponents from 0.15 to 1: below that, what falls cannot be told from what does not. Expects
/// positive work and deviations. With one measurement the exponent is taken as 1/2, the law of independent samples; the
/// floor is taken as 0 below three.
[[nodiscard]] inline decay_fit fit_decay(std::span<const measured_error> points) {
    if (points.empty()) { return {}; }
    if (points.size() < 3) {
        const measured_error& last = points.back();
        decay_fit fit{};
        if (points.size() == 2 && points[0].work < last.work && points[0].error > 0 && last.error > 0) {
            const double slope = std::log(points[0].error / last.error) / std::log(last.work / points[0].work);
            fit.exponent = std::clamp(slope, 0.15, 1.0);
        }
        fit.amplitude = std::max(0.0, last.error) * std::pow(last.work, fit.exponent);
        return fit;
    }
    std::array<detail::decay_candidate, 35> all;
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = detail::fit_decay_at(points, 0.15 + 0.025 * static_cast<double>(i));
    }
    const auto least = [&](decay_fit detail::decay_candidate::*kind) {
        return (*std::min_element(all.begin(), all.end(),
                                  [&](const auto& a, const auto& b) { return (a.*kind).misfit < (b.*kind).misfit; })).*
               kind;
    };
    const decay_fit best = least(&detail::decay_candidate::fit);
    const decay_fit floorless = least(&detail::decay_candidate::floorless);
    double low = std::numeric_limits<double>::infinity();
    for (const detail::decay_candidate& c : all) {
        const double room = 12 - (c.fit.misfit - best.misfit);  // Δχ² = 12 is three and a half standard deviations
        if (room >= 0) { low = std::min(low, c.fit.floor - c.floor_deviation * std::sqrt(room)); }
    }
    // A floor is believed in only where the measurements ask for it by two standard deviations.
    decay_fit chosen = floorless.misfit <= best.misfit + 4 ? floorless : best;
    chosen.floor_low = std::max(0.0, low);
    return chosen;
}

}  // namespace aglow
