#include "error_vs_time/records.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>

#include "error_vs_time/json.hpp"

namespace error_vs_time {

namespace {

constexpr const char* schema_name = "aglow error_vs_time";

struct error_field {
    const char* name;
    double aglow::image_error::*value;
};

constexpr error_field error_fields[]{
    {"mape", &aglow::image_error::mape},
    {"smape", &aglow::image_error::smape},
    {"relmse", &aglow::image_error::relmse},
    {"relmse_trimmed", &aglow::image_error::relmse_trimmed},
    {"mse", &aglow::image_error::mse},
    {"rmse", &aglow::image_error::rmse},
    {"energy_bias", &aglow::image_error::energy_bias},
    {"relative_q50", &aglow::image_error::relative_q50},
    {"relative_q95", &aglow::image_error::relative_q95},
    {"relative_q99", &aglow::image_error::relative_q99},
    {"relative_max", &aglow::image_error::relative_max},
    {"absolute_max", &aglow::image_error::absolute_max},
};

std::string digits(double number) {
    char text[64];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

/// A field of a CSV line: in quotes where it must be (RFC 4180).
std::string field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) { return text; }
    std::string out = "\"";
    for (const char c : text) { out += c == '"' ? std::string{"\"\""} : std::string{c}; }
    return out + '"';
}

using pair_list = number_pairs run_note::*;

std::vector<std::string> names_of(const study& all, pair_list pairs) {
    std::vector<std::string> names;
    for (const run_note& run : all.runs) {
        for (const auto& [name, value] : run.*pairs) {
            if (std::find(names.begin(), names.end(), name) == names.end()) { names.push_back(name); }
        }
    }
    return names;
}

std::string value_of(const number_pairs& pairs, const std::string& name) {
    const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == name; });
    return found == pairs.end() ? std::string{} : digits(found->second);
}

json as_json(const number_pairs& pairs) {
    json::object all;
    for (const auto& [name, value] : pairs) { all.emplace_back(name, value); }
    return all;
}

json as_json(const text_pairs& pairs) {
    json::object all;
    for (const auto& [name, value] : pairs) { all.emplace_back(name, value); }
    return all;
}

json as_json(const scene_note& s) {
    return json::object{{"name", s.name},
                        {"description", s.description},
                        {"width", s.width},
                        {"height", s.height},
                        {"reference", s.reference},
                        {"reference_relmse", s.reference_relmse},
                        {"reference_mape", s.reference_mape},
                        {"reference_pictures", s.reference_pictures}};
}

json as_json(const run_note& r) {
    json::object error;
    for (const error_field& f : error_fields) { error.emplace_back(f.name, r.error.*f.value); }
    error.emplace_back("broken", r.error.broken);
    error.emplace_back("pixels", r.error.pixels);
    return json::object{{"scene", r.scene},
                        {"method", r.method},
                        {"budget", r.budget},
                        {"settings", r.settings},
                        {"seed", std::to_string(r.seed)},
                        {"cpu_seconds", r.cpu_seconds},
                        {"wall_seconds", r.wall_seconds},
                        {"threads", static_cast<std::size_t>(r.threads)},
                        {"phases", as_json(r.phases)},
                        {"counts", as_json(r.counts)},
                        {"peak_bytes", r.peak_bytes},
                        {"error", std::move(error)}};
}

json as_json(const parts_note& p) {
    return json::object{{"scene", p.scene},
                        {"method", p.method},
                        {"budget", p.budget},
                        {"bias2", p.parts.bias2},
                        {"bias2_error", p.parts.bias2_error},
                        {"variance", p.parts.variance},
                        {"pictures", p.parts.pictures}};
}

json as_json(const audit_note& a) {
    return json::object{{"scene", a.scene},
                        {"method", a.method},
                        {"budget", a.budget},
                        {"status", a.status},
                        {"statement", a.statement},
                        {"target", a.target},
                        {"bound", a.bound},
                        {"true_error", a.true_error},
                        {"bias_low", a.bias_low},
                        {"bias_high", a.bias_high},
                        {"true_bias", a.true_bias},
                        {"seconds", a.seconds},
                        {"render_seconds", a.render_seconds}};
}

template <typename Notes>
json as_list(const Notes& notes) {
    json::list all;
    for (const auto& note : notes) { all.push_back(as_json(note)); }
    return all;
}

/// What JSON has no number for is written as null.
constexpr double endless = std::numeric_limits<double>::infinity();

std::size_t size_of(const json& value) { return static_cast<std::size_t>(value.number()); }

number_pairs numbers_from(const json& value) {
    number_pairs pairs;
    for (const auto& [name, number] : value.members()) { pairs.emplace_back(name, number.number()); }
    return pairs;
}

scene_note scene_from(const json& j) {
    return {j["name"].text(),
            j["description"].text(),
            size_of(j["width"]),
            size_of(j["height"]),
            j["reference"].text(),
            j["reference_relmse"].number(),
            j["reference_mape"].number(),
            static_cast<std::size_t>(j["reference_pictures"].number(1))};
}

