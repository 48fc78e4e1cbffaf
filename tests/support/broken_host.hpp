// A host that misbehaves in one chosen way now and then, around a room that is lit evenly.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "support/scenes.hpp"

namespace support {

enum class flaw {
    none,
    nan_position,
    behind,
    long_normal,
    nan_normal,
    nan_weight,
    negative_weight,
    infinite_weight,
    nan_direction,
    long_direction,
    nan_evaluate,
    nan_emitted
};
inline constexpr auto all_flaws = {flaw::nan_position,    flaw::behind,        flaw::long_normal,
                                   flaw::nan_normal,      flaw::nan_weight,    flaw::negative_weight,
                                   flaw::infinite_weight, flaw::nan_direction, flaw::long_direction,
                                   flaw::nan_evaluate,    flaw::nan_emitted};

inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// A hit of which a share is flawed: by its place, so that every run is the same.
struct flawed_hit : toy_hit<glm::vec3, float> {
    flaw wrong{flaw::none};

    [[nodiscard]] glm::vec3 evaluate(const glm::vec3& wo, const glm::vec3& wi, lobe_set asked) const {
        return wrong == flaw::nan_evaluate ? glm::vec3{not_a_number} : toy_hit::evaluate(wo, wi, asked);
    }
    [[nodiscard]] glm::vec3 emitted(const glm::vec3& wo) const {
        return wrong == flaw::nan_emitted ? glm::vec3{1, not_a_number, 0} : toy_hit::emitted(wo);
    }
    template <aglow::Sampler R>
    [[nodiscard]] auto sample(const glm::vec3& wo, R& random, lobe_set asked) const {
        auto s = toy_hit::sample(wo, random, asked);
        if (!s) { return s; }
        if (wrong == flaw::nan_weight) { s->weight = glm::vec3{1, 1, not_a_number}; }
        if (wrong == flaw::negative_weight) { s->weight = {1, -1, 1}; }
        if (wrong == flaw::infinite_weight) { s->weight = glm::vec3{std::numeric_limits<float>::infinity()}; }
        if (wrong == flaw::nan_direction) { s->wi = glm::vec3{not_a_number}; }
        if (wrong == flaw::long_direction) { s->wi *= 3.0f; }
        return s;
    }
};

struct flawed_scene {
    toy_scene<glm::vec3, float> inner{};
    flaw wrong{flaw::none};

    [[nodiscard]] std::optional<flawed_hit> intersect(const ray<float>& r) const {
        const auto found = inner.intersect(r);
        if (!found) { return std::nullopt; }
        flawed_hit hit{*found};
        if (hit.position.x > 0.5f) {
            hit.wrong = wrong;
            if (wrong == flaw::nan_position) { hit.position.y = not_a_number; }
            if (wrong == flaw::behind) { hit.position = r.origin - r.direction; }
            if (wrong == flaw::long_normal) { hit.normal *= 2.0f; }
            if (wrong == flaw::nan_normal) { hit.normal.x = not_a_number; }
        }
        return hit;
    }
    [[nodiscard]] bool occluded(const glm::vec3& a, const glm::vec3& b) const { return inner.occluded(a, b); }
};

/// A bulb whose particles are flawed every second time.
struct flawed_bulb : bulb<glm::vec3, float> {
    float bad_power{1};
    bool bad_direction{false};

    template <aglow::Sampler R>
    [[nodiscard]] aglow::emission<glm::vec3, float> emit(R& random) const {
        auto e = bulb::emit(random);
        if (e.path.direction.x > 0) {
            e.power.y *= bad_power;
            if (bad_direction) { e.path.direction.z = not_a_number; }
        }
        return e;
    }
};

}  // namespace support
