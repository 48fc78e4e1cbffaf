// How wrong a rendering is: pictures that go on until an error is certified, error bars, and statements.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/report/render_until.hpp>
#include <aglow/report/statement.hpp>

#include "common/audited_film.hpp"
#include "common/camera.hpp"
#include "common/developed.hpp"
#include "common/interruption.hpp"
#include "common/light_set.hpp"
#include "common/probe_paths.hpp"
#include "common/progress.hpp"
#include "render/options.hpp"
#include "render/passes.hpp"
#include "render/phases.hpp"
#include "render/report.hpp"

namespace host {

/// Holds pictures of one scene to path tracing.
template <typename World>
class certifier {
    using T = float;
    using S = vec3<float>;

public:
    /// Keeps references to all but `view`.
    certifier(const World& scene, const light_set<T>& lights, const camera<T>& view, const render_options& options,
              const aglow::own_threads& run)
        : scene_{scene}, lights_{lights}, view_{view}, options_{options}, run_{run} {}

    /// A film with samples until an audit certifies the error that was asked for, or it is clear that none will; what
    /// came of it is told to `result`. `lookups` are those of a sample.
    template <typename Integrator>
    [[nodiscard]] aglow::film<S> until(const Integrator& integrator, const sample_lookups& lookups,
                                       const time_budget& budget, render_result& result) {
        const double begun = budget.spent();
        exposure taken{.film{options_.width, options_.height}};
        std::optional<aglow::audited_film<T>> numbers;
        const auto advance = [&](double work) {
            if (!expose(taken, integrator, work, budget)) { throw interrupted{}; }
            return numbers.emplace(taken.film).view();
        };
        aglow::render_until_options o;
        o.audit = {.target = options_.until, .seed = options_.seed};
        o.first_work = 4;
        o.most_work = 1 << 16;
        o.progress = [&](const aglow::until_progress& p) {
            const double more = p.predicted_work / p.last.work - 1;
            const bool goes_on = more > 0 && aglow::is_finite(more);
            std::printf("%.0f samples a pixel: mean relative error about %.2f %%%s\n", p.last.work, 100 * p.last.error,
                        goes_on ? (", about " + spoken(more * (budget.spent() - begun)) + " left").c_str() : "");
            return !budget.is_over();
        };
        const interruptible looking{run_, [&] { return budget.is_over(); }};
        try {
            o.probe_work = probe_work(integrator, lookups);
            const aglow::until_result reached =
                with_probe([&](const auto& probe) { return aglow::render_until(advance, probe, o, looking); });
            tell(reached, budget, result);
        } catch (const interrupted&) {
            if (taken.film.samples() == 0) { (void)expose(taken, integrator, o.first_work, budget); }
            tell({.status = aglow::until_status::cancelled}, budget, result);
        }
        result.phases.push_back({"picture and audits", budget.spent() - begun});
        result.add_fact("samples a pixel", taken.film.samples());
        return std::move(taken.film);
    }

    /// Audits a finished film: the statements, and the error bars of all pixels.
    void audit(const aglow::film<S>& film, const time_budget& budget, render_result& result) {
        try {
            audit_whole(film, budget, result);
        } catch (const interrupted&) { result.notes.push_back("interrupted: the picture is not audited"); }
    }

private:
    /// A film, and the seconds that its samples took.
    struct exposure {
        aglow::film<S> film;
        double seconds{0};
    };

    /// Takes samples up to `work` a pixel, one pass at least; false where the time was over between two passes.
    template <typename Integrator>
    [[nodiscard]] bool expose(exposure& taken, const Integrator& integrator, double work, const time_budget& budget) {
        const auto wanted = static_cast<std::uint32_t>(std::ceil(work));
        for (std::uint32_t so_far = taken.film.samples(); so_far < wanted; so_far = taken.film.samples()) {
            if (so_far > 0 && budget.is_over()) { return false; }
            const double begun = budget.spent();
            const std::uint32_t pass = samples_of_pass(so_far, taken.seconds, budget.left());
            const std::uint32_t samples = std::min(pass, wanted - so_far);
            taken.film.expose(eye(), integrator, {.samples = samples, .seed = options_.seed}, run_);
            taken.seconds += budget.spent() - begun;
        }
        return true;
    }

