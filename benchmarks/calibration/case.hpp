// One picture whose truth is known, and a pool of unbiased looks at its pixels to draw certificates from.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/report/audit.hpp>

#include "common/scene.hpp"
#include "common/scenes/registry.hpp"

namespace calibration {

using rgb = glm::vec3;

/// How much work goes into a calibration.
struct effort {
    std::size_t pixels{64};      ///< width and height of the pictures
    std::uint32_t truth{16384};  ///< samples per pixel of the truth
    std::uint32_t pool{4096};    ///< samples per pixel of the pool, in batches
    std::uint32_t batches{64};
    std::size_t certificates{200};
};

/// A scene, its true picture, and independent looks at every pixel.
class known_scene {
public:
    [[nodiscard]] auto eye() const {
        return [this](const aglow::vec2<float>& film) {
            return scene_.view().through(film, effort_.pixels, effort_.pixels);
        };
    }

    known_scene(const host::scene_description<float>& description, const effort& e)
        : name_{description.name}, effort_{e}, scene_{description} {
        const aglow::path_tracer tracer{scene_, scene_.lights()};
        aglow::film<rgb> film{e.pixels, e.pixels};
        film.expose(eye(), tracer, {.samples = e.truth, .seed = 1001}, aglow::own_threads{});
        truth_ = values_of(film);
        pool_.resize(e.batches);
        for (std::uint32_t b = 0; b < e.batches; ++b) {
            aglow::film<rgb> batch{e.pixels, e.pixels};
            batch.expose(eye(), tracer, {.samples = e.pool / e.batches, .seed = 2000 + b}, aglow::own_threads{});
            pool_[b] = values_of(batch);
        }
        find_features();
        find_caustics();
    }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const effort& how() const { return effort_; }
    [[nodiscard]] const host::scene<float>& scene() const { return scene_; }
    [[nodiscard]] const std::vector<float>& truth() const { return truth_; }
    [[nodiscard]] const std::vector<char>& feature() const { return feature_; }
    /// Pixels that owe a tenth of their light or more to caustics.
    [[nodiscard]] const std::vector<char>& caustic() const { return caustic_; }

    /// Samples that a look is the mean of.
    [[nodiscard]] std::size_t samples_per_look() const { return effort_.pool / effort_.batches; }

    /// What no sample of a path exceeds but for a share that falls exponentially: the brightest lamp at each surface
    /// before roulette begins, and once more for what is left then.
    [[nodiscard]] double sample_bound() const {
        float brightest = 0;
        for (const float x : truth_) { brightest = std::max(brightest, x); }
        return brightest * (aglow::path_options{}.roulette_from + 1.0);
    }

    /// An unbiased look at a pixel: one batch of the pool, chosen by the seed.
    [[nodiscard]] rgb look(std::size_t pixel, std::uint64_t seed) const {
        const std::vector<float>& batch = pool_[aglow::mix(seed, pixel) % pool_.size()];
        return {batch[3 * pixel], batch[3 * pixel + 1], batch[3 * pixel + 2]};
    }

