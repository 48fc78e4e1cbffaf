// Error against run time: scenes × methods × budgets × seeds, written as CSV, JSON and a page to look at.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <aglow/core/version.hpp>
#include <aglow/report/bias_variance.hpp>

#include "common/image_io.hpp"
#include "common/scenes/registry.hpp"
#include "error_vs_time/ladder.hpp"
#include "error_vs_time/make_run.hpp"
#include "error_vs_time/records.hpp"
#include "error_vs_time/report_page.hpp"

using namespace error_vs_time;

namespace {

struct settings {
    std::filesystem::path output{"build/error_vs_time"};
    std::vector<std::string> scenes{"cornell-diffuse", "cornell-glass"};
    std::size_t size{256};
    std::size_t seeds{3};
    std::uint32_t reference_samples{2048};
    bool full{false};
    bool smoke{false};
};

constexpr std::string_view usage =
    "usage: error_vs_time [--output DIR] [--scene NAME]... [--size N] [--seeds N] [--full | --smoke]\n"
    "Renders scenes by all methods at rising budgets and writes runs.csv, report.json, report.html, report.md and the\n"
    "curves of each scene as SVG into DIR (build/error_vs_time). What DIR holds already of the same study is not "
    "rendered again. A few minutes; with\n"
    "--full, hours: more seeds, larger budgets, all scenes.\n";

settings parse(int count, char** arguments) {
    settings result;
    bool named = false;
    for (int i = 1; i < count; ++i) {
        const std::string_view word = arguments[i];
        const auto value = [&]() -> std::string {
            if (++i >= count) { throw std::invalid_argument(std::string{word} + " wants a value"); }
            return arguments[i];
        };
        if (word == "--output") {
            result.output = value();
        } else if (word == "--scene") {
            if (!named) { result.scenes.clear(); }
            named = true;
            result.scenes.push_back(value());
        } else if (word == "--size") {
            result.size = std::stoul(value());
        } else if (word == "--seeds") {
            result.seeds = std::max(2ul, std::stoul(value()));
        } else if (word == "--full") {
            result.full = true;
            result.seeds = 8;
        } else if (word == "--smoke") {
            result.smoke = true;
            result.size = 16;
            result.seeds = 2;
            result.reference_samples = 16;
            result.scenes = {"cornell-diffuse"};
        } else {
            throw std::invalid_argument("unknown option " + std::string{word});
        }
    }
    if (result.full && !named) {
        result.scenes.insert(result.scenes.end(), {"glossy-floor", "point-light", "sky-room"});
    }
    return result;
}

/// Replaces `file` at once, so that a stop in the middle leaves the old one.
void write(const std::filesystem::path& file, const std::string& text) {
    const std::filesystem::path part = file.string() + ".part";
    std::ofstream{part, std::ios::binary} << text;
    std::filesystem::rename(part, file);
}

std::string first_line_of(const char* file, const std::string& start) {
    std::ifstream in{file};
    for (std::string line; std::getline(in, line);) {
        if (line.rfind(start, 0) == 0) { return line.substr(line.find(':') + 2); }
    }
    return "unknown";
}

text_pairs provenance(const settings& s) {
    return {{"library", "aglow " + std::to_string(aglow::version.major) + "." + std::to_string(aglow::version.minor) +
                            "." + std::to_string(aglow::version.patch)},
            {"compiler", __VERSION__},
#ifdef __OPTIMIZE__
            {"optimised", "yes"},
#else
            {"optimised", "no"},
#endif
            {"processor", first_line_of("/proc/cpuinfo", "model name")},
            {"threads", "1"},
            {"seeds", std::to_string(s.seeds)},
            {"size", std::to_string(s.size) + " x " + std::to_string(s.size)}};
}

/// A scene's true picture, in two halves where it was made here.
struct truth {
    std::vector<float> first{};
    std::vector<float> second{};
    scene_note note{};

    [[nodiscard]] std::vector<float> mean() const {
        std::vector<float> m(first.size());
        for (std::size_t i = 0; i < m.size(); ++i) { m[i] = 0.5f * first[i] + 0.5f * second[i]; }
        return m;
    }
};

class runner {
public:
    explicit runner(const settings& s) : settings_{s} {
        std::filesystem::create_directories(s.output);
        study_.title = "aglow: error against run time";
        study_.baseline = "path tracing";
        study_.provenance = provenance(s);
        resume();
    }