    void audit_whole(const aglow::film<S>& film, const time_budget& budget, render_result& result) {
        const double begun = budget.spent();
        const classified_film numbers{film, features(),
                                      aglow::caustic_light(scene_, lights_, eye(), options_.width, options_.height,
                                                           {.seed = options_.seed}, probing_)};
        aglow::audit_options o{
            .target = options_.until > 0 ? options_.until : 0.05, .seed = options_.seed, .stream = 1};
        o.budget = options_.error_samples.value_or(o.budget);
        const aglow::audit_result stated =
            with_probe([&](const auto& probe) { return aglow::audit(numbers.view(), probe, o, probing_); });
        result.phases.push_back({"audit", budget.spent() - begun});
        if (options_.until == 0) { note(stated, result); }
        const std::vector<double> bars = aglow::error_bars(numbers.view(), stated);
        picture layer{options_.width, options_.height};
        for (std::size_t i = 0; i < bars.size(); ++i) { layer.pixels[i] = S{static_cast<T>(bars[i])}; }
        result.heat = heat_map(developed(film), bars);
        result.layers.push_back({"error_bar", std::move(layer)});
    }

    [[nodiscard]] auto eye() const {
        return [this](const vec2<T>& film) { return view_.through(film, options_.width, options_.height); };
    }

    /// What looks at pixels again, made when it is first asked for.
    [[nodiscard]] const probe_paths<World>& judge() {
        if (!judge_) { judge_.emplace(scene_, lights_, options_.seed, run_); }
        return *judge_;
    }

    template <typename Use>
    auto with_probe(const Use& use) {
        const auto through = eye();
        const auto tracer = judge().tracer();
        return use(aglow::pixel_probe{through, tracer, options_.width});
    }

    [[nodiscard]] std::vector<char> features() const {
        return feature_pixels(options_.width, options_.height, [this](std::size_t x, std::size_t y) {
            const auto hit = scene_.intersect(eye()({static_cast<T>(x) + T(0.5), static_cast<T>(y) + T(0.5)}));
            return hit ? static_cast<std::uint32_t>(hit->primitive) : ~0u;
        });
    }

    /// What a sample of a probe costs, in samples of every pixel by `integrator`.
    template <typename Integrator>
    [[nodiscard]] double probe_work(const Integrator& integrator, const sample_lookups& lookups) {
        const auto rays = [&](const auto& of) {
            return rays_a_sample(eye(), of, options_.width, options_.height, options_.seed);
        };
        return (rays(judge().tracer()) + judge().guiding_cost()) / (rays(integrator) + lookups.cost()) /
               static_cast<double>(options_.width * options_.height);
    }

    static void tell(const aglow::until_result& reached, const time_budget& budget, render_result& result) {
        if (reached.status == aglow::until_status::unreachable) {
            result.notes.push_back("the error cannot be reached with these settings: more samples will not do");
        }
        if (reached.status == aglow::until_status::cancelled) {
            result.notes.push_back(budget.ended() ? "interrupted before the error could be certified"
                                                  : "the time was over before the error could be certified");
        } else if (reached.claims > 0 || reached.status == aglow::until_status::broken) {
            note(reached.certificate, result);
        } else if (!reached.checks.empty()) {
            char text[80];
            std::snprintf(text, sizeof text, "not certified: the mean relative error is about %.3g %%",
                          100 * reached.checks.back().error);
            result.notes.push_back(text);
        }
    }
    static void note(const aglow::audit_result& stated, render_result& result) {
        std::istringstream lines{aglow::statement(stated)};
        for (std::string line; std::getline(lines, line);) { result.notes.push_back(line); }
    }

    const World& scene_;
    const light_set<T>& lights_;
    camera<T> view_;
    const render_options& options_;
    const aglow::own_threads& run_;
    interruptible<aglow::own_threads> probing_{run_};  ///< of what is not kept in part
    std::optional<probe_paths<World>> judge_{};
};

}  // namespace host
