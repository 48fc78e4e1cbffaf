// Where light arrives from over mirrors, learned from photons beforehand: paths that look there find caustics.
//
// Jensen 1995, Importance driven path tracing using the photon map; a cone about each photon as Hey & Purgathofer 2002;
// mixed with what the surface samples by itself, so that nothing the photons missed is lost (Müller et al. 2017). A
// path takes half as long again, for a quarter of the variance where caustics are; elsewhere none is guided.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include <aglow/algorithms/guide_lobes.hpp>
#include <aglow/algorithms/path_walk.hpp>
#include <aglow/algorithms/plan.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/lasting.hpp>
#include <aglow/core/parallel.hpp>

namespace aglow {

/// A scattered direction whose density was raised `boost` times by a guide, and its weight lowered as much. `pdf` is
/// still the surface's own, by which the light sampling shares.
template <Spectrum S, std::floating_point T>
struct guided_sample : scatter_sample<S, T> {
    T boost{1};
};

/// Directions worth a look, by place and side: what light brings there over mirrors. `const`, safe from many threads.
template <std::floating_point T>
class path_guide {
public:
    /// Guides nowhere.
    path_guide() = default;

    /// Learns from photons of `lights`; guides nowhere where the plan of `scene` knows no caustics. The same for any
    /// threads of `run`. Throws `std::invalid_argument` for options out of range.
    template <Scene World, Emitter Lights, Executor Run = in_sequence>
    path_guide(const World& scene, const Lights& lights, const path_guide_options& options = {}, const Run& run = {}) {
        const T most = static_cast<T>(options.most);
        if (!(most > 0 && most < 1)) { throw std::invalid_argument("most: not between 0 and 1"); }
        if (!(options.gain >= 0)) { throw std::invalid_argument("gain: below 0"); }
        if (options.cells == 0 || options.cells > 256) { throw std::invalid_argument("cells: not between 1 and 256"); }
        if (!plan_for(scene).caustic_map) { return; }
        const auto maps = trace_photons(scene, lights,
                                        {.caustic = options.photons,
                                         .indirect = 2 * options.photons,
                                         .reflected = options.photons / 2,
                                         .seed = options.seed},
                                        run);
        std::vector<detail::mirrored_photon<T>> photons;
        add(scene, maps.caustic, photons);
        add(scene, maps.reflected, photons);
        if (photons.size() < detail::guide_lobes<T>::room) { return; }
        build(photons, maps.indirect, options, run);
    }

    /// Places and sides that know where to look.
    [[nodiscard]] std::size_t size() const { return lobes_.size(); }
    [[nodiscard]] bool empty() const { return lobes_.empty(); }

    /// A direction that scatters light towards `wo` at `hit`: by the guide or by the surface, weighed by the density of
    /// both together. `boost` is what guides have done to the path so far: by surfaces alone where that is below
    /// `least_boost`, since each guide that is not followed raises the path's weight, which has to end somewhere.
    template <Surface H, Sampler R>
    [[nodiscard]] std::optional<guided_sample<surface_spectrum<H>, T>> sample(const H& hit, const vec3<T>& wo,
                                                                              R& random, lobe_set lobes,
                                                                              T boost = 1) const {
        const bool may = boost >= T(least_boost) && any(lobes, lobe_set::smooth);
        const detail::guide_lobes<T>* guide = may ? at(hit, wo, lobes) : nullptr;
        if (!guide) { return by_surface(hit, wo, random, lobes, nullptr); }
        const T u = random.next_1d();
        if (!(u < guide->chance)) { return by_surface(hit, wo, random, lobes, guide); }
        return by_guide(hit, wo, random, lobes, *guide, u / guide->chance);
    }

    /// Lobes for light that arrives at `point` on the side that unit `normal` points out of; null where none is
    /// guided.
    [[nodiscard]] const detail::guide_lobes<T>* at(const vec3<T>& point, const vec3<T>& normal) const {
        if (lobes_.empty()) { return nullptr; }
        const std::uint32_t found = cells_[grid_.index(point, normal)];
        return found < lobes_.size() ? &lobes_[found] : nullptr;
    }

private:
    static constexpr double least_boost = 0.25;  // at 0.5 audits behind glass met heavy tails three times as often
    static constexpr std::uint32_t none = ~0u;
    static constexpr std::uint32_t unknown = ~1u;

