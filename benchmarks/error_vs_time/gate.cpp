#include "error_vs_time/gate.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

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
    [[nodiscard]] std::string told() const { return scene + ", " + method + ", step " + std::to_string(budget + 1); }
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

struct quantity {
    const char* name;
    double (*of)(const run_note&);
};

constexpr quantity quantities[]{
    {"relMSE", [](const run_note& r) { return r.error.relmse; }},
    {"MAPE", [](const run_note& r) { return r.error.mape; }},
    {"CPU seconds", [](const run_note& r) { return r.cpu_seconds; }},
};

/// Logarithms of after over before, of the seeds that both have.
std::vector<double> log_ratios(const by_seed& before, const by_seed& after, const quantity& what) {
    std::vector<double> logs;
    for (const auto& [seed, run] : before) {
        const auto other = after.find(seed);
        if (other == after.end() || !(what.of(*run) > 0) || !(what.of(*other->second) > 0)) { continue; }
        logs.push_back(std::log(what.of(*other->second) / what.of(*run)));
    }
    return logs;
}

void add(std::vector<difference>& found, difference d, std::span<const double> logs) {
    const aglow::running_mean mean = aglow::mean_of(logs);
    if (mean.count() < 2) { return; }
    d.ratio = std::exp(mean.mean());
    d.p_value = two_sided_p(mean);
    d.pairs = mean.count();
    found.push_back(std::move(d));
}

/// What a step means: the same for all its seeds.
const std::string& settings_of(const by_seed& runs) { return runs.begin()->second->settings; }

/// Each step of the first study that the second has too, with the same settings.
template <typename Visit>
void for_each_common(const std::map<step, by_seed>& before, const std::map<step, by_seed>& after, const Visit& visit) {
    for (const auto& [where, runs] : before) {
        const auto now = after.find(where);
        if (now != after.end() && settings_of(runs) == settings_of(now->second)) { visit(where, runs, now->second); }
    }
}

bool has_scene(const study& all, const std::string& scene) {
    return std::any_of(all.runs.begin(), all.runs.end(), [&](const run_note& r) { return r.scene == scene; });
}

std::string value_of(const text_pairs& pairs, const std::string& name) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == name; });
    return found == pairs.end() ? "not told" : found->second;
}

void add_missing_scenes(std::vector<std::string>& lines, const study& from, const study& in, const char* which) {
    std::set<std::string> scenes;
    for (const run_note& r : from.runs) { scenes.insert(r.scene); }
    for (const std::string& scene : scenes) {
        if (!has_scene(in, scene)) { lines.push_back(scene + ": not in the " + which + " report"); }
    }
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
    for (const quantity& what : quantities) {
        std::map<std::pair<std::string, std::string>, std::vector<double>> together;
        for_each_common(old_steps, new_steps, [&](const step& where, const by_seed& old_runs, const by_seed& new_runs) {
            const std::vector<double> logs = log_ratios(old_runs, new_runs, what);
            add(found, {.scene = where.scene, .method = where.method, .budget = where.budget, .quantity = what.name},
                logs);
            auto& all = together[{where.scene, where.method}];
            all.insert(all.end(), logs.begin(), logs.end());
        });
        for (const auto& [where, logs] : together) {
            add(found, {.scene = where.first, .method = where.second, .quantity = what.name}, logs);
        }
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

std::vector<std::string> losses(const study& before, const study& after) {
    const std::map<step, by_seed> new_steps = steps_of(after);
    std::vector<std::string> lines;
    for (const auto& [where, old_runs] : steps_of(before)) {
        if (!has_scene(after, where.scene)) { continue; }
        const auto now = new_steps.find(where);
        if (now != new_steps.end() && settings_of(old_runs) != settings_of(now->second)) {
            lines.push_back(where.told() + ": " + settings_of(old_runs) + " before, now " + settings_of(now->second));
        }
        for (const auto& [seed, run] : old_runs) {
            const bool there = now != new_steps.end() && now->second.contains(seed);
            const std::string name = where.told() + ", seed " + std::to_string(seed);
            if (!there) { lines.push_back(name + ": not in the second report"); }
            const std::size_t broken = there ? now->second.at(seed)->error.broken : 0;
            if (broken > run->error.broken) {
                lines.push_back(name + ": " + std::to_string(broken) + " broken pixels, " +
                                std::to_string(run->error.broken) + " before");
            }
        }
    }
    return lines;
}

std::vector<std::string> other_scenes(const study& before, const study& after) {
    std::vector<std::string> lines;
    for (const scene_note& old : before.scenes) {
        for (const scene_note& now : after.scenes) {
            if (now.name != old.name) { continue; }
            const auto size = [](const scene_note& s) {
                return std::to_string(s.width) + "x" + std::to_string(s.height);
            };
            if (size(now) != size(old)) {
                lines.push_back(old.name + ": pictures of " + size(old) + " before, now of " + size(now));
            } else if (now.reference != old.reference ||
                       std::abs(now.reference_relmse - old.reference_relmse) > 1e-3 * old.reference_relmse) {
                lines.push_back(old.name + ": another reference");
            }
        }
    }
    return lines;
}

std::vector<std::string> unlike(const study& before, const study& after) {
    std::vector<std::string> lines;
    for (const auto& [name, value] : before.provenance) {
        const std::string now = value_of(after.provenance, name);
        if (now != value) { lines.push_back(name + ": " + value + " before, now " + now); }
    }
    add_missing_scenes(lines, before, after, "second");
    add_missing_scenes(lines, after, before, "first");
    return lines;
}

std::string told(std::span<const difference> all) {
    std::vector<const difference*> order;
    for (const difference& d : all) {
        if (d.ratio != 1) { order.push_back(&d); }
    }
    std::stable_sort(order.begin(), order.end(), [](const difference* a, const difference* b) {
        return a->significant != b->significant ? a->significant : a->adjusted_p < b->adjusted_p;
    });
    std::string out;
    for (const difference* d : order) {
        out += std::string{d->significant ? (d->ratio > 1 ? "WORSE   " : "better  ") : "        "} + d->scene + ", " +
               d->method + (d->budget ? ", step " + std::to_string(*d->budget + 1) : ", all steps") + ": " +
               d->quantity + " × " + rounded(d->ratio) + " (p " + rounded(d->adjusted_p) + ", " +
               std::to_string(d->pairs) + " pairs)\n";
    }
    return out;
}

}  // namespace error_vs_time
