// How much light a smooth boundary between two media reflects.
#pragma once

#include <cmath>
#include <optional>

#include <aglow/core/vec.hpp>

namespace host {

using aglow::vec2;
using aglow::vec3;

/// Unpolarised reflectance of a smooth boundary at `cosine` >= 0 from the normal; `eta` is the index beyond over the
/// index on this side. Exactly 1 at total reflection, exactly 0 where the indices are equal.
template <typename T>
[[nodiscard]] T fresnel(T cosine, T eta) {
    if (eta == 1) { return 0; }
    const T sine2 = (1 - cosine * cosine) / (eta * eta);
    if (sine2 >= 1) { return 1; }
    const T beyond = std::sqrt(1 - sine2);
    const T across = (cosine - eta * beyond) / (cosine + eta * beyond);
    const T along = (eta * cosine - beyond) / (eta * cosine + beyond);
    return (across * across + along * along) / 2;
}

/// Reflectance that rises from `straight` at normal incidence to `grazing` (Schlick 1994).
template <typename T>
[[nodiscard]] vec3<T> schlick(const vec3<T>& straight, const vec3<T>& grazing, T cosine) {
    const T m = 1 - cosine;
    const T m2 = m * m;
    return straight + (grazing - straight) * (m2 * m2 * m);
}

/// `wo` mirrored at `normal`.
template <typename T>
[[nodiscard]] vec3<T> reflected(const vec3<T>& wo, const vec3<T>& normal) {
    return normal * (2 * glm::dot(wo, normal)) - wo;
}

/// `wo` bent at `normal`, which lies on its side; empty at total reflection, and straight on where the indices are
/// equal.
template <typename T>
[[nodiscard]] std::optional<vec3<T>> refracted(const vec3<T>& wo, const vec3<T>& normal, T eta) {
    if (eta == 1) { return -wo; }
    const T cosine = glm::dot(wo, normal);
    const T sine2 = (1 - cosine * cosine) / (eta * eta);
    if (sine2 >= 1) { return std::nullopt; }
    const T beyond = std::sqrt(std::max(T(0), 1 - sine2));
    return glm::normalize(normal * (cosine / eta - beyond) - wo / eta);
}

}  // namespace host
