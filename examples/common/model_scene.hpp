// A model ready to be traced by Embree and lit by its own lights, or by an even sky where it has none.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/bsdf.hpp"
#include "common/camera.hpp"
#include "common/light_set.hpp"
#include "common/model.hpp"
#include "common/shaded_hit.hpp"
#include "common/texture.hpp"
#include "embree/embree_scene.hpp"

namespace host {

/// Makes a surface of what Embree hit: the material there, its colour, and the normal it is shaded by. Triangles are
/// numbered through all meshes, for the lights.
class model_shade {
public:
    explicit model_shade(const model& m) : textures_{m.textures} {
        for (const material<float>& made_of : m.materials) { bsdfs_.emplace_back(made_of); }
        std::uint32_t triangles = 0;
        for (const model::mesh& mesh : m.meshes) {
            meshes_.push_back({mesh, triangles});
            triangles += static_cast<std::uint32_t>(mesh.triangles.size());
        }
    }

    [[nodiscard]] shaded_hit<float> operator()(const embree_hit& h) const {
        const part& p = meshes_[h.mesh];
        const auto told = between(p.mesh.normals, p.mesh.triangles[h.triangle], h);
        return {.position = h.position,
                .normal = h.normal,
                .shading = shading_normal(told, h.normal, -h.direction),
                .position_error = h.position_error,
                .distance = h.distance,
                .scatterer = scatterer(p.mesh, h),
                .primitive = p.first + h.triangle};
    }

    [[nodiscard]] lobe_set lobes() const {
        lobe_set all = lobe_set::none;
        for (const bsdf<float>& b : bsdfs_) { all = all | b.lobes(); }
        return all;
    }

private:
    struct part {
        model::mesh mesh;
        std::uint32_t first;
    };

    /// What belongs to the corners, where the ray met the triangle.
    template <typename V>
    static V between(const std::vector<V>& of, const std::array<std::uint32_t, 3>& t, const embree_hit& h) {
        return of[t[0]] * (1 - h.u - h.v) + of[t[1]] * h.u + of[t[2]] * h.v;
    }

    [[nodiscard]] bsdf<float> scatterer(const model::mesh& mesh, const embree_hit& h) const {
        const auto& corners = mesh.triangles[h.triangle];
        const picture& texture = textures_[mesh.material];
        vec3<float> colour{1};
        if (!mesh.colours.empty()) { colour = between(mesh.colours, corners, h); }
        if (!mesh.places.empty() && !texture.pixels.empty()) {
            const vec2<float> at = between(mesh.places, corners, h);
            colour *= texture_colour(texture, at.x, at.y);
        }
        return bsdfs_[mesh.material].tinted(glm::clamp(colour, 0.0f, 1.0f));
    }

    std::vector<bsdf<float>> bsdfs_{};
    std::vector<picture> textures_{};
    std::vector<part> meshes_{};
};

/// The library's `Scene` for a model file, with lights and a camera.
class model_scene : public embree_scene<model_shade> {
public:
    explicit model_scene(const model& m) : embree_scene{model_shade{m}} {
        for (const model::mesh& mesh : m.meshes) { add_mesh(mesh.corners, mesh.triangles); }
        commit();
        add_lights(m);
        view_ = m.camera ? *m.camera : framed();
    }

    [[nodiscard]] lobe_set possible_lobes() const { return shade().lobes(); }
    [[nodiscard]] const light_set<float>& lights() const { return lights_; }
    [[nodiscard]] const camera<float>& view() const { return view_; }

private:
    void add_lights(const model& m) {
        std::uint32_t number = 0;
        for (const model::mesh& mesh : m.meshes) {
            const vec3<float> radiance = m.materials[mesh.material].radiance;
            for (const auto& t : mesh.triangles) {
                const auto& c = mesh.corners;
                if (!aglow::is_black(radiance)) {
                    lights_.add(triangle_light<float>{c[t[0]], c[t[1]], c[t[2]], radiance, position_error()}, number);
                }
                ++number;
            }
        }
        for (const model::lamp& l : m.lamps) { lights_.add(point_light<float>{l.position, l.intensity}); }
        if (lights_.empty()) {
            lights_.add(sky_light<float>{sky<float>{.ground = vec3<float>{1}}, bounds(), position_error()});
        }
    }

    /// From the front, a little above and aside, all in view.
    [[nodiscard]] camera<float> framed() const {
        const vec3<float> aside = glm::normalize(vec3<float>{0.5f, 0.35f, 1});
        const camera<float> unit = look_at<float>(aside, {0, 0, 0}, 39.3f);
        const float distance = bounds().radius() * std::sqrt(1 + 1 / (unit.tangent * unit.tangent));
        return look_at<float>(bounds().centre() + aside * distance, bounds().centre(), 39.3f);
    }

    light_set<float> lights_{};
    camera<float> view_{};
};

}  // namespace host
