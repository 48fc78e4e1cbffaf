// The octree of spheres of influence: how long an insertion takes, and a lookup, growing and settled.
#include <aglow/containers/octree.hpp>

#include "micro/question.hpp"

namespace {

using micro::ask;
using micro::point;
using micro::wall_place;
using octree = aglow::octree<std::uint32_t>;

constexpr std::int64_t largest = 1'000'000;
constexpr double covering = 12;  // spheres over each point

const std::vector<wall_place>& places(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return micro::on_walls(count, 1); });
}
const std::vector<wall_place>& sorted_places(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) { return micro::on_walls(count, 1, true); });
}

octree grown(const std::vector<wall_place>& from) {
    octree tree;
    const float radius = micro::wall_radius(covering, from.size());
    for (std::uint32_t i = 0; i < from.size(); ++i) { (void)tree.insert(i, from[i].position, radius); }
    return tree;
}
const octree& grown_tree(std::int64_t n) {
    return micro::kept(n, [n](std::size_t) { return grown(places(n)); });
}
const octree& settled_tree(std::int64_t n) {
    return micro::kept(n, [n](std::size_t) {
        octree tree = grown(places(n));
        tree.settle();
        return tree;
    });
}
/// All items into an empty tree.
void insert(benchmark::State& state, bool sorted) {
    const auto& from = sorted ? sorted_places(state.range(0)) : places(state.range(0));
    for (auto _ : state) { benchmark::DoNotOptimize(grown(from).size()); }
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.SetComplexityN(state.range(0));
}

void settle(benchmark::State& state) {
    for (auto _ : state) {
        state.PauseTiming();
        octree tree = grown(places(state.range(0)));
        state.ResumeTiming();
        tree.settle();
        benchmark::DoNotOptimize(tree.size());
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.SetComplexityN(state.range(0));
}

template <typename Count>
void look_up(benchmark::State& state, bool coherent, Count count) {
    micro::round_trip<wall_place> trip{micro::wall_questions(coherent)};
    std::uint64_t found = 0;
    for (auto _ : state) { found += count(trip.next().position); }
    benchmark::DoNotOptimize(found);
    micro::count_queries(state);
    state.counters["found"] = {static_cast<double>(found) / static_cast<double>(state.iterations()),
                               benchmark::Counter::kAvgThreads};
}

void look_up_in_octree(benchmark::State& state, bool settled, bool coherent) {
    const octree& tree = settled ? settled_tree(state.range(0)) : grown_tree(state.range(0));
    look_up(state, coherent, [&](const point& p) {
        std::uint64_t found = 0;
        tree.visit_covering(p, [&](std::uint32_t) { ++found; });
        return found;
    });
}

const bool asked = [] {
    const auto over_sizes = [](benchmark::internal::Benchmark* question) { return micro::sizes(question, largest); };
    const std::string how_long = "octree/how_long_does_";
    for (const bool sorted : {false, true}) {
        over_sizes(ask(how_long + "inserting_all_take/" + (sorted ? "morton_order" : "random_order"), insert, sorted))
            ->Unit(benchmark::kMillisecond)
            ->Complexity(benchmark::oNLogN);
    }
    over_sizes(ask(how_long + "settling_take", settle))->Unit(benchmark::kMillisecond)->Complexity(benchmark::oNLogN);
    for (const bool coherent : {false, true}) {
        const std::string order = coherent ? "/coherent" : "/random";
        over_sizes(ask(how_long + "one_lookup_take/growing" + order, look_up_in_octree, false, coherent))
            ->Complexity(benchmark::oLogN);
        over_sizes(ask(how_long + "one_lookup_take/settled" + order, look_up_in_octree, true, coherent))
            ->Complexity(benchmark::oLogN);
    }
    ask("octree/how_do_readers_scale/growing", look_up_in_octree, false, false)->Arg(10000)->ThreadRange(1, 2);
    ask("octree/how_do_readers_scale/settled", look_up_in_octree, true, false)->Arg(10000)->ThreadRange(1, 2);
    return true;
}();

}  // namespace