run_note run_from(const json& j) {
    run_note r{.scene = j["scene"].text(), .method = j["method"].text(), .budget = size_of(j["budget"])};
    r.settings = j["settings"].text();
    const std::string& seed = j["seed"].text();
    std::from_chars(seed.data(), seed.data() + seed.size(), r.seed);
    r.cpu_seconds = j["cpu_seconds"].number();
    r.wall_seconds = j["wall_seconds"].number();
    r.threads = static_cast<unsigned>(j["threads"].number());
    r.phases = numbers_from(j["phases"]);
    r.counts = numbers_from(j["counts"]);
    r.peak_bytes = j["peak_bytes"].number();
    for (const error_field& f : error_fields) { r.error.*f.value = j["error"][f.name].number(endless); }
    r.error.broken = size_of(j["error"]["broken"]);
    r.error.pixels = size_of(j["error"]["pixels"]);
    return r;
}

parts_note parts_from(const json& j) {
    return {j["scene"].text(),
            j["method"].text(),
            size_of(j["budget"]),
            {j["bias2"].number(endless), j["bias2_error"].number(endless), j["variance"].number(endless),
             size_of(j["pictures"])}};
}

audit_note audit_from(const json& j) {
    return {j["scene"].text(),
            j["method"].text(),
            size_of(j["budget"]),
            j["status"].text(),
            j["statement"].text(),
            j["target"].number(),
            j["bound"].number(endless),
            j["true_error"].number(endless),
            j["bias_low"].number(-endless),
            j["bias_high"].number(endless),
            j["true_bias"].number(endless),
            j["seconds"].number(),
            j["render_seconds"].number()};
}

}  // namespace

std::string runs_csv(const study& all) {
    const std::vector<std::string> phases = names_of(all, &run_note::phases);
    const std::vector<std::string> counts = names_of(all, &run_note::counts);
    std::string out = "scene,method,budget,settings,seed,cpu_seconds,wall_seconds,threads,peak_bytes,broken";
    for (const error_field& f : error_fields) { out += std::string{','} + f.name; }
    for (const std::string& name : phases) { out += ',' + field("seconds " + name); }
    for (const std::string& name : counts) { out += ',' + field("count " + name); }
    out += '\n';
    for (const run_note& r : all.runs) {
        out += field(r.scene) + ',' + field(r.method) + ',' + std::to_string(r.budget) + ',' + field(r.settings) + ',' +
               std::to_string(r.seed) + ',' + digits(r.cpu_seconds) + ',' + digits(r.wall_seconds) + ',' +
               std::to_string(r.threads) + ',' + digits(r.peak_bytes) + ',' + std::to_string(r.error.broken);
        for (const error_field& f : error_fields) { out += ',' + digits(r.error.*f.value); }
        for (const std::string& name : phases) { out += ',' + value_of(r.phases, name); }
        for (const std::string& name : counts) { out += ',' + value_of(r.counts, name); }
        out += '\n';
    }
    return out;
}

std::string report_json(const study& all) {
    return json{json::object{{"schema", schema_name},
                             {"version", schema_version},
                             {"title", all.title},
                             {"baseline", all.baseline},
                             {"provenance", as_json(all.provenance)},
                             {"relmse_targets", json::list(all.relmse_targets.begin(), all.relmse_targets.end())},
                             {"scenes", as_list(all.scenes)},
                             {"runs", as_list(all.runs)},
                             {"parts", as_list(all.parts)},
                             {"audits", as_list(all.audits)}}}
               .dump() +
           '\n';
}

study read_report(std::string_view json_text) {
    const json all = parse_json(json_text);
    if (all["schema"].text() != schema_name) { throw std::runtime_error("not a report of error_vs_time"); }
    if (all["version"].number() != schema_version) {
        throw std::runtime_error("a report of version " + digits(all["version"].number()) + ", not " +
                                 std::to_string(schema_version));
    }
    study result{.title = all["title"].text(), .baseline = all["baseline"].text()};
    for (const auto& [name, value] : all["provenance"].members()) {
        result.provenance.emplace_back(name, value.text());
    }
    if (!all["relmse_targets"].elements().empty()) { result.relmse_targets.clear(); }
    for (const json& j : all["relmse_targets"].elements()) { result.relmse_targets.push_back(j.number()); }
    for (const json& j : all["scenes"].elements()) { result.scenes.push_back(scene_from(j)); }
    for (const json& j : all["runs"].elements()) { result.runs.push_back(run_from(j)); }
    for (const json& j : all["parts"].elements()) { result.parts.push_back(parts_from(j)); }
    for (const json& j : all["audits"].elements()) { result.audits.push_back(audit_from(j)); }
    return result;
}

}  // namespace error_vs_time
