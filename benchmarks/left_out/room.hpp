// The matte room that the library and its twin look at: a sphere with a bulb in it.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include <aglow/concepts/lambert.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/core/ray.hpp>

struct matte_room {
    using hit = aglow::lambert<float>;
    static constexpr aglow::lobe_set possible_lobes = aglow::lobe_set::diffuse_reflection;

    [[nodiscard]] std::optional<hit> intersect(const aglow::ray<float>& r) const {
        const float b = glm::dot(r.origin, r.direction);
        const float root2 = b * b + 1 - aglow::length2(r.origin);
        if (!(root2 > 0)) { return std::nullopt; }
        const float t = std::sqrt(root2) - b;
        if (!(t > 0 && t < r.reach)) { return std::nullopt; }
        const aglow::vec3<float> out = glm::normalize(r.origin + r.direction * t);
        return hit{out, -out, 0.7f};
    }
    [[nodiscard]] bool occluded(const aglow::vec3<float>& a, const aglow::vec3<float>& b) const {
        return aglow::length2(a) > 1 || aglow::length2(b) > 1;
    }
};

struct centre_bulb {
    template <aglow::Sampler R>
    [[nodiscard]] std::optional<aglow::illumination<float, float>> illuminate(const aglow::vec3<float>& x, R&) const {
        const aglow::vec3<float> across = aglow::vec3<float>{0.25f, 0, 0} - x;
        const float d = glm::length(across);
        return aglow::illumination<float, float>{across / d, d, 1 / (d * d), 0};
    }
};

/// Sum of the radiance of `count` paths into the room.
float by_library(std::uint64_t count);
float by_twin(std::uint64_t count);
