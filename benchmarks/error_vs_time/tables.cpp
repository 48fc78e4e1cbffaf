#include "error_vs_time/tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <aglow/report/quantiles.hpp>
#include <aglow/report/statement.hpp>

#include "error_vs_time/plot.hpp"
#include "error_vs_time/summary.hpp"

namespace error_vs_time {

namespace {

constexpr const char* dash = "–";

std::string target_name(const metric& what, double target) {
    return what.squared ? "≤ " + rounded(target) : "≤ " + aglow::percent(target);
}

std::string between(double low, double high) { return " (" + rounded(low) + " … " + rounded(high) + ")"; }

/// What stands in brackets.
std::string interval_name(const study& all, const std::string& scene) {
    const std::size_t seeds = seeds_in(all, scene);
    return seeds < seeds_for_95 ? "least to most of " + std::to_string(seeds) + " seeds" : "95 % bootstrap interval";
}

std::string told(const time_to& time, const std::optional<double>& longer) {
    using kind = aglow::crossing::kind;
    if (time.median.when == kind::before) { return "< " + rounded(time.median.time); }
    if (time.median.when == kind::never) {
        if (!(time.median.time > 0)) { return dash; }
        return "> " + rounded(time.median.time) + (longer ? " (≈ " + rounded(*longer) + ")" : "");
    }
    return rounded(time.median.time) + (time.interval ? between(time.interval->low, time.interval->high) : "");
}

std::string told(const std::optional<speed_up>& ratio) {
    if (!ratio) { return dash; }
    const std::string sign = ratio->sign == '=' ? "" : std::string{ratio->sign} + ' ';
    return sign + rounded(ratio->estimate) + "×" + (ratio->about ? " (≈ " + rounded(*ratio->about) + "×)" : "") +
           (ratio->interval ? between(ratio->interval->low, ratio->interval->high) : "");
}

std::vector<std::string> methods_in(const study& all, const std::string& scene) {
    std::vector<std::string> names;
    for (const std::string& method : methods_of(all)) {
        const bool ran = std::any_of(all.runs.begin(), all.runs.end(),
                                     [&](const run_note& r) { return r.scene == scene && r.method == method; });
        if (ran) { names.push_back(method); }
    }
    return names;
}

std::string settings_of(const study& all, const std::string& scene, const std::string& method, std::size_t budget) {
    const auto found = std::find_if(all.runs.begin(), all.runs.end(), [&](const run_note& r) {
        return r.scene == scene && r.method == method && r.budget == budget;
    });
    return found == all.runs.end() ? dash : found->settings;
}

/// The runs of a method's largest budget.
std::vector<const run_note*> final_runs(const study& all, const std::string& scene, const std::string& method) {
    std::size_t largest = 0;
    std::vector<const run_note*> runs;
    for (const run_note& r : all.runs) {
        if (r.scene != scene || r.method != method || r.budget < largest) { continue; }
        if (r.budget > largest) { runs.clear(); }
        largest = r.budget;
        runs.push_back(&r);
    }
    return runs;
}

template <typename Of>
double median_of(const std::vector<const run_note*>& runs, const Of& of) {
    std::vector<double> values;
    for (const run_note* r : runs) { values.push_back(of(*r)); }
    return aglow::median(values);
}

double value_of(const number_pairs& pairs, const std::string& name) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == name; });
    return found == pairs.end() ? 0 : found->second;
}

/// The names in a scene's last runs, in the order of the run that has most of them.
std::vector<std::string> names_in(const study& all, const std::string& scene, number_pairs run_note::*pairs) {
    std::vector<const number_pairs*> lists;
    for (const std::string& method : methods_in(all, scene)) {
        for (const run_note* r : final_runs(all, scene, method)) { lists.push_back(&(r->*pairs)); }
    }
    std::stable_sort(lists.begin(), lists.end(),
                     [](const number_pairs* a, const number_pairs* b) { return a->size() > b->size(); });
    std::vector<std::string> names;
    for (const number_pairs* list : lists) {
        for (const auto& [name, value] : *list) {
            if (std::find(names.begin(), names.end(), name) == names.end()) { names.push_back(name); }
        }
    }
    return names;
}

/// Seconds, or a count: thousands and millions by their letters.
std::string amount(double value) {
    if (value == 0) { return dash; }
    if (value >= 1e6) { return rounded(value / 1e6) + " M"; }
    return value >= 1e4 ? rounded(value / 1e3) + " k" : rounded(value);
}

