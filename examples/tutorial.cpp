// A ray tracer of its own plugged into aglow, concept by concept: README.md beside this file walks through it.
//
// A bulb hangs in the middle of a round room. Light that the wall sends back arrives at the wall again, so all of the
// wall shines alike and the answer is known: L = albedo / pi * E / (1 - albedo), E from the bulb alone.
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>
#include <vector>

#include <aglow/aglow.hpp>

namespace {

using vec3 = aglow::vec3<float>;
using aglow::lobe_set;

// What a ray meets: a place, and how light scatters there. A painter's wall here, matte on both sides.
struct plaster {
    vec3 position;
    vec3 normal;
    float albedo;

    lobe_set lobes() const { return lobe_set::diffuse_reflection; }

    float evaluate(vec3 wo, vec3 wi, lobe_set asked) const {
        const bool reflects = glm::dot(normal, wo) * glm::dot(normal, wi) > 0;
        return reflects && any(asked, lobe_set::diffuse_reflection) ? albedo / aglow::pi<float> : 0;
    }
    float pdf(vec3 wo, vec3 wi, lobe_set asked) const {
        return evaluate(wo, wi, asked) > 0 ? std::abs(glm::dot(normal, wi)) / aglow::pi<float> : 0;
    }
    std::optional<aglow::scatter_sample<float, float>> sample(vec3 wo, aglow::Sampler auto& random,
                                                              lobe_set asked) const {
        if (!any(asked, lobe_set::diffuse_reflection)) { return std::nullopt; }
        const aglow::frame<float> axes{glm::dot(normal, wo) > 0 ? normal : -normal};
        const vec3 wi = axes.to_world(aglow::cosine_hemisphere(random.next_2d()));
        return aglow::scatter_sample<float, float>{
            .wi = wi, .weight = albedo, .pdf = pdf(wo, wi, asked), .lobe = lobe_set::diffuse_reflection};
    }
};

// The ray tracer: two questions, asked from several threads at once.
struct round_room {
    float radius = 2;
    float albedo = 0.5f;

    std::optional<plaster> intersect(const aglow::ray<float>& r) const {
        const float b = glm::dot(r.origin, r.direction);
        const float c = glm::dot(r.origin, r.origin) - radius * radius;
        if (b * b < c) { return std::nullopt; }
        const float t = std::sqrt(b * b - c) - b;
        if (!(t > 0 && t < r.reach)) { return std::nullopt; }
        const vec3 outwards = glm::normalize(r.origin + r.direction * t);
        return plaster{.position = outwards * radius, .normal = -outwards, .albedo = albedo};
    }
    bool occluded(vec3, vec3) const { return false; }  // a ball hides nothing from those within it

    // What a scene cannot have is left out: maps, rays and code.
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;

    aglow::bounds<float> bounds() const { return {vec3{-radius}, vec3{radius}}; }
};

// A light, from its two sides: it sends particles out, and it can be looked at.
struct bulb {
    float watts = 100;
    vec3 position{0};

    aglow::emission<float, float> emit(aglow::Sampler auto& random) const {
        return {.path = {position, aglow::uniform_sphere(random.next_2d())}, .power = watts};
    }
    std::optional<aglow::illumination<float, float>> illuminate(vec3 point, aglow::Sampler auto&) const {
        const vec3 way = position - point;
        const float distance = glm::length(way);
        const float intensity = watts / (4 * aglow::pi<float>);
        return aglow::illumination<float, float>{.towards = way / distance,
                                                 .distance = distance,
                                                 .radiance_over_pdf = intensity / (distance * distance),
                                                 .pdf = 0};  // no scattered ray can meet a point
    }
};

bool all_right = true;

void tell(const char* what, float value, float exact) {
    all_right = all_right && std::abs(value - exact) < 0.05f * exact;
    std::printf("%-28s %.4f   exact %.4f\n", what, value, exact);
}

}  // namespace

