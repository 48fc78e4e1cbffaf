// Irradiance worked out ahead at many points, so that a gather ray reads it with one nearest look-up.
//
// Christensen 1999, Faster photon map global illumination.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/packed_direction.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/estimators/estimate.hpp>

namespace aglow {

/// Irradiance at a place: all light that arrives on one side of a surface.
template <Spectrum S, std::floating_point T>
struct irradiance_point {
    vec3<T> position{};
    vec3<T> normal{};    ///< unit, on the side that is lit
    S irradiance{};      ///< W/m², without `caustic`
    S caustic{};         ///< irradiance that came over mirrors, which some gathers read elsewhere
    band_of<S> error{};  ///< guess of its error
    T radius{};          ///< what the estimate was spread over: nearer than that, it knows no detail
    bool cut{};          ///< whether something cuts through that disc, so that it may lie hidden from a near place

    /// The same place with so many times the light.
    [[nodiscard]] irradiance_point times(band_of<S> factor) const {
        irradiance_point result = *this;
        result.irradiance = irradiance * factor;
        result.caustic = caustic * factor;
        return result;
    }
};

/// Many irradiance points; the nearest one that fits a surface speaks for it. `const` look-ups from many threads.
template <Spectrum S, std::floating_point T = float>
class irradiance_points {
public:
    /// What is read at a place.
    struct reading : estimate<S> {
        T radius{};           ///< of the estimate that was read
        S without_caustic{};  ///< the value without what came over mirrors
        vec3<T> position{};   ///< of the point that was read
        bool cut{};           ///< whether it may be hidden from where it was read
    };

    irradiance_points() = default;

    /// Points with broken irradiance are left out.
    template <Executor Run = in_sequence>
    explicit irradiance_points(std::span<const irradiance_point<S, T>> points, const Run& run = {},
                               const shared_error& shared = {})
        : shared_{shared} {
        std::vector<std::uint32_t> sound;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (is_radiance(points[i].irradiance) && is_radiance(points[i].caustic)) {
                sound.push_back(static_cast<std::uint32_t>(i));
            }
        }
        tree_ = kd_tree<T>{sound, [&](std::uint32_t i) { return points[i].position; }, run};
        stored_.reserve(tree_.size());
        sides_.reserve(tree_.size());
        for (const std::uint32_t i : tree_.order()) {
            const irradiance_point<S, T>& p = points[sound[i]];
            stored_.push_back({p.irradiance, p.caustic, p.error, p.radius});
            sides_.push_back({packed_direction<std::int8_t>{p.normal}, p.cut});
        }
        tree_.forget_order();
        measure();
    }

    [[nodiscard]] std::size_t size() const { return stored_.size(); }
    [[nodiscard]] bool empty() const { return stored_.empty(); }
    /// What all points are off by together, relative to their irradiance.
    [[nodiscard]] const shared_error& shared() const { return shared_; }
    /// Bytes in all.
    [[nodiscard]] std::size_t memory() const {
        return tree_.memory() + stored_.capacity() * sizeof(stored) + sides_.capacity() * sizeof(side);
    }

    /// The irradiance of the nearest point whose normal is within 37 degrees of unit `normal` and that lies within 14
    /// degrees of the tangent plane, so that a wall close behind does not answer; empty where none is within reach.
    /// O(log n).
    [[nodiscard]] std::optional<reading> nearest(const vec3<T>& point, const vec3<T>& normal) const {
        const auto fits = [&](kd_slot i) {
            if (!(glm::dot(sides_[i].normal.template direction<T>(), normal) > T(0.8))) { return false; }
            const vec3<T> away = tree_.position(i) - point;
            const T height = std::abs(glm::dot(away, normal)) - slack_;
            if (!(height <= 0 || square(4 * height) <= length2(away))) { return false; }
            simd::prefetch(&stored_[i]);
            return true;
        };
        const auto found = tree_.nearest_one(point, square(reach_), fits);
        if (!found) { return std::nullopt; }
        const stored& s = stored_[found->slot];
        const S all = s.irradiance + s.caustic;
        const band_of<S> level = max_component(all);
        return reading{{all, s.error, level * band_of<S>(shared_.common), level * band_of<S>(shared_.bias)},
                       s.radius,
                       s.irradiance,
                       tree_.position(found->slot),
                       sides_[found->slot].cut};
    }

private:
    struct stored {
        S irradiance;
        S caustic;
        band_of<S> error;
        T radius;
    };
    /// What a search looks at: by itself, so that it looks at few bytes.
    struct side {
        packed_direction<std::int8_t> normal;
        bool cut;
    };

    /// Looks eight times as far as the spacing of points that lay evenly on the faces of their box.
    void measure() {
        if (empty()) { return; }
        const vec3<T> e = tree_.box().extent();
        const T area = 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
        const T far = std::max(max_abs(tree_.box().low), max_abs(tree_.box().high));
        slack_ = position_error(far);
        reach_ = std::max(8 * std::sqrt(area / (pi<T> * static_cast<T>(size()))), 16 * slack_);
    }

    kd_tree<T> tree_{};
    std::vector<stored> stored_{};
    std::vector<side> sides_{};
    shared_error shared_{};
    T reach_{0};
    T slack_{0};  ///< how far positions may lie off their surface
};

}  // namespace aglow
