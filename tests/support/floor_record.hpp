// Irradiance records at random on a floor that is not quite flat.
#pragma once

#include <cmath>
#include <type_traits>

#include <aglow/core/frame.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/irradiance_record.hpp>

namespace support {

/// A record, and how much its light bends.
template <typename S, aglow::record_features F>
struct floor_record {
    aglow::irradiance_record<S, float, F> record;
    float bend;
};

/// Near the origin, with a normal along z within a few degrees: `up` is 1 or -1.
template <typename S, aglow::record_features F>
floor_record<S, F> random_floor_record(aglow::random_sampler<float>& random, float up = 1) {
    using rgb = aglow::vec3<float>;
    const auto signed_unit = [&] { return random.next_1d() * 2 - 1; };
    const auto light = [&] {
        if constexpr (std::is_same_v<S, float>) {
            return random.next_1d();
        } else {
            return rgb{random.next_1d(), random.next_1d(), random.next_1d() * 10};
        }
    };
    aglow::irradiance_estimate<S, float> e;
    e.position = {signed_unit(), signed_unit(), 0.02f * signed_unit()};
    e.axes = aglow::frame<float>{glm::normalize(rgb{0.1f * signed_unit(), 0.1f * signed_unit(), up})};
    e.irradiance = light();
    e.gradients.translation = {light() * 3.f, light() * -3.f};
    e.gradients.rotation = {light() * -1.f, light()};
    e.relative_noise = random.next_1d();
    e.rays = 100;
    const float angle = 7 * random.next_1d();
    const aglow::record_reach<float> reach{
        .radius = 0.3f + random.next_1d(), .ratio = 1 + random.next_1d(), .axis = {std::cos(angle), std::sin(angle)}};
    return {{e, reach}, random.next_1d()};
}

/// A unit normal of a place on the floor.
inline aglow::vec3<float> random_floor_normal(aglow::random_sampler<float>& random) {
    return glm::normalize(aglow::vec3<float>{0.1f * random.next_1d(), -0.05f * random.next_1d(), 1});
}

}  // namespace support
