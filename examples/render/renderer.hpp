// Renders a scene by any of the library's ready integrators, and takes their pictures apart.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/layered_integrator.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/plan.hpp>

#include "common/camera.hpp"
#include "common/developed.hpp"
#include "common/drawing.hpp"
#include "common/interruption.hpp"
#include "common/light_set.hpp"
#include "common/probe_paths.hpp"
#include "common/progress.hpp"
#include "render/certifier.hpp"
#include "render/options.hpp"
#include "render/passes.hpp"
#include "render/phases.hpp"
#include "render/report.hpp"
#include "render/settings.hpp"
#include "render/usage_error.hpp"

namespace host {

/// One rendering of one scene. `World` is an aglow `Scene` of floats and RGB with bounds and a position error.
template <typename World>
class renderer {
    using T = float;
    using S = vec3<float>;
    using maps_type = aglow::photon_maps<S, T>;
    using cache_type = aglow::frozen_irradiance_cache<S, T>;

public:
    renderer(const World& scene, const light_set<T>& lights, const camera<T>& view, const render_options& options)
        : scene_{scene},
          lights_{lights},
          view_{view},
          options_{options},
          run_{threads(options)},
          budget_{options.seconds, [begun = options.begun] { return since(begun); }, &interruption::came},
          settings_{options_},
          certifier_{scene, lights, view, options_, run_} {}

    [[nodiscard]] render_result render() {
        if (options_.reference) { return reference(); }
        check_view();
        for (const auto& o : aglow::plan_for(scene_).left_out) {
            result_.notes.push_back("left out: " + o.part + ", " + o.why);
        }
        switch (options_.how) {
            case method::path:
                finish(aglow::path_tracer<World, light_set<T>>{scene_, lights_}, nullptr, nullptr);
                break;
            case method::irradiance_cache: irradiance_cache(); break;
            case method::photon_map: photon_map(); break;
            case method::final_gather: final_gather(); break;
            case method::gather_cache: gather_cache(); break;
        }
        return std::move(result_);
    }

private:
    using clock = std::chrono::steady_clock;

    static aglow::own_threads threads(const render_options& o) {
        return o.threads == 0 ? aglow::own_threads{} : aglow::own_threads{o.threads};
    }
    static double since(clock::time_point start) { return std::chrono::duration<double>(clock::now() - start).count(); }

    [[nodiscard]] auto eye() const {
        return [this](const vec2<T>& film) { return view_.through(film, options_.width, options_.height); };
    }

    /// Refuses what the method has not, before anything is made.
    void check_view() const {
        const bool by_cache = options_.how == method::irradiance_cache;
        const bool maps =
            by_cache ? aglow::irradiance_caching<World, light_set<T>>::has_maps : options_.how != method::path;
        if (!maps && (options_.show == view::photons || options_.show == view::caustic)) {
            throw usage_error(
                "--view photons and caustic need photons: path has none, irradiance-cache only beside mirrors");
        }
        if (options_.show == view::records && !by_cache && options_.how != method::gather_cache) {
            throw usage_error("--view records needs a method with an irradiance cache");
        }
    }

    // ---- methods ----------------------------------------------------------------------------------------------------

    void irradiance_cache() {
        const aglow::irradiance_caching<World, light_set<T>> integrator = prepare([&](const auto& told) {
            return aglow::irradiance_caching<World, light_set<T>>{
                scene_, lights_, scene_.bounds(), eye(), settings_.caching(), run_, told};
        });
        if constexpr (integrator.has_maps) {
            finish(integrator, &integrator.maps(), &integrator.cache());
        } else {
            finish(integrator, nullptr, &integrator.cache());
        }
    }
    void photon_map() {
        const aglow::photon_mapping<World, light_set<T>> integrator = prepare([&](const auto& told) {
            return aglow::photon_mapping<World, light_set<T>>{scene_, lights_, settings_.photon_mapping(), run_, told};
        });
        finish(integrator, &integrator.maps(), nullptr);
    }
    void final_gather() {
        const aglow::final_gathering<World, light_set<T>> integrator = prepare([&](const auto& told) {
            return aglow::final_gathering<World, light_set<T>>{scene_, lights_, settings_.final_gathering(), run_,
                                                               told};
        });
        finish(integrator, &integrator.maps(), nullptr);
    }
    void gather_cache() {
        const aglow::gather_caching<World, light_set<T>> integrator = prepare([&](const auto& told) {
            return aglow::gather_caching<World, light_set<T>>{
                scene_, lights_, scene_.bounds(), eye(), settings_.gather_caching(), run_, told};
        });
        finish(integrator, &integrator.maps(), &integrator.cache());
    }

