// Which part of the emission that a path meets is its own, and which was or will be found in another way.
//
// Veach & Guibas 1995: what shadow rays and scattered rays both find is shared by the balance heuristic.
#pragma once

#include <cstdint>

#include <aglow/algorithms/direct_light.hpp>
#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/surface.hpp>
#include <aglow/core/ray.hpp>

namespace aglow {

/// Which emission a walk takes for itself where its first ray, or a chain of mirrors after it, meets a light.
enum class emission_rule : std::uint8_t {
    all,          ///< a ray from the eye: everything it meets
    indirect,     ///< a gather ray: the asker looked for lights himself, but not through mirrors
    no_caustics,  ///< a gather ray beside a caustic map: not through mirrors either
    no_reflected  ///< beside a map of reflected caustics too: nor through mirrors after one diffuse or glossy bounce
};

namespace detail {

/// Where a walk stands.
template <Scene World>
struct walk_state {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;

    ray<T> path{};
    S throughput{white<S>()};
    vec3<T> came_from{};  ///< the last point that looked for lights
    T travelled{0};       ///< since the start or the last diffuse or glossy surface
    T scatter_pdf{0};     ///< density of `path` there; 0 where specular or the eye
    T boost{1};           ///< by how much a guide lowered the throughput: that is no reason to end the path
    lobe_set last{lobe_set::none};
    bool mirrored{true};    ///< only specular bounces so far
    bool scattered{false};  ///< more than one diffuse or glossy bounce
};

/// Whether light met over a mirror now belongs to a map of reflected caustics.
template <Scene World>
[[nodiscard]] bool reflects_caustic(const walk_state<World>& at, emission_rule rule) {
    return rule == emission_rule::no_reflected && !at.mirrored && !at.scattered;
}

/// The share of emission met by a scattered ray that is not the light sampling's (1 for the eye and for mirrors).
template <Scene World, typename Lights>
[[nodiscard]] scalar_of<World> emission_share(const walk_state<World>& at, const Lights& lights,
                                              const hit_of<World>& hit, emission_rule rule, std::uint32_t bounce) {
    using T = scalar_of<World>;
    if (at.mirrored && rule != emission_rule::all) {
        return bounce == 1 || rule != emission_rule::indirect ? T(0) : T(1);
    }
    if (!any(at.last, lobe_set::smooth)) { return reflects_caustic(at, rule) ? T(0) : T(1); }
    if constexpr (TellsPdf<Lights, hit_of<World>>) {
        return balance(at.scatter_pdf, T(lights.pdf(at.came_from, at.path.direction, hit)));
    } else {
        return T(0);
    }
}

/// The same for what comes from beyond the scene.
template <Scene World, typename Lights>
[[nodiscard]] scalar_of<World> escape_share(const walk_state<World>& at, const Lights& lights, emission_rule rule,
                                            std::uint32_t bounce) {
    using T = scalar_of<World>;
    if constexpr (TellsEscapedPdf<Lights, T>) {
        if (at.mirrored && rule != emission_rule::all) {
            return bounce == 1 || rule != emission_rule::indirect ? T(0) : T(1);
        }
        if (!any(at.last, lobe_set::smooth)) { return reflects_caustic(at, rule) ? T(0) : T(1); }
        return balance(at.scatter_pdf, T(lights.escaped_pdf(at.came_from, at.path.direction)));
    } else {
        // Nobody looks at the sky, so every ray that meets it counts.
        return T(1);
    }
}

}  // namespace detail

}  // namespace aglow
