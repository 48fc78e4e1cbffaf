// A closed sphere with one albedo and one glow all over: the scene whose light is known everywhere.
#pragma once

#include <cmath>
#include <optional>

#include <aglow/concepts/lambert.hpp>
#include <aglow/concepts/light.hpp>

namespace aglow::testing {

/// The wall of a furnace: Lambertian, and glowing on its inside.
template <Spectrum S, std::floating_point T>
struct furnace_wall : lambert<S, T> {
    S glow{};
    T position_error{};
    [[nodiscard]] S emitted(const vec3<T>& wo) const { return glm::dot(this->normal, wo) < 0 ? glow : S{}; }
};

/// The inside of a sphere of `radius` around the origin. Radiance everywhere inside: glow / (1 - albedo).
template <Spectrum S, std::floating_point T = float>
struct furnace_sphere {
    using scalar = T;
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;

    T radius{1};
    S albedo{};
    S glow{};

    [[nodiscard]] std::optional<furnace_wall<S, T>> intersect(const ray<T>& r) const {
        const T b = glm::dot(r.origin, r.direction);
        const T c = length2(r.origin) - radius * radius;
        const T root2 = b * b - c;
        if (!(root2 > 0)) { return std::nullopt; }
        // From inside, only the far root lies ahead.
        const T t = -b + std::sqrt(root2);
        if (!(t > 0) || t > r.reach) { return std::nullopt; }
        const vec3<T> outwards = glm::normalize(r.origin + r.direction * t);
        furnace_wall<S, T> wall;
        wall.position = outwards * radius;
        wall.normal = outwards;
        wall.albedo = albedo;
        wall.glow = glow;
        wall.position_error = position_error(radius);
        return wall;
    }
    [[nodiscard]] bool occluded(const vec3<T>&, const vec3<T>&) const { return false; }
};

/// The furnace's wall as a light: emits particles; looked at from a point, uniformly over the wall.
template <Spectrum S, std::floating_point T = float>
struct furnace_light {
    using scalar = T;
    T radius{1};
    S glow{};

    template <Sampler R>
    [[nodiscard]] emission<S, T> emit(R& random) const {
        const vec3<T> outwards = uniform_sphere(vec2<T>(random.next_2d()));
        const vec3<T> direction = frame<T>{-outwards}.to_world(cosine_hemisphere(vec2<T>(random.next_2d())));
        const T area = 4 * pi<T> * radius * radius;
        return {{outwards * (radius * (1 - 64 * std::numeric_limits<T>::epsilon())), direction},
                glow * band_of<S>(pi<T> * area)};
    }

    template <Sampler R>
    [[nodiscard]] std::optional<illumination<S, T>> illuminate(const vec3<T>& point, R& random) const {
        const vec3<T> outwards = uniform_sphere(vec2<T>(random.next_2d()));
        const vec3<T> across = outwards * radius - point;
        const T distance = glm::length(across);
        if (!(distance > 0)) { return std::nullopt; }
        const vec3<T> towards = across / distance;
        const T density = pdf(point, towards, furnace_wall<S, T>{{outwards * radius, outwards, {}}, {}, {}});
        if (!(density > 0)) { return std::nullopt; }
        return illumination<S, T>{towards, distance, glow * band_of<S>(1 / density), density};
    }

    template <Hit H>
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& towards, const H& hit) const {
        const T cosine = std::abs(glm::dot(vec3<T>(hit.normal), towards));
        return distance2(point, vec3<T>(hit.position)) / (cosine * 4 * pi<T> * radius * radius);
    }
};

}  // namespace aglow::testing
