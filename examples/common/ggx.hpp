// The GGX distribution of microfacets, in the frame whose z is the normal.
#pragma once

#include <algorithm>
#include <cmath>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace host {

using aglow::vec2;
using aglow::vec3;

/// Microfacets of width `alpha`, the same in all directions (Walter et al. 2007).
template <typename T>
struct ggx {
    T alpha;

    /// Density of facet normals per steradian of facets over area of surface.
    [[nodiscard]] T density(const vec3<T>& h) const {
        const T a2 = alpha * alpha;
        const T s = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        return 1 / (aglow::pi<T> * a2 * s * s);
    }

    /// Smith's Lambda: hidden over visible facet area.
    [[nodiscard]] T hidden(const vec3<T>& w) const {
        const T tangent2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
    }

    /// Share of the facets that face `w` and are seen from it.
    [[nodiscard]] T seen(const vec3<T>& w) const { return 1 / (1 + hidden(w)); }

    /// Share of the facets that are seen from both, heights correlated (Heitz 2014, (99)).
    [[nodiscard]] T seen(const vec3<T>& a, const vec3<T>& b) const { return 1 / (1 + hidden(a) + hidden(b)); }

    /// A facet normal, by how much of it is seen from `wo` (Dupuy & Benyoub 2023, listing 3).
    [[nodiscard]] vec3<T> facet(const vec3<T>& wo, const vec2<T>& u) const {
        const vec3<T> round = glm::normalize(vec3<T>{alpha * wo.x, alpha * wo.y, wo.z});
        const T angle = 2 * aglow::pi<T> * u.x;
        const T z = (1 - u.y) * (1 + round.z) - round.z;
        const T sine = std::sqrt(std::clamp(1 - z * z, T(0), T(1)));
        const vec3<T> h = vec3<T>{sine * std::cos(angle), sine * std::sin(angle), z} + round;
        return glm::normalize(vec3<T>{alpha * h.x, alpha * h.y, std::max(T(0), h.z)});
    }

    /// Density of `wo` mirrored at `facet(wo)`, per steradian, where its facet normal is `h`.
    [[nodiscard]] T reflection_pdf(const vec3<T>& wo, const vec3<T>& h) const {
        return seen(wo) * density(h) / (4 * wo.z);
    }
};

}  // namespace host
