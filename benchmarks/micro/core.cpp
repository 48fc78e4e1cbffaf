// Numbers and directions: how long one draw takes.
#include <aglow/core/frame.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/octahedral.hpp>
#include <aglow/core/packed_direction.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/core/warp.hpp>

#include "micro/question.hpp"

namespace {

using micro::ask;
using v2 = aglow::vec2<float>;
using v3 = aglow::vec3<float>;

/// Calls `draw(i)` for i = 0, 1, ...
template <typename Draw>
void draws(benchmark::State& state, Draw draw) {
    std::uint32_t i = 0;
    for (auto _ : state) { benchmark::DoNotOptimize(draw(i++)); }
    state.SetItemsProcessed(state.iterations());
}

/// Warps the points of a fixed list.
template <typename Warp>
void warps(benchmark::State& state, Warp warp) {
    std::vector<v2> list;
    aglow::random_sampler<float> random{1};
    for (int i = 0; i < 1024; ++i) { list.push_back(random.next_2d()); }
    micro::round_trip<v2> trip{list};
    for (auto _ : state) { benchmark::DoNotOptimize(warp(trip.next())); }
    state.SetItemsProcessed(state.iterations());
}

const bool asked = [] {
    const std::string draw = "how_long_does_one_draw_take/";
    ask(draw + "random_2d", [](benchmark::State& s) {
        aglow::random_sampler<float> random{1};
        draws(s, [&](std::uint32_t) { return random.next_2d(); });
    });
    ask(draw + "random_2d_of_a_new_path", [](benchmark::State& s) {
        draws(s, [](std::uint32_t i) {
            return aglow::random_numbers<float>{{0, 0, i}}.at(1, aglow::purpose::scatter).next_2d();
        });
    });
    ask(draw + "sobol_2d_of_a_new_sample", [](benchmark::State& s) {
        draws(s, [](std::uint32_t i) {
            return aglow::sobol_numbers<float>{{0, 0, 7}, i}.at(1, aglow::purpose::scatter).next_2d();
        });
    });
    for (const std::size_t dimension : {0, 1, 8, 40, 64}) {
        const std::string which = "halton_dimension_" + std::to_string(dimension) + (dimension == 64 ? "_hashed" : "");
        ask(draw + which, [=](benchmark::State& s) {
            const aglow::halton_scrambling table{0};
            draws(s, [&](std::uint32_t i) { return table.number<float>(i, dimension); });
        });
    }
    ask("how_long_do_the_tables_of_halton_take", [](benchmark::State& s) {
        draws(s, [](std::uint32_t i) { return aglow::halton_scrambling{i}.number<float>(1, 0); });
    });

    const std::string warp = "how_long_does_one_warp_take/";
    const auto ask_warp = [&](const char* name, auto f) {
        ask(warp + name, [=](benchmark::State& s) { warps(s, f); });
    };
    ask_warp("concentric_disc", [](const v2& u) { return aglow::concentric_disc(u); });
    ask_warp("cosine_hemisphere", [](const v2& u) { return aglow::cosine_hemisphere(u); });
    ask_warp("uniform_hemisphere", [](const v2& u) { return aglow::uniform_hemisphere(u); });
    ask_warp("uniform_sphere", [](const v2& u) { return aglow::uniform_sphere(u); });
    ask_warp("uniform_cone", [](const v2& u) { return aglow::uniform_cone(u, 0.25f); });
    ask_warp("uniform_triangle", [](const v2& u) { return aglow::uniform_triangle(u); });
    ask_warp("frame_of_a_normal", [](const v2& u) {
        return aglow::frame<float>{aglow::uniform_sphere(u)}.to_world({0, 0, 1});
    });
    ask_warp("direction_packed_and_back", [](const v2& u) {
        return aglow::packed_direction<std::int16_t>{aglow::uniform_sphere(u)}.direction<float>();
    });
    ask_warp("octahedral_and_back",
             [](const v2& u) { return aglow::octahedral{aglow::uniform_sphere(u)}.direction<float>(); });
    return true;
}();

}  // namespace