    /// Makes an integrator, its phases watched.
    template <typename Make>
    auto prepare(Make&& make) {
        phase_watch watch{budget_};
        auto made = make(aglow::preparation_progress{std::ref(watch)});
        watch.finish(result_);
        return made;
    }

    // ---- pictures ---------------------------------------------------------------------------------------------------

    template <typename Integrator>
    void finish(const Integrator& integrator, const maps_type* maps, const cache_type* cache) {
        count(maps, cache);
        switch (options_.show) {
            case view::photons: return show("", photons_seen(maps));
            case view::records: return show("", records_seen(expose("picture", integrator), cache));
            case view::direct: return show("", direct());
            case view::caustic: return show("", caustic(maps));
            case view::indirect: return show("", indirect(expose("picture", integrator), maps));
            case view::beauty: break;
        }
        end_ = end_of_picture(maps);
        const picture all =
            options_.until > 0 ? until(integrator, lookups_a_sample(maps, cache)) : expose("picture", integrator, true);
        result_.layers.insert(result_.layers.begin(), {"", all});
        if (!options_.layers) { return; }
        if (budget_.ended()) { return result_.notes.push_back("interrupted: the layers are left out"); }
        show("direct", direct());
        if (maps) { show("caustic", caustic(maps)); }
        show("indirect", indirect(all, maps));
    }
    /// Two pictures by path tracing that share no random number: how they differ tells how noisy they are.
    [[nodiscard]] render_result reference() {
        const aglow::path_tracer<World, light_set<T>> tracer{scene_, lights_};
        std::vector<picture> halves;
        for (const char* name : {"first half", "second half"}) {
            end_ = budget_.spent() + (budget_.seconds() - budget_.spent()) / (halves.empty() ? 2 : 1);
            if (!budget_.ended()) { taken_ = 0; }  // else the second gets as many samples as the first
            halves.push_back(expose(name, tracer));
            ++options_.seed;
        }
        char text[32];
        std::snprintf(text, sizeof text, "%.2e", difference_of_halves(halves[0], halves[1]));
        result_.facts.push_back({"relMSE between halves", text});
        result_.layers = {{"", std::move(halves[0])}, {second_half, std::move(halves[1])}};
        return std::move(result_);
    }

    void show(const char* name, picture image) { result_.layers.push_back({name, std::move(image)}); }

    /// Takes the samples that were asked for, or as many as fit into the time.
    template <typename Integrator>
    picture expose(const std::string& name, const Integrator& integrator, bool with_error = false) {
        const auto begun = clock::now();
        aglow::film<S> film{options_.width, options_.height};
        {
            progress bar{name};
            do {
                const std::uint32_t samples = next_samples(film.samples(), since(begun));
                const std::uint32_t before = film.samples();
                aglow::film_options o{.samples = samples, .seed = options_.seed};
                o.progress = [&](double share) {
                    const double more = static_cast<double>(before) + share * static_cast<double>(samples);
                    bar.show(timed() ? since(begun) / (since(begun) + std::max(0.0, end_ - budget_.spent()))
                                     : more / static_cast<double>(wanted()));
                    return true;
                };
                film.expose(eye(), integrator, o, run_);
            } while (!done(film.samples(), since(begun)));
        }
        result_.phases.push_back({name, since(begun)});
        note_interruption(name, film.samples());
        if (taken_ == 0) { result_.add_fact("samples a pixel", film.samples()); }
        taken_ = film.samples();
        if (film.dropped() > 0) { result_.add_fact(name + ", samples dropped", film.dropped()); }
        if (with_error && options_.error) { certifier_.audit(film, budget_, result_); }
        return taken_from(film, with_error);
    }

    picture taken_from(const aglow::film<S>& film, bool with_error) {
        if (with_error) { result_.layers.push_back({"error", developed_errors(film)}); }
        return developed(film);
    }

    /// Adds samples until an audit certifies the error that was asked for, or it is clear that none will.
    template <typename Integrator>
    picture until(const Integrator& integrator, const sample_lookups& lookups) {
        const aglow::film<S> film = certifier_.until(integrator, lookups, budget_, result_);
        taken_ = film.samples();
        if (options_.error) { certifier_.audit(film, budget_, result_); }
        return taken_from(film, true);
    }

    [[nodiscard]] sample_lookups lookups_a_sample(const maps_type* maps, const cache_type* cache) const {
        const bool caustics = maps && maps->caustic.size() > 0;
        return {.caches = cache ? 1u : 0u,
                .maps = (caustics ? 1u : 0u) + (options_.how == method::photon_map ? 1u : 0u)};
    }