/// One row a method, one cell a name; the first cells come from `first`.
table by_name(const study& all, const std::string& scene, number_pairs run_note::*pairs, table start,
              double run_note::*first, double first_scale) {
    const std::vector<std::string> names = names_in(all, scene, pairs);
    start.head.insert(start.head.end(), names.begin(), names.end());
    for (const std::string& method : methods_in(all, scene)) {
        const auto runs = final_runs(all, scene, method);
        std::vector<std::string> row{method};
        row.push_back(rounded(median_of(runs, [&](const run_note& r) { return first_scale * r.*first; })));
        for (const std::string& name : names) {
            row.push_back(amount(median_of(runs, [&](const run_note& r) { return value_of(r.*pairs, name); })));
        }
        start.rows.push_back(std::move(row));
    }
    return start;
}

}  // namespace

table times_to_targets(const study& all, const std::string& scene, const metric& what) {
    table result{.caption = std::string{"CPU seconds to "} + what.name + ", median over seeds and " +
                            interval_name(all, scene)};
    result.head = {"method"};
    for (const double target : targets_of(all, what)) { result.head.push_back(target_name(what, target)); }
    for (const std::string& method : methods_in(all, scene)) {
        std::vector<std::string> row{method};
        for (const double target : targets_of(all, what)) {
            const auto longer = method == all.baseline ? carried_on(all, scene, what, target) : std::nullopt;
            row.push_back(told(time_to_target(all, scene, method, what, target), longer));
        }
        result.rows.push_back(std::move(row));
    }
    return result;
}

table speed_ups(const study& all, const std::string& scene, const metric& what) {
    table result{.caption =
                     "Times faster than " + all.baseline + " to " + what.name + ", and " + interval_name(all, scene)};
    result.head = {"method"};
    for (const double target : targets_of(all, what)) { result.head.push_back(target_name(what, target)); }
    for (const std::string& method : methods_in(all, scene)) {
        if (method == all.baseline) { continue; }
        std::vector<std::string> row{method};
        for (const double target : targets_of(all, what)) {
            row.push_back(told(speed_up_to_target(all, scene, method, what, target)));
        }
        result.rows.push_back(std::move(row));
    }
    return result;
}

table steps(const study& all, const std::string& scene) {
    const metric& mape = metrics()[0];
    const metric& relmse = metrics()[1];
    table result{.caption = "Every step, medians over seeds, beside what " + all.baseline +
                            " takes to the same relMSE (≈ where carried on beyond its last run), and " +
                            interval_name(all, scene),
                 .words = 2};
    result.head = {"method",      "settings", "CPU s", "MAPE", "relMSE", "5 … 95 % of seeds", all.baseline + " takes",
                   "times faster"};
    for (const std::string& method : methods_in(all, scene)) {
        const auto relative = curve(all, scene, method, mape);
        const auto squared = curve(all, scene, method, relmse);
        for (std::size_t i = 0; i < squared.size(); ++i) {
            const aglow::convergence_row& r = squared[i];
            const auto equal = at_equal_error(all, scene, method, r.budget, relmse);
            const std::string sign = !equal || equal->sign == '=' ? "" : equal->sign == '~' ? "≈ " : "< ";
            result.rows.push_back(
                {method, settings_of(all, scene, method, r.budget), rounded(r.seconds),
                 aglow::percent(relative[i].error), rounded(r.error),
                 rounded(r.error_low) + " … " + rounded(r.error_high),
                 equal ? sign + rounded(equal->baseline_seconds) : dash,
                 equal ? sign + rounded(equal->ratio.estimate) + "×" + between(equal->ratio.low, equal->ratio.high)
                       : dash});
        }
    }
    return result;
}

table slopes(const study& all, const std::string& scene) {
    table result{.caption = "Slope of each error over CPU seconds (log-log) ± standard error"};
    result.head = {"method"};
    for (const metric& what : metrics()) {
        if (std::string{what.name} != "energy bias") { result.head.push_back(what.name); }
    }
    for (const std::string& method : methods_in(all, scene)) {
        std::vector<std::string> row{method};
        for (const metric& what : metrics()) {
            if (std::string{what.name} == "energy bias") { continue; }
            const auto fit = slope(all, scene, method, what);
            row.push_back(fit ? rounded(fit->slope, 2) + " ± " + rounded(fit->slope_error, 1) : dash);
        }
        result.rows.push_back(std::move(row));
    }
    return result;
}

