// Light on its way through the Cornell box: how many paths, samples, gathers and records a second, and where the
// photons' energy went.
#include <aglow/algorithms/gather.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/sobol.hpp>

#include "common/scenes/cornell.hpp"
#include "micro/question.hpp"

namespace {

using micro::ask;
using micro::rgb;
using lights = host::light_set<float>;

const host::diffuse_scene<float>& diffuse() {
    static const host::diffuse_scene<float> scene{host::scenes::cornell_diffuse<float>()};
    return scene;
}
const host::scene<float>& glass() {
    static const host::scene<float> scene{host::scenes::cornell_glass<float>()};
    return scene;
}

/// A map of `range(0)` indirect photons; an item is a path.
template <typename World>
void photons(benchmark::State& state, const World& scene, unsigned threads) {
    std::uint64_t paths = 0;
    aglow::energy_ledger<rgb> books;
    for (auto _ : state) {
        const auto maps = aglow::trace_photons(
            scene, scene.lights(), {.indirect = static_cast<std::size_t>(state.range(0))}, aglow::own_threads{threads});
        books = maps.ledger;
        paths += books.emitted;
    }
    state.SetItemsProcessed(static_cast<std::int64_t>(paths));
    state.SetComplexityN(state.range(0));
    const auto share = [&](const rgb& power) {
        return static_cast<double>(aglow::max_component(power) / aglow::max_component(books.power_emitted));
    };
    state.counters["energy_absorbed"] = share(books.power_absorbed);
    state.counters["energy_escaped"] = share(books.power_escaped);
    state.counters["bounces_per_path"] = static_cast<double>(books.bounces) / static_cast<double>(books.emitted);
}

/// Rays through points all over the picture.
template <typename World, typename Integrator>
void samples(benchmark::State& state, const World& scene, const Integrator& integrator) {
    std::uint32_t i = 0;
    for (auto _ : state) {
        const aglow::sobol_numbers<float> numbers{{0, 0, 0}, i++};
        const auto film = numbers.at(0, aglow::purpose::camera).next_2d() * 256.0f;
        benchmark::DoNotOptimize(integrator(scene.view().through(film, 256, 256), numbers).value);
    }
    state.SetItemsProcessed(state.iterations());
}

template <typename World>
void path_tracing(benchmark::State& state, const World& scene) {
    samples(state, scene, aglow::path_tracer<World, lights>{scene, scene.lights()});
}

template <typename World>
void final_gathering(benchmark::State& state, const World& scene) {
    const aglow::final_gathering_options options{.photons = {.direct = 2'000, .caustic = 20'000, .indirect = 20'000},
                                                 .rays = static_cast<std::uint32_t>(state.range(0))};
    samples(state, scene, aglow::final_gathering<World, lights>{scene, scene.lights(), options});
}

/// Irradiance at one in four of `range(0)` indirect photons and as many caustic ones, where there are any.
template <typename World>
void points(benchmark::State& state, const World& scene, unsigned threads) {
    const auto wanted = static_cast<std::size_t>(state.range(0));
    const auto maps = aglow::trace_photons(scene, scene.lights(), {.caustic = wanted, .indirect = wanted});
    const std::size_t photons = maps.caustic.size() + maps.indirect.size();
    std::size_t made = 0;
    for (auto _ : state) {
        made = aglow::precompute_irradiance(scene, scene.lights(), maps, {}, aglow::own_threads{threads}).size();
        benchmark::DoNotOptimize(made);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(photons));
    state.SetComplexityN(state.range(0));
    state.counters["photons_per_point"] = static_cast<double>(photons) / static_cast<double>(made);
}

/// One record in the middle of the floor, its rays path-traced.
void record(benchmark::State& state) {
    const auto& scene = diffuse();
    const aglow::path_tracer<host::diffuse_scene<float>, lights> source{scene, scene.lights()};
    const auto incoming = [&](const aglow::ray<float>& r, const aglow::random_numbers<float>& n) {
        return source.incoming(r, n);
    };
    const auto shape = aglow::hemisphere_of(static_cast<std::uint32_t>(state.range(0)));
    const aglow::irradiance_estimator<float> estimator{shape};
    aglow::gather_workspace<rgb, float> workspace;
    std::uint64_t i = 0;
    for (auto _ : state) {
        const aglow::random_numbers<float> numbers{{0, 0, i++}};
        const aglow::gather_point<float> at{{278, 0, 200}, {0, 1, 0}, 1e-3f};
        benchmark::DoNotOptimize(aglow::gather_irradiance(incoming, at, numbers, estimator, workspace));
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(shape.count()));
    state.SetComplexityN(state.range(0));
}

const bool asked = [] {
    const std::string paths = "trace_photons/how_many_paths_a_second/";
    for (const unsigned threads : {1u, 2u}) {
        const std::string crew = "/threads_" + std::to_string(threads);
        const auto over_sizes = [](benchmark::internal::Benchmark* question) {
            micro::sizes(question, 100'000)->Unit(benchmark::kMillisecond)->UseRealTime()->Complexity(benchmark::oN);
        };
        over_sizes(ask(paths + "diffuse" + crew, [=](benchmark::State& s) { photons(s, diffuse(), threads); }));
        over_sizes(ask(paths + "glass" + crew, [=](benchmark::State& s) { photons(s, glass(), threads); }));
        const std::string ahead = "precompute_irradiance/how_many_photons_a_second/";
        over_sizes(ask(ahead + "diffuse" + crew, [=](benchmark::State& s) { points(s, diffuse(), threads); }));
        over_sizes(ask(ahead + "glass" + crew, [=](benchmark::State& s) { points(s, glass(), threads); }));
    }
    const std::string seen = "how_many_samples_a_second/";
    ask("path_trace/" + seen + "diffuse", [](benchmark::State& s) { path_tracing(s, diffuse()); });
    ask("path_trace/" + seen + "glass", [](benchmark::State& s) { path_tracing(s, glass()); });
    ask("final_gather/" + seen + "diffuse", [](benchmark::State& s) { final_gathering(s, diffuse()); })
        ->Arg(16)
        ->Arg(64);
    ask("gather/how_long_does_one_record_take_with_its_rays", record)
        ->RangeMultiplier(4)
        ->Range(100, 1600)
        ->Unit(benchmark::kMicrosecond)
        ->Complexity(benchmark::oN);
    return true;
}();

}  // namespace
