// How questions are asked of Google Benchmark here, and what they are asked about.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

#include "rivals/kd_tree_sets.hpp"

namespace micro {

using point = aglow::vec3<float>;
using rgb = aglow::vec3<float>;

/// Asks `body(state, values...)` under the name `question`.
template <typename Body, typename... Values>
benchmark::internal::Benchmark* ask(const std::string& question, Body body, Values... values) {
    return benchmark::RegisterBenchmark(question.c_str(), [=](benchmark::State& state) { body(state, values...); });
}

/// At sizes of 10^3, 10^4, ... up to `largest`.
inline benchmark::internal::Benchmark* sizes(benchmark::internal::Benchmark* question, std::int64_t largest) {
    return question->RangeMultiplier(10)->Range(1000, largest);
}

/// What `make(n)` makes, made once for questions in a row about the same `n`.
template <typename Make>
const auto& kept(std::int64_t n, Make make) {
    using thing = std::invoke_result_t<Make, std::size_t>;
    static std::mutex guard;
    static std::int64_t of = -1;
    static std::unique_ptr<thing> made;
    const std::scoped_lock lock{guard};
    if (of != n) {
        made.reset();
        made = std::make_unique<thing>(make(static_cast<std::size_t>(n)));
        of = n;
    }
    return *made;
}

/// Counts one item an iteration, `n` in the collection that was asked.
inline void count_queries(benchmark::State& state) {
    state.SetItemsProcessed(state.iterations());
    state.SetComplexityN(state.range(0));
}

/// Keeps `bytes` of a collection of `n` beside its times.
inline void count_bytes(benchmark::State& state, std::size_t bytes, std::size_t n) {
    state.counters["bytes_per_item"] = static_cast<double>(bytes) / static_cast<double>(n);
}

/// Goes round and round a list of questions.
template <typename T>
class round_trip {
public:
    explicit round_trip(const std::vector<T>& list) : list_{list} {}
    const T& next() {
        const T& now = list_[at_];
        at_ = at_ + 1 < list_.size() ? at_ + 1 : 0;
        return now;
    }

private:
    const std::vector<T>& list_;
    std::size_t at_{0};
};

/// A place on one of the six walls of the unit cube.
struct wall_place {
    point position;
    point normal;  ///< inwards
};

/// `count` places spread evenly over the walls; near ones follow each other where `coherent`.
inline std::vector<wall_place> on_walls(std::size_t count, std::uint64_t seed, bool coherent = false) {
    rivals::dice random{seed};
    std::vector<point> positions(count);
    for (point& p : positions) {
        p = random.in_cube();
        const std::uint64_t wall = random.below(6);
        p[static_cast<int>(wall / 2)] = static_cast<float>(wall % 2);
    }
    if (coherent) { rivals::sort_near(positions); }
    std::vector<wall_place> places(count);
    for (std::size_t i = 0; i < count; ++i) {
        const point& p = positions[i];
        const int axis = p.x == 0 || p.x == 1 ? 0 : p.y == 0 || p.y == 1 ? 1 : 2;
        places[i].position = p;
        places[i].normal[axis] = p[axis] == 0 ? 1.0f : -1.0f;
    }
    return places;
}

/// What shading asks: places on the walls in random order, or in tiles of 128 that are as near each other as pixels.
inline const std::vector<wall_place>& wall_questions(bool coherent) {
    static const std::vector<wall_place> random = on_walls(16384, 2);
    static const std::vector<wall_place> tiles = [] {
        constexpr std::uint64_t tile = 128;
        const std::vector<wall_place> all = on_walls(262144, 2, true);
        rivals::dice dice{3};
        std::vector<wall_place> some;
        while (some.size() < 16384) {
            const std::uint64_t first = dice.below(all.size() / tile) * tile;
            for (std::uint64_t i = first; i < first + tile; ++i) { some.push_back(all[i]); }
        }
        return some;
    }();
    return coherent ? tiles : random;
}

/// The radius within which `wanted` of `count` places on the walls lie.
inline float wall_radius(double wanted, std::size_t count) {
    return static_cast<float>(std::sqrt(6 * wanted / (aglow::pi<double> * static_cast<double>(count))));
}

/// Asks `ask(questions, answers)` 1,024 questions at once, again and again, and counts each as an item. Keeps the mean
/// of `used(answer)`, of the first of each batch, beside its times as `what`.
template <typename Answer, typename Ask, typename Used>
void ask_at_once(benchmark::State& state, bool coherent, const Ask& ask, const char* what, const Used& used) {
    constexpr std::size_t batch = 1024;
    const std::span<const wall_place> all{wall_questions(coherent)};
    std::vector<Answer> answers(batch);
    std::size_t first = 0;
    std::uint64_t sum = 0;
    for (auto _ : state) {
        ask(all.subspan(first, batch), std::span{answers});
        benchmark::DoNotOptimize(answers.data());
        sum += used(answers.front());
        first = (first + batch) % all.size();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(batch));
    state.SetComplexityN(state.range(0));
    state.counters[what] = static_cast<double>(sum) / static_cast<double>(state.iterations());
}

}  // namespace micro
