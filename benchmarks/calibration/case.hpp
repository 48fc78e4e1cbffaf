// One picture whose truth is known, and a pool of unbiased looks at its pixels to draw certificates from.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/caustic_light.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/sobol.hpp>
#include <aglow/report/audit.hpp>

#include "common/audited_film.hpp"
#include "common/counted_scene.hpp"
#include "common/probe_paths.hpp"
#include "common/scene.hpp"
#include "common/scenes/registry.hpp"

namespace calibration {

using rgb = glm::vec3;
using world_type = host::counted_scene<host::scene<float>>;

/// How much work goes into a calibration.
struct effort {
    std::size_t pixels{64};     ///< width and height of the pictures
    std::uint32_t pool{16384};  ///< samples per pixel of the pool; a power of two, or the one below is taken
    bool whole{false};          ///< whether pictures that are rendered until they are certified are as wide as `width`
    std::size_t truths{8192};   ///< pixels of these whose truth is known, by so many samples each
    std::size_t certificates{200};
    double target{0};  ///< of audits and trials; 0: 3 % below the true error, and where an oracle needs 4 to 32 samples
    double noise{aglow::audit_options{}.noise};
    std::size_t class_probes{aglow::audit_options{}.class_probes};
    bool bounded{false};     ///< whether audits are told how large a sample can be
    std::size_t width{512};  ///< and height of the pictures whose work that of probes is compared with
    std::size_t budget{0};   ///< samples of an audit; 0: an eighth of the pool for each of its probes
    host::probe_kind probes{host::probe_kind::guided};  ///< as the renderer's, or by plain paths
};

struct judged_picture;

/// A scene, and a pool of unbiased samples of every pixel. What is true here is the mean of the pool and looks are
/// drawn from it, so that the truth has no noise of its own; the pool must be much larger than any look.
class known_scene {
public:
    [[nodiscard]] auto eye() const {
        return [this](const aglow::vec2<float>& film) {
            return scene_.view().through(film, effort_.pixels, effort_.pixels);
        };
    }

