// The same small picture by every ready integrator.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>

#include "support/scenes.hpp"

namespace stability {

using rgb = glm::vec3;

/// What all of them are asked for.
struct picture_options {
    std::size_t size{4};
    std::uint32_t samples{2};
    std::size_t photons{300};
    std::uint32_t rays{16};
    std::uint32_t threads{1};
};

/// One integrator's pixels, row by row, and their errors.
struct picture {
    std::string by;
    std::vector<rgb> pixels{};
    std::vector<float> errors{};
};

/// A camera at `at`, looking along +y, that sees the film of `size` pixels.
struct small_camera {
    rgb at{0.1f, -0.9f, 0.2f};
    float size{4};
    [[nodiscard]] aglow::ray<float> operator()(const aglow::vec2<float>& film) const {
        return {at, glm::normalize(rgb{film.x / size - 0.5f, 0.75f, 0.375f - film.y / size})};
    }
};

[[nodiscard]] inline picture exposed(std::string by, const aglow::film<rgb>& film) {
    picture p{std::move(by)};
    for (std::size_t y = 0; y < film.height(); ++y) {
        for (std::size_t x = 0; x < film.width(); ++x) {
            p.pixels.push_back(film.radiance(x, y));
            p.errors.push_back(film.error(x, y));
        }
    }
    return p;
}

/// Pictures of `scene` under `light` by path tracing, photon mapping, final gathering, irradiance caching, gathering
/// with a cache, and progressive photon mapping.
template <typename World, typename Light>
[[nodiscard]] std::vector<picture> by_every_integrator(const World& scene, const Light& light,
                                                       const aglow::bounds<float>& box, small_camera eye,
                                                       const picture_options& o = {}) {
    using namespace aglow;
    const own_threads run{o.threads};
    eye.size = static_cast<float>(o.size);
    std::vector<picture> all;
    const auto show = [&](const char* name, const auto& integrator) {
        film<rgb> f{o.size, o.size};
        f.expose(eye, integrator, {.samples = o.samples}, run);
        all.push_back(exposed(name, f));
    };
    const photon_options photons{
        .direct = o.photons / 2, .caustic = o.photons / 2, .indirect = o.photons, .pilot_paths = o.photons};
    const caching_options caching{
        .fill = {.rays = o.rays}, .view = {.width = o.size, .height = o.size}, .caustics = {.photons = photons}};
    show("path tracing", path_tracer{scene, light});
    show("photon mapping", photon_mapping{scene, light, {.photons = photons}, run});
    show("final gathering", final_gathering{scene, light, {.photons = photons, .rays = o.rays}, run});
    show("irradiance caching", irradiance_caching{scene, light, box, eye, caching, run});
    show("gather caching", gather_caching{scene, light, box, eye, {.photons = photons, .caching = caching}, run});
    progressive_photon_mapping progressive{
        scene, light, {.caustic = o.photons / 2, .indirect = o.photons, .density = {.count = 20}}};
    film<rgb> f{o.size, o.size};
    for (int pass = 0; pass < 2; ++pass) { progressive.pass(f, eye, run); }
    all.push_back(exposed("progressive photon mapping", f));
    return all;
}

/// The room of the toy scenes with everything in it, every length times `scale`, every light times `power`; bands
/// turned by `turn` places.
struct scaled_room {
    support::ball_room<rgb, float> inner;
    aglow::bounds<float> box;
    small_camera eye;

    explicit scaled_room(float scale = 1, float power = 1, int turn = 0) {
        const auto turned = [&](const rgb& c) { return rgb{c[turn % 3], c[(turn + 1) % 3], c[(turn + 2) % 3]}; };
        inner = support::room_with_balls<rgb, float>(turned({0.7f, 0.5f, 0.3f}), turned({10, 12, 14}) * power);
        inner.scene.rectangles[1].made_of.diffuse = turned({0.125f, 0.5f, 0.75f});
        inner.scene = inner.scene.scaled(scale);
        inner.light.shape.corner *= scale;
        inner.light.shape.u *= scale;
        inner.light.shape.v *= scale;
        box.add(rgb{-scale});
        box.add(rgb{scale});
        eye.at *= scale;
    }

    [[nodiscard]] std::vector<picture> pictures(const picture_options& o = {}) const {
        return by_every_integrator(inner.scene, inner.light, box, eye, o);
    }
};

}  // namespace stability