    void run() {
        std::size_t done = 0;
        const std::size_t all = total();
        for (const std::string& name : settings_.scenes) {
            const auto scene = host::scenes::find<float>(name);
            if (!scene) { throw std::invalid_argument("no scene called " + name); }
            const truth known = truth_of(*scene);
            study_.scenes.push_back(known.note);
            for (const ladder& method : ladders()) { done = climb(*scene, known, method, done, all); }
            add_picture({.scene = name, .method = "reference", .caption = "reference"}, known.mean(), {});
        }
        write_all();
        std::printf("\n%s\nwritten to %s\n", report_markdown(study_).c_str(), settings_.output.c_str());
    }

private:
    [[nodiscard]] bool wanted(const budget& b, std::size_t step) const {
        return settings_.smoke ? step == 0 : settings_.full || !b.full;
    }

    [[nodiscard]] std::size_t total() const {
        std::size_t count = 0;
        for (const ladder& l : ladders()) {
            for (std::size_t i = 0; i < l.steps.size(); ++i) { count += wanted(l.steps[i], i) ? settings_.seeds : 0; }
        }
        return count * settings_.scenes.size();
    }

    /// Takes over the runs of an earlier, unfinished study of the same settings.
    void resume() {
        std::ifstream in{settings_.output / "report.json", std::ios::binary};
        if (!in) { return; }
        try {
            const study before = read_report(std::string{std::istreambuf_iterator<char>{in}, {}});
            if (before.provenance == study_.provenance) { earlier_ = before.runs; }
        } catch (const std::runtime_error&) { earlier_.clear(); }
    }

    [[nodiscard]] const run_note* known_run(const std::string& scene, const ladder& method, std::size_t step,
                                            std::uint64_t seed) const {
        for (const run_note& r : earlier_) {
            if (r.scene == scene && r.method == method.name && r.budget == step && r.seed == seed &&
                r.settings == method.steps[step].told()) {
                return &r;
            }
        }
        return nullptr;
    }

    truth truth_of(const host::scene_description<float>& scene) {
        const std::filesystem::path file = std::filesystem::path{AGLOW_REFERENCES} / (scene.name + ".exr");
        truth known{
            .note = {
                .name = scene.name, .description = scene.about, .width = settings_.size, .height = settings_.size}};
        if (std::filesystem::exists(file) && read_reference(file, known)) { return known; }
        std::printf("reference of %s: path tracing, 2 x %u samples per pixel\n", scene.name.c_str(),
                    settings_.reference_samples);
        reference_halves halves = path_traced(scene, settings_.reference_samples, settings_.size);
        known.first = std::move(halves.first);
        known.second = std::move(halves.second);
        tell_noise(known);
        return known;
    }

    /// Takes the scene's reference picture from its file; false where that is of another size.
    bool read_reference(const std::filesystem::path& file, truth& known) const {
        const host::picture image = host::read_exr(file);
        if (image.width != settings_.size || image.height != settings_.size) { return false; }
        const auto take = [](const host::picture& from, std::vector<float>& into) {
            for (const auto& p : from.pixels) { into.insert(into.end(), {p.x, p.y, p.z}); }
        };
        take(image, known.first);
        if (known.note.name == "cornell-diffuse" || known.note.name == "cornell-glass") {
            known.second = known.first;
            known.note.reference = "an independent path tracer's picture, relMSE between its halves 2e-5";
            known.note.reference_relmse = 2e-5;
            return true;
        }
        take(host::read_exr(file, host::second_half), known.second);
        tell_noise(known);
        return true;
    }

    void tell_noise(truth& known) const {
        const aglow::image_error noise = compare(known.first, known);
        known.note.reference = "own path tracer, two halves";
        known.note.reference_relmse = noise.reference_relmse;
        known.note.reference_mape = noise.reference_mape;
    }

    [[nodiscard]] aglow::image_view<float> view(const std::vector<float>& values) const {
        return {values, settings_.size, settings_.size, 3};
    }
    [[nodiscard]] aglow::image_error compare(const std::vector<float>& image, const truth& known) const {
        return aglow::compare(view(image), view(known.first), view(known.second));
    }

