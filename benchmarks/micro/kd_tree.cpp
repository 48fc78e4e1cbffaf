// The kd-tree: how long building takes, and each kind of search, over the number of points.
#include <functional>
#include <span>

#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/parallel.hpp>

#include "micro/question.hpp"

namespace {

using micro::ask;
using micro::point;
using tree = aglow::kd_tree<float>;

constexpr std::int64_t largest = 10'000'000;

/// Walls and a caustic.
const std::vector<point>& cloud(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return rivals::points_of('B', count, 1); });
}
const tree& tree_of(std::int64_t n) {
    return micro::kept(n, [n](std::size_t) { return tree{cloud(n), std::identity{}}; });
}
const std::vector<point>& random_questions(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return rivals::questions('B', count, 16384, false); });
}
const std::vector<point>& coherent_questions(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return rivals::questions('B', count, 16384, true); });
}
const std::vector<point>& questions(std::int64_t n, bool coherent) {
    return coherent ? coherent_questions(n) : random_questions(n);
}

void build(benchmark::State& state, unsigned threads) {
    const std::vector<point>& points = cloud(state.range(0));
    std::size_t memory = 0;
    for (auto _ : state) {
        const tree built{points, std::identity{}, aglow::own_threads{threads}};
        memory = built.memory();
        benchmark::DoNotOptimize(memory);
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.SetComplexityN(state.range(0));
    micro::count_bytes(state, memory, points.size());
}

/// Calls `search(tree, point)` for one question after the other.
template <typename Search>
void one_by_one(benchmark::State& state, bool coherent, Search search) {
    const tree& asked = tree_of(state.range(0));
    micro::round_trip<point> trip{questions(state.range(0), coherent)};
    for (auto _ : state) { benchmark::DoNotOptimize(search(asked, trip.next())); }
    micro::count_queries(state);
}

void nearest(benchmark::State& state, std::size_t k, bool coherent) {
    aglow::kd_scratch<float> scratch;
    one_by_one(state, coherent, [&](const tree& t, const point& p) { return t.nearest(p, k, scratch).radius2; });
}

void nearest_hinted(benchmark::State& state, std::size_t k) {
    aglow::kd_scratch<float> scratch;
    float hint = 0;
    one_by_one(state, true,
               [&](const tree& t, const point& p) { return hint = t.nearest(p, k, scratch, {.hint2 = hint}).radius2; });
}

void nearest_in_a_batch(benchmark::State& state, std::size_t k, bool coherent) {
    constexpr std::size_t batch = 1024;
    const tree& asked = tree_of(state.range(0));
    const std::span<const point> all{questions(state.range(0), coherent)};
    aglow::kd_scratch<float> scratch;
    std::size_t first = 0;
    for (auto _ : state) {
        float sum = 0;
        asked.nearest(all.subspan(first, batch), k, scratch, {},
                      [&](std::size_t, const aglow::kd_neighbours<float>& found) { sum += found.radius2; });
        benchmark::DoNotOptimize(sum);
        first = (first + batch) % all.size();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(batch));
    state.SetComplexityN(state.range(0));
}

void nearest_one(benchmark::State& state, bool coherent) {
    one_by_one(state, coherent, [](const tree& t, const point& p) { return t.nearest_one(p)->distance2; });
}

/// On evenly strewn walls about 50 points are within.
void within(benchmark::State& state, bool coherent) {
    const float radius = micro::wall_radius(50, static_cast<std::size_t>(state.range(0)));
    one_by_one(state, coherent, [&](const tree& t, const point& p) {
        std::uint32_t found = 0;
        t.within(p, radius * radius, [&](aglow::kd_slot, float) { ++found; });
        return found;
    });
}

const bool asked = [] {
    const auto over_sizes = [](benchmark::internal::Benchmark* question) { return micro::sizes(question, largest); };
    for (const unsigned threads : {1u, 2u}) {
        over_sizes(ask("kd_tree/how_long_does_a_build_take/threads_" + std::to_string(threads), build, threads))
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime()
            ->Complexity(benchmark::oNLogN);
    }
    for (const bool coherent : {false, true}) {
        const std::string order = coherent ? "coherent" : "random";
        const auto about = [&](const std::string& what) { return "kd_tree/how_long_" + what + "/" + order; };
        for (const std::size_t k : {std::size_t{8}, std::size_t{50}, std::size_t{200}}) {
            const std::string some = std::to_string(k);
            over_sizes(ask(about("do_the_nearest_" + some + "_take"), nearest, k, coherent))
                ->Complexity(benchmark::oLogN);
        }
        over_sizes(ask(about("do_the_nearest_50_take_in_batches"), nearest_in_a_batch, std::size_t{50}, coherent))
            ->Complexity(benchmark::oLogN);
        over_sizes(ask(about("does_the_nearest_one_take"), nearest_one, coherent))->Complexity(benchmark::oLogN);
        over_sizes(ask(about("does_all_within_a_radius_take"), within, coherent))->Complexity(benchmark::oLogN);
    }
    over_sizes(
        ask("kd_tree/how_long_do_the_nearest_50_take_with_the_last_radius_as_hint", nearest_hinted, std::size_t{50}))
        ->Complexity(benchmark::oLogN);
    return true;
}();

}  // namespace
