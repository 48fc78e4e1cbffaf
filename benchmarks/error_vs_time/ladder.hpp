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
    double cost{1};            ///< rough CPU seconds at 256 x 256, to foresee the time that is left
};

struct ladder {
    const char* name;
    technique how;
    std::vector<budget> steps;

    /// What a step means, for people.
    [[nodiscard]] std::string told(std::size_t step) const {
        const budget& b = steps[step];
        const std::string photons = std::to_string(b.caustic + b.indirect) + " photons";
        if (how == technique::progressive) { return std::to_string(b.samples) + " passes of " + photons; }
        std::string words = std::to_string(b.samples) + " samples";
        if (b.indirect > 0) { words += ", " + photons; }
        if (b.rays > 0) { words += ", " + std::to_string(b.rays) + " gather rays"; }
        if (how == technique::irradiance_cache || how == technique::gather_cache) {
            words += ", a = " + std::to_string(b.accuracy).substr(0, 4);
        }
        return words;
    }
};

[[nodiscard]] inline std::vector<ladder> ladders() {
    const bool full = true;
    return {
        {"path tracing",
         technique::path,
         {{.samples = 4, .cost = 0.23},
          {.samples = 16, .cost = 0.9},
          {.samples = 64, .cost = 3.6},
          {.samples = 256, .cost = 14.5},
          {.samples = 1024, .full = full, .cost = 58}}},
        {"irradiance cache",
         technique::irradiance_cache,
         {{.samples = 4, .rays = 100, .accuracy = 0.15, .cost = 0.8},
          {.samples = 8, .rays = 200, .cost = 1.9},
          {.samples = 16, .rays = 600, .accuracy = 0.08, .cost = 5.5},
          {.samples = 32, .rays = 1600, .accuracy = 0.06, .full = full, .cost = 12.5},
          {.samples = 64, .rays = 4000, .accuracy = 0.05, .full = full, .cost = 35}}},
        {"photon map",
         technique::photon_map,
         {{.samples = 2, .caustic = 25'000, .indirect = 25'000, .cost = 0.35},
          {.samples = 4, .caustic = 100'000, .indirect = 100'000, .cost = 0.7},
          {.samples = 8, .caustic = 400'000, .indirect = 400'000, .cost = 1.6},
          {.samples = 16, .caustic = 1'600'000, .indirect = 1'600'000, .full = full, .cost = 4}}},
        {"final gather",
         technique::final_gather,
         {{.samples = 2, .caustic = 25'000, .indirect = 20'000, .rays = 8, .every = 8, .cost = 0.9},
          {.samples = 4, .caustic = 100'000, .indirect = 50'000, .rays = 16, .cost = 2.5},
          {.samples = 16, .caustic = 200'000, .indirect = 100'000, .rays = 16, .cost = 9.5},
          {.samples = 16, .caustic = 400'000, .indirect = 200'000, .rays = 64, .full = full, .cost = 30}}},
        {"gather cache",
         technique::gather_cache,
         {{.samples = 4, .caustic = 30'000, .indirect = 20'000, .rays = 100, .accuracy = 0.15, .every = 8, .cost = 0.6},
          {.samples = 8, .caustic = 50'000, .indirect = 20'000, .rays = 200, .every = 8, .cost = 1.1},
          {.samples = 16, .caustic = 200'000, .indirect = 100'000, .rays = 800, .accuracy = 0.08, .cost = 2.7},
          {.samples = 32, .caustic = 400'000, .indirect = 200'000, .rays = 1600, .accuracy = 0.07, .cost = 5.5},
          {.samples = 64,
           .caustic = 1'000'000,
           .indirect = 400'000,
           .rays = 6400,
           .accuracy = 0.05,
           .full = full,
           .cost = 20}}},
        {"progressive",
         technique::progressive,
         {{.samples = 4, .caustic = 25'000, .indirect = 25'000, .cost = 0.75},
          {.samples = 16, .caustic = 25'000, .indirect = 25'000, .cost = 3},
          {.samples = 64, .caustic = 50'000, .indirect = 50'000, .full = full, .cost = 14},
          {.samples = 256, .caustic = 50'000, .indirect = 50'000, .full = full, .cost = 55}}},
    };
}

}  // namespace error_vs_time