table efficiencies(const study& all, const std::string& scene) {
    const metric& relmse = metrics()[1];
    table result{.caption =
                     "Efficiency 1/(relMSE · CPU seconds) by step: flat while variance rules, falling where bias does"};
    std::size_t steps = 0;
    for (const std::string& method : methods_in(all, scene)) {
        std::vector<std::string> row{method};
        for (const aglow::convergence_row& r : curve(all, scene, method, relmse)) {
            row.push_back(rounded(r.efficiency));
        }
        steps = std::max(steps, row.size() - 1);
        result.rows.push_back(std::move(row));
    }
    result.head = {"method"};
    for (std::size_t i = 0; i < steps; ++i) { result.head.push_back("step " + std::to_string(i + 1)); }
    for (auto& row : result.rows) { row.resize(steps + 1, dash); }
    return result;
}

table final_errors(const study& all, const std::string& scene) {
    table result{.caption = "Errors at each method's largest budget, medians over seeds"};
    result.head = {"method", "CPU s"};
    for (const metric& what : metrics()) { result.head.push_back(what.name); }
    result.head.push_back("broken pixels");
    for (const std::string& method : methods_in(all, scene)) {
        const auto runs = final_runs(all, scene, method);
        std::vector<std::string> row{method};
        row.push_back(rounded(median_of(runs, [](const run_note& r) { return r.cpu_seconds; })));
        for (const metric& what : metrics()) {
            const double value = median_of(runs, [&](const run_note& r) { return r.error.*what.value; });
            const bool share = !what.squared && what.value != &aglow::image_error::rmse;
            row.push_back(share ? aglow::percent(value) : rounded(value));
        }
        row.push_back(rounded(median_of(runs, [](const run_note& r) { return static_cast<double>(r.error.broken); })));
        result.rows.push_back(std::move(row));
    }
    return result;
}

table bias_and_variance(const study& all, const std::string& scene) {
    table result{.caption = "relMSE taken apart: what all seeds share, and what differs between them"};
    result.head = {"method", "step", "bias²", "± standard error", "variance", "bias² share", "pictures"};
    for (const parts_note& p : all.parts) {
        if (p.scene != scene) { continue; }
        const double sum = std::max(0.0, p.parts.bias2) + p.parts.variance;
        result.rows.push_back({p.method, std::to_string(p.budget + 1), rounded(p.parts.bias2),
                               rounded(p.parts.bias2_error, 2), rounded(p.parts.variance),
                               sum > 0 ? aglow::percent(std::max(0.0, p.parts.bias2) / sum) : dash,
                               std::to_string(p.parts.pictures)});
    }
    return result;
}

table phase_times(const study& all, const std::string& scene) {
    table start{.caption = "CPU seconds by phase at each method's largest budget, medians over seeds"};
    start.head = {"method", "all"};
    return by_name(all, scene, &run_note::phases, std::move(start), &run_note::cpu_seconds, 1);
}

table work_done(const study& all, const std::string& scene) {
    table start{.caption = "Work and memory at each method's largest budget, medians over seeds"};
    start.head = {"method", "peak MiB"};
    return by_name(all, scene, &run_note::counts, std::move(start), &run_note::peak_bytes, 1.0 / (1 << 20));
}

table certificates(const study& all, const std::string& scene) {
    table result{.caption = "Audits beside the truth they could not know (mean relative error; energy bias)",
                 .words = 2};
    result.head = {"method",        "status",    "target",  "bound",    "true error",
                   "bias interval", "true bias", "audit s", "of render"};
    for (const audit_note& a : all.audits) {
        if (a.scene != scene) { continue; }
        result.rows.push_back(
            {a.method, a.status, aglow::percent(a.target), aglow::percent(a.bound), aglow::percent(a.true_error),
             aglow::percent(a.bias_low) + " … " + aglow::percent(a.bias_high), aglow::percent(a.true_bias),
             rounded(a.seconds), a.render_seconds > 0 ? rounded(100 * a.seconds / a.render_seconds) + " %" : dash});
    }
    return result;
}

}  // namespace error_vs_time
