// A scene as it is written down, and ready to be traced: the library's `Scene` and its lights.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aglow/concepts/intersector.hpp>

#include "bsdf.hpp"
#include "camera.hpp"
#include "geometry.hpp"
#include "light_set.hpp"

namespace host {

/// A built-in scene as data: materials, what is made of them by their index, and who looks at it.
template <typename T>
struct scene_description {
    struct quad {
        std::array<vec3<T>, 4> corners;
        std::size_t material;
    };
    struct sphere {
        vec3<T> centre;
        T radius;
        std::size_t material;
        bool inside_out{false};
    };
    struct lamp {
        vec3<T> position;
        vec3<T> intensity;
    };

    std::string name;
    std::string about;
    std::vector<host::material<T>> materials{};
    /// A quad is the triangles 0 1 2 and 0 2 3.
    std::vector<quad> quads{};
    std::vector<sphere> spheres{};
    std::vector<lamp> lamps{};
    std::optional<host::sky<T>> sky{};
    host::camera<T> camera{};

    std::size_t add(const host::material<T>& m) {
        materials.push_back(m);
        return materials.size() - 1;
    }
    void add_quad(const vec3<T>& a, const vec3<T>& b, const vec3<T>& c, const vec3<T>& d, std::size_t m) {
        quads.push_back({{a, b, c, d}, m});
    }
    void add_sphere(const vec3<T>& centre, T radius, std::size_t m) { spheres.push_back({centre, radius, m}); }
};

/// A built-in scene that can be traced and lit; copies stand alone. `Possible` names the lobes that its materials may
/// have.
template <typename T, lobe_set Possible = lobe_set::all>
class traced_scene {
public:
    using scalar = T;
    using hit_type = surface_hit<T, Possible>;

    /// Throws `std::invalid_argument` for a material that cannot be, or that has a lobe outside of `Possible`.
    explicit traced_scene(const scene_description<T>& d) : view_{d.camera} {
        for (const material<T>& m : d.materials) { add(m); }
        for (const auto& q : d.quads) { add(q); }
        for (const auto& s : d.spheres) {
            made_of_.push_back(static_cast<std::uint32_t>(s.material));
            shapes_.add_sphere(s.centre, s.radius, s.inside_out);
        }
        shapes_.finish();
        add_lights(d);
    }

    [[nodiscard]] std::optional<hit_type> intersect(const aglow::ray<T>& r) const {
        meeting<T> m;
        if (!shapes_.nearest(r, m)) { return std::nullopt; }
        return hit_type{.position = m.position,
                        .normal = m.normal,
                        .position_error = shapes_.position_error(),
                        .distance = m.distance,
                        .scatterer = &bsdfs_[made_of_[m.primitive]],
                        .primitive = m.primitive};
    }
    [[nodiscard]] bool occluded(const vec3<T>& a, const vec3<T>& b) const { return shapes_.occluded(a, b); }

    [[nodiscard]] const aglow::bounds<T>& bounds() const { return shapes_.bounds(); }
    [[nodiscard]] const light_set<T>& lights() const { return lights_; }
    [[nodiscard]] const camera<T>& view() const { return view_; }
    [[nodiscard]] std::size_t primitives() const { return shapes_.size(); }

protected:
    [[nodiscard]] lobe_set lobes() const { return lobes_; }

private:
    void add(const material<T>& m) {
        bsdfs_.emplace_back(m);
        lobes_ = lobes_ | lobes_of(m);
        if (aglow::any(lobes_, ~Possible)) { throw std::invalid_argument("scene: a material has an excluded lobe"); }
    }

    void add(const typename scene_description<T>::quad& q) {
        const auto& [a, b, c, d] = q.corners;
        const auto m = static_cast<std::uint32_t>(q.material);
        if (is_flat_convex(a, b, c, d) && (!shines(m) || as_rectangle(q.corners))) {
            made_of_.push_back(m);
            shapes_.add_quad(a, b, c, d);
            return;
        }
        made_of_.insert(made_of_.end(), 2, m);
        shapes_.add_triangle(a, b, c);
        shapes_.add_triangle(a, c, d);
    }

    [[nodiscard]] bool shines(std::size_t m) const { return !aglow::is_black(bsdfs_[m].made_of().radiance); }

    /// The quad as a rectangle, where its edges are parallel and upright within rounding.
    static std::optional<rectangle<T>> as_rectangle(const std::array<vec3<T>, 4>& p) {
        const vec3<T> x = p[1] - p[0];
        const vec3<T> y = p[3] - p[0];
        const T slack = 4 * std::numeric_limits<T>::epsilon();
        const T size = std::max(aglow::max_abs(p[0]), aglow::max_abs(p[2]));
        if (glm::length(p[2] - p[1] - y) > slack * size) { return std::nullopt; }
        if (std::abs(glm::dot(x, y)) > slack * size * (glm::length(x) + glm::length(y))) { return std::nullopt; }
        return rectangle<T>{p[0], glm::normalize(x), glm::normalize(y), glm::length(x), glm::length(y)};
    }

    void add_lights(const scene_description<T>& d) {
        const T error = shapes_.position_error();
        std::uint32_t number = 0;
        for (const auto& q : d.quads) {
            const vec3<T> radiance = d.materials[q.material].radiance;
            const auto& [a, b, c, e] = q.corners;
            if (is_split(q)) {
                lights_.add(triangle_light<T>{a, b, c, radiance, error}, number++);
                lights_.add(triangle_light<T>{a, c, e, radiance, error}, number++);
                continue;
            }
            if (shines(q.material)) {
                lights_.add(rectangle_light<T>{*as_rectangle(q.corners), radiance, error}, number);
            }
            ++number;
        }
        for (const auto& s : d.spheres) {
            const vec3<T> radiance = d.materials[s.material].radiance;
            lights_.add(sphere_light<T>{s.centre, s.radius, s.inside_out, radiance, error}, number++);
        }
        for (const auto& l : d.lamps) { lights_.add(point_light<T>{l.position, l.intensity}); }
        if (d.sky) { lights_.add(sky_light<T>{*d.sky, shapes_.bounds(), error}); }
    }
    [[nodiscard]] bool is_split(const typename scene_description<T>::quad& q) const {
        const auto& [a, b, c, d] = q.corners;
        return !is_flat_convex(a, b, c, d) || (shines(q.material) && !as_rectangle(q.corners));
    }

    std::vector<bsdf<T>> bsdfs_{};
    std::vector<std::uint32_t> made_of_{};
    geometry<T> shapes_{};
    light_set<T> lights_{};
    camera<T> view_;
    lobe_set lobes_{lobe_set::none};
};

/// A scene that says at run time which lobes it has.
template <typename T>
class scene : public traced_scene<T> {
public:
    using traced_scene<T>::traced_scene;
    [[nodiscard]] lobe_set possible_lobes() const { return this->lobes(); }
};

/// A scene that says at compile time which lobes it can have.
template <typename T, lobe_set Possible>
class limited_scene : public traced_scene<T, Possible> {
public:
    using traced_scene<T, Possible>::traced_scene;
    static constexpr lobe_set possible_lobes = Possible;
};

/// A scene of Lambert's surfaces alone: all other code is left out.
template <typename T>
using diffuse_scene = limited_scene<T, lobe_set::diffuse_reflection>;

}  // namespace host
