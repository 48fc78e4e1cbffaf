// Error against time: slopes, the time to reach an error, and the table of a series of runs.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include <aglow/report/quantiles.hpp>

namespace aglow {

/// A straight line y = `at_zero` + `slope` · x through points, with the standard error of its slope.
struct line_fit {
    double slope{0};
    double at_zero{0};
    double slope_error{std::numeric_limits<double>::infinity()};  ///< infinite below three points
};

/// Least squares. Throws `std::invalid_argument` below two different x or for lists of different lengths.
[[nodiscard]] inline line_fit fit_line(std::span<const double> x, std::span<const double> y) {
    if (x.size() != y.size() || x.size() < 2) { throw std::invalid_argument("fit_line: needs two points or more"); }
    const double n = static_cast<double>(x.size());
    double mean_x = 0;
    double mean_y = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += x[i] / n;
        mean_y += y[i] / n;
    }
    double xx = 0;
    double xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    if (!(xx > 0)) { throw std::invalid_argument("fit_line: all x are the same"); }
    line_fit fit{.slope = xy / xx, .at_zero = mean_y - xy / xx * mean_x};
    if (x.size() < 3) { return fit; }
    double rest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) { rest += std::pow(y[i] - fit.at_zero - fit.slope * x[i], 2); }
    fit.slope_error = std::sqrt(rest / (n - 2) / xx);
    return fit;
}

/// The exponent p of error ~ time^p, by a straight line through the logarithms; pairs with a number that is not
/// positive are left out. Each metric has its own slope: where there are edges, L1 and L2 fall at different rates.
[[nodiscard]] inline line_fit fit_slope(std::span<const double> times, std::span<const double> errors) {
    if (times.size() != errors.size()) { throw std::invalid_argument("fit_slope: lists of different lengths"); }
    std::vector<double> x;
    std::vector<double> y;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!(times[i] > 0 && errors[i] > 0)) { continue; }
        x.push_back(std::log(times[i]));
        y.push_back(std::log(errors[i]));
    }
    return fit_line(x, y);
}

/// When a falling error met a target.
struct crossing {
    enum class kind { before, at, never };
    kind when{kind::never};
    double time{
        0};  ///< `at`: the time; `before`: the first time known, an upper limit; `never`: the last, a lower limit
};

/// The first time at which `errors` is at or below `target`, interpolated between the logarithms of its neighbours;
/// that of the first error below zero, as one whose reference's noise was taken out may be, as it is. Expects rising,
/// positive `times`.
[[nodiscard]] inline crossing time_to_error(std::span<const double> times, std::span<const double> errors,
                                            double target) {
    if (times.size() != errors.size()) { throw std::invalid_argument("time_to_error: lists of different lengths"); }
    if (times.empty()) { return {}; }
    if (errors[0] <= target) { return {crossing::kind::before, times[0]}; }
    for (std::size_t i = 1; i < times.size(); ++i) {
        if (errors[i] > target) { continue; }
        if (!(errors[i] > 0)) { return {crossing::kind::at, times[i]}; }
        const double way = std::log(errors[i - 1] / target) / std::log(errors[i - 1] / errors[i]);
        return {crossing::kind::at, times[i - 1] * std::pow(times[i] / times[i - 1], way)};
    }
    return {crossing::kind::never, times.back()};
}

/// One run: which step of the budget it had, its time and its error.
struct timed_error {
    std::size_t budget{0};
    double seconds{0};
    double error{0};
};

/// The runs of one budget over all seeds.
struct convergence_row {
    std::size_t budget{0};
    std::size_t runs{0};
    double seconds{0};     ///< median
    double error{0};       ///< median
    double error_low{0};   ///< 5 % quantile
    double error_high{0};  ///< 95 % quantile
    double efficiency{0};  ///< 1 / (error · seconds) of the medians; flat over time where the error is all variance
};

/// One row a budget, in rising order of budget. Give squared errors (relMSE) for an efficiency that means something.
[[nodiscard]] inline std::vector<convergence_row> convergence_table(std::span<const timed_error> runs) {
    std::vector<double> budgets;
    for (const timed_error& run : runs) { budgets.push_back(static_cast<double>(run.budget)); }
    const std::vector<std::size_t> rising = rising_order(budgets);
    std::vector<convergence_row> rows;
    for (std::size_t i = 0; i < rising.size();) {
        const std::size_t budget = runs[rising[i]].budget;
        std::vector<double> seconds;
        std::vector<double> errors;
        for (; i < rising.size() && runs[rising[i]].budget == budget; ++i) {
            seconds.push_back(runs[rising[i]].seconds);
            errors.push_back(runs[rising[i]].error);
        }
        convergence_row row{.budget = budget, .runs = errors.size(), .seconds = median(seconds)};
        row.error = median(errors);
        row.error_low = quantile(errors, 0.05);
        row.error_high = quantile(errors, 0.95);
        row.efficiency = 1 / (row.error * row.seconds);
        rows.push_back(row);
    }
    return rows;
}

}  // namespace aglow