int main() {
    const round_room room;
    const bulb light;
    const float direct = light.watts / (4 * aglow::pi<float> * room.radius * room.radius);
    const float wall = room.albedo / aglow::pi<float> * direct / (1 - room.albedo);

    // What this scene does without.
    for (const auto& o : aglow::plan_for(room).left_out) {
        std::printf("%s: left out, %s\n", o.part.c_str(), o.why.c_str());
    }

    // Threads are the host's: anything that calls task(0), ..., task(count - 1) and waits. Here, two of its own.
    const auto crew = [](std::size_t count, auto&& task) {
        const auto every_second = [&](std::size_t first) {
            for (std::size_t i = first; i < count; i += 2) { task(i); }
        };
        const std::jthread helper{[&] { every_second(1); }};
        every_second(0);
    };

    // Photon maps: each remembers a kind of light.
    const auto maps = aglow::trace_photons(room, light, {.direct = 50'000, .indirect = 50'000}, crew);
    const vec3 spot{0, 0, -room.radius};
    const vec3 inwards{0, 0, 1};
    tell("irradiance, direct map", maps.direct.irradiance(spot, inwards, {.count = 500}).value, direct);
    tell("irradiance, indirect map", maps.indirect.irradiance(spot, inwards, {.count = 500}).value,
         direct * room.albedo / (1 - room.albedo));

    // An irradiance cache by hand: places, a way to answer rays, and questions.
    const aglow::path_tracer paths{room, light};
    const auto incoming = [&](const aglow::ray<float>& r, const auto& numbers) { return paths.incoming(r, numbers); };
    std::vector<aglow::cache_candidate<float>> places;
    for (std::uint64_t i = 0; i < 500; ++i) {
        const vec3 outwards = aglow::uniform_sphere(aglow::sobol_2d<float>(static_cast<std::uint32_t>(i), 0));
        places.push_back({.place = {outwards * room.radius, -outwards, aglow::position_error(room.radius)}, .key = i});
    }
    aglow::irradiance_cache<float> cache{room.bounds()};
    const auto filled = aglow::fill_cache(cache, places, incoming, {}, crew);
    std::printf("%zu records cover %zu places\n", filled.records, places.size());
    const auto answer = cache.freeze(crew).lookup(places[7].place.position, places[7].place.normal);
    tell("irradiance, cached", answer.irradiance, direct * room.albedo / (1 - room.albedo));

    // A camera: the ray through a point of the film, in pixels.
    const auto eye = [](const aglow::vec2<float>& film) {
        return aglow::ray<float>{{0, 0, 0.5f}, glm::normalize(vec3{film.x - 16, 16 - film.y, -24})};
    };

    // The classical combination in one line: photon map, seen through a final gather, remembered in an irradiance
    // cache.
    const aglow::gather_caching classical{room, light, room.bounds(), eye, {.caching = {.view = {32, 32}}}, crew};

    aglow::film<float> film{32, 32};
    film.expose(eye, classical, {.samples = 4}, crew);
    tell("radiance, classical", film.radiance(3, 20), wall);

    // Did the scene keep its word? What it answers wrongly is cut out of the light, and counted by kind.
    aglow::host_faults faults;
    aglow::film<float> trial{32, 32};
    trial.expose(eye, aglow::path_tracer{room, light, {.faults = &faults}}, {.samples = 4}, crew);
    std::printf("%llu faults of the scene\n%s", static_cast<unsigned long long>(faults.count()),
                aglow::statement(faults).c_str());
    all_right = all_right && faults.count() == 0;

    // How good is it? A few hundred pixels are looked at afresh by an unbiased integrator.
    const aglow::pixel_probe probe{eye, paths, film.width()};
    const auto result = aglow::audit(film, probe, {.target = 0.05, .noise = 0.1}, crew);
    std::printf("%s", aglow::statement(result).c_str());

    return all_right && result.status == aglow::audit_status::certified ? 0 : 1;
}
