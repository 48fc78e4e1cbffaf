// Would a grid serve progressive passes better than the kd-tree? Both are built for one pass of photons and asked for
// all within its radius; CPU time of building and asking together, medians; a sample is compared with brute force.
//
// So far a grid gains at most a quarter, where photons lie evenly and few are within, and takes twice as long in
// crowds.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include <aglow/containers/kd_tree.hpp>

#include "common/command_line.hpp"
#include "hash_grid.hpp"
#include "kd_tree_sets.hpp"
#include "kd_tree_threads.hpp"

namespace {

using namespace rivals;

constexpr std::string_view usage =
    "usage: rivals_fixed_radius [--smoke]\n"
    "\n"
    "A grid for one radius beside the kd-tree, built for one pass of photons and asked for all within its radius.\n"
    "\n"
    "  --smoke   only tries whether everything works\n"
    "  --help    this\n";

using points = std::vector<point>;
/// An index and a squared distance, in the order of indices.
using answers = std::vector<std::pair<std::uint32_t, float>>;

struct seconds {
    std::vector<double> build, ask;
    [[nodiscard]] static double median(std::vector<double> v) {
        std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
        return v[v.size() / 2];
    }
    [[nodiscard]] double total() const { return median(build) + median(ask); }
};

double sum_of_all = 0;

/// The radius within which `hits` are in the median over the questions.
float radius_for(const points& photons, const points& questions, std::size_t hits) {
    const aglow::kd_tree<float> tree{photons, std::identity{}};
    aglow::kd_scratch<float> scratch;
    std::vector<double> radii2;
    for (const point& q : questions) { radii2.push_back(double{tree.nearest(q, hits, scratch).radius2}); }
    return static_cast<float>(std::sqrt(seconds::median(radii2)));
}

template <typename Within>
void ask_all(const points& questions, Within within) {
    for (const point& q : questions) {
        float sum = 0;
        within(q, [&](std::uint32_t, float distance2) { sum += distance2; });
        sum_of_all += static_cast<double>(sum);
    }
}

/// Times a structure that `build` returns and `ask(structure, question, visit)` asks.
template <typename Build, typename Ask>
void measure(seconds& times, const points& questions, Build build, Ask ask) {
    const double start = cpu_seconds();
    const auto built = build();
    const double middle = cpu_seconds();
    ask_all(questions, [&](const point& q, auto visit) { ask(built, q, visit); });
    times.build.push_back(middle - start);
    times.ask.push_back(cpu_seconds() - middle);
}

template <typename Within>
answers listed(Within within, const point& q) {
    answers all;
    within(q, [&](std::uint32_t i, float d2) { all.emplace_back(i, d2); });
    std::sort(all.begin(), all.end());
    return all;
}

/// Whether the grid finds each photon within the radius once, and nothing else.
bool is_right(const points& photons, const points& questions, float radius) {
    const hash_grid grid{photons, std::identity{}, radius};
    grid_found found;
    bool right = true;
    for (std::size_t i = 0; i < questions.size(); i += questions.size() / 8) {
        const point& q = questions[i];
        answers truth;
        for (std::uint32_t j = 0; j < photons.size(); ++j) {
            const float d2 = aglow::simd::distance2(photons[j], q);
            if (d2 < radius * radius) { truth.emplace_back(j, d2); }
        }
        right =
            right &&
            truth == listed([&](const point& at, auto visit) { grid.within(at, radius * radius, found, visit); }, q);
    }
    return right;
}

bool compare(char set, std::size_t count, bool coherent, std::size_t asked, int repeats) {
    const points photons = points_of(set, count, 1);
    const points questions = rivals::questions(set, 1'000'000, asked, coherent);
    bool right = true;
    for (const std::size_t hits : {std::size_t{10}, std::size_t{50}, std::size_t{200}}) {
        const float radius = radius_for(photons, points(questions.begin(), questions.begin() + 500), hits);
        seconds tree, grid;
        grid_found found;
        for (int i = 0; i < repeats; ++i) {
            measure(
                tree, questions,
                [&] {
                    return aglow::kd_tree<float>{photons, std::identity{}};
                },
                [&](const auto& t, const point& q, auto visit) { t.within(q, radius * radius, visit); });
            measure(
                grid, questions,
                [&] {
                    return hash_grid{photons, std::identity{}, radius};
                },
                [&](const auto& g, const point& q, auto visit) { g.within(q, radius * radius, found, visit); });
        }
        right = right && is_right(photons, questions, radius);
        const auto ms = [](const std::vector<double>& v) { return 1e3 * seconds::median(v); };
        std::printf("%c %8zu %-8s %4zu  tree %6.1f + %6.1f  grid %6.1f + %6.1f ms  together %.2fx\n", set, count,
                    coherent ? "coherent" : "random", hits, ms(tree.build), ms(tree.ask), ms(grid.build), ms(grid.ask),
                    tree.total() / grid.total());
        std::fflush(stdout);
    }
    return right;
}

int run(command_line::words& asked) {
    bool smoke = false;
    while (asked.next()) {
        if (!asked.is("--smoke")) { asked.refuse(); }
        smoke = true;
    }
    bool right = true;
    std::printf("set, photons, order, hits; building + asking; how many times as fast the grid is\n");
    for (const std::size_t photons : {std::size_t{100'000}, std::size_t{1'000'000}}) {
        for (const char set : {'A', 'B', 'R'}) {
            for (const bool coherent : {false, true}) {
                right = compare(set, smoke ? photons / 100 : photons, coherent, smoke ? 1000 : photons / 4,
                                smoke ? 1 : 3) &&
                        right;
            }
        }
    }
    std::printf("%s (checksum %g)\n", right ? "every compared answer is right" : "WRONG ANSWERS", sum_of_all);
    return right ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) { return command_line::run(count, arguments, usage, run); }
