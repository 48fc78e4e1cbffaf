// A floor, a lamp above it, and the question how bright the floor is below the lamp.
#include <cstdio>
#include <optional>

#include <aglow/aglow.hpp>

// Your ray tracer: anything that can answer these two questions. Here, a matte floor of 10 x 10 metres.
struct floor_scene {
    using hit = aglow::lambert<float>;

    std::optional<hit> intersect(const aglow::ray<float>& ray) const {
        const float t = -ray.origin.z / ray.direction.z;
        const glm::vec3 p = ray.origin + ray.direction * t;
        if (!(t > 0 && t < ray.reach) || aglow::max_abs(p) > 5) { return std::nullopt; }
        return hit{.position = {p.x, p.y, 0}, .normal = {0, 0, 1}, .albedo = 0.5f};
    }
    bool occluded(glm::vec3 a, glm::vec3 b) const { return a.z * b.z < 0; }
};

// Your light: it sends out particles. Here, a bulb of 100 watts, two metres up.
struct bulb {
    float power = 100;
    glm::vec3 position{0, 0, 2};

    aglow::emission<float, float> emit(aglow::Sampler auto& random) const {
        return {.path = {position, aglow::uniform_sphere(random.next_2d())}, .power = power};
    }
};

int main() {
    const bulb light;
    const auto photons = aglow::trace_photons(floor_scene{}, light, {.direct = 100'000});
    const auto estimate = photons.direct.irradiance({0, 0, 0}, {0, 0, 1}, {.count = 500});

    const float exact = light.power / (4 * aglow::pi<float> * 2 * 2);  // the inverse square law
    std::printf("irradiance below the lamp: %.3f W/m2 +- %.3f, exact %.3f\n", estimate.value, estimate.error, exact);
    std::printf("%zu photons stored, %u of them read within %.2f m\n", photons.direct.size(), estimate.count,
                estimate.radius);
}
