#include "error_vs_time/gate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <aglow/report/distributions.hpp>
#include <aglow/report/running_mean.hpp>

#include "error_vs_time/plot.hpp"

namespace error_vs_time {

namespace {

struct step {
    std::string scene;
    std::string method;
    std::size_t budget;
    auto operator<=>(const step&) const = default;
};

using by_seed = std::map<std::uint64_t, const run_note*>;

std::map<step, by_seed> steps_of(const study& all) {
    std::map<step, by_seed> steps;
    for (const run_note& r : all.runs) { steps[{r.scene, r.method, r.budget}][r.seed] = &r; }
    return steps;
}

double two_sided_p(const aglow::running_mean& logs) {
    if (logs.variance() == 0) { return logs.mean() == 0 ? 1 : 0; }
    const double t = std::abs(logs.mean()) / logs.standard_error();
    return 2 * aglow::student_t_cdf(-t, static_cast<double>(logs.count() - 1));
}

template <typename Of>
void add(std::vector<difference>& found, const step& where, const by_seed& before, const by_seed& after,
         const char* quantity, const Of& of) {
    aglow::running_mean logs;
    for (const auto& [seed, run] : before) {
        const auto other = after.find(seed);
        if (other == after.end() || !(of(*run) > 0) || !(of(*other->second) > 0)) { continue; }
        logs.add(std::log(of(*other->second) / of(*run)));
    }
    if (logs.count() < 2) { return; }
    difference d{.scene = where.scene, .method = where.method, .budget = where.budget, .quantity = quantity};
    d.ratio = std::exp(logs.mean());
    d.p_value = two_sided_p(logs);
    d.pairs = logs.count();
    found.push_back(d);
}

}  // namespace

std::vector<double> holm_adjusted(std::span<const double> p_values) {
    std::vector<std::size_t> order(p_values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
    std::vector<double> adjusted(p_values.size());
    double largest = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        largest = std::max(largest, static_cast<double>(order.size() - i) * p_values[order[i]]);
        adjusted[order[i]] = std::min(1.0, largest);
    }
    return adjusted;
}

std::vector<difference> differences(const study& before, const study& after, const gate_options& options) {
    const std::map<step, by_seed> old_steps = steps_of(before);
    const std::map<step, by_seed> new_steps = steps_of(after);
    std::vector<difference> found;
    for (const auto& [where, old_runs] : old_steps) {
        const auto now = new_steps.find(where);
        if (now == new_steps.end()) { continue; }
        add(found, where, old_runs, now->second, "relMSE", [](const run_note& r) { return r.error.relmse; });
        add(found, where, old_runs, now->second, "MAPE", [](const run_note& r) { return r.error.mape; });
        add(found, where, old_runs, now->second, "CPU seconds", [](const run_note& r) { return r.cpu_seconds; });
    }
    std::vector<double> p_values;
    for (const difference& d : found) { p_values.push_back(d.p_value); }
    const std::vector<double> adjusted = holm_adjusted(p_values);
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i].adjusted_p = adjusted[i];
        found[i].significant = adjusted[i] <= options.miss;
    }
    return found;
}

bool worse(std::span<const difference> all, const gate_options& options) {
    return std::any_of(all.begin(), all.end(),
                       [&](const difference& d) { return d.significant && d.ratio > 1 + options.smallest; });
}

std::string told(std::span<const difference> all) {
    std::vector<const difference*> order;
    for (const difference& d : all) { order.push_back(&d); }
    std::stable_sort(order.begin(), order.end(), [](const difference* a, const difference* b) {
        return a->significant != b->significant ? a->significant : a->adjusted_p < b->adjusted_p;
    });
    std::string out;
    for (const difference* d : order) {
        out += std::string{d->significant ? (d->ratio > 1 ? "WORSE   " : "better  ") : "        "} + d->scene + ", " +
               d->method + ", step " + std::to_string(d->budget + 1) + ": " + d->quantity + " × " + rounded(d->ratio) +
               " (p " + rounded(d->adjusted_p) + ", " + std::to_string(d->pairs) + " seeds)\n";
    }
    return out;
}

}  // namespace error_vs_time