    template <Surface H>
    [[nodiscard]] const detail::guide_lobes<T>* at(const H& hit, const vec3<T>& wo, lobe_set lobes) const {
        const vec3<T> n = hit.normal;
        const bool through = !any(lobes, lobe_set::smooth & lobe_set::reflection);
        return at(vec3<T>(hit.position), (glm::dot(n, wo) < 0) != through ? -n : n);
    }

    template <Surface H, Sampler R>
    [[nodiscard]] static std::optional<guided_sample<surface_spectrum<H>, T>> by_surface(
        const H& hit, const vec3<T>& wo, R& random, lobe_set lobes, const detail::guide_lobes<T>* guide) {
        const auto drawn = hit.sample(wo, random, lobes);
        if (!drawn) { return std::nullopt; }
        guided_sample<surface_spectrum<H>, T> next{{drawn->wi, drawn->weight, T(drawn->pdf), drawn->lobe}, T(1)};
        if (!guide) { return next; }
        next.boost = 1 - guide->chance;
        if (any(next.lobe, lobe_set::smooth) && next.pdf > 0) {
            next.boost += guide->chance * guide->pdf(vec3<T>(hit.position), next.wi) / next.pdf;
        }
        next.weight = next.weight * band_of<surface_spectrum<H>>(1 / next.boost);
        return next;
    }

    template <Surface H, Sampler R>
    [[nodiscard]] static std::optional<guided_sample<surface_spectrum<H>, T>> by_guide(
        const H& hit, const vec3<T>& wo, R& random, lobe_set lobes, const detail::guide_lobes<T>& guide, T u) {
        using S = surface_spectrum<H>;
        const vec3<T> point = hit.position;
        const std::size_t i = guide.choose(u);
        const auto u2 = random.next_2d();
        const auto wi = guide.sample(point, i, {T(u2.x), T(u2.y)});
        if (!wi) { return std::nullopt; }
        const T own = hit.pdf(wo, *wi, lobes);
        if (!(own > 0)) { return std::nullopt; }
        const T boost = 1 - guide.chance + guide.chance * guide.pdf(point, *wi, i) / own;
        const T cosine = std::abs(glm::dot(vec3<T>(hit.normal), *wi));
        const S weight = S(hit.evaluate(wo, *wi, lobes)) * band_of<S>(cosine / (own * boost));
        return guided_sample<S, T>{{*wi, weight, own, lobes & lobe_set::smooth}, boost};
    }

    template <Scene World, typename Map>
    static void add(const World& scene, const Map& map, std::vector<detail::mirrored_photon<T>>& photons) {
        for (std::size_t i = 0; i < map.size(); ++i) {
            const auto& p = map.photons()[i];
            const vec3<T> position = map.position(i);
            const vec3<T> normal = p.template facing<T>();
            const vec3<T> wi = glm::normalize(p.template towards<T>());
            const T error = position_error(max_abs(position));
            const auto mirror = scene.intersect(ray<T>{lift(position, normal, wi, error), wi});
            const T distance = mirror ? glm::dot(vec3<T>(mirror->position) - position, wi) : T(0);
            const T power = static_cast<T>(max_component(p.flux()) * map.unit());
            photons.push_back({position, normal, wi, is_finite(distance) ? distance : T(0), power});
        }
    }

    struct place {
        std::uint32_t cell;
        vec3<T> position, normal;
    };

    /// A place in the middle of those where photons landed, for each cell and side.
    template <typename Map>
    [[nodiscard]] std::vector<place> sites_of(const std::vector<detail::mirrored_photon<T>>& photons,
                                              const Map& others) const {
        std::vector<place> places;
        const auto note = [&](const vec3<T>& x, const vec3<T>& n) { places.push_back({grid_.index(x, n), x, n}); };
        for (const auto& p : photons) { note(p.position, p.normal); }
        for (std::size_t i = 0; i < others.size(); ++i) {
            note(others.position(i), others.photons()[i].template facing<T>());
        }
        std::stable_sort(places.begin(), places.end(), [](const place& a, const place& b) { return a.cell < b.cell; });
        std::vector<place> sites;
        for (std::size_t first = 0, last = 0; first < places.size(); first = last) {
            while (last < places.size() && places[last].cell == places[first].cell) { ++last; }
            sites.push_back(places[first + (last - first) / 2]);
        }
        return sites;
    }

