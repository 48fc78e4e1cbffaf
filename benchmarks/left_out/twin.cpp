// The same paths by hand: a path tracer that knows of matte surfaces and bulbs, and of nothing else.
#include <algorithm>

#include <aglow/core/frame.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/warp.hpp>

#include "room.hpp"

namespace {

using point = aglow::vec3<float>;

bool is_unit(const point& v) {
    const float norm2 = aglow::length2(v);
    return aglow::is_finite(norm2) && norm2 > 0.99f && norm2 < 1.01f;
}

float direct(const matte_room& scene, const centre_bulb& light, const matte_room::hit& hit, const point& wo,
             float error, aglow::random_sampler<float> random) {
    const auto seen = light.illuminate(hit.position, random);
    if (!seen) { return 0; }
    const float cosine = std::abs(glm::dot(hit.normal, seen->towards));
    const bool lit = glm::dot(hit.normal, wo) * glm::dot(hit.normal, seen->towards) > 0;
    const float radiance = lit ? seen->radiance_over_pdf * hit.albedo / aglow::pi<float> * cosine : 0.0f;
    if (!aglow::is_radiance(radiance) || radiance == 0) { return 0; }
    const point from = aglow::lift(hit.position, hit.normal, seen->towards, error);
    if (!aglow::is_finite(seen->distance)) { return scene.intersect({from, seen->towards}) ? 0.0f : radiance; }
    const float step = std::min(seen->distance / 2, 4 * std::max(error, aglow::position_error(seen->distance)));
    return scene.occluded(from, hit.position + seen->towards * (seen->distance - step)) ? 0.0f : radiance;
}

float trace(const matte_room& scene, const centre_bulb& light, const aglow::random_numbers<float>& numbers) {
    aglow::ray<float> path;
    float throughput = 1;
    float sum = 0;
    for (std::uint32_t bounce = 1;; ++bounce) {
        const auto hit = scene.intersect(path);
        if (!hit) { return sum; }
        const float along = glm::dot(hit->position - path.origin, path.direction);
        const float error = aglow::error_of(*hit, path.origin);
        if (!aglow::is_finite(along) || along < -error || !is_unit(hit->normal)) { return sum; }
        const point wo = -path.direction;
        if (hit->albedo <= 0) { return sum; }
        const float arriving =
            throughput * direct(scene, light, *hit, wo, error, numbers.at(bounce, aglow::purpose::light));
        if (aglow::is_radiance(arriving)) { sum += arriving; }
        auto random = numbers.at(bounce, aglow::purpose::scatter);
        const point local = aglow::cosine_hemisphere(random.next_2d());
        const aglow::frame<float> around{glm::dot(hit->normal, wo) < 0 ? -hit->normal : hit->normal};
        const point wi = around.to_world(local);
        throughput *= hit->albedo;
        if (!aglow::is_radiance(throughput) || throughput == 0 || !is_unit(wi)) { return sum; }
        if (bounce >= 5) {
            const float q = std::min(bounce < 4096 ? 1.0f : 1 - 0x1p-20f, throughput);
            if (!(numbers.at(bounce, aglow::purpose::roulette).next_1d() < q)) { return sum; }
            throughput *= 1 / q;
        }
        path = {aglow::lift(hit->position, hit->normal, wi, error), wi};
    }
}

}  // namespace

float by_twin(std::uint64_t count) {
    const matte_room scene;
    const centre_bulb light;
    float sum = 0;
    for (std::uint64_t i = 0; i < count; ++i) { sum += trace(scene, light, aglow::random_numbers<float>{{.path = i}}); }
    return sum;
}
