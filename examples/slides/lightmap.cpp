// A lightmap: what light falls on every wall and block of the box, unfolded, with error bars.
//
// Integrators answer rays. For a baker these start just above a texel and look straight down: then an atlas is a film,
// every integrator a baker, and the audit of a picture that of a lightmap.
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <aglow/algorithms/cache_integrators.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/report/audit.hpp>

#include "common/audited_film.hpp"
#include "common/scenes/registry.hpp"
#include "slides/slide.hpp"

namespace {

using aglow::vec2;
using aglow::vec3;
using description = host::scene_description<float>;
using world = host::diffuse_scene<float>;
using baker = aglow::gather_caching<world, host::light_set<float>>;

/// A place on a wall, and which way the wall faces.
struct texel {
    vec3<float> position;
    vec3<float> normal;
};

/// Every quad of a scene that reflects light, in a square of texels of its own.
class atlas {
public:
    atlas(const description& d, const world& scene, std::size_t side)
        : scene_{scene}, above_{16 * aglow::position_error(aglow::max_abs(scene.bounds().extent()))}, side_{side} {
        for (const auto& quad : d.quads) {
            const vec3<float>& albedo = d.materials[quad.material].diffuse;
            if (!aglow::is_black(albedo)) { charts_.push_back({quad.corners, albedo}); }
        }
        while (columns_ * columns_ < charts_.size()) { ++columns_; }
        for (std::size_t i = 0; i < side * side; ++i) {
            const auto t = texel_at(middle_of(i));
            buried_.push_back(!t || is_buried(*t));
        }
    }

    /// The texel of a pixel; empty where there is none, or it lies within something solid.
    [[nodiscard]] std::optional<texel> at(std::size_t pixel) const {
        return buried_[pixel] ? std::nullopt : texel_at(middle_of(pixel));
    }

    /// The ray that looks down at a point of the film.
    [[nodiscard]] aglow::ray<float> eye(vec2<float> film) const {
        film = glm::min(film, std::nextafter(static_cast<float>(side_), 0.0f));  // 255 + u may round to 256
        const auto pixel = static_cast<std::size_t>(film.y) * side_ + static_cast<std::size_t>(film.x);
        const auto t = buried_[pixel] ? std::nullopt : texel_at(film);
        if (!t) { return {.reach = 0}; }
        return {t->position + t->normal * above_, -t->normal};
    }

    /// What turns the light that leaves a pixel, W/(m² sr), into what fell on it, W/m².
    [[nodiscard]] vec3<float> irradiance_per_radiance(std::size_t pixel) const {
        return buried_[pixel] ? vec3<float>{0} : aglow::pi<float> / chart_at(middle_of(pixel)).albedo;
    }

private:
    struct chart {
        std::array<vec3<float>, 4> corners;
        vec3<float> albedo;
    };

    [[nodiscard]] vec2<float> middle_of(std::size_t pixel) const {
        return vec2<float>{pixel % side_, pixel / side_} + 0.5f;
    }

    [[nodiscard]] vec2<float> in_charts(const vec2<float>& film) const {
        return film * (static_cast<float>(columns_) / static_cast<float>(side_));
    }
    [[nodiscard]] std::size_t number_at(const vec2<float>& film) const {
        const vec2<float> cell = in_charts(film);
        return static_cast<std::size_t>(cell.y) * columns_ + static_cast<std::size_t>(cell.x);
    }
    [[nodiscard]] const chart& chart_at(const vec2<float>& film) const { return charts_[number_at(film)]; }

    [[nodiscard]] std::optional<texel> texel_at(const vec2<float>& film) const {
        if (number_at(film) >= charts_.size()) { return std::nullopt; }
        const auto& [a, b, c, d] = chart_at(film).corners;
        const vec2<float> u = glm::fract(in_charts(film));
        return texel{glm::mix(glm::mix(a, b, u.x), glm::mix(d, c, u.x), u.y), glm::normalize(glm::cross(b - a, d - a))};
    }

