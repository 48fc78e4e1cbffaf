// The smallest complete surface: matte on both sides of its geometry, reflecting a fraction of what arrives.
#pragma once

#include <cmath>
#include <concepts>
#include <optional>

#include <aglow/concepts/surface.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/warp.hpp>

namespace aglow {

/// A two-sided Lambertian `Surface` for hosts and tests that need nothing more: f = albedo / pi.
template <Spectrum S, std::floating_point T = float>
struct lambert {
    vec3<T> position{};
    vec3<T> normal{0, 0, 1};  ///< unit, geometric
    S albedo{};               ///< the fraction reflected, in [0, 1]

    [[nodiscard]] lobe_set lobes() const { return is_black(albedo) ? lobe_set::none : lobe_set::diffuse_reflection; }

    [[nodiscard]] S evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        if (!any(asked, lobe_set::diffuse_reflection) || !same_side(wo, wi)) { return S{}; }
        return albedo * (1 / pi<band_of<S>>);
    }

    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        if (!any(asked, lobe_set::diffuse_reflection) || !same_side(wo, wi)) { return T(0); }
        return cosine_hemisphere_pdf(std::abs(glm::dot(normal, wi)));
    }

    template <Sampler R>
    [[nodiscard, gnu::always_inline]] std::optional<scatter_sample<S, T>> sample(const vec3<T>& wo, R& random,
                                                                                 lobe_set asked) const {
        if (!any(asked, lobes())) { return std::nullopt; }
        const auto u = random.next_2d();
        const vec3<T> local = cosine_hemisphere(vec2<T>{T(u.x), T(u.y)});
        const frame<T> around{glm::dot(normal, wo) < 0 ? -normal : normal};
        return scatter_sample<S, T>{around.to_world(local), albedo, cosine_hemisphere_pdf(local.z),
                                    lobe_set::diffuse_reflection};
    }

private:
    [[nodiscard]] bool same_side(const vec3<T>& a, const vec3<T>& b) const {
        return glm::dot(normal, a) * glm::dot(normal, b) > 0;
    }
};

}  // namespace aglow