    known_scene(const host::scene_description<float>& description, const effort& e)
        : name_{description.name},
          effort_{e},
          scene_{description},
          paths_{scene_, scene_.lights(), 0, aglow::own_threads{}, e.probes},
          tracer_{paths_.tracer()} {
        effort_.pool = std::bit_floor(std::max(e.pool, 256u));
        fill_pool();
        find_features();
        find_caustics();
    }
    known_scene(const known_scene&) = delete;
    known_scene& operator=(const known_scene&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const effort& how() const { return effort_; }
    [[nodiscard]] const world_type& scene() const { return scene_; }
    [[nodiscard]] const std::vector<float>& truth() const { return truth_; }
    [[nodiscard]] const std::vector<char>& feature() const { return feature_; }
    /// Pixels that owe a tenth of their light or more to caustics.
    [[nodiscard]] const std::vector<char>& caustic() const { return caustic_; }

    /// Rays that a probe's sample costs.
    [[nodiscard]] double probe_cost() const { return rays_a_sample(tracer_) + paths_.guiding_cost(); }
    /// Rays that were spent before the first of them.
    [[nodiscard]] double guide_cost() const { return paths_.guide_cost(); }
    template <typename Integrator>
    [[nodiscard]] double rays_a_sample(const Integrator& integrator) const {
        return host::rays_a_sample(eye(), integrator, effort_.pixels, effort_.pixels, 5);
    }

    /// What no sample of a path exceeds but for a share that falls exponentially: the brightest lamp at each surface
    /// before roulette begins, and once more for what is left then.
    [[nodiscard]] double sample_bound() const {
        float brightest = 0;
        for (const float x : truth_) { brightest = std::max(brightest, x); }
        return brightest * (aglow::path_options{}.roulette_from + 1.0);
    }

    /// What an audit of so many probes may spend: an eighth more than its probes, for the look that deals samples out.
    [[nodiscard]] std::size_t budget(std::size_t probes) const {
        return effort_.budget > 0 ? effort_.budget : 9 * probes * (effort_.pool / 8) / 8;
    }

    /// The mean of `count` samples of a pixel: the largest sets of the pool that fit, drawn at random, and what is left
    /// over traced anew.
    [[nodiscard]] rgb look(std::size_t pixel, std::uint64_t seed, std::size_t count) const {
        rgb sum{};
        std::size_t left = count;
        std::uint64_t drawn = 0;
        for (std::size_t size = largest(), level = levels() - 1; size >= smallest; size /= 2, --level) {
            const rgb* const own = &pool_[level][pixel * (effort_.pool / size)];
            for (; left >= size; left -= size) {
                sum += own[aglow::mix(seed, ++drawn) % (effort_.pool / size)] * static_cast<float>(size);
            }
        }
        if (left > 0) { sum += trace(pixel, seed, left) * static_cast<float>(left); }
        return sum / static_cast<float>(count);
    }

    /// The mean relative error of a picture, as audits define it.
    [[nodiscard]] double mean_error(const judged_picture& picture) const;

    /// `look` as audits want it.
    [[nodiscard]] auto probe() const {
        return [this](std::size_t pixel, std::uint64_t seed, std::size_t count) { return look(pixel, seed, count); };
    }

private:
    static constexpr std::size_t smallest = 4;  // samples in a set of the pool

    /// Samples in a set, at most: few sets would be drawn twice by one probe, whose noise then seems too small.
    [[nodiscard]] std::size_t largest() const {
        return std::max(smallest, std::bit_floor(static_cast<std::size_t>(effort_.pool) / 256));
    }
    [[nodiscard]] std::size_t levels() const { return static_cast<std::size_t>(std::bit_width(largest() / smallest)); }

    /// The mean of `count` samples from number `first` on of a sequence of the pixel's, as `aglow::pixel_probe` takes
    /// them.
    [[nodiscard]] rgb trace(std::size_t pixel, std::uint64_t seed, std::size_t count, std::size_t first = 0) const {
        rgb sum{};
        for (std::size_t i = first; i < first + count; ++i) {
            const aglow::sobol_numbers<float> numbers{{aglow::mix(seed, 1), seed, pixel},
                                                      static_cast<std::uint32_t>(i)};
            const aglow::vec2<float> u = numbers.at(0, aglow::purpose::camera).next_2d();
            const aglow::vec2<float> film{static_cast<float>(pixel % effort_.pixels) + u.x,
                                          static_cast<float>(pixel / effort_.pixels) + u.y};
            sum += tracer_(eye()(film), numbers).value;
        }
        return sum / static_cast<float>(count);
    }

    /// All levels hold the same samples: a set is two sets of the level below, that lie side by side in a Sobol
    /// sequence and are as well spread together as a look of that size.
    void fill_pool() {
        const std::size_t count = effort_.pixels * effort_.pixels;
        truth_.resize(3 * count);
        pool_.resize(levels());
        for (std::size_t l = 0; l < levels(); ++l) { pool_[l].resize(count * (effort_.pool / (smallest << l))); }
        aglow::own_threads{}(count, [&](std::size_t pixel) { fill_pool(pixel); });
    }

    void fill_pool(std::size_t pixel) {
        const std::size_t per_sequence = largest() / smallest;
        const std::size_t sets = effort_.pool / smallest;
        glm::dvec3 sum{};
        for (std::size_t i = 0; i < sets; ++i) {
            const rgb mean = trace(pixel, aglow::mix(2000, i / per_sequence), smallest, i % per_sequence * smallest);
            pool_[0][pixel * sets + i] = mean;
            sum += glm::dvec3{mean};
        }
        for (std::size_t l = 1; l < levels(); ++l) {
            const std::size_t own = sets >> l;
            for (std::size_t i = 0; i < own; ++i) {
                const rgb* const pair = &pool_[l - 1][2 * (pixel * own + i)];
                pool_[l][pixel * own + i] = 0.5f * (pair[0] + pair[1]);
            }
        }
        sum /= static_cast<double>(sets);
        for (int c = 0; c < 3; ++c) { truth_[3 * pixel + static_cast<std::size_t>(c)] = static_cast<float>(sum[c]); }
    }

    /// Pixels with another primitive within two of them.
    void find_features() {
        feature_ = host::feature_pixels(effort_.pixels, effort_.pixels, [this](std::size_t x, std::size_t y) {
            const auto hit = scene_.intersect(eye()({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
            return hit ? hit->primitive : ~0u;
        });
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
    world_type scene_;
    host::probe_paths<world_type> paths_;
    decltype(paths_.tracer()) tracer_;
    std::vector<float> truth_;
    std::vector<std::vector<rgb>> pool_;  // [level][pixel][set], sets twice as large with each level
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

/// Values and guesses of a film, without classes: for claims on the whole picture.
[[nodiscard]] inline judged_picture picture_of(const aglow::film<rgb>& film) {
    judged_picture result{.pixels = film.width()};
    for (std::size_t y = 0; y < film.height(); ++y) {
        for (std::size_t x = 0; x < film.width(); ++x) {
            const rgb p = film.radiance(x, y);
            result.values.insert(result.values.end(), {p.x, p.y, p.z});
            result.guess.push_back(film.error(x, y));
        }
    }
    return result;
}

[[nodiscard]] inline judged_picture judge(const known_scene& scene, const aglow::film<rgb>& film) {
    judged_picture result = picture_of(film);
    const std::size_t count = film.width() * film.height();
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

/// How wrong a picture is.
struct true_errors {
    std::vector<double> absolute{};  ///< of the mean of the channels
    double bias{0};
    double mean_relative{0};
    double quantile95{0};
};

/// Relative errors are over the truth and `dark` times the mean of the picture, as in audits.
[[nodiscard]] inline true_errors errors_of(const known_scene& scene, const judged_picture& picture, double dark) {
    true_errors result;
    const std::size_t count = scene.truth().size() / 3;
    double ours = 0;
    double theirs = 0;
    for (const float x : picture.values) { ours += static_cast<double>(x); }
    for (const float x : scene.truth()) { theirs += static_cast<double>(x); }
    const double delta = dark * ours / static_cast<double>(picture.values.size());
    result.bias = ours / theirs - 1;
    std::vector<double> relative;
    for (std::size_t i = 0; i < count; ++i) {
        double signed_error = 0;
        double pixel = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double truth = static_cast<double>(scene.truth()[3 * i + c]);
            const double error = static_cast<double>(picture.values[3 * i + c]) - truth;
            signed_error += error / 3;
            pixel += std::abs(error) / (truth + delta) / 3;
        }
        result.absolute.push_back(std::abs(signed_error));
        relative.push_back(pixel);
        result.mean_relative += pixel / static_cast<double>(count);
    }
    const auto at = relative.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(count) * 0.95);
    std::nth_element(relative.begin(), at, relative.end());
    result.quantile95 = *at;
    return result;
}

inline double known_scene::mean_error(const judged_picture& picture) const {
    return errors_of(*this, picture, aglow::audit_options{}.dark).mean_relative;
}

inline constexpr const char* methods[] = {"photon map", "final gather", "irradiance cache", "gather cache",
                                          "progressive"};

/// What is wrong with a picture, on purpose.
enum class mistake { none, wide_radius, no_depth, lamp_missing, coarse_cache };

/// Calls `use` with the integrator number `method`, all but the progressive one, of `world` with its maps.
template <typename Known, typename Use>
void with_integrator(const Known& scene, const world_type& world, std::size_t method, std::uint64_t seed, mistake wrong,
                     const Use& use) {
    const std::size_t n = scene.how().pixels;
    const auto& lights = world.lights();
    const aglow::own_threads run{};
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
        case 0: return use(aglow::photon_mapping{world, lights, {.photons = photons, .density = density}, run});
        case 1: return use(aglow::final_gathering{world, lights, {.photons = photons, .rays = 32}, run});
        case 2: return use(aglow::irradiance_caching{world, lights, world.bounds(), scene.eye(), caching, run});
        default: {
            aglow::gather_caching_options options;
            options.photons = photons;
            options.caching = caching;
            return use(aglow::gather_caching{world, lights, world.bounds(), scene.eye(), options, run});
        }
    }
}

inline constexpr std::size_t progressive = 4;
inline constexpr aglow::progressive_options passes_of{.caustic = 10'000, .indirect = 20'000};

/// Calls `use` with a callable that exposes a film with so many more samples, or passes of the progressive method.
template <typename Known, typename Use>
void with_method(const Known& scene, const world_type& world, std::size_t method, std::uint64_t seed, mistake wrong,
                 const Use& use) {
    const aglow::own_threads run{};
    if (method == progressive) {
        aglow::progressive_options options = passes_of;
        options.seed = seed;
        aglow::progressive_photon_mapping passes{world, world.lights(), options};
        return use([&](aglow::film<rgb>& film, std::uint32_t more) {
            for (std::uint32_t i = 0; i < more; ++i) { passes.pass(film, scene.eye(), run); }
        });
    }
    with_integrator(scene, world, method, seed, wrong, [&](const auto& integrator) {
        use([&](aglow::film<rgb>& film, std::uint32_t more) {
            film.expose(scene.eye(), integrator, {.samples = more, .seed = seed}, run);
        });
    });
}

/// The picture of `scene` by method number `method`, seen in `world`.
[[nodiscard]] inline judged_picture render(const known_scene& scene, const world_type& world, std::size_t method,
                                           std::uint64_t seed, mistake wrong = mistake::none) {
    aglow::film<rgb> film{scene.how().pixels, scene.how().pixels};
    with_method(scene, world, method, seed, wrong,
                [&](const auto& expose) { expose(film, method == progressive ? 32 : 16); });
    return judge(scene, film);
}

/// The picture of `scene` by method number `method`.
[[nodiscard]] inline judged_picture render(const known_scene& scene, std::size_t method, std::uint64_t seed,
                                           mistake wrong = mistake::none) {
    return render(scene, scene.scene(), method, seed, wrong);
}

/// Rays of one pixel in a pass of the progressive method: its own share of the photons', and those of its sample.
template <typename Known>
[[nodiscard]] double pass_cost(const Known& scene) {
    const auto& world = scene.scene();
    const auto rays = [] { return host::ray_count::all_nearest() + host::ray_count::all_shadow(); };
    const aglow::photon_options wanted{.caustic = passes_of.caustic, .indirect = passes_of.indirect, .seed = 11};
    const auto maps = aglow::trace_photons(world, world.lights(), wanted, aglow::own_threads{});
    aglow::photon_options next = wanted;
    next.paths = {.caustic = maps.caustic.paths, .indirect = maps.indirect.paths};
    next.pass = 1;
    const std::uint64_t before = rays();
    (void)aglow::trace_photons(world, world.lights(), next, aglow::own_threads{});
    const double photons = static_cast<double>(rays() - before) / aglow::square(static_cast<double>(scene.how().width));
    const host::sample_lookups lookups{.maps = maps.caustic.size() > 0 ? 2u : 1u};
    return photons + lookups.cost() +
           scene.rays_a_sample(
               aglow::layered_integrator{world, world.lights(), aglow::direct_layer{world, world.lights()}});
}

/// Rays that a sample of a pixel costs by method number `method`, lookups weighed as the renderer weighs them.
template <typename Known>
[[nodiscard]] double picture_cost(const Known& scene, std::size_t method) {
    if (method == progressive) { return pass_cost(scene); }
    double cost = 0;
    with_integrator(scene, scene.scene(), method, 11, mistake::none, [&](const auto& integrator) {
        host::sample_lookups lookups;
        if constexpr (requires { integrator.cache(); }) { lookups.caches = 1; }
        if constexpr (requires { integrator.maps(); }) { lookups.maps = integrator.maps().caustic.size() > 0 ? 1 : 0; }
        if (method == 0) { ++lookups.maps; }
        cost = scene.rays_a_sample(integrator) + lookups.cost();
    });
    return cost;
}

}  // namespace calibration