    /// Whether a texel sees back faces more often than not.
    [[nodiscard]] bool is_buried(const texel& t) const {
        constexpr std::uint32_t looks = 64;
        const aglow::frame<float> axes{t.normal};
        std::uint32_t behind = 0;
        for (std::uint32_t i = 0; i < looks; ++i) {
            const aglow::sobol_numbers<float> numbers{{}, i};
            const auto u = numbers.at(0, aglow::purpose::camera).next_2d();
            const vec3<float> to = axes.to_world(aglow::cosine_hemisphere(u));
            const auto met = scene_.intersect({t.position + t.normal * above_, to});
            behind += met && glm::dot(met->normal, to) > 0;
        }
        return 2 * behind > looks;
    }

    const world& scene_;
    float above_;
    std::size_t side_;
    std::size_t columns_{1};
    std::vector<chart> charts_{};
    std::vector<char> buried_{};
};

/// Indirect light of all texels, read from the cache in one go.
host::picture indirect_light(const atlas& map, const baker::cache_type& cache, host::picture image) {
    std::vector<texel> texels;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (const auto t = map.at(i)) { texels.push_back(*t), pixels.push_back(i); }
    }
    std::vector<aglow::irradiance_answer<vec3<float>, float>> answers(texels.size());
    const host::stopwatch clock;
    cache.lookup_each(std::span<const texel>{texels}, std::span{answers});
    std::printf("indirect light of %zu texels read from %u records in %.1f ms\n", texels.size(), cache.size(),
                1e3 * clock.seconds());
    for (std::size_t k = 0; k < texels.size(); ++k) {
        const auto found = answers[k] ? answers[k] : cache.nearest(texels[k].position, texels[k].normal);
        image.pixels[pixels[k]] = found.irradiance;
    }
    return image;
}

}  // namespace

int main(int count, char** words) {
    return host::show_slide(count, words, [](const host::slide& s) {
        const description box = host::scenes::cornell_diffuse<float>();
        const world scene{box};
        const atlas map{box, scene, s.side()};
        const auto eye = [&map](const vec2<float>& film) { return map.eye(film); };

        const host::stopwatch clock;
        aglow::gather_caching_options options;
        options.caching.view.width = options.caching.view.height = s.side();
        const baker bake{scene, scene.lights(), scene.bounds(), eye, options, s.run()};
        aglow::film<vec3<float>> film{s.side(), s.side()};
        film.expose(eye, bake, {.samples = s.tiny() ? 1u : 16u}, s.run());
        const double baked = clock.seconds();

        const aglow::path_tracer truth{scene, scene.lights()};
        const auto said = aglow::audit(film, aglow::pixel_probe{eye, truth, s.side()}, {}, s.run());
        std::printf("baked in %.2f s, audited in %.2f s: off by %.2f %%, at most %.2f %%, in the mean\n", baked,
                    clock.seconds() - baked, 100 * said.likely_error, 100 * said.mean_error_bound);

        const host::picture light = host::developed(film);
        host::picture irradiance = light;
        std::vector<double> bars = aglow::error_bars(film, said);
        for (std::size_t i = 0; i < light.pixels.size(); ++i) {
            irradiance.pixels[i] *= map.irradiance_per_radiance(i);
            if (!map.at(i)) { bars[i] = 0; }
        }
        const host::picture indirect = indirect_light(map, bake.cache(), {s.side(), s.side()});
        const auto shown = [&](host::picture image, float exposure, const char* what) {
            for (vec3<float>& p : image.pixels) { p *= exposure; }
            return host::captioned(image, s.tiny() ? "" : what);
        };
        s.save("lightmap", {shown(irradiance, 0.25f, "irradiance"), shown(indirect, 0.25f, "indirect alone"),
                            shown(host::heat_map(light, bars), 1, "error bars")});
    });
}
