// Error against run time: scenes × methods × budgets × seeds, written as CSV, JSON and a page to look at.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <aglow/report/bias_variance.hpp>

#include "common/image_io.hpp"
#include "common/progress.hpp"
#include "common/scenes/registry.hpp"
#include "error_vs_time/ladder.hpp"
#include "error_vs_time/make_run.hpp"
#include "error_vs_time/options.hpp"
#include "error_vs_time/plot.hpp"
#include "error_vs_time/png.hpp"
#include "error_vs_time/provenance.hpp"
#include "error_vs_time/records.hpp"
#include "error_vs_time/report_page.hpp"
#include "error_vs_time/seeds.hpp"
#include "error_vs_time/truth.hpp"
#include "error_vs_time/work_left.hpp"

using namespace error_vs_time;

namespace {

using description = host::scene_description<float>;

/// Replaces `file` at once, so that a stop in the middle leaves the old one.
void write(const std::filesystem::path& file, const std::string& text) {
    const std::filesystem::path part = file.string() + ".part";
    std::ofstream out{part, std::ios::binary};
    out << text;
    out.close();
    if (!out) { throw std::runtime_error(file.string() + ": cannot be written"); }
    std::filesystem::rename(part, file);
}

std::vector<description> scenes_named(const std::vector<std::string>& names) {
    std::vector<description> found;
    for (const std::string& name : names) {
        auto scene = host::scenes::find<float>(name);
        if (!scene) {
            std::string known;
            for (const description& s : host::scenes::all<float>()) { known += ' ' + s.name; }
            throw std::invalid_argument("no scene " + name + "; there are" + known);
        }
        found.push_back(std::move(*scene));
    }
    return found;
}

/// One step of a method in a scene, with all its seeds.
struct rung {
    const description& scene;
    const ladder& method;
    std::size_t step;
    bool last;  ///< of its method: the last picture is shown and audited

    template <typename Note>
    [[nodiscard]] bool is_of(const Note& note) const {
        return scene.name == note.scene && method.name == note.method && note.budget == step;
    }
};

class runner {
public:
    runner(const options& o, const text_pairs& made_with) : options_{o}, scenes_{scenes_named(o.scenes)} {
        std::filesystem::create_directories(o.output / "pictures");
        study_.title = "aglow: error against run time";
        study_.baseline = "path tracing";
        study_.provenance = made_with;
        if (!o.relmse_targets.empty()) { study_.relmse_targets = o.relmse_targets; }
        resume();
        plan();
    }

    void run() {
        std::size_t done = 0;
        for (const description& scene : scenes_) {
            const truth known = made_truth(scene);
            study_.scenes.push_back(known.note);
            for (const rung& r : rungs_) {
                if (&r.scene == &scene) { climb(r, known, done); }
            }
            show({.scene = scene.name, .method = "reference"}, known.mean(), {});
        }
        earlier_ = {};
        write_all();
        std::printf("\n%s\nwritten to %s\n", report_markdown(study_).c_str(), options_.output.c_str());
    }

private:
    // ---- what is to be done -----------------------------------------------------------------------------------------

    [[nodiscard]] bool wanted(const ladder& method, std::size_t step) const {
        if (step >= method.steps.size()) { return false; }
        return options_.smoke ? step == 0 : options_.full || !method.steps[step].full;
    }

    void plan() {
        for (const description& scene : scenes_) {
            for (const ladder& method : ladders_) {
                for (std::size_t step = 0; wanted(method, step); ++step) {
                    rungs_.push_back({scene, method, step, !wanted(method, step + 1)});
                    left_.expect(cost(rungs_.back()) * static_cast<double>(options_.seeds));
                }
            }
            if (must_be_made(scene, options_.size, reference_file(scene))) { left_.expect(reference_cost()); }
        }
    }

