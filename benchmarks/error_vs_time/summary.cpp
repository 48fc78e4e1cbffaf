#include "error_vs_time/summary.hpp"

#include <algorithm>
#include <map>

#include <aglow/report/bootstrap.hpp>

namespace error_vs_time {

namespace {

template <typename Visit>
void for_each_run(const study& all, const std::string& scene, const std::string& method, const Visit& visit) {
    for (const run_note& run : all.runs) {
        if (run.scene == scene && run.method == method) { visit(run); }
    }
}

/// Where each seed's own curve crosses the target, in rising order of time; those that never do come last.
std::vector<aglow::crossing> crossings(const study& all, const std::string& scene, const std::string& method,
                                       const metric& what, double target) {
    std::map<std::uint64_t, std::vector<std::pair<double, double>>> curves;
    for_each_run(all, scene, method,
                 [&](const run_note& run) { curves[run.seed].emplace_back(run.cpu_seconds, run.error.*what.value); });
    std::vector<aglow::crossing> found;
    for (auto& [seed, points] : curves) {
        std::sort(points.begin(), points.end());
        std::vector<double> seconds;
        std::vector<double> errors;
        for (const auto& [s, e] : points) {
            seconds.push_back(s);
            errors.push_back(e);
        }
        found.push_back(aglow::time_to_error(seconds, errors, target));
    }
    using kind = aglow::crossing::kind;
    std::sort(found.begin(), found.end(), [](const aglow::crossing& a, const aglow::crossing& b) {
        const bool a_never = a.when == kind::never;
        const bool b_never = b.when == kind::never;
        return a_never != b_never ? b_never : a.time < b.time;
    });
    return found;
}

}  // namespace

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
    if (!(*least < *most)) { return std::nullopt; }
    return aglow::fit_slope(seconds, errors);
}

time_to time_to_target(const study& all, const std::string& scene, const std::string& method, const metric& what,
                       double target) {
    const std::vector<aglow::crossing> found = crossings(all, scene, method, what, target);
    if (found.empty()) { return {}; }
    time_to result{.median = found[(found.size() - 1) / 2]};
    for (const aglow::crossing& c : found) {
        if (c.when != aglow::crossing::kind::at) { return result; }
        result.seconds.push_back(c.time);
    }
    result.median.time = aglow::median(result.seconds);
    result.interval = aglow::bootstrap(result.seconds.size(), [&](std::span<const std::size_t> indices) {
        return aglow::median(aglow::pick(result.seconds, indices));
    });
    return result;
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
        if (slow.interval && fast.interval) {
            result.interval = aglow::bootstrap_ratio(slow.seconds, fast.seconds, aglow::median);
        }
        return result;
    }
    if (no_less) { return speed_up{.sign = '>', .estimate = ratio}; }
    if (no_more) { return speed_up{.sign = '<', .estimate = ratio}; }
    return std::nullopt;
}

}  // namespace error_vs_time
