// The methods of the study, each with a ladder of budgets: the settings that its author would choose for that much
// time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace error_vs_time {

enum class technique { path, irradiance_cache, photon_map, final_gather, gather_cache, progressive };

/// One step of a ladder.
struct budget {
    std::uint32_t samples{4};  ///< per pixel; passes for the progressive method
    std::size_t caustic{0};    ///< photons
    std::size_t indirect{0};   ///< photons
    std::uint32_t rays{0};     ///< per gather or per record
    double accuracy{0.1};      ///< of the cache
    std::size_t every{4};      ///< an irradiance point at every so many photons
    bool full{false};          ///< left to the long run

    [[nodiscard]] std::string told() const {
        std::string words = std::to_string(samples) + " samples";
        if (indirect > 0) { words += ", " + std::to_string(caustic + indirect) + " photons"; }
        if (rays > 0) { words += ", " + std::to_string(rays) + " gather rays"; }
        return words;
    }
};

struct ladder {
    const char* name;
    technique how;
    std::vector<budget> steps;
};

[[nodiscard]] inline std::vector<ladder> ladders() {
    const bool full = true;
    return {
        {"path tracing",
         technique::path,
         {{.samples = 4},
          {.samples = 16},
          {.samples = 64},
          {.samples = 256, .full = full},
          {.samples = 1024, .full = full}}},
        {"irradiance cache",
         technique::irradiance_cache,
         {{.samples = 4, .rays = 100, .accuracy = 0.15},
          {.samples = 8, .rays = 200},
          {.samples = 16, .rays = 600, .accuracy = 0.08},
          {.samples = 32, .rays = 1600, .accuracy = 0.06},
          {.samples = 64, .rays = 4000, .accuracy = 0.05, .full = full}}},
        {"photon map",
         technique::photon_map,
         {{.samples = 2, .caustic = 25'000, .indirect = 25'000},
          {.samples = 4, .caustic = 100'000, .indirect = 100'000},
          {.samples = 8, .caustic = 400'000, .indirect = 400'000},
          {.samples = 16, .caustic = 1'600'000, .indirect = 1'600'000, .full = full}}},
        {"final gather",
         technique::final_gather,
         {{.samples = 2, .caustic = 25'000, .indirect = 20'000, .rays = 8, .every = 8},
          {.samples = 4, .caustic = 100'000, .indirect = 50'000, .rays = 16},
          {.samples = 16, .caustic = 200'000, .indirect = 100'000, .rays = 16},
          {.samples = 16, .caustic = 400'000, .indirect = 200'000, .rays = 64, .full = full}}},
        {"gather cache",
         technique::gather_cache,
         {{.samples = 4, .caustic = 30'000, .indirect = 20'000, .rays = 100, .accuracy = 0.15, .every = 8},
          {.samples = 8, .caustic = 50'000, .indirect = 20'000, .rays = 200, .every = 8},
          {.samples = 16, .caustic = 200'000, .indirect = 100'000, .rays = 800, .accuracy = 0.08},
          {.samples = 32, .caustic = 400'000, .indirect = 200'000, .rays = 1600, .accuracy = 0.07},
          {.samples = 64, .caustic = 1'000'000, .indirect = 400'000, .rays = 6400, .accuracy = 0.05, .full = full}}},
        {"progressive",
         technique::progressive,
         {{.samples = 4, .caustic = 25'000, .indirect = 25'000},
          {.samples = 16, .caustic = 25'000, .indirect = 25'000},
          {.samples = 64, .caustic = 50'000, .indirect = 50'000, .full = full},
          {.samples = 256, .caustic = 50'000, .indirect = 50'000, .full = full}}},
    };
}

}  // namespace error_vs_time
