// Irradiance records: how long one takes to be worked out from its hemisphere, inserted, and looked up.
#include <vector>

#include <aglow/estimators/irradiance_cache.hpp>

#include "micro/question.hpp"

namespace {

using micro::ask;
using micro::rgb;
using micro::wall_place;
using cache = aglow::irradiance_cache<rgb, float>;
using estimate = aglow::irradiance_estimate<rgb, float>;

constexpr std::int64_t largest = 1'000'000;
constexpr double covering = 12;  // records over each point
constexpr float scene_radius = 0.87f;

aglow::irradiance_cache_options options() {
    aglow::irradiance_cache_options o;
    o.reach.minimum_radius = 1e-6;  // so that a million of them need not overlap more than a thousand
    return o;
}

/// Light that bends as much as it takes for records to reach as far as `radius`.
estimate bent(const wall_place& at, float radius) {
    estimate e;
    e.position = at.position;
    e.axes = aglow::frame<float>{at.normal};
    e.irradiance = rgb{1};
    const double reach = static_cast<double>(radius / scene_radius) / options().reach.accuracy;
    e.curvature.xx = e.curvature.yy =
        static_cast<float>(4 / (reach * reach * reach * reach)) / (scene_radius * scene_radius);
    e.gradients.translation.x = rgb{0.1f};
    e.relative_noise = 0.02f;
    e.rays = 400;
    return e;
}

cache filled(std::size_t count, bool sorted) {
    cache made{scene_radius, options()};
    const float radius = micro::wall_radius(covering, count);
    for (const wall_place& p : micro::on_walls(count, 1, sorted)) { (void)made.insert(bent(p, radius)); }
    return made;
}
const cache& cache_of(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return filled(count, false); });
}
const cache::frozen& frozen_of(std::int64_t n) {
    return micro::kept(n, [n](std::size_t) { return cache_of(n).freeze(); });
}

/// From a filled hemisphere to an estimate; the rays are not counted.
void work_out(benchmark::State& state, aglow::estimate_parts parts) {
    const auto shape = aglow::hemisphere_of(static_cast<std::uint32_t>(state.range(0)));
    const aglow::irradiance_estimator<float> estimator{shape, parts};
    aglow::hemisphere_grid<rgb, float> grid{shape};
    for (std::uint32_t k = 0; k < shape.sectors; ++k) {
        for (std::uint32_t j = 0; j < shape.rings; ++j) {
            const float turn = static_cast<float>(k) / static_cast<float>(shape.sectors);
            grid.set(j, k, rgb{1 + turn}, 1 + static_cast<float>(j));
        }
    }
    const aglow::frame<float> axes{{0, 0, 1}};
    for (auto _ : state) { benchmark::DoNotOptimize(estimator(grid, {0, 0, 0}, axes)); }
    micro::count_queries(state);
}

void insert(benchmark::State& state, bool sorted) {
    std::size_t inserted = 0;
    for (auto _ : state) { inserted = filled(static_cast<std::size_t>(state.range(0)), sorted).size(); }
    benchmark::DoNotOptimize(inserted);
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.SetComplexityN(state.range(0));
}

template <typename Cache>
void ask_cache(benchmark::State& state, const Cache& from, bool coherent) {
    micro::round_trip<wall_place> trip{micro::wall_questions(coherent)};
    std::uint64_t blended = 0;
    for (auto _ : state) {
        const wall_place& p = trip.next();
        const auto answer = from.lookup(p.position, p.normal);
        blended += answer.records;
        benchmark::DoNotOptimize(answer.irradiance);
    }
    micro::count_queries(state);
    state.counters["records"] = {static_cast<double>(blended) / static_cast<double>(state.iterations()),
                                 benchmark::Counter::kAvgThreads};
}

void look_up(benchmark::State& state, bool coherent) { ask_cache(state, cache_of(state.range(0)), coherent); }
void look_up_frozen(benchmark::State& state, bool coherent) {
    const cache::frozen& from = frozen_of(state.range(0));
    ask_cache(state, from, coherent);
    if (state.thread_index() == 0) { micro::count_bytes(state, from.bytes(), from.size()); }
}

/// An item is a lookup, of 1,024 in step.
void look_up_in_step(benchmark::State& state, bool coherent) {
    using answer = aglow::irradiance_answer<rgb, float>;
    const cache::frozen& from = frozen_of(state.range(0));
    micro::ask_at_once<answer>(
        state, coherent, [&](auto places, auto answers) { from.lookup_each(places, answers); }, "records",
        [](const answer& a) { return a.records; });
    micro::count_bytes(state, from.bytes(), from.size());
}

const bool asked = [] {
    const auto over_sizes = [](benchmark::internal::Benchmark* question) { return micro::sizes(question, largest); };
    const auto over_rays = [](benchmark::internal::Benchmark* question) {
        question->RangeMultiplier(4)->Range(100, 6400)->Unit(benchmark::kMicrosecond)->Complexity(benchmark::oN);
    };
    const std::string record = "irradiance_record/how_long_does_one_take_from_a_hemisphere_of_rays/";
    over_rays(ask(record + "irradiance", work_out, aglow::estimate_parts{.gradients = false, .curvature = false}));
    over_rays(ask(record + "with_gradients", work_out, aglow::estimate_parts{.curvature = false}));
    over_rays(ask(record + "with_gradients_and_hessian", work_out, aglow::estimate_parts{}));

    const std::string how_long = "irradiance_cache/how_long_does_";
    for (const bool sorted : {false, true}) {
        over_sizes(ask(how_long + "inserting_all_take/" + (sorted ? "morton_order" : "random_order"), insert, sorted))
            ->Unit(benchmark::kMillisecond)
            ->Complexity(benchmark::oNLogN);
    }
    for (const bool coherent : {false, true}) {
        const std::string order = coherent ? "/coherent" : "/random";
        over_sizes(ask(how_long + "one_lookup_take/growing" + order, look_up, coherent))->Complexity(benchmark::oLogN);
        over_sizes(ask(how_long + "one_lookup_take/frozen" + order, look_up_frozen, coherent))
            ->Complexity(benchmark::oLogN);
        over_sizes(ask("irradiance_cache/how_long_do_1024_lookups_take_in_step" + order, look_up_in_step, coherent))
            ->Unit(benchmark::kMicrosecond)
            ->Complexity(benchmark::oLogN);
    }
    ask("irradiance_cache/how_do_readers_scale/growing", look_up, false)->Arg(10000)->ThreadRange(1, 2);
    ask("irradiance_cache/how_do_readers_scale/frozen", look_up_frozen, false)->Arg(10000)->ThreadRange(1, 2);
    return true;
}();

}  // namespace
