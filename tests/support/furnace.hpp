// A closed sphere and a closed box with one albedo and one glow all over: scenes whose light is known everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
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

/// The inside of the cube [-size, size]³. Radiance everywhere inside: glow / (1 - albedo). It has what the sphere has
/// not: edges and corners, where discs of photons reach over and rays are short.
template <Spectrum S, std::floating_point T = float>
struct furnace_box {
    using scalar = T;
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;

    T size{1};
    S albedo{};
    S glow{};

    [[nodiscard]] std::optional<furnace_wall<S, T>> intersect(const ray<T>& r) const {
        T nearest = r.reach;
        int axis = -1;
        for (int a = 0; a < 3; ++a) {
            if (r.direction[a] == 0) { continue; }
            const T t = (std::copysign(size, r.direction[a]) - r.origin[a]) / r.direction[a];
            if (t < nearest) {
                nearest = t;
                axis = a;
            }
        }
        if (axis < 0 || !(nearest > 0)) { return std::nullopt; }
        furnace_wall<S, T> wall;
        wall.normal = vec3<T>{0};
        wall.normal[axis] = std::copysign(T(1), r.direction[axis]);
        wall.position = glm::clamp(r.origin + r.direction * nearest, vec3<T>{-size}, vec3<T>{size});
        wall.position[axis] = std::copysign(size, r.direction[axis]);
        wall.albedo = albedo;
        wall.glow = glow;
        wall.position_error = position_error(size);
        return wall;
    }
    [[nodiscard]] bool occluded(const vec3<T>&, const vec3<T>&) const { return false; }
};

/// The box's walls as a light: emits particles; looked at evenly in all directions.
template <Spectrum S, std::floating_point T = float>
struct furnace_box_light {
    using scalar = T;
    T size{1};
    S glow{};

    template <Sampler R>
    [[nodiscard]] emission<S, T> emit(R& random) const {
        const vec2<T> u = vec2<T>(random.next_2d());
        const T face = 6 * u.x;
        const int wall = std::min(5, static_cast<int>(face));
        const int axis = wall / 2;
        vec3<T> outwards{0};
        outwards[axis] = wall % 2 == 0 ? T(-1) : T(1);
        vec3<T> position = outwards * size;
        position[(axis + 1) % 3] = size * (2 * (face - static_cast<T>(wall)) - 1);
        position[(axis + 2) % 3] = size * (2 * u.y - 1);
        const vec3<T> direction = frame<T>{-outwards}.to_world(cosine_hemisphere(vec2<T>(random.next_2d())));
        return {{position * (1 - 64 * std::numeric_limits<T>::epsilon()), direction},
                glow * band_of<S>(pi<T> * 24 * size * size)};
    }

    template <Sampler R>
    [[nodiscard]] std::optional<illumination<S, T>> illuminate(const vec3<T>& point, R& random) const {
        const vec3<T> towards = uniform_sphere(vec2<T>(random.next_2d()));
        const auto wall = furnace_box<S, T>{.size = size}.intersect(ray<T>{point, towards});
        if (!wall) { return std::nullopt; }
        return illumination<S, T>{towards, glm::distance(point, wall->position), glow * band_of<S>(4 * pi<T>),
                                  1 / (4 * pi<T>)};
    }

    template <Hit H>
    [[nodiscard]] T pdf(const vec3<T>&, const vec3<T>&, const H&) const {
        return 1 / (4 * pi<T>);
    }
};

}  // namespace aglow::testing
