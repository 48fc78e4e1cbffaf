// Scenes whose pictures are as large as those that users render, for trials of the stop rule: too large to know the
// truth of every pixel, so it is known at pixels drawn at random.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <aglow/algorithms/pixel_probe.hpp>
#include <aglow/core/random.hpp>

#include "case.hpp"

namespace calibration {

/// Rays of a square picture.
struct camera_eye {
    host::camera<float> view;
    std::size_t width;

    [[nodiscard]] aglow::ray<float> operator()(const aglow::vec2<float>& film) const {
        return view.through(film, width, width);
    }
};

/// A scene, and the truth of some pixels of pictures of it. Probes look anew each time.
class whole_scene {
public:
    whole_scene(const host::scene_description<float>& description, const effort& e)
        : name_{description.name},
          effort_{e},
          scene_{description},
          paths_{scene_, scene_.lights(), 0, aglow::own_threads{}, e.probes},
          tracer_{paths_.tracer()},
          eye_{scene_.view(), e.width},
          known_(std::min(e.truths, e.width * e.width)) {
        effort_.pixels = e.width;
        aglow::own_threads{}(known_.size(), [&](std::size_t i) {
            const std::size_t pixel = aglow::mix(4000, i) % (effort_.width * effort_.width);
            known_[i] = {pixel, look(pixel, aglow::mix(4001, i)), look(pixel, aglow::mix(4002, i))};
        });
    }
    whole_scene(const whole_scene&) = delete;
    whole_scene& operator=(const whole_scene&) = delete;

    [[nodiscard]] const camera_eye& eye() const { return eye_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const effort& how() const { return effort_; }
    [[nodiscard]] const world_type& scene() const { return scene_; }

    [[nodiscard]] auto probe() const { return aglow::pixel_probe{eye_, tracer_, effort_.width}; }

    /// Rays that a probe's sample costs.
    [[nodiscard]] double probe_cost() const { return rays_a_sample(tracer_) + paths_.guiding_cost(); }
    /// Rays that were spent before the first of them.
    [[nodiscard]] double guide_cost() const { return paths_.guide_cost(); }
    template <typename Integrator>
    [[nodiscard]] double rays_a_sample(const Integrator& integrator) const {
        return host::rays_a_sample(eye_, integrator, effort_.width, effort_.width, 5);
    }

    /// The mean relative error of a picture as audits define it. What the noise of the truth adds to it is taken off to
    /// first order, by half the truth, which is twice as noisy.
    [[nodiscard]] double mean_error(const judged_picture& picture) const {
        double light = 0;
        for (const float x : picture.values) { light += static_cast<double>(x); }
        const double delta = aglow::audit_options{}.dark * light / static_cast<double>(picture.values.size());
        double whole = 0;
        double halves = 0;
        for (const auto& [pixel, a, b] : known_) {
            for (int c = 0; c < 3; ++c) {
                const auto ours = static_cast<double>(picture.values[3 * pixel + static_cast<std::size_t>(c)]);
                const double one = static_cast<double>(a[c]);
                const double two = static_cast<double>(b[c]);
                const double truth = (one + two) / 2;
                whole += std::abs(ours - truth) / (truth + delta);
                halves += (std::abs(ours - one) + std::abs(ours - two)) / (2 * (truth + delta));
            }
        }
        return (2 * whole - halves) / static_cast<double>(3 * known_.size());
    }

private:
    /// The truth of a pixel, by two independent halves.
    struct known_pixel {
        std::size_t pixel{0};
        rgb one{}, two{};
    };

    [[nodiscard]] rgb look(std::size_t pixel, std::uint64_t seed) const {
        return probe()(pixel, seed, std::max(2u, effort_.pool) / 2);
    }

    std::string name_;
    effort effort_;
    world_type scene_;
    host::probe_paths<world_type> paths_;
    decltype(paths_.tracer()) tracer_;
    camera_eye eye_;
    std::vector<known_pixel> known_;
};

}  // namespace calibration
