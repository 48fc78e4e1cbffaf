#include "error_vs_time/make_run.hpp"

#include <time.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <chrono>
#include <cstdio>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/report/audited_film.hpp>
#include <aglow/report/statement.hpp>

#include "common/counted_scene.hpp"
#include "common/phase_name.hpp"
#include "error_vs_time/seeds.hpp"

namespace error_vs_time {

namespace {

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Forgets the largest memory use so far, where the system lets one. What earlier runs have freed goes back to it
/// first: it would count as this run's.
void reset_peak() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    std::ofstream{"/proc/self/clear_refs"} << '5';
}

double peak_bytes() {
    std::ifstream status{"/proc/self/status"};
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmHWM:", 0) == 0) { return 1024 * std::stod(line.substr(6)); }
    }
    return 0;
}

/// Calls `use` with the scene, as a diffuse one where it is; its rays are counted.
template <typename Use>
auto with_scene(const host::scene_description<float>& d, const Use& use) {
    const host::counted_scene<host::scene<float>> any{d};
    if (any.possible_lobes() == aglow::lobe_set::diffuse_reflection) {
        return use(host::counted_scene<host::diffuse_scene<float>>{d});
    }
    return use(any);
}

/// Listens to an integrator's preparation and notes the CPU seconds of each phase.
class phase_clock {
public:
    explicit phase_clock(number_pairs& phases) : phases_{phases} {}

    bool operator()(const aglow::preparation& now) {
        if (open_ != now.phase) { close(); }
        open_ = now.phase;
        return true;
    }
    /// Ends the phase that is open.
    void close() {
        const double now = cpu_seconds();
        if (open_) { phases_.emplace_back(host::name_of(*open_), now - begun_); }
        open_.reset();
        begun_ = now;
    }

private:
    number_pairs& phases_;
    double begun_{cpu_seconds()};
    std::optional<aglow::preparation_phase> open_{};
};

/// One run in the making.
template <typename World>
class maker {
public:
    maker(const World& scene, const budget& b, std::uint64_t seed, std::size_t size)
        : scene_{scene}, budget_{b}, seed_{seed}, size_{size}, film_{size, size} {}

    made_run make(technique how) {
        reset_peak();
        const auto wall = std::chrono::steady_clock::now();
        const double start = cpu_seconds();
        const std::uint64_t nearest = host::ray_count::all_nearest();
        const std::uint64_t shadow = host::ray_count::all_shadow();
        switch (how) {
            case technique::path: expose(aglow::path_tracer{scene_, scene_.lights()}); break;
            case technique::irradiance_cache: irradiance_cache(); break;
            case technique::photon_map: photon_map(); break;
            case technique::final_gather: final_gather(); break;
            case technique::gather_cache: gather_cache(); break;
            case technique::progressive: progressive(); break;
        }
        run_note& note = run_.note;
        note.cpu_seconds = cpu_seconds() - start;
        note.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
        note.peak_bytes = peak_bytes();
        count("rays", static_cast<double>(host::ray_count::all_nearest() - nearest));
        count("shadow rays", static_cast<double>(host::ray_count::all_shadow() - shadow));
        note.seed = seed_;
        const aglow::audited_film numbers{film_};
        run_.values = numbers.values();
        run_.guess = numbers.guess();
        return std::move(run_);
    }

private:
    [[nodiscard]] auto eye() const {
        return [this](const aglow::vec2<float>& film) { return scene_.view().through(film, size_, size_); };
    }
    [[nodiscard]] aglow::photon_options photons() const {
        return {
            .direct = budget_.indirect / 5, .caustic = budget_.caustic, .indirect = budget_.indirect, .seed = seed_};
    }
    [[nodiscard]] aglow::caching_options caching() const {
        aglow::caching_options options;
        options.cache.reach.accuracy = budget_.accuracy;
        options.fill.rays = budget_.rays;
        options.fill.seed = seed_;
        options.view = {.width = size_, .height = size_, .seed = seed_};
        return options;
    }

    template <typename Integrator>
    void expose(const Integrator& integrator) {
        const double before = cpu_seconds();
        film_.expose(eye(), integrator, {.samples = budget_.samples, .seed = seed_});
        run_.note.phases.emplace_back("picture", cpu_seconds() - before);
        count("samples", static_cast<double>(size_ * size_) * budget_.samples);
    }
    void count(const char* what, double number) { run_.note.counts.emplace_back(what, number); }
    void count(const aglow::photon_maps<rgb, float>& maps) {
        count("photons", static_cast<double>(maps.size()));
        count("light paths", static_cast<double>(maps.ledger.emitted));
    }
    void count(const aglow::fill_result& filled) {
        count("records", static_cast<double>(filled.records));
        count("gather rays", static_cast<double>(filled.rays));
    }

    /// Makes an integrator by `how(progress)`, its phases timed.
    template <typename How>
    auto prepared(const How& how) {
        phase_clock clock{run_.note.phases};
        auto made = how(aglow::preparation_progress{std::ref(clock)});
        clock.close();
        return made;
    }

