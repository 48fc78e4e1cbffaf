// One path from the eye or from a gather point, carried on until it ends by itself or reads the rest from elsewhere.
//
// Kajiya 1986; next-event estimation and scattering share the light by multiple importance sampling (Veach & Guibas
// 1995). The one loop under the path tracer and under the rays of every gather.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/algorithms/incoming_light.hpp>
#include <aglow/algorithms/path_emission.hpp>
#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/core/roulette.hpp>
#include <aglow/estimators/estimate.hpp>

namespace aglow {

/// How long paths get, and how they end.
struct path_options {
    std::uint32_t most_bounces{0};   ///< depth cap, 0 for none; a cap makes the picture darker
    std::uint32_t roulette_from{5};  ///< bounces before Russian roulette may end a path
    std::uint32_t split{2};          ///< of the first surfaces from the eye that both mirror and refract, so many are
                                     ///< followed both ways instead of one by chance; not by the path tracer
    host_faults* faults{nullptr};    ///< where the host's broken answers are noted; null for nowhere. Must live as long
};

/// The end of no path: every path goes on by itself.
struct no_terminal {};

/// The guide of no path: every surface chooses by itself where paths go on.
struct no_guide {
    template <Surface H, Sampler R>
    [[nodiscard, gnu::always_inline]] inline auto sample(const H& hit, const vec3<hit_scalar<H>>& wo, R& random,
                                                         lobe_set lobes, hit_scalar<H>) const {
        return hit.sample(wo, random, lobes);
    }
};

namespace detail {

inline constexpr no_guide unguided{};

/// Notes what a path carried when a broken answer of the host ended it.
template <Spectrum S>
[[nodiscard]] inline bool lose(const path_options& options, host_fault why, const S& carried) {
    if (options.faults) { options.faults->note(why, static_cast<double>(max_component(carried))); }
    return false;
}

/// Sends the walk on from `hit` by one of `lobes`; false where it ends.
template <Scene World, Numbers N, typename Guide = no_guide>
[[nodiscard, gnu::always_inline]] inline bool scatter(walk_state<World>& at, const hit_of<World>& hit,
                                                      const vec3<scalar_of<World>>& wo, scalar_of<World> error,
                                                      const N& numbers, std::uint32_t bounce, lobe_set lobes,
                                                      const path_options& options, const Guide& guide = unguided) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using B = band_of<S>;
    if (!any(lobes)) { return false; }
    auto scatter_numbers = numbers.at(bounce, purpose::scatter);
    const auto next = guide.sample(hit, wo, scatter_numbers, lobes & static_lobes<World>, at.boost);
    if (!next) { return false; }
    const vec3<T> wi = next->wi;
    const S carried = at.throughput;
    at.throughput = at.throughput * next->weight;
    if (!is_radiance(at.throughput)) { return lose(options, host_fault::weight, carried); }
    if (is_black(at.throughput)) { return false; }
    if (!is_direction(wi)) { return lose(options, host_fault::direction, carried); }
    constexpr bool guided = requires { next->boost; };
    if constexpr (guided) { at.boost *= next->boost; }
    if (bounce >= options.roulette_from) {
        const B carries = max_component(at.throughput) * (guided ? B(at.boost) : B(1));
        const B q = survival(B(1), carries, survival_ceiling<B>(bounce));
        if (!(numbers.at(bounce, purpose::roulette).next_1d() < q)) { return false; }
        at.throughput = at.throughput * (1 / q);
    }
    at.last = next->lobe;
    at.scattered = at.scattered || (!at.mirrored && any(next->lobe, lobe_set::smooth));
    at.mirrored = at.mirrored && !any(next->lobe, lobe_set::smooth);
    at.scatter_pdf = any(next->lobe, lobe_set::smooth) ? T(next->pdf) : T(0);
    if (any(next->lobe, lobe_set::smooth)) { at.travelled = 0; }
    const vec3<T> here = hit.position;
    at.came_from = here;
    at.path = {lift(here, vec3<T>(hit.normal), wi, error), wi};
    return true;
}

/// A surface on a walk.
template <Scene World>
struct walk_stop {
    using T = scalar_of<World>;

