// What a ray meets where triangles stand in for something smooth: a face, and the normal that it is shaded by.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "bsdf.hpp"

namespace host {

/// The library's `Surface` with a shading normal. The material scatters around `shading`; light goes where the face
/// lets it: nothing is reflected through the face, and photons carry the factor of Veach 1997, 5.3.
template <typename T>
struct shaded_hit {
    vec3<T> position{};
    vec3<T> normal{};   ///< unit, of the face
    vec3<T> shading{};  ///< unit, on the side of `normal`
    T position_error{};
    T distance{};
    bsdf<T> scatterer;
    std::uint32_t primitive{};

    [[nodiscard]] lobe_set lobes() const { return scatterer.lobes(); }

    [[nodiscard]] vec3<T> evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        if (!agree(wo) || !agree(wi)) { return vec3<T>{0}; }
        const T face = std::abs(glm::dot(normal, wi));
        return scatterer.evaluate(shading, wo, wi, asked) * (std::abs(glm::dot(shading, wi)) / face);
    }
    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        return agree(wo) && agree(wi) ? scatterer.pdf(shading, wo, wi, asked) : T(0);
    }
    template <typename R>
    [[nodiscard]] auto sample(const vec3<T>& wo, R& random, lobe_set asked) const {
        auto made = scatterer.sample(shading, wo, random, asked);
        // The cosine of the weight is the shading normal's, which is what `evaluate` times the face's comes to.
        if (made && !(agree(wo) && agree(made->wi))) { made.reset(); }
        return made;
    }
    [[nodiscard]] vec3<T> emitted(const vec3<T>& wo) const { return scatterer.emitted(normal, wo); }

    [[nodiscard]] T adjoint(const vec3<T>& wo, const vec3<T>& wi) const {
        const auto ratio = [this](const vec3<T>& w) { return std::abs(glm::dot(w, shading) / glm::dot(w, normal)); };
        return ratio(wo) / ratio(wi);
    }

private:
    /// Whether `w` is on the same side of the face and of what it stands for.
    [[nodiscard]] bool agree(const vec3<T>& w) const { return glm::dot(w, normal) * glm::dot(w, shading) > 0; }
};

/// A shading normal from what a file says, for a face with `normal` that is seen from `wo`: turned to the side of the
/// face, and bent so far that it can be seen where the face can; the face's own where the file says nothing of use.
template <typename T>
[[nodiscard]] vec3<T> shading_normal(const vec3<T>& told, const vec3<T>& normal, const vec3<T>& wo) {
    const T length = glm::length(told);
    if (!(length > 0) || !aglow::is_finite(length)) { return normal; }
    vec3<T> n = told / length;
    if (glm::dot(n, normal) < 0) { n = -n; }
    const T side = glm::dot(wo, normal) < 0 ? T(-1) : T(1);
    const T seen = glm::dot(n, wo) * side;
    constexpr T least = T(0.02);
    if (seen < least) { n = glm::normalize(n + wo * (side * (least - seen))); }
    return glm::dot(n, normal) > T(0.1) ? n : normal;
}

}  // namespace host
