// One picture by one method at one budget, with what it took.
#pragma once

#include <cstdint>
#include <vector>

#include <aglow/algorithms/film.hpp>
#include <aglow/core/callback.hpp>

#include "common/scene.hpp"
#include "error_vs_time/ladder.hpp"
#include "error_vs_time/study.hpp"

namespace error_vs_time {

using rgb = glm::vec3;

/// What a run leaves behind: its note without the errors, the picture, and its own guess of its errors.
struct made_run {
    run_note note{};
    std::vector<float> values{};  ///< RGB, row by row from the top
    std::vector<float> guess{};
};

/// Makes the picture of `scene`, `size` pixels square, on one thread. A scene that can have Lambert's surfaces alone is
/// traced as such.
[[nodiscard]] made_run make_run(const host::scene_description<float>& scene, const ladder& method, std::size_t step,
                                std::uint64_t seed, std::size_t size);

/// Two independent path-traced halves of a reference, `samples` per pixel each. `progress` is told the share done.
struct reference_halves {
    std::vector<float> first{};
    std::vector<float> second{};
};
[[nodiscard]] reference_halves path_traced(const host::scene_description<float>& scene, std::uint32_t samples,
                                           std::size_t size, const aglow::callback<double>& progress = {});

/// An audit of a finished picture at `target`, beside the truth that it did not know.
[[nodiscard]] audit_note audit_run(const host::scene_description<float>& scene, const made_run& run, double target,
                                   const std::vector<float>& truth, std::size_t size);

}  // namespace error_vs_time
