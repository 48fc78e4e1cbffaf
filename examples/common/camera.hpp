// A pinhole camera.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>

#include <aglow/core/numbers.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/vec.hpp>

namespace host {

using aglow::vec2;
using aglow::vec3;

/// Looks from `origin` along `forward`. `tangent` is that of half the field of view from top to bottom; pixels are
/// square.
template <typename T>
struct camera {
    vec3<T> origin{0};
    vec3<T> forward{0, 0, 1};
    vec3<T> up{0, 1, 0};
    T tangent{T(0.5)};

    /// Through film point `film` in [0, width) x [0, height), whose row 0 is on top.
    [[nodiscard]] aglow::ray<T> through(const vec2<T>& film, std::size_t width, std::size_t height) const {
        const vec3<T> right = glm::normalize(glm::cross(forward, up));
        const vec3<T> above = glm::cross(right, forward);
        const T half = T(height) / 2;
        const T x = (film.x - T(width) / 2) / half * tangent;
        const T y = (half - film.y) / half * tangent;
        return {.origin = origin, .direction = glm::normalize(forward + right * x + above * y)};
    }

    /// Where `place` appears on the film; empty where it does not.
    [[nodiscard]] std::optional<vec2<T>> film_point(const vec3<T>& place, std::size_t width, std::size_t height) const {
        const vec3<T> right = glm::normalize(glm::cross(forward, up));
        const vec3<T> above = glm::cross(right, forward);
        const vec3<T> to = place - origin;
        const T depth = glm::dot(to, forward);
        if (!(depth > 0)) { return std::nullopt; }
        const T scale = T(height) / (2 * tangent * depth);
        const vec2<T> film{T(width) / 2 + glm::dot(to, right) * scale, T(height) / 2 - glm::dot(to, above) * scale};
        if (!(film.x >= 0 && film.y >= 0 && film.x < T(width) && film.y < T(height))) { return std::nullopt; }
        return film;
    }
};

/// A camera at `from` that looks at `at`, y upwards, `degrees` from top to bottom.
template <typename T>
[[nodiscard]] camera<T> look_at(const vec3<T>& from, const vec3<T>& at, T degrees) {
    return {.origin = from,
            .forward = glm::normalize(at - from),
            .tangent = static_cast<T>(std::tan(static_cast<double>(degrees) * aglow::pi<double> / 360))};
}

}  // namespace host