    const hit_of<World>& hit;
    vec3<T> wo;
    T travelled;  ///< since the start or the last diffuse or glossy surface: over mirrors, all legs
    T error;      ///< of the position
    std::uint32_t bounce;
};

/// What a walk from the eye brings: `incoming_light`, but of no use for gradients.
template <Spectrum S, std::floating_point T>
struct eye_light {
    S radiance{};
    T distance{std::numeric_limits<T>::infinity()};
    band_of<S> error{};
    band_of<S> common{};
    band_of<S> bias{};
};

/// A walk from the eye or from a gather point. It takes for itself what surfaces emit and what comes from beyond the
/// scene; the rest of a surface's light is for `shade` to add.
template <Scene World, Illuminator Lights, Numbers N, bool Eye = false, typename Guide = no_guide>
class path_walk {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using B = band_of<S>;
    using found = std::conditional_t<Eye, eye_light<S, T>, incoming_light<S, T>>;

public:
    path_walk(const World& scene, const Lights& lights, const N& numbers, emission_rule rule,
              const path_options& options, const ray<T>& start, const Guide& guide = unguided)
        : scene_{scene},
          lights_{lights},
          numbers_{numbers},
          rule_{rule},
          options_{options},
          guide_{guide},
          at_{.path = start} {}

    /// Walks to the end. At each surface, `shade(walk, stop)` adds the light that it sends by its smooth lobes, and
    /// returns the lobes to go on by. At the first `splits` surfaces, mirrors all, the walk goes both ways where they
    /// are two.
    template <typename Shade>
    [[nodiscard, gnu::always_inline]] inline found run(const Shade& shade, std::uint32_t splits = 0,
                                                       std::uint32_t bounce = 1) {
        for (;; ++bounce) {
            const auto hit = scene_.intersect(at_.path);
            if (!hit) { return leave(bounce); }
            const walk_stop<World> stop = stop_at(*hit, bounce);
            if (!is_sound(*hit, at_.path, stop.error)) {
                (void)lose(options_, fault_of(*hit), at_.throughput);
                return result_;
            }
            take_in(stop);
            if (options_.most_bounces != 0 && bounce > options_.most_bounces) { return result_; }
            const lobe_set on = shade(*this, stop);
            if constexpr (can_fork) {
                // Of specular lobes alone: a smooth one shares the light with shadow rays that count on the others too.
                const bool forks = splits > 0 && at_.mirrored && on == lobe_set::specular;
                if (forks) { return split(*hit, stop, shade, splits - 1); }
            }
            if (!scatter(at_, *hit, stop.wo, stop.error, numbers_, bounce, on, options_, guide_)) { return result_; }
        }
    }

    /// The walk's own numbers: another set in each branch.
    [[nodiscard]] const N& numbers() const { return numbers_; }

    /// Whether the walk met nothing but mirrors before where it stands.
    [[nodiscard]] bool mirrored() const { return at_.mirrored; }

    /// Takes in light that leaves the surface the walk stands at, unless its numbers are broken.
    void add(const S& radiance) {
        const S arriving = at_.throughput * radiance;
        if (!is_radiance(arriving)) { return void(lose(options_, host_fault::radiance, at_.throughput)); }
        result_.radiance = result_.radiance + arriving;
    }
    void add(const estimate<S>& light) {
        add(light.value);
        const B carried = max_component(at_.throughput);
        const auto take = [&](B& sum, B part) { sum += is_finite(carried * part) ? carried * part : B(0); };
        take(result_.error, light.error);
        take(result_.common, light.common);
        take(result_.bias, light.bias);
    }

    /// The largest band of what the walk carries.
    [[nodiscard]] double carried() const { return static_cast<double>(max_component(at_.throughput)); }

private:
    /// Whether surfaces that mirror and refract can be here at all.
    static constexpr bool can_fork = (static_lobes<World> & lobe_set::specular) == lobe_set::specular;