    [[nodiscard]] static std::vector<float> values_of(const aglow::film<rgb>& film) {
        std::vector<float> values;
        values.reserve(3 * film.width() * film.height());
        for (std::size_t y = 0; y < film.height(); ++y) {
            for (std::size_t x = 0; x < film.width(); ++x) {
                const rgb p = film.radiance(x, y);
                values.insert(values.end(), {p.x, p.y, p.z});
            }
        }
        return values;
    }

private:
    /// Pixels with another primitive within two of them.
    void find_features() {
        const std::size_t n = effort_.pixels;
        std::vector<std::uint32_t> ids(n * n);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const auto hit =
                scene_.intersect(eye()({static_cast<float>(i % n) + 0.5f, static_cast<float>(i / n) + 0.5f}));
            ids[i] = hit ? hit->primitive : ~0u;
        }
        feature_.assign(n * n, 0);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const std::size_t x = i % n;
            const std::size_t y = i / n;
            for (std::size_t v = y < 2 ? 0 : y - 2; v <= std::min(n - 1, y + 2); ++v) {
                for (std::size_t u = x < 2 ? 0 : x - 2; u <= std::min(n - 1, x + 2); ++u) {
                    if (ids[v * n + u] != ids[i]) { feature_[i] = 1; }
                }
            }
        }
    }

    /// By more photons and samples than an audit takes, and by the true light.
    void find_caustics() {
        const std::vector<float> light =
            aglow::caustic_light(scene_, scene_.lights(), eye(), effort_.pixels, effort_.pixels,
                                 {.photons = 200'000, .samples = 16, .seed = 3}, aglow::own_threads{});
        caustic_.assign(truth_.size() / 3, 0);
        for (std::size_t i = 0; i < light.size(); ++i) {
            caustic_[i] = light[i] > 0.1f * std::max({truth_[3 * i], truth_[3 * i + 1], truth_[3 * i + 2]});
        }
    }

    std::string name_;
    effort effort_;
    host::scene<float> scene_;
    std::vector<float> truth_;
    std::vector<std::vector<float>> pool_;
    std::vector<char> feature_;
    std::vector<char> caustic_;
};

/// A picture by some integrator, with its guesses and the classes that an audit gives error bars for.
struct judged_picture {
    std::vector<float> values{};
    std::vector<float> guess{};
    std::vector<std::uint32_t> classes{};  ///< feature + 2 * hard, or dark, or caustic
    std::vector<char> hard{};
    std::size_t pixels{0};

    static constexpr std::uint32_t dark_class = 4;
    static constexpr std::uint32_t caustic_class = 5;

    [[nodiscard]] aglow::audited_picture<float> audited() const {
        return {.image = {values, pixels, pixels, 3}, .guess = guess, .classes = classes};
    }
    [[nodiscard]] double gray(std::size_t i) const {
        return (static_cast<double>(values[3 * i]) + values[3 * i + 1] + values[3 * i + 2]) / 3;
    }
};

[[nodiscard]] inline judged_picture judge(const known_scene& scene, const aglow::film<rgb>& film) {
    judged_picture result{.values = known_scene::values_of(film), .pixels = film.width()};
    const std::size_t count = film.width() * film.height();
    for (std::size_t i = 0; i < count; ++i) { result.guess.push_back(film.error(i % film.width(), i / film.width())); }
    std::vector<double> hardness(count);
    for (std::size_t i = 0; i < count; ++i) {
        hardness[i] = static_cast<double>(result.guess[i]) / std::max(1e-30, result.gray(i));
    }
    std::vector<double> sorted = hardness;
    const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>(3 * count / 4);
    std::nth_element(sorted.begin(), quarter, sorted.end());
    const std::vector<float> caustic = aglow::caustic_light(scene.scene(), scene.scene().lights(), scene.eye(),
                                                            film.width(), film.height(), {}, aglow::own_threads{});
    std::vector<double> grays;
    for (std::size_t i = 0; i < count; ++i) { grays.push_back(result.gray(i)); }
    const auto tenth = grays.begin() + static_cast<std::ptrdiff_t>(count / 10);
    std::nth_element(grays.begin(), tenth, grays.end());
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t hard = hardness[i] > *quarter ? 2 : 0;
        const bool dark = result.gray(i) <= *tenth;
        const float most = std::max({result.values[3 * i], result.values[3 * i + 1], result.values[3 * i + 2]});
        const std::uint32_t kind =
            dark ? judged_picture::dark_class : hard + static_cast<std::uint32_t>(scene.feature()[i]);
        const bool in_caustic = !caustic.empty() && caustic[i] > 0.1f * most;
        result.classes.push_back(in_caustic ? judged_picture::caustic_class : kind);
        result.hard.push_back(hard > 0);
    }
    return result;
}

inline constexpr const char* methods[] = {"photon map", "final gather", "irradiance cache", "gather cache",
                                          "progressive"};

/// What is wrong with a picture, on purpose.
enum class mistake { none, wide_radius, no_depth, lamp_missing, coarse_cache };

/// The picture of `scene` by method number `method`, seen in `world`.
[[nodiscard]] inline judged_picture render(const known_scene& scene, const host::scene<float>& world,
                                           std::size_t method, std::uint64_t seed, mistake wrong = mistake::none) {
    const std::size_t n = scene.how().pixels;
    const auto& lights = world.lights();
    const aglow::own_threads run{};
    aglow::film<rgb> film{n, n};
    const auto expose = [&](const auto& integrator, std::uint32_t samples) {
        film.expose(scene.eye(), integrator, {.samples = samples, .seed = seed}, run);
    };
    aglow::caching_options caching;
    caching.view = {.width = n, .height = n, .looks = 4};
    caching.fill.rays = 256;
    caching.fill.seed = seed;
    if (wrong == mistake::coarse_cache) { caching.cache.reach.accuracy = 1; }
    aglow::photon_options photons{.direct = 10'000, .caustic = 50'000, .indirect = 50'000, .seed = seed};
    if (wrong == mistake::no_depth) { photons.most_bounces = 1; }
    aglow::density_options density;
    if (wrong == mistake::wide_radius) { density.count *= 9; }
    switch (method) {
        case 0: expose(aglow::photon_mapping{world, lights, {.photons = photons, .density = density}, run}, 16); break;
        case 1: expose(aglow::final_gathering{world, lights, {.photons = photons, .rays = 32}, run}, 16); break;
        case 2: expose(aglow::irradiance_caching{world, lights, world.bounds(), scene.eye(), caching, run}, 16); break;
        case 3: {
            aglow::gather_caching_options options;
            options.photons = photons;
            options.caching = caching;
            expose(aglow::gather_caching{world, lights, world.bounds(), scene.eye(), options, run}, 16);
            break;
        }
        default: {
            aglow::progressive_photon_mapping passes{
                world, lights, {.caustic = 10'000, .indirect = 20'000, .seed = seed}};
            for (int i = 0; i < 32; ++i) { passes.pass(film, scene.eye(), run); }
        }
    }
    return judge(scene, film);
}

/// The picture of `scene` by method number `method`.
[[nodiscard]] inline judged_picture render(const known_scene& scene, std::size_t method, std::uint64_t seed,
                                           mistake wrong = mistake::none) {
    return render(scene, scene.scene(), method, seed, wrong);
}

}  // namespace calibration
