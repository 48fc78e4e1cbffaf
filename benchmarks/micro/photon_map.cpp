// Photon maps and irradiance points: how long one estimate takes over the number of photons.
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/estimators/compact_photon.hpp>
#include <aglow/estimators/irradiance_points.hpp>
#include <aglow/estimators/photon_map.hpp>

#include "micro/question.hpp"

namespace {

using micro::ask;
using micro::point;
using micro::rgb;
using micro::wall_place;
using photon_map = aglow::photon_map<rgb, float>;
using compact_map = aglow::photon_map<rgb, float, aglow::compact_photon<rgb>>;
using irradiance_points = aglow::irradiance_points<rgb, float>;

constexpr std::int64_t largest = 10'000'000;

const std::vector<aglow::landed_photon<rgb, float>>& photons(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) {
        std::vector<aglow::landed_photon<rgb, float>> landed;
        landed.reserve(count);
        for (const wall_place& p : micro::on_walls(count, 1)) {
            const point towards = glm::normalize(point{0.5f} - p.position);
            const aglow::photon<rgb> what{.power = rgb{1},
                                          .wi = aglow::packed_direction<std::int16_t>{towards},
                                          .normal = aglow::packed_direction<std::int16_t>{p.normal}};
            landed.push_back({p.position, what});
        }
        return landed;
    });
}
template <typename Map>
const Map& map_of(std::int64_t n) {
    return micro::kept(n, [n](std::size_t count) { return Map{photons(n), 1 / static_cast<float>(count)}; });
}
const irradiance_points& points_of(std::int64_t n) {
    return micro::kept(n, [](std::size_t count) {
        std::vector<aglow::irradiance_point<rgb, float>> points;
        points.reserve(count);
        for (const wall_place& p : micro::on_walls(count, 1)) {
            points.push_back({.position = p.position, .normal = p.normal, .irradiance = rgb{1}});
        }
        return irradiance_points{points};
    });
}

template <typename Map>
void build(benchmark::State& state, unsigned threads) {
    const auto& landed = photons(state.range(0));
    std::size_t memory = 0;
    for (auto _ : state) {
        const Map map{landed, 1.0f, aglow::own_threads{threads}};
        memory = map.memory();
        benchmark::DoNotOptimize(memory);
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
    state.SetComplexityN(state.range(0));
    micro::count_bytes(state, memory, landed.size());
}

template <typename Map>
void estimate(benchmark::State& state, aglow::density_options options, bool coherent) {
    const Map& map = map_of<Map>(state.range(0));
    if (options.count == 0) { options.max_radius = micro::wall_radius(50, map.size()); }
    micro::round_trip<wall_place> trip{micro::wall_questions(coherent)};
    std::uint64_t used = 0;
    for (auto _ : state) {
        const wall_place& p = trip.next();
        const auto found = map.irradiance(p.position, p.normal, options);
        used += found.count;
        benchmark::DoNotOptimize(found.value);
    }
    micro::count_queries(state);
    micro::count_bytes(state, map.memory(), map.size());
    state.counters["photons"] = static_cast<double>(used) / static_cast<double>(state.iterations());
}

/// An item is an estimate, of 1,024 asked for at once.
template <typename Map>
void estimates(benchmark::State& state, aglow::density_options options, bool coherent) {
    using estimate = aglow::density_estimate<rgb, float>;
    const Map& map = map_of<Map>(state.range(0));
    micro::ask_at_once<estimate>(
        state, coherent, [&](auto places, auto found) { map.irradiance_each(places, found, options); }, "photons",
        [](const estimate& e) { return e.count; });
    micro::count_bytes(state, map.memory(), map.size());
}

void read_point(benchmark::State& state, bool coherent) {
    const irradiance_points& points = points_of(state.range(0));
    micro::round_trip<wall_place> trip{micro::wall_questions(coherent)};
    for (auto _ : state) {
        const wall_place& p = trip.next();
        benchmark::DoNotOptimize(points.nearest(p.position, p.normal)->value);
    }
    micro::count_queries(state);
    micro::count_bytes(state, points.memory(), points.size());
}

const bool asked = [] {
    const auto over_sizes = [](benchmark::internal::Benchmark* question) { return micro::sizes(question, largest); };
    for (const unsigned threads : {1u, 2u}) {
        const auto timed = [&](const std::string& what, auto question) {
            over_sizes(ask(what + "/how_long_does_a_build_take/threads_" + std::to_string(threads), question, threads))
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime()
                ->Complexity(benchmark::oNLogN);
        };
        timed("photon_map", build<photon_map>);
        timed("compact_photon", build<compact_map>);
    }
    for (const bool coherent : {false, true}) {
        const std::string order = coherent ? "/coherent" : "/random";
        for (const std::uint32_t k : {50u, 200u}) {
            const std::string question = "/how_long_does_an_estimate_from_" + std::to_string(k) + "_take" + order;
            const aglow::density_options nearest{.count = k};
            over_sizes(ask("photon_map" + question, estimate<photon_map>, nearest, coherent))
                ->Complexity(benchmark::oLogN);
            over_sizes(ask("compact_photon" + question, estimate<compact_map>, nearest, coherent))
                ->Complexity(benchmark::oLogN);
            const std::string in_batches =
                "/how_long_do_1024_estimates_from_" + std::to_string(k) + "_take_at_once" + order;
            over_sizes(ask("photon_map" + in_batches, estimates<photon_map>, nearest, coherent))
                ->Unit(benchmark::kMicrosecond)
                ->Complexity(benchmark::oLogN);
            over_sizes(ask("compact_photon" + in_batches, estimates<compact_map>, nearest, coherent))
                ->Unit(benchmark::kMicrosecond)
                ->Complexity(benchmark::oLogN);
        }
        over_sizes(ask("photon_map/how_long_does_an_estimate_within_a_radius_take" + order, estimate<photon_map>,
                       aglow::density_options{.count = 0}, coherent))
            ->Complexity(benchmark::oLogN);
        over_sizes(ask("irradiance_points/how_long_does_one_reading_take" + order, read_point, coherent))
            ->Complexity(benchmark::oLogN);
    }
    return true;
}();

}  // namespace
