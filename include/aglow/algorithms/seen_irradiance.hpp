// Irradiance from the photons that can be seen from a place, over the part of their disc that can.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include <aglow/concepts/intersector.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/estimators/kernel.hpp>
#include <aglow/estimators/photon_map.hpp>

namespace aglow::detail {

/// What cuts through discs around a point on a surface: how far twelve spokes in its plane are free.
template <std::floating_point T>
class disc_cut {
public:
    static constexpr int spokes = 12;

    /// Looks as far as `radius`. What is met with a normal within `alike` (a cosine) is the surface itself, hollow.
    template <Intersector World>
    disc_cut(const World& scene, const vec3<T>& from, const vec3<T>& normal, T radius, T alike = 1) {
        free_.fill(radius);
        const frame<T> axes{normal};
        // Every other one at first: most discs are whole.
        for (int i = 0; i < spokes; i += 2) { cut_ = cut_ || scene.occluded(from, from + spoke(axes, i) * radius); }
        for (int i = 0; cut_ && i < spokes; ++i) {
            const vec3<T> towards = spoke(axes, i);
            const auto hit = scene.intersect(ray<T>{from, towards, radius});
            if (!hit || std::abs(glm::dot(vec3<T>(hit->normal), normal)) > alike) { continue; }
            const T distance = glm::dot(vec3<T>(hit->position) - from, towards);
            if (distance < radius) { free_[static_cast<std::size_t>(i)] = std::max(T(0), distance); }
        }
    }

    /// Whether anything does.
    explicit operator bool() const { return cut_; }

    /// The share of a kernel of `radius` that lies where its middle can see; never below a tenth, so that the noise
    /// of few photons in a crevice is not blown up.
    template <typename Kernel>
    [[nodiscard]] T share(T radius, const Kernel& kernel) const {
        if (!cut_ || !(radius > 0)) { return 1; }
        T sum{};
        for (const T f : free_) { sum += f < radius ? mass(kernel, square(f / radius)) : T(1); }
        return std::max(T(0.1), sum / spokes);
    }

private:
    /// Of the kernel within `rho2`, by Simpson's rule, which is exact for the polynomials among them.
    template <typename Kernel>
    static T mass(const Kernel& kernel, T rho2) {
        return std::min(T(1), pi<T> * rho2 / 6 * (kernel(T(0)) + 4 * kernel(rho2 / 2) + kernel(rho2)));
    }

    /// Off the axes, along which walls are built.
    static vec3<T> spoke(const frame<T>& axes, int i) {
        const T angle = 2 * pi<T> / spokes * (static_cast<T>(i) + T(0.5));
        return axes.x * std::cos(angle) + axes.y * std::sin(angle);
    }

    std::array<T, spokes> free_{};
    bool cut_{false};
};

/// What photons that can be seen make, and whether anything cuts through the disc that it was spread over.
template <Spectrum S, std::floating_point T>
struct seen_estimate : density_estimate<S, T> {
    bool cut{};
};

/// Irradiance from photons that can be seen from a place, over the part of their disc that can: behind a thin
/// wall in the middle of it lie photons of the same plane, side and normal, which no test of these can tell apart,
/// and in the corner of a room half of it lies beyond the wall, where no photon can be. `const`, safe from many
/// threads.
template <Intersector World, Spectrum S>
class seen_irradiance {
    using T = scalar_of<World>;
    using B = band_of<S>;
    using found = density_estimate<S, T>;

public:
    /// From the photons of `map` but those that are `left_out`; one of no length leaves out none. What is left has
    /// `factor` times the power. Rays are lifted by `error`. Keeps references.
    seen_irradiance(const World& scene, const photon_map<S, T>& map, const density_options& options, T error,
                    const std::vector<char>& left_out, B factor)
        : scene_{scene}, map_{map}, options_{options}, error_{error}, left_out_{left_out}, factor_{factor} {}

    /// At every place, which has a `position` and a unit `normal`.
    template <typename Place>
    [[nodiscard]] std::vector<seen_estimate<S, T>> operator()(std::span<const Place> places) const {
        std::vector<found> all(places.size());
        map_.irradiance_each(places, std::span<found>{all}, options_,
                             [&](std::size_t, std::size_t i) { return counts(i); });
        std::vector<seen_estimate<S, T>> seen;
        seen.reserve(all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            seen.push_back(seen_of(all[i], places[i].position, places[i].normal));
        }
        return seen;
    }

private:
    [[nodiscard]] bool counts(std::size_t i) const { return left_out_.empty() || !left_out_[i]; }

    /// What is seen of `all` that photons make at a point.
    [[nodiscard]] seen_estimate<S, T> seen_of(const found& all, const vec3<T>& point, const vec3<T>& normal) const {
        if (all.count == 0) { return {all.times(factor_), false}; }
        const vec3<T> from = point + normal * error_;
        const T alike = static_cast<T>(options_.normal_cosine);
        disc_cut<T> cut{scene_, from, normal, all.radius, alike};
        if (!cut) { return {all.times(factor_), false}; }
        const found seen = map_.irradiance(point, normal, options_, [&](std::size_t i) {
            return counts(i) && !scene_.occluded(from, beside(map_.position(i), point, normal));
        });
        if (seen.radius > all.radius) { cut = disc_cut<T>{scene_, from, normal, seen.radius, alike}; }
        return {within(cut, seen), static_cast<bool>(cut)};
    }

    /// Where to look for a photon at `at`: lifted to the plane of `point` where it lies below that, as on a ball, which
    /// would hide its own light otherwise.
    [[nodiscard]] vec3<T> beside(const vec3<T>& at, const vec3<T>& point, const vec3<T>& normal) const {
        return at + normal * (std::max(T(0), glm::dot(point - at, normal)) + error_);
    }

    /// What is `seen`, spread over the part of its disc that is.
    [[nodiscard]] found within(const disc_cut<T>& cut, const found& seen) const {
        const auto share = [&](T radius) {
            return with_kernel(options_.kernel, [&](const auto& k) { return B(cut.share(radius, k)); });
        };
        const B wide = 1 / share(seen.radius);
        const B level = max_component(seen.value);
        // The bias is told by what half the radius gives, of which less is cut off.
        const B half = (level - seen.bias / 2) / share(seen.radius / 2);
        found made = seen.times(factor_ * wide);
        made.bias = 2 * (level * wide - half) * factor_;
        return made;
    }

    const World& scene_;
    const photon_map<S, T>& map_;
    const density_options& options_;
    T error_;
    const std::vector<char>& left_out_;
    B factor_;
};

}  // namespace aglow::detail