    template <typename Map, typename Run>
    void build(const std::vector<detail::mirrored_photon<T>>& photons, const Map& others,
               const path_guide_options& options, const Run& run) {
        bounds<T> box;
        for (const auto& p : photons) { box.add(p.position); }
        for (std::size_t i = 0; i < others.size(); ++i) { box.add(others.position(i)); }
        grid_ = {box, options.cells};
        const std::vector<place> sites = sites_of(photons, others);
        const vec3<T> e = box.extent();
        const detail::guide_maker<T> maker{photons, 64 * std::max({e.x, e.y, e.z}), options};
        std::vector<detail::guide_lobes<T>> made(sites.size());
        for_each_block(run, sites.size(), 64, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const auto rest = others.irradiance(sites[i].position, sites[i].normal, {.count = 32}).value;
                made[i] = maker.at(sites[i].position, sites[i].normal, static_cast<T>(max_component(rest)));
            }
        });
        cells_.assign(grid_.size(), unknown);
        for (std::size_t i = 0; i < sites.size(); ++i) {
            const bool guides = made[i].chance > 0;
            cells_[sites[i].cell] = guides ? static_cast<std::uint32_t>(lobes_.size()) : none;
            if (guides) { lobes_.push_back(made[i]); }
        }
        for (int times = 0; times < 2; ++times) { ask_neighbours(); }
    }

    /// Where no photon landed, the cell beside speaks.
    void ask_neighbours() {
        const std::vector<std::uint32_t> before = cells_;
        grid_.for_each_beside([&](std::size_t cell, std::size_t beside) {
            if (cells_[cell] == unknown) { cells_[cell] = before[beside]; }
        });
    }

    detail::guide_grid<T> grid_{};
    std::vector<std::uint32_t> cells_{};
    std::vector<detail::guide_lobes<T>> lobes_{};
};

template <Scene World, typename Lights, typename... Rest>
path_guide(const World&, const Lights&, const Rest&...) -> path_guide<scalar_of<World>>;

/// The same light as `path_tracer`, with less noise where caustics are: an integrator whose paths follow a `path_guide`
/// made beforehand. Unbiased for any guide. Keeps references; `const`, safe from many threads.
template <Scene World, Illuminator Lights>
class guided_path_tracer {
public:
    using spectrum = spectrum_of<World>;
    using scalar = scalar_of<World>;

    guided_path_tracer(lasting<World> scene, lasting<Lights> lights, lasting<path_guide<scalar>> guide,
                       const path_options& options = {})
        : scene_{*scene}, lights_{*lights}, guide_{*guide}, options_{options} {}

    /// Radiance that comes back along `eye`, W/(m² sr); unbiased without `most_bounces`, so its own error guess is 0.
    template <Numbers N>
    [[nodiscard]] estimate<spectrum> operator()(const ray<scalar>& eye, const N& numbers) const {
        const auto light =
            walk_path<true>(scene_, lights_, eye, numbers, emission_rule::all, options_, no_terminal{}, guide_);
        return {light.radiance, 0};
    }

    /// The same, but for where the host's faults are noted: there, if the options name no place.
    [[nodiscard]] guided_path_tracer watched(host_faults& faults) const {
        guided_path_tracer same = *this;
        if (!same.options_.faults) { same.options_.faults = &faults; }
        return same;
    }
    /// Where the host's faults are noted; null for nowhere.
    [[nodiscard]] const host_faults* faults() const { return options_.faults; }

private:
    const World& scene_;
    const Lights& lights_;
    const path_guide<scalar>& guide_;
    path_options options_;
};

template <Scene World, Illuminator Lights>
guided_path_tracer(const World&, const Lights&, const path_guide<scalar_of<World>>&, const path_options& = {})
    -> guided_path_tracer<World, Lights>;

}  // namespace aglow