    /// Layers are given as many samples as the picture got, whatever it was limited by.
    [[nodiscard]] std::uint32_t wanted() const { return taken_ > 0 ? taken_ : options_.samples; }
    [[nodiscard]] bool timed() const { return budget_.limited() && taken_ == 0; }

    void note_interruption(const std::string& name, std::uint32_t taken) {
        if (!budget_.ended() || taken_ > 0 || (!timed() && taken >= wanted())) { return; }
        const std::string of = timed() ? "" : " of " + std::to_string(wanted());
        result_.notes.push_back(name + ": interrupted after " + std::to_string(taken) + of + " samples a pixel");
    }

    [[nodiscard]] std::uint32_t next_samples(std::uint32_t taken, double spent) const {
        if (timed()) { return samples_of_pass(taken, spent, end_ - budget_.spent()); }
        return std::min(wanted() - taken, samples_of_pass(taken, spent, std::numeric_limits<double>::infinity()));
    }
    [[nodiscard]] bool done(std::uint32_t taken, double spent) const {
        if (budget_.ended() && taken_ == 0) { return true; }
        if (!timed()) { return taken >= wanted(); }
        return taken >= (1u << 24) || budget_.spent() + spent / static_cast<double>(taken) > end_;
    }

    /// When the picture must be done, in seconds since the job began: its layers, which cost as much at the most, fit
    /// in after it.
    [[nodiscard]] double end_of_picture(const maps_type* maps) const {
        const double now = budget_.spent();
        const double pictures = !options_.layers ? 1 : maps ? 4 : 2;
        return now + std::max(0.0, budget_.seconds() - now) / pictures;
    }

    [[nodiscard]] const picture& direct() {
        if (direct_) { return *direct_; }
        const aglow::direct_layer<World, light_set<T>> layer{scene_, lights_};
        return direct_.emplace(expose("direct light", aglow::layered_integrator{scene_, lights_, layer}));
    }

    /// What is seen of lights alone, in mirrors too.
    [[nodiscard]] picture glow() {
        const auto dark = [](const auto&, const vec3<T>&, T, const auto&, std::uint32_t) {
            return aglow::estimate<S>{};
        };
        return expose("lights", aglow::layered_integrator{scene_, lights_, dark});
    }

    [[nodiscard]] const picture& caustic(const maps_type* maps) {
        if (caustic_) { return *caustic_; }
        const aglow::map_layer<S, T> layer{maps->caustic, settings_.density()};
        return caustic_.emplace(minus(expose("caustics", aglow::layered_integrator{scene_, lights_, layer}), glow()));
    }

    /// All light but the direct and what the caustic map shows. The same numbers were drawn, so the noise of direct
    /// light leaves with it.
    [[nodiscard]] picture indirect(const picture& all, const maps_type* maps) {
        picture rest = minus(all, direct());
        return maps ? minus(rest, caustic(maps)) : rest;
    }

    [[nodiscard]] static picture minus(picture a, const picture& b) {
        for (std::size_t i = 0; i < a.pixels.size(); ++i) { a.pixels[i] -= b.pixels[i]; }
        return a;
    }

    [[nodiscard]] picture photons_seen(const maps_type* maps) {
        picture image{options_.width, options_.height};
        for (const auto* map : {&maps->direct, &maps->caustic, &maps->indirect}) {
            add_photons(image, scene_, view_, *map);
        }
        return image;
    }

    [[nodiscard]] picture records_seen(picture image, const cache_type* cache) {
        for (S& pixel : image.pixels) { pixel *= 0.4f; }
        paint_records(image, scene_, view_, *cache);
        return image;
    }

    void count(const maps_type* maps, const cache_type* cache) {
        if (cache) {
            result_.add_fact("records", cache->size());
            result_.add_bytes("records, memory", cache->bytes());
        }
        if (!maps) { return; }
        const auto add = [&](const char* name, const auto& map) {
            if (map.size() > 0) { result_.add_fact(std::string{"photons, "} + name, map.size()); }
            if (!map.why.empty() && map.why != "full") {
                result_.notes.push_back(std::string{name} + " map: " + map.why);
            }
        };
        add("direct", maps->direct);
        add("caustic", maps->caustic);
        add("indirect", maps->indirect);
        result_.add_bytes("photons, memory", maps->direct.memory() + maps->caustic.memory() + maps->indirect.memory());
    }

    const World& scene_;
    const light_set<T>& lights_;
    camera<T> view_;
    render_options options_;
    aglow::own_threads run_;
    render_result result_{};
    time_budget budget_;
    render_settings settings_;
    certifier<World> certifier_;
    double end_{options_.seconds};  ///< of the picture, in seconds since the job began
    std::uint32_t taken_{0};
    std::optional<picture> direct_{};
    std::optional<picture> caustic_{};
};

}  // namespace host