    [[nodiscard]] static double cost(const rung& r) { return r.method.steps[r.step].cost; }
    /// Of path tracing at 4 samples, which the first rung is.
    [[nodiscard]] double reference_cost() const {
        return ladders_.front().steps.front().cost / 4 * 2 * options_.reference_samples;
    }
    [[nodiscard]] std::filesystem::path reference_file(const description& scene) const {
        return kept_file(scene, options_.size, options_.reference_samples, options_.output / "pictures");
    }
    /// Named by its step too: the last of a short study is not that of a long one.
    [[nodiscard]] std::filesystem::path picture_file(const rung& r) const {
        std::string name = r.scene.name + '-' + r.method.name + "-step-" + std::to_string(r.step + 1) + ".exr";
        std::replace(name.begin(), name.end(), ' ', '-');
        return options_.output / "pictures" / name;
    }

    truth made_truth(const description& scene) {
        const std::filesystem::path kept = reference_file(scene);
        const bool new_one = must_be_made(scene, options_.size, kept);
        const auto begun = work_left::clock::now();
        truth known = truth_of(scene, options_.size, options_.reference_samples, kept);
        if (new_one) { left_.did(reference_cost(), since(begun)); }
        return known;
    }

    // ---- an earlier, unfinished study of the same making ------------------------------------------------------------

    void resume() {
        std::ifstream in{options_.output / "report.json", std::ios::binary};
        if (!in) { return; }
        try {
            study before = read_report(std::string{std::istreambuf_iterator<char>{in}, {}});
            if (same_making(before.provenance, study_.provenance)) { earlier_ = std::move(before); }
        } catch (const std::runtime_error&) { return; }  // cut off or of another version: nothing to go on with
    }

    [[nodiscard]] std::size_t runs_known(const rung& r) const {
        return static_cast<std::size_t>(std::count_if(earlier_.runs.begin(), earlier_.runs.end(), [&](const auto& run) {
            return r.is_of(run) && run.settings == r.method.told(r.step);
        }));
    }

    /// Takes a step over whole: its runs, their bias and variance, and, where it is the last, the audit and the
    /// picture.
    bool taken_over(const rung& r, const truth& known) {
        const auto parts =
            std::find_if(earlier_.parts.begin(), earlier_.parts.end(), [&](const parts_note& p) { return r.is_of(p); });
        if (runs_known(r) != options_.seeds || parts == earlier_.parts.end()) { return false; }
        const auto audit = std::find_if(earlier_.audits.begin(), earlier_.audits.end(),
                                        [&](const audit_note& a) { return r.is_of(a); });
        std::vector<float> picture;
        if (r.last) {
            picture = kept_picture(r);
            if (picture.empty() || audit == earlier_.audits.end()) { return false; }
            study_.audits.push_back(*audit);
        }
        study_.parts.push_back(*parts);
        for (const run_note& run : earlier_.runs) {
            if (r.is_of(run)) { study_.runs.push_back(run); }
        }
        if (r.last) { show_run(study_.runs.back(), picture, known); }
        return true;
    }

    /// The picture that an earlier study showed; empty where it is not there whole.
    [[nodiscard]] std::vector<float> kept_picture(const rung& r) const {
        try {
            const host::picture image = host::read_exr(picture_file(r));
            if (image.width == options_.size && image.height == options_.size) { return values_of(image); }
        } catch (const std::runtime_error&) { return {}; }
        return {};
    }

    /// What this study has, and what an earlier one has besides that may still be taken over.
    [[nodiscard]] study all_known() const {
        study all = study_;
        for (const rung& r : rungs_) {
            const auto has = [&](const auto& note) { return r.is_of(note); };
            if (std::any_of(all.runs.begin(), all.runs.end(), has)) { continue; }
            std::copy_if(earlier_.runs.begin(), earlier_.runs.end(), std::back_inserter(all.runs), has);
            std::copy_if(earlier_.parts.begin(), earlier_.parts.end(), std::back_inserter(all.parts), has);
            if (!r.last) { continue; }
            std::copy_if(earlier_.audits.begin(), earlier_.audits.end(), std::back_inserter(all.audits), has);
        }
        return all;
    }

    // ---- the work ---------------------------------------------------------------------------------------------------

