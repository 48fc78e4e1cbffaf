// A study whose answers are known: errors that follow power laws exactly, but for noise between seeds.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <aglow/core/random.hpp>

#include "error_vs_time/png.hpp"
#include "error_vs_time/study.hpp"

namespace synthetic {

/// MAPE = floor + start · t^-slope after t CPU seconds.
struct law {
    std::string method;
    double start;
    double slope;
    double floor;
    double first_seconds;
};

inline double noise(std::uint64_t seed) {
    aglow::random_sampler<double> random{aglow::mix(seed)};
    return std::sqrt(-2 * std::log(1 - random.next_1d())) * std::cos(2 * aglow::pi<double> * random.next_1d());
}

inline const std::vector<law>& laws() {
    static const std::vector<law> all{{"path", 0.20, 0.5, 0, 0.25},
                                      {"irradiance-cache", 0.02, 0.5, 0.004, 0.1},
                                      {"photon-map", 0.08, 0.25, 0, 0.1},
                                      {"gather-cache", 0.01, 0.5, 0, 0.3}};
    return all;
}

/// `spread`: relative deviation of errors between seeds; `slower`: factor on every time, `salt` makes other noise.
inline error_vs_time::study study(double spread = 0.05, double slower = 1, double wronger = 1, std::uint64_t salt = 0,
                                  std::uint64_t seeds = 8) {
    error_vs_time::study all{.title = "Error against time <synthetic>", .baseline = "path"};
    all.provenance = {{"compiler", "none"}, {"seeds", "0 … 7"}, {"flags", "-O2 \"quoted\""}};
    for (const char* scene : {"box", "glass & mirror"}) {
        all.scenes.push_back({scene, "A synthetic scene.", 64, 64, "known exactly", 1e-5, 0.002});
        std::uint64_t id = aglow::mix(salt, scene[0] == 'b' ? 1u : 2u);
        for (const law& l : laws()) {
            for (std::size_t budget = 0; budget < 7; ++budget) {
                for (std::uint64_t seed = 0; seed < seeds; ++seed) {
                    const double t = l.first_seconds * std::pow(2.0, static_cast<double>(budget));
                    const double e = l.floor + l.start * std::pow(t, -l.slope);
                    error_vs_time::run_note r{.scene = scene, .method = l.method, .budget = budget, .seed = seed};
                    r.settings = std::to_string(4 << budget) + " samples, \"stratified\"";
                    r.cpu_seconds = slower * t * std::exp(0.02 * noise(++id));
                    r.wall_seconds = r.cpu_seconds;
                    r.error.mape = wronger * e * std::exp(spread * noise(++id));
                    r.error.relmse = 1.7 * r.error.mape * r.error.mape;
                    r.error.relmse_trimmed = 0.8 * r.error.relmse;
                    r.error.smape = r.error.mape;
                    r.error.rmse = 0.3 * r.error.mape;
                    r.error.energy_bias = -l.floor;
                    r.error.relative_q95 = 2.4 * r.error.mape;
                    r.error.relative_q99 = 3.5 * r.error.mape;
                    r.error.pixels = 4096;
                    r.phases = {{"build", 0.1 * t}, {"shade", 0.9 * t}};
                    r.counts = {{"camera rays", 65536 * t}, {"shadow rays", 262144 * t}};
                    if (l.method != "path") { r.counts.emplace_back("records", 1700); }
                    r.peak_bytes = 3e7;
                    all.runs.push_back(r);
                }
                all.parts.push_back({scene,
                                     l.method,
                                     budget,
                                     {l.floor * l.floor, 1e-7, 1e-3 / (1.0 + static_cast<double>(budget)), 8}});
            }
            all.audits.push_back({scene, l.method, 6, "certified", "certified: mean relative error within 5 %\n", 0.05,
                                  0.031, 0.027, -0.004, 0.006, 0.001, 0.05, 3});
        }
        std::vector<float> reference, picture;
        for (std::size_t i = 0; i < 64 * 64; ++i) {
            const float x = static_cast<float>(i % 64) / 64;
            const float y = static_cast<float>(i / 64) / 64;
            for (const float c : {x, y, 0.3f}) {
                reference.push_back(c);
                picture.push_back(c * (1 + 0.1f * static_cast<float>(noise(i))));
            }
        }
        all.pictures.push_back({scene, "reference", "", 64, 64, error_vs_time::shown(reference), {}});
        for (const law& l : laws()) {
            all.pictures.push_back({scene, l.method, "1 s", 64, 64, error_vs_time::shown(picture),
                                    error_vs_time::shown_error(picture, reference, 0.01)});
        }
    }
    return all;
}

}  // namespace synthetic
