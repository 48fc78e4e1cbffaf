// How far off is a cache of so many records, by what sets their reach? The set-up of Schwarzhaupt, Jensen & Jarosz
// 2012, figure 1: the Cornell box, one bounce of indirect light, 1,700 records of 4096 rays each. They give an RMSE of
// 0.0901 for the split sphere, 0.0290 for the bounded one with gradients, 0.0071 for the occlusion Hessian.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>

#include "common/camera.hpp"
#include "common/command_line.hpp"
#include "common/light_set.hpp"
#include "common/scenes/cornell.hpp"

namespace {

using T = float;
using S = aglow::vec3<float>;
using world = host::scene<T>;
using tracer = aglow::path_tracer<world, host::light_set<T>>;

constexpr std::string_view usage =
    "usage: records [RECORDS] [RAYS] | --smoke\n"
    "\n"
    "The error of an irradiance cache of so many records (1700), of so many rays each (4096), by what sets their "
    "reach.\n"
    "\n"
    "  --smoke   only tries whether everything works\n"
    "  --help    this\n";

struct effort {
    std::size_t records{1700};
    std::uint32_t rays{4096};
    std::size_t picture{512};  ///< its width and height: candidates for records
    std::size_t judged{64};    ///< across and down, how many of its places are compared
};

/// A place in the picture and what its irradiance is, twice: the errors of two truths have nothing in common, so the
/// mean of (x - first)(x - second) is the squared error of x alone.
struct judged_place {
    aglow::gather_point<T> at{};
    S first{};
    S second{};
};

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<judged_place> judge(const world& scene, const aglow::ray_reader<tracer>& light, const effort& e) {
    std::vector<judged_place> places;
    for (std::size_t i = 0; i < e.judged * e.judged; ++i) {
        const aglow::vec2<T> film{static_cast<T>(i % e.judged) + T(0.5), static_cast<T>(i / e.judged) + T(0.5)};
        const auto eye = scene.view().through(film, e.judged, e.judged);
        const auto hit = scene.intersect(eye);
        if (!hit || !any(hit->lobes(), aglow::lobe_set::diffuse_reflection)) { continue; }
        places.push_back({{hit->position, aglow::side_of(*hit, -eye.direction), aglow::error_of(*hit, eye.origin)}});
    }
    const auto shape = aglow::hemisphere_of(e.rays);
    aglow::own_threads{}(places.size(), [&](std::size_t i) {
        judged_place& p = places[i];
        p.first = gather_once(light, p.at, aglow::random_numbers<T>{{.seed = 1001, .path = i}}, shape);
        p.second = gather_once(light, p.at, aglow::random_numbers<T>{{.seed = 1002, .path = i}}, shape);
    });
    return places;
}

struct outcome {
    std::size_t records{};
    std::uint64_t rays{};
    double seconds{};
    double rmse{};      ///< W/m²
    double relative{};  ///< over the mean irradiance
    double missed{};    ///< share of places without a record
};

template <typename Frozen>
void compare(const Frozen& cache, const std::vector<judged_place>& places, outcome& result) {
    double off2 = 0;
    double level = 0;
    for (const judged_place& p : places) {
        auto answer = cache.lookup(p.at.position, p.at.normal);
        if (!answer) {
            result.missed += 1 / static_cast<double>(places.size());
            answer = cache.nearest(p.at.position, p.at.normal);
        }
        for (int band = 0; band < 3; ++band) {
            const double x = static_cast<double>(answer.irradiance[band]);
            const double first = static_cast<double>(p.first[band]);
            const double second = static_cast<double>(p.second[band]);
            off2 += (x - first) * (x - second);
            level += (first + second) / 2;
        }
    }
    const double count = 3 * static_cast<double>(places.size());
    result.rmse = std::sqrt(std::max(0.0, off2) / count);
    result.relative = result.rmse / (level / count);
}

/// Fills caches of ever better accuracies until the number of records is as wanted, give or take 2 %.
template <aglow::record_features Features>
outcome run(const world& scene, const aglow::ray_reader<tracer>& light, const std::vector<judged_place>& places,
            const effort& e, aglow::error_metric metric, double accuracy) {
    const auto eye = [&](const aglow::vec2<T>& film) { return scene.view().through(film, e.picture, e.picture); };
    const aglow::own_threads threads{};
    const auto where = cache_candidates(scene, eye, {.width = e.picture, .height = e.picture}, threads);
    outcome result;
    double slope = 0.5;  // of log accuracy over log records
    std::pair<double, double> before{};
    for (int attempt = 0; attempt < 12; ++attempt) {
        aglow::irradiance_cache_options o;
        o.reach.metric = metric;
        o.reach.accuracy = accuracy;
        // Few rays do while the number is far off.
        const bool last = attempt >= 6;
        const double begun = cpu_seconds();
        aglow::irradiance_cache<S, T, Features> cache{scene.bounds(), o};
        const aglow::fill_cache_options fill{.rays = last ? e.rays : std::min(256u, e.rays), .scatter = 0};
        const auto filled = fill_cache(cache, std::span{where}, light, fill, threads);
        const auto frozen = cache.freeze(threads);
        result = {cache.size(), filled.rays, cpu_seconds() - begun, 0, 0, 0};
        const double ratio = static_cast<double>(cache.size()) / static_cast<double>(e.records);
        if (last && (std::abs(ratio - 1) < 0.02 || attempt == 11)) {
            compare(frozen, places, result);
            break;
        }
        if (!last && std::abs(ratio - 1) < 0.02) { attempt = 5; }
        // Floors of the reach make the number less sensitive than it would be in the open: learn by how much.
        const std::pair<double, double> now{std::log(accuracy), std::log(ratio)};
        if (attempt > 0 && std::abs(now.second - before.second) > 1e-3) {
            const double learnt = (before.first - now.first) / (now.second - before.second);
            slope = learnt > 0 ? std::clamp(learnt, 0.3, 3.0) : slope;
        }
        before = now;
        accuracy *= std::pow(ratio, slope);
    }
    return result;
}

void print(const char* name, const outcome& r) {
    std::printf("%-34s %7zu %11llu %8.1f %10.4f %10.4f %8.4f\n", name, r.records,
                static_cast<unsigned long long>(r.rays), r.seconds, r.rmse, r.relative, r.missed);
    std::fflush(stdout);
}

int benchmark(const effort& e) {
    const world scene{host::scenes::cornell_diffuse<T>()};
    // One bounce: what direct light makes of the walls.
    const tracer paths{scene, scene.lights(), {.most_bounces = 1}};
    const aglow::ray_reader<tracer> light{paths};
    const auto places = judge(scene, light, e);
    std::printf("Cornell box, one bounce of indirect light, %zu records of %u rays, judged at %zu places\n\n",
                e.records, e.rays, places.size());
    std::printf("%-34s %7s %11s %8s %10s %10s %8s\n", "reach by", "records", "rays", "CPU s", "RMSE W/m2", "over mean",
                "missed");
    using aglow::error_metric;
    constexpr aglow::record_features flat{.gradients = false, .ellipse = false};
    constexpr aglow::record_features sloping{};
    print("split sphere, without gradients", run<flat>(scene, light, places, e, error_metric::split_sphere, 0.2));
    print("split sphere, bounded, gradients", run<sloping>(scene, light, places, e, error_metric::split_sphere, 0.2));
    print("nearest distance, gradients", run<sloping>(scene, light, places, e, error_metric::nearest_distance, 0.5));
    print("occlusion Hessian", run<sloping>(scene, light, places, e, error_metric::hessian, 0.1));
    return 0;
}

effort effort_of(command_line::words& asked) {
    effort e;
    for (int place = 0; asked.next();) {
        if (asked.is("--smoke")) {
            e = {.records = 60, .rays = 32, .picture = 32, .judged = 8};
        } else if (asked.is_option() || place == 2) {
            asked.refuse();
        } else if (place++ == 0) {
            e.records = command_line::whole("RECORDS", asked.word(), 20, 1'000'000);
        } else {
            e.rays = static_cast<std::uint32_t>(command_line::whole("RAYS", asked.word(), 16, 1'000'000));
        }
    }
    return e;
}

}  // namespace

int main(int count, char** arguments) {
    return command_line::run(count, arguments, usage,
                             [](command_line::words& asked) { return benchmark(effort_of(asked)); });
}