    /// All seeds of one step.
    void climb(const rung& r, const truth& known, std::size_t& done) {
        if (taken_over(r, known)) {
            done += options_.seeds;
            left_.spared(cost(r) * static_cast<double>(options_.seeds));
            return;
        }
        aglow::bias_variance parts;
        for (std::size_t i = 0; i < options_.seeds; ++i) {
            tell(++done, r);
            const auto begun = work_left::clock::now();
            made_run made = make_run(r.scene, r.method, r.step, first_seed + i, options_.size);
            made.note.error = known.compare(made.values);
            parts.add(view(made.values));
            study_.runs.push_back(made.note);
            if (r.last && i + 1 == options_.seeds) { finish(r, made, known); }
            left_.did(cost(r), since(begun));
        }
        study_.parts.push_back(
            {r.scene.name, r.method.name, r.step, parts.parts(view(known.first), view(known.second))});
        write(options_.output / "report.json", report_json(all_known()));
    }

    /// Audits the last picture of a method, keeps it and shows it.
    void finish(const rung& r, const made_run& made, const truth& known) {
        study_.audits.push_back(audit_run(r.scene, made, 0.05, known.mean(), options_.size));
        host::picture guess{options_.size, options_.size};
        for (std::size_t i = 0; i < made.guess.size(); ++i) { guess.pixels[i] = aglow::vec3<float>{made.guess[i]}; }
        host::write_exr(picture_file(r), {{"", picture_of(made.values, options_.size)}, {"guess", guess}});
        show_run(made.note, made.values, known);
    }

    void show_run(const run_note& run, const std::vector<float>& values, const truth& known) {
        const std::string caption =
            run.settings + ", " + rounded(run.cpu_seconds, 2) + " s, relMSE " + rounded(run.error.relmse, 2);
        show({.scene = run.scene, .method = run.method, .caption = caption}, values, known.mean());
    }

    void show(picture_note note, const std::vector<float>& values, const std::vector<float>& truth) {
        note.width = note.height = options_.size;
        note.rgb = shown(values);
        if (!truth.empty()) { note.error_rgb = shown_error(values, truth, dark_of(truth)); }
        study_.pictures.push_back(std::move(note));
    }

    /// What the MAPE adds to each pixel's reference.
    [[nodiscard]] double dark_of(const std::vector<float>& truth) const {
        return aglow::image_error_options{}.dark * aglow::mean_value(view(truth));
    }

    [[nodiscard]] aglow::image_view<float> view(const std::vector<float>& values) const {
        return {values, options_.size, options_.size, 3};
    }

    // ---- what is told -----------------------------------------------------------------------------------------------

    [[nodiscard]] static double since(work_left::clock::time_point begun) {
        return std::chrono::duration<double>(work_left::clock::now() - begun).count();
    }

    void tell(std::size_t done, const rung& r) const {
        const bool terminal = isatty(STDOUT_FILENO) != 0;
        const std::string left = left_.known() ? "  (about " + host::spoken(left_.seconds()) + " left)" : "";
        std::printf("%s%zu/%zu  %s, %s, %s%s%s", terminal ? "\r\033[K" : "", done, rungs_.size() * options_.seeds,
                    r.scene.name.c_str(), r.method.name, r.method.told(r.step).c_str(), left.c_str(),
                    terminal ? "" : "\n");
        std::fflush(stdout);
    }

    void write_all() const {
        write(options_.output / "report.json", report_json(study_));
        write(options_.output / "runs.csv", runs_csv(study_));
        write(options_.output / "report.html", report_html(study_));
        write(options_.output / "report.md", report_markdown(study_));
        for (const scene_note& scene : study_.scenes) {
            write(options_.output / (scene.name + "-relmse.svg"), report_svg(study_, scene.name, metrics()[1]));
        }
    }

    options options_;
    std::vector<description> scenes_;
    std::vector<ladder> ladders_{ladders()};
    std::vector<rung> rungs_{};
    study study_{};
    study earlier_{};
    work_left left_{};
};

}  // namespace

int main(int count, char** arguments) {
    try {
        const std::vector<std::string_view> words(arguments + 1, arguments + count);
        const options asked = parse(words);
        if (asked.help) {
            std::fputs(usage.data(), stdout);
            return 0;
        }
        runner{asked, provenance(asked, words)}.run();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error_vs_time: %s\n", error.what());
        return 2;
    }
}
