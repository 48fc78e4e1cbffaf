#include "error_vs_time/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <aglow/report/bootstrap.hpp>

namespace error_vs_time {

namespace {

template <typename Visit>
void for_each_run(const study& all, const std::string& scene, const std::string& method, const Visit& visit) {
    for (const run_note& run : all.runs) {
        if (run.scene == scene && run.method == method) { visit(run); }
    }
}

/// One seed's errors in rising order of time.
struct seed_curve {
    std::vector<double> seconds{};
    std::vector<double> errors{};
};

std::map<std::uint64_t, seed_curve> seed_curves(const study& all, const std::string& scene, const std::string& method,
                                                const metric& what) {
    std::map<std::uint64_t, std::vector<std::pair<double, double>>> points;
    for_each_run(all, scene, method,
                 [&](const run_note& run) { points[run.seed].emplace_back(run.cpu_seconds, run.error.*what.value); });
    std::map<std::uint64_t, seed_curve> curves;
    for (auto& [seed, of_seed] : points) {
        std::sort(of_seed.begin(), of_seed.end());
        for (const auto& [s, e] : of_seed) {
            curves[seed].seconds.push_back(s);
            curves[seed].errors.push_back(e);
        }
    }
    return curves;
}

/// Where each seed's own curve crosses the target, in rising order of time; those that never do come last.
std::vector<aglow::crossing> crossings(const study& all, const std::string& scene, const std::string& method,
                                       const metric& what, double target) {
    using kind = aglow::crossing::kind;
    std::vector<aglow::crossing> found;
    for (const auto& [seed, points] : seed_curves(all, scene, method, what)) {
        found.push_back(aglow::time_to_error(points.seconds, points.errors, target));
    }
    std::sort(found.begin(), found.end(), [](const aglow::crossing& a, const aglow::crossing& b) {
        const bool a_never = a.when == kind::never;
        const bool b_never = b.when == kind::never;
        return a_never != b_never ? b_never : a.time < b.time;
    });
    return found;
}

/// The median of crossings in order, or the limit that is known of it.
aglow::crossing middle_of(const std::vector<aglow::crossing>& found) {
    using kind = aglow::crossing::kind;
    const aglow::crossing& a = found[(found.size() - 1) / 2];
    const aglow::crossing& b = found[found.size() / 2];
    if (b.when != kind::never) { return {a.when, (a.time + b.time) / 2}; }
    return {kind::never, ((a.when == kind::before ? 0 : a.time) + b.time) / 2};
}

/// The exponent by which the baseline is carried on.
double baseline_exponent(const study& all, const std::string& scene, const metric& what) {
    const double independent = what.squared ? -1 : -0.5;
    const auto fit = slope(all, scene, all.baseline, what);
    return fit ? std::min(fit->slope, independent) : independent;
}

/// When the baseline's curve meets the target, carried on beyond its end.
double carried_to(const seed_curve& points, double target, double exponent) {
    const aglow::crossing found = aglow::time_to_error(points.seconds, points.errors, target);
    if (found.when != aglow::crossing::kind::never || points.errors.empty()) { return found.time; }
    return found.time * std::pow(target / points.errors.back(), 1 / exponent);
}

/// The median, with its bootstrap interval, or the least and the most of too few for one.
aglow::interval middle_and_spread(const std::vector<double>& values) {
    if (values.size() < seeds_for_95) {
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        return {aglow::median(values), *least, *most};
    }
    return aglow::bootstrap(values.size(), [&](std::span<const std::size_t> indices) {
        return aglow::median(aglow::pick(values, indices));
    });
}

/// The ratio of the medians of two independent lists, with its interval in the same way.
aglow::interval ratio_and_spread(const std::vector<double>& above, const std::vector<double>& below) {
    if (std::min(above.size(), below.size()) >= seeds_for_95) {
        return aglow::bootstrap_ratio(above, below, aglow::median);
    }
    const auto [least_above, most_above] = std::minmax_element(above.begin(), above.end());
    const auto [least_below, most_below] = std::minmax_element(below.begin(), below.end());
    return {aglow::median(above) / aglow::median(below), *least_above / *most_below, *most_above / *least_below};
}

}  // namespace

std::size_t seeds_in(const study& all, const std::string& scene) {
    std::map<std::string, std::set<std::uint64_t>> seeds;
    for (const run_note& run : all.runs) {
        if (run.scene == scene) { seeds[run.method].insert(run.seed); }
    }
    std::size_t fewest = 0;
    for (const auto& [method, of_method] : seeds) {
        fewest = fewest == 0 ? of_method.size() : std::min(fewest, of_method.size());
    }
    return fewest;
}

std::vector<aglow::convergence_row> curve(const study& all, const std::string& scene, const std::string& method,
                                          const metric& what) {
    std::vector<aglow::timed_error> points;
    for_each_run(all, scene, method, [&](const run_note& run) {
        points.push_back({run.budget, run.cpu_seconds, run.error.*what.value});
    });
    return aglow::convergence_table(points);
}

std::optional<aglow::line_fit> slope(const study& all, const std::string& scene, const std::string& method,
                                     const metric& what) {
    std::vector<double> seconds;
    std::vector<double> errors;
    for_each_run(all, scene, method, [&](const run_note& run) {
        const double error = run.error.*what.value;
        if (!(run.cpu_seconds > 0 && error > 0)) { return; }
        seconds.push_back(run.cpu_seconds);
        errors.push_back(error);
    });
    if (seconds.empty()) { return std::nullopt; }
    const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
    if (!(2 * *least <= *most)) { return std::nullopt; }
    return aglow::fit_slope(seconds, errors);
}

time_to time_to_target(const study& all, const std::string& scene, const std::string& method, const metric& what,
                       double target) {
    const std::vector<aglow::crossing> found = crossings(all, scene, method, what, target);
    if (found.empty()) { return {}; }
    time_to result{.median = middle_of(found)};
    for (const aglow::crossing& c : found) {
        if (c.when != aglow::crossing::kind::at) { return result; }
        result.seconds.push_back(c.time);
    }
    result.median.time = aglow::median(result.seconds);
    result.interval = middle_and_spread(result.seconds);
    return result;
}

std::optional<double> carried_on(const study& all, const std::string& scene, const metric& what, double target) {
    if (time_to_target(all, scene, all.baseline, what, target).median.when != aglow::crossing::kind::never) {
        return std::nullopt;
    }
    const double exponent = baseline_exponent(all, scene, what);
    std::vector<double> seconds;
    for (const auto& [seed, points] : seed_curves(all, scene, all.baseline, what)) {
        seconds.push_back(carried_to(points, target, exponent));
    }
    if (seconds.empty()) { return std::nullopt; }
    return aglow::median(seconds);
}

std::optional<speed_up> speed_up_to_target(const study& all, const std::string& scene, const std::string& method,
                                           const metric& what, double target) {
    using kind = aglow::crossing::kind;
    if (all.baseline.empty() || method == all.baseline) { return std::nullopt; }
    const time_to slow = time_to_target(all, scene, all.baseline, what, target);
    const time_to fast = time_to_target(all, scene, method, what, target);
    if (!(slow.median.time > 0 && fast.median.time > 0)) { return std::nullopt; }
    const double ratio = slow.median.time / fast.median.time;
    const bool no_less = slow.median.when != kind::before && fast.median.when != kind::never;
    const bool no_more = slow.median.when != kind::never && fast.median.when != kind::before;
    if (no_less && no_more) {
        speed_up result{.estimate = ratio};
        if (slow.interval && fast.interval) { result.interval = ratio_and_spread(slow.seconds, fast.seconds); }
        return result;
    }
    if (no_more) { return speed_up{.sign = '<', .estimate = ratio}; }
    if (!no_less) { return std::nullopt; }
    speed_up result{.sign = '>', .estimate = ratio};
    const auto longer = carried_on(all, scene, what, target);
    if (longer && fast.median.when == kind::at) { result.about = *longer / fast.median.time; }
    return result;
}

std::optional<equal_error> at_equal_error(const study& all, const std::string& scene, const std::string& method,
                                          std::size_t budget, const metric& what) {
    if (method == all.baseline) { return std::nullopt; }
    const auto baseline = seed_curves(all, scene, all.baseline, what);
    const double exponent = baseline_exponent(all, scene, what);
    equal_error result;
    std::vector<double> seconds;
    std::vector<double> ratios;
    for_each_run(all, scene, method, [&](const run_note& run) {
        const auto same_seed = baseline.find(run.seed);
        const double error = run.error.*what.value;
        if (run.budget != budget || same_seed == baseline.end() || !(error > 0 && run.cpu_seconds > 0)) { return; }
        const seed_curve& points = same_seed->second;
        const auto when = aglow::time_to_error(points.seconds, points.errors, error).when;
        if (when == aglow::crossing::kind::before) { result.sign = '<'; }
        if (when == aglow::crossing::kind::never && result.sign == '=') { result.sign = '~'; }
        seconds.push_back(carried_to(points, error, exponent));
        ratios.push_back(seconds.back() / run.cpu_seconds);
    });
    if (seconds.empty()) { return std::nullopt; }
    result.baseline_seconds = aglow::median(seconds);
    result.ratio = middle_and_spread(ratios);
    return result;
}

}  // namespace error_vs_time
