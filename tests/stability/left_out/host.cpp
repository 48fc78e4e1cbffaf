// A host that knows every lobe, in two builds: with MATTE it states that its scene is matte all over. What it can do
// besides is then to be found neither in its own code nor in the library's. Prints a pixel, the same in both builds.
#include <cstdio>
#include <optional>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/warp.hpp>

namespace {

using namespace aglow;

// Not to be inlined, so that their names tell whether anybody can call them.
[[gnu::noinline]] float glossy_lobe(float x) { return x * 1.5f; }
[[gnu::noinline]] float specular_lobe(float x) { return x * 2.5f; }
[[gnu::noinline]] float transmitted_lobe(float x) { return x * 3.5f; }

struct hit {
#ifdef MATTE
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
#endif
    vec3<float> position{};
    vec3<float> normal{};
    float glow{};
    lobe_set has{lobe_set::diffuse_reflection};

    [[nodiscard]] lobe_set lobes() const { return has; }
    [[nodiscard]] float emitted(const vec3<float>&) const { return glow; }
    [[nodiscard, gnu::always_inline]] float evaluate(const vec3<float>& wo, const vec3<float>& wi,
                                                     lobe_set asked) const {
        const lobe_set mine = has & asked;
        float f = any(mine, lobe_set::diffuse_reflection) && glm::dot(normal, wo) * glm::dot(normal, wi) > 0
                      ? 0.5f / pi<float>
                      : 0.0f;
        if (any(mine, lobe_set::glossy)) { f += glossy_lobe(wo.x); }
        if (any(mine, lobe_set::diffuse_transmission)) { f += transmitted_lobe(wo.y); }
        return f;
    }
    [[nodiscard, gnu::always_inline]] float pdf(const vec3<float>&, const vec3<float>& wi, lobe_set asked) const {
        const lobe_set mine = has & asked;
        float p = any(mine, lobe_set::diffuse_reflection) ? std::abs(glm::dot(normal, wi)) / pi<float> : 0.0f;
        if (any(mine, lobe_set::glossy)) { p += glossy_lobe(wi.x); }
        return p;
    }
    template <Sampler R>
    [[nodiscard, gnu::always_inline]] std::optional<scatter_sample<float, float>> sample(const vec3<float>& wo,
                                                                                         R& random,
                                                                                         lobe_set asked) const {
        const lobe_set mine = has & asked;
        const vec2<float> u = random.next_2d();
        const vec3<float> side = glm::dot(normal, wo) < 0 ? -normal : normal;
        const vec3<float> local = cosine_hemisphere(u);
        scatter_sample<float, float> s{frame<float>{side}.to_world(local), 0.5f, local.z / pi<float>,
                                       lobe_set::diffuse_reflection};
        if (any(mine, lobe_set::specular)) {
            s.weight = specular_lobe(u.x);
            s.lobe = lobe_set::specular_reflection;
        }
        if (any(mine, lobe_set::glossy)) { s.weight += glossy_lobe(u.y); }
        if (any(mine, lobe_set::transmission)) { s.weight += transmitted_lobe(u.y); }
        return any(mine) ? std::optional{s} : std::nullopt;
    }
};

/// The inside of a unit sphere with a bulb at its centre.
struct room {
#ifdef MATTE
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
#endif
    lobe_set has{lobe_set::diffuse_reflection};

    [[nodiscard]] std::optional<hit> intersect(const ray<float>& r) const {
        const float b = glm::dot(r.origin, r.direction);
        const float root2 = b * b + 1 - length2(r.origin);
        if (!(root2 > 0)) { return std::nullopt; }
        const float t = std::sqrt(root2) - b;
        if (!(t > 0 && t < r.reach)) { return std::nullopt; }
        const vec3<float> out = glm::normalize(r.origin + r.direction * t);
        return hit{out, -out, 0, has};
    }
    [[nodiscard]] bool occluded(const vec3<float>&, const vec3<float>&) const { return false; }
};

struct bulb {
    template <Sampler R>
    [[nodiscard]] emission<float, float> emit(R& random) const {
        const vec2<float> u = random.next_2d();
        return {{{}, uniform_sphere(u)}, 4 * pi<float>};
    }
    template <Sampler R>
    [[nodiscard]] std::optional<illumination<float, float>> illuminate(const vec3<float>& x, R&) const {
        const float d = glm::length(x);
        return illumination<float, float>{-x / d, d, 1 / (d * d), 0};
    }
};

}  // namespace

int main(int count, char**) {
    // Nobody but the running program knows, so no compiler leaves anything out for it.
    const room scene{count > 1 ? lobe_set::all : lobe_set::diffuse_reflection};
    const bulb light;
    const ray<float> eye{{0.1f, 0, 0}, {0, 0, 1}};
    const random_numbers<float> numbers{{}};
    bounds<float> box;
    box.add(vec3<float>{-1});
    box.add(vec3<float>{1});
    const auto camera = [&](const vec2<float>& film) {
        return ray<float>{{0.1f, 0, 0}, glm::normalize(vec3<float>{film.x - 1, film.y - 1, 2})};
    };
    const photon_options photons{.direct = 200, .caustic = 200, .indirect = 500, .pilot_paths = 200};
    const path_tracer traced{scene, light};
    const photon_mapping mapped{scene, light, {.photons = photons}};
    const final_gathering gathered{scene, light, {.photons = photons}};
    const irradiance_caching cached{scene, light, box, camera, {.fill = {.rays = 32}, .view = {2, 2}}};
    std::printf("%a %a %a %a\n", static_cast<double>(traced(eye, numbers).value),
                static_cast<double>(mapped(eye, numbers).value), static_cast<double>(gathered(eye, numbers).value),
                static_cast<double>(cached(eye, numbers).value));
    std::printf("caustic paths %zu: %s\n", mapped.maps().caustic.paths, mapped.maps().caustic.why.c_str());
}