    /// All budgets and seeds of a method. The last picture made is shown and audited.
    std::size_t climb(const host::scene_description<float>& scene, const truth& known, const ladder& method,
                      std::size_t done, std::size_t all) {
        for (std::size_t step = 0; step < method.steps.size(); ++step) {
            if (!wanted(method.steps[step], step)) { continue; }
            const bool last = step + 1 == method.steps.size() || !wanted(method.steps[step + 1], step + 1);
            aglow::bias_variance parts;
            std::size_t collected = 0;
            for (std::uint64_t seed = 1; seed <= settings_.seeds; ++seed) {
                tell(++done, all, scene.name, method, step);
                const run_note* before = last ? nullptr : known_run(scene.name, method, step, seed);
                if (before != nullptr) {
                    study_.runs.push_back(*before);
                    continue;
                }
                made_run made = make_run(scene, method, step, seed, settings_.size);
                made.note.error = compare(made.values, known);
                parts.add(view(made.values));
                ++collected;
                study_.runs.push_back(made.note);
                if (last && seed == settings_.seeds) { show(scene, known, made); }
            }
            if (collected >= 2) {
                study_.parts.push_back(
                    {scene.name, method.name, step, parts.parts(view(known.first), view(known.second))});
            }
            write_records();
        }
        return done;
    }

    void show(const host::scene_description<float>& scene, const truth& known, const made_run& made) {
        study_.audits.push_back(audit_run(scene, made, 0.05, known.mean(), settings_.size));
        char caption[160];
        std::snprintf(caption, sizeof caption, "%s, %.1f s, relMSE %.1e", made.note.settings.c_str(),
                      made.note.cpu_seconds, made.note.error.relmse);
        add_picture({.scene = scene.name, .method = made.note.method, .caption = caption}, made.values, known.mean());
    }

    void add_picture(picture_note note, const std::vector<float>& values, const std::vector<float>& truth) {
        note.width = note.height = settings_.size;
        for (const float x : values) {
            const float c = std::clamp(x, 0.0f, 1.0f);
            const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
            note.rgb.push_back(static_cast<std::uint8_t>(s * 255 + 0.5f));
        }
        for (std::size_t i = 0; i + 2 < truth.size(); i += 3) { add_false_colour(note, &values[i], &truth[i]); }
        study_.pictures.push_back(std::move(note));
    }

    /// Blue where too dark, red where too bright, black where right; full at 20 % off.
    static void add_false_colour(picture_note& note, const float* value, const float* truth) {
        const float light = truth[0] + truth[1] + truth[2] + 0.01f;
        const float off = (value[0] + value[1] + value[2] - light + 0.01f) / light * 5;
        const auto level = [](float x) { return static_cast<std::uint8_t>(255 * std::clamp(x, 0.0f, 1.0f)); };
        const float strong = std::abs(off) - 1;
        note.error_rgb.insert(note.error_rgb.end(), {level(off), level(strong), level(-off)});
    }

    void tell(std::size_t done, std::size_t all, const std::string& scene, const ladder& method,
              std::size_t step) const {
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
        const double left =
            done > 1 ? seconds / static_cast<double>(done - 1) * static_cast<double>(all - done + 1) : 0;
        const bool terminal = isatty(STDOUT_FILENO) != 0;
        std::printf("%s%zu/%zu  %s, %s, %s  (about %.0f s left)   %s", terminal ? "\r\033[K" : "", done, all,
                    scene.c_str(), method.name, method.steps[step].told().c_str(), left, terminal ? "" : "\n");
        std::fflush(stdout);
    }

    void write_records() const { write(settings_.output / "report.json", report_json(study_)); }

    void write_all() const {
        write_records();
        write(settings_.output / "runs.csv", runs_csv(study_));
        write(settings_.output / "report.html", report_html(study_));
        write(settings_.output / "report.md", report_markdown(study_));
        for (const std::string& scene : settings_.scenes) {
            write(settings_.output / (scene + "-relmse.svg"), report_svg(study_, scene, metrics()[1]));
        }
    }

    settings settings_;
    study study_{};
    std::vector<run_note> earlier_{};
    std::chrono::steady_clock::time_point begun_{std::chrono::steady_clock::now()};
};

}  // namespace

int main(int count, char** arguments) {
    if (count > 1 && std::string_view{arguments[1]} == "--help") {
        std::fputs(usage.data(), stdout);
        return 0;
    }
    try {
        runner{parse(count, arguments)}.run();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error_vs_time: %s\n", error.what());
        return 2;
    }
}
