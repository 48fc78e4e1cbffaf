// A model ready to be traced by Embree and lit by its own lights, or by an even sky where it has none.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "common/bsdf.hpp"
#include "common/camera.hpp"
#include "common/light_set.hpp"
#include "common/model.hpp"
#include "embree/embree_scene.hpp"

namespace host {

/// Finds the material of what Embree hit. Triangles are numbered through all meshes, for the lights.
class model_shade {
public:
    explicit model_shade(const model& m) {
        for (const material<float>& made_of : m.materials) { bsdfs_.emplace_back(made_of); }
        std::uint32_t triangles = 0;
        for (const model::mesh& mesh : m.meshes) {
            meshes_.push_back({mesh.material, triangles});
            triangles += static_cast<std::uint32_t>(mesh.triangles.size());
        }
    }

    [[nodiscard]] surface_hit<float> operator()(const embree_hit& h) const {
        const part& mesh = meshes_[h.mesh];
        return {.position = h.position,
                .normal = h.normal,
                .position_error = h.position_error,
                .distance = h.distance,
                .scatterer = &bsdfs_[mesh.material],
                .primitive = mesh.first + h.triangle};
    }

    [[nodiscard]] lobe_set lobes() const {
        lobe_set all = lobe_set::none;
        for (const bsdf<float>& b : bsdfs_) { all = all | b.lobes(); }
        return all;
    }

private:
    struct part {
        std::size_t material;
        std::uint32_t first;
    };
    std::vector<bsdf<float>> bsdfs_{};
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