    template <typename Shade>
    found split(const hit_of<World>& hit, const walk_stop<World>& stop, const Shade& shade, std::uint32_t splits) {
        for (const lobe_set way : {lobe_set::specular_reflection, lobe_set::specular_transmission}) {
            const auto name = static_cast<std::uint64_t>(way);
            path_walk branch{scene_,   lights_, N{numbers_.fork(mix(stop.bounce, name))}, rule_, options_,
                             at_.path, guide_};
            branch.at_ = at_;
            if (!scatter(branch.at_, hit, stop.wo, stop.error, branch.numbers_, stop.bounce, way, options_, guide_)) {
                continue;
            }
            const auto light = branch.run(shade, splits, stop.bounce + 1);
            result_.radiance = result_.radiance + light.radiance;
            result_.error += light.error;
            result_.common += light.common;
            result_.bias += light.bias;
        }
        return result_;
    }

    [[nodiscard]] walk_stop<World> stop_at(const hit_of<World>& hit, std::uint32_t bounce) {
        at_.travelled += glm::dot(vec3<T>(hit.position) - at_.path.origin, at_.path.direction);
        return {hit, -at_.path.direction, at_.travelled, error_of(hit, at_.path.origin), bounce};
    }

    /// What the surface sends out by itself.
    void take_in(const walk_stop<World>& stop) {
        if (stop.bounce == 1) {
            result_.distance = stop.travelled;
            if constexpr (!Eye) { result_.normal = vec3<T>(stop.hit.normal); }
        }
        const S glow = emitted(stop.hit, stop.wo);
        if (is_radiance(glow) && is_black(glow)) { return; }
        add(glow * B(emission_share(at_, lights_, stop.hit, rule_, stop.bounce)));
    }

    found leave(std::uint32_t bounce) {
        if constexpr (ShinesFromBeyond<Lights, T>) {
            const T share = escape_share(at_, lights_, rule_, bounce);
            if (share > 0) { add(escaped_radiance<S>(lights_, at_.path.direction) * B(share)); }
        }
        return result_;
    }

    const World& scene_;
    const Lights& lights_;
    N numbers_;
    emission_rule rule_;
    const path_options options_;
    const Guide& guide_;
    walk_state<World> at_;
    found result_{};
};

}  // namespace detail

/// Walks along `start` and returns the radiance that comes back along it, and distance and normal of the first hit.
///
/// `terminal(hit, wo, travelled, error, mirrored)` may end the walk with an optional `estimate` of the radiance that
/// the diffuse lobes of `hit` send towards `wo`, direct light included; `travelled` is the way from the last
/// diffuse or glossy surface, `mirrored` tells that there were only mirrors before. Samples with broken hits or numbers
/// end where they are, never summed. A walk from the `Eye` tells no normal. `guide` has a say in where paths go on.
template <bool Eye = false, Scene World, Illuminator Lights, Numbers N, typename Terminal = no_terminal,
          typename Guide = no_guide>
[[nodiscard, gnu::always_inline]] inline auto walk_path(const World& scene, const Lights& lights,
                                                        const ray<scalar_of<World>>& start, const N& numbers,
                                                        emission_rule rule = emission_rule::all,
                                                        const path_options& options = {}, const Terminal& terminal = {},
                                                        const Guide& guide = detail::unguided) {
    const auto shade = [&](auto& walk, const detail::walk_stop<World>& stop) {
        lobe_set lobes = stop.hit.lobes();
        if constexpr (!std::same_as<Terminal, no_terminal>) {
            if (any(lobes, lobe_set::diffuse)) {
                if (const auto rest = terminal(stop.hit, stop.wo, stop.travelled, stop.error, walk.mirrored())) {
                    walk.add(*rest);
                    lobes = lobes & ~lobe_set::diffuse;
                }
            }
        }
        if (any(lobes, lobe_set::smooth)) {
            walk.add(
                direct_light(scene, lights, stop.hit, stop.wo, stop.error, numbers.at(stop.bounce, purpose::light),
                             {.lit = lobes, .scattered = lobes, .faults = options.faults, .carried = walk.carried()}));
        }
        return lobes;
    };
    return detail::path_walk<World, Lights, N, Eye, Guide>{scene, lights, numbers, rule, options, start, guide}.run(
        shade);
}

}  // namespace aglow