    void irradiance_cache() {
        const auto picture = prepared([&](const auto& told) {
            return aglow::irradiance_caching{scene_, scene_.lights(), scene_.bounds(), eye(), caching(), one_, told};
        });
        count(picture.filled());
        expose(picture);
    }
    void photon_map() {
        aglow::photon_options wanted = photons();
        wanted.direct = 0;
        const auto picture = prepared([&](const auto& told) {
            return aglow::photon_mapping{scene_, scene_.lights(), {.photons = wanted}, one_, told};
        });
        count(picture.maps());
        expose(picture);
    }
    void final_gather() {
        const aglow::final_gathering_options options{
            .photons = photons(), .irradiance = {.every = budget_.every, .seed = seed_}, .rays = budget_.rays};
        const auto picture = prepared([&](const auto& told) {
            return aglow::final_gathering{scene_, scene_.lights(), options, one_, told};
        });
        count(picture.maps());
        expose(picture);
    }
    void gather_cache() {
        aglow::gather_caching_options options;
        options.photons = photons();
        options.irradiance = {.every = budget_.every, .seed = seed_};
        options.caching = caching();
        const auto picture = prepared([&](const auto& told) {
            return aglow::gather_caching{scene_, scene_.lights(), scene_.bounds(), eye(), options, one_, told};
        });
        count(picture.maps());
        count(picture.filled());
        expose(picture);
    }
    void progressive() {
        aglow::progressive_photon_mapping passes{
            scene_, scene_.lights(), {.caustic = budget_.caustic, .indirect = budget_.indirect, .seed = seed_}};
        const double before = cpu_seconds();
        for (std::uint32_t i = 0; i < budget_.samples; ++i) { passes.pass(film_, eye()); }
        run_.note.phases.emplace_back("passes", cpu_seconds() - before);
        count("passes", budget_.samples);
    }

    const World& scene_;
    const budget& budget_;
    std::uint64_t seed_;
    std::size_t size_;
    aglow::film<rgb> film_;
    aglow::in_sequence one_{};
    made_run run_{};
};

}  // namespace

made_run make_run(const host::scene_description<float>& scene, const ladder& method, std::size_t step,
                  std::uint64_t seed, std::size_t size) {
    made_run run = with_scene(scene, [&](const auto& world) {
        return maker<std::remove_cvref_t<decltype(world)>>{world, method.steps[step], seed, size}.make(method.how);
    });
    run.note.scene = scene.name;
    run.note.method = method.name;
    run.note.budget = step;
    run.note.settings = method.told(step);
    return run;
}

reference_halves path_traced(const host::scene_description<float>& scene, std::uint32_t samples, std::size_t size,
                             const aglow::callback<double>& progress) {
    return with_scene(scene, [&](const auto& world) {
        const aglow::path_tracer tracer{world, world.lights()};
        const auto half = [&](std::uint64_t seed, double before) {
            aglow::film<rgb> film{size, size};
            const auto told = [&](double share) { return !progress || progress(before + 0.5 * share); };
            film.expose([&](const aglow::vec2<float>& p) { return world.view().through(p, size, size); }, tracer,
                        {.samples = samples, .seed = seed, .progress = told}, aglow::own_threads{});
            return aglow::audited_film{film}.values();
        };
        std::vector<float> first = half(reference_seeds[0], 0);
        return reference_halves{std::move(first), half(reference_seeds[1], 0.5)};
    });
}

audit_note audit_run(const host::scene_description<float>& scene, const made_run& run, double target,
                     const std::vector<float>& truth, std::size_t size) {
    return with_scene(scene, [&](const auto& world) {
        const auto eye = [&](const aglow::vec2<float>& p) { return world.view().through(p, size, size); };
        const aglow::path_tracer tracer{world, world.lights()};
        const aglow::audited_picture<float> picture{.image = {run.values, size, size, 3}, .guess = run.guess};
        const double before = cpu_seconds();
        const aglow::audit_result stated =
            aglow::audit(picture, aglow::pixel_probe{eye, tracer, size}, {.target = target, .seed = run.note.seed});
        audit_note note{.scene = run.note.scene, .method = run.note.method, .budget = run.note.budget};
        note.seconds = cpu_seconds() - before;
        note.render_seconds = run.note.cpu_seconds;
        note.status = aglow::words(stated.status);
        note.statement = aglow::statement(stated);
        note.target = target;
        note.bound = stated.mean_error_bound;
        note.bias_low = stated.energy_bias.low;
        note.bias_high = stated.energy_bias.high;
        const aglow::image_error known = aglow::compare(aglow::image_view<float>{run.values, size, size, 3},
                                                        aglow::image_view<float>{truth, size, size, 3});
        note.true_error = known.mape;
        note.true_bias = known.energy_bias;
        return note;
    });
}

}  // namespace error_vs_time
