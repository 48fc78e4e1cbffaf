// Where a guided path looks: a few cones at each place, about photons that came over mirrors.
//
// A cone about each photon: Hey & Purgathofer 2002. It is aimed at the point where the photon left the mirror, so that
// it stays on the light's image when the path stands a little aside.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/warp.hpp>

namespace aglow {

/// How well a guide is made: worse ones cost noise, and never the mean.
struct path_guide_options {
    std::size_t photons{5'000};  ///< caustic ones; half as many of those that were reflected once more, and twice as
                                 ///< many of all others, to know how much they are beside
    std::uint32_t cells{32};     ///< along the longest side of the scene, up to 256
    double gain{2};     ///< how many times its share of the light is the chance of a ray to be guided, where few are
    double most{0.75};  ///< the largest such chance, below 1
    std::uint64_t seed{0};
};

namespace detail {

/// Balls to aim at from one cell: from a point there, each fills a cone, sampled evenly by solid angle.
template <std::floating_point T>
struct guide_lobes {
    static constexpr std::size_t room = 24;

    std::array<T, room> x{}, y{}, z{};  ///< centres
    std::array<T, room> radius2{};
    std::array<T, room> share{};  ///< of the guided rays; 1 together
    T chance{0};                  ///< of a ray to be guided

    [[nodiscard]] vec3<T> centre(std::size_t i) const { return {x[i], y[i], z[i]}; }

    /// 1 - cos of the cone of a ball seen from a squared distance; from inside, nearly a hemisphere.
    [[nodiscard]] static T one_minus_cosine(T sine2) { return sine2 / (1 + std::sqrt(1 - sine2)); }
    [[nodiscard]] static T sine2(T radius2, T distance2) { return std::min(radius2, distance2 * T(0.99)) / distance2; }

    /// The lobe that `u` in [0, 1) names, of those that have a share.
    [[nodiscard]] std::size_t choose(T u) const {
        std::size_t chosen = 0;
        for (std::size_t i = 0; i < room && u >= 0; ++i) {
            if (!(share[i] > 0)) { continue; }
            chosen = i;
            u -= share[i];
        }
        return chosen;
    }

    /// A direction from `point` into lobe `i`; empty where it has none, at the centre.
    [[nodiscard]] std::optional<vec3<T>> sample(const vec3<T>& point, std::size_t i, const vec2<T>& u) const {
        const vec3<T> to = centre(i) - point;
        const T d2 = length2(to);
        if (!(d2 > 0)) { return std::nullopt; }
        const vec3<T> local = uniform_cone(u, one_minus_cosine(sine2(radius2[i], d2)));
        return frame<T>{to * (1 / std::sqrt(d2))}.to_world(local);
    }

    /// Density of guided rays from `point` along unit `wi`, per steradian. `own` is the lobe that `wi` was sampled
    /// from, if any: rounding at its rim must not deny it.
    [[nodiscard]] T pdf(const vec3<T>& point, const vec3<T>& wi, std::size_t own = room) const {
        std::array<T, room> sines2;
        std::array<std::uint32_t, room> within;
        for (std::size_t i = 0; i < room; ++i) {
            const T dx = x[i] - point.x;
            const T dy = y[i] - point.y;
            const T dz = z[i] - point.z;
            const T d2 = dx * dx + dy * dy + dz * dz;
            const T along = dx * wi.x + dy * wi.y + dz * wi.z;
            // Not d2 - along * along, of which little is left in a narrow cone.
            const T aside2 = square(dx - along * wi.x) + square(dy - along * wi.y) + square(dz - along * wi.z);
            const T most = d2 * T(0.99);
            const T inner = radius2[i] < most ? radius2[i] : most;
            sines2[i] = inner / d2;
            within[i] = along > 0 && aside2 < inner ? 1u : 0u;
        }
        if (own < room) { within[own] = 1; }
        T sum = 0;
        for (std::size_t i = 0; i < room; ++i) {
            if (within[i] != 0 && share[i] > 0) { sum += share[i] * uniform_cone_pdf(one_minus_cosine(sines2[i])); }
        }
        return sum;
    }
};

/// Cells of a box, and in each six sides that a surface may face.
template <std::floating_point T>
struct guide_grid {
    vec3<T> low{};
    T per_length{0};
    std::array<std::uint32_t, 3> counts{1, 1, 1};

    guide_grid() = default;
    guide_grid(const bounds<T>& box, std::uint32_t cells) : low{box.low} {
        const vec3<T> e = box.extent();
        const T longest = std::max({e.x, e.y, e.z});
        if (!(longest > 0)) { return; }
        per_length = static_cast<T>(std::max(1u, cells)) / longest;
        for (int axis = 0; axis < 3; ++axis) {
            counts[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(e[axis] * per_length) + 1;
        }
    }

    [[nodiscard]] std::size_t size() const { return std::size_t{6} * counts[0] * counts[1] * counts[2]; }

    /// Calls `visit(cell, beside)` for each cell and the cells of the same side that share a face with it.
    template <typename Visit>
    void for_each_beside(const Visit& visit) const {
        std::size_t step = 6;
        for (const std::uint32_t count : counts) {
            for (std::size_t i = 0; i < size(); ++i) {
                const std::size_t along = i / step % count;
                if (along > 0) { visit(i, i - step); }
                if (along + 1 < count) { visit(i, i + step); }
            }
            step *= count;
        }
    }

    /// Expects a finite point; what lies outside is in the nearest cell.
    [[nodiscard]] std::uint32_t index(const vec3<T>& point, const vec3<T>& normal) const {
        const vec3<T> at = (point - low) * per_length;
        const auto cell = [](T x, std::uint32_t count) {
            return std::min(x > 0 ? static_cast<std::uint32_t>(std::min(x, T(1 << 20))) : 0u, count - 1);
        };
        const std::uint32_t place =
            (cell(at.z, counts[2]) * counts[1] + cell(at.y, counts[1])) * counts[0] + cell(at.x, counts[0]);
        const vec3<T> a{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
        const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
        return 6 * place + 2 * static_cast<std::uint32_t>(axis) + (normal[axis] < 0 ? 1u : 0u);
    }
};

/// A photon that came over a mirror.
template <std::floating_point T>
struct mirrored_photon {
    vec3<T> position{};
    vec3<T> normal{};
    vec3<T> wi{};
    T distance{};  ///< to the mirror
    T power{};
};

/// Makes the lobes of one cell out of the photons nearest to its middle.
template <std::floating_point T>
class guide_maker {
public:
    static constexpr std::size_t room = guide_lobes<T>::room;

    guide_maker(const std::vector<mirrored_photon<T>>& photons, T far, const path_guide_options& options)
        : photons_{photons},
          tree_{photons, [](const mirrored_photon<T>& p) { return p.position; }},
          far_{far},
          options_{options} {}

    /// Lobes at `point`, where all other photons bring `rest` W/m²; without a chance where none is worth it.
    [[nodiscard]] guide_lobes<T> at(const vec3<T>& point, const vec3<T>& normal, T rest) const {
        kd_scratch<T> scratch;
        const auto accept = [&](kd_slot slot) {
            const mirrored_photon<T>& p = photons_[tree_.order()[slot]];
            const vec3<T> away = p.position - point;
            return glm::dot(p.normal, normal) > T(0.8) && square(10 * glm::dot(away, normal)) <= length2(away);
        };
        const auto found = tree_.nearest(point, room, scratch, {}, accept);
        guide_lobes<T> lobes;
        if (found.size() < room) { return lobes; }
        const T area = pi<T> * found.radius2;
        const T reach = std::sqrt(found.radius2);
        std::array<vec3<T>, room> along;
        for (std::size_t i = 0; i < room; ++i) {
            const mirrored_photon<T>& p = photons_[tree_.order()[found.slots[i]]];
            // A mirror near by is seen elsewhere from each place: there the directions last, and else the image.
            const bool near = p.distance < 3 * reach;
            const vec3<T> to = near ? p.wi : p.position + p.wi * p.distance - point;
            along[i] = glm::normalize(to);
            const vec3<T> centre = point + along[i] * (near ? far_ : glm::length(to));
            lobes.x[i] = centre.x;
            lobes.y[i] = centre.y;
            lobes.z[i] = centre.z;
            lobes.share[i] = p.power / area;
        }
        widen(lobes, along, point);
        choose(lobes, point, normal, rest);
        return lobes;
    }

private:
    static constexpr std::size_t overlap = 3;  ///< other photons that the cone about each reaches

    static void widen(guide_lobes<T>& lobes, const std::array<vec3<T>, room>& along, const vec3<T>& point) {
        for (std::size_t i = 0; i < room; ++i) {
            std::array<T, room> cosines;
            for (std::size_t j = 0; j < room; ++j) { cosines[j] = glm::dot(along[i], along[j]); }
            std::nth_element(cosines.begin(), cosines.begin() + overlap, cosines.end(), [](T a, T b) { return a > b; });
            const T cosine = std::max(T(0), cosines[overlap]);
            const T sine2 = std::clamp(T(1.5) * (1 - cosine * cosine), T(1e-4), T(0.99));
            lobes.radius2[i] = sine2 * length2(lobes.centre(i) - point);
        }
    }

    /// Keeps lobes that are brighter than what else arrives, and shares the rays out.
    void choose(guide_lobes<T>& lobes, const vec3<T>& point, const vec3<T>& normal, T rest) const {
        std::size_t kept = 0;
        T worth = 0;
        for (std::size_t i = 0; i < room; ++i) {
            const vec3<T> to = lobes.centre(i) - point;
            const T d2 = length2(to);
            const T cosine = std::max(T(0.1), std::abs(glm::dot(to, normal)) / std::sqrt(d2));
            const T angle = 2 * pi<T> * lobes.one_minus_cosine(lobes.sine2(lobes.radius2[i], d2));
            const T light = lobes.share[i];
            const bool bright = pi<T> * static_cast<T>(overlap + 1) * light >= rest * cosine * angle;
            (bright ? worth : rest) += light;
            if (!bright) { continue; }
            for (auto* of : {&lobes.x, &lobes.y, &lobes.z, &lobes.radius2, &lobes.share}) { (*of)[kept] = (*of)[i]; }
            ++kept;
        }
        for (auto* of : {&lobes.x, &lobes.y, &lobes.z}) { std::fill(of->begin() + kept, of->end(), far_); }
        std::fill(lobes.radius2.begin() + kept, lobes.radius2.end(), T(0));
        std::fill(lobes.share.begin() + kept, lobes.share.end(), T(0));
        // Of photons that all landed at one point there is no density.
        if (!(worth > 0 && is_finite(worth))) { return; }
        for (T& share : lobes.share) { share = share / worth; }
        const T more = static_cast<T>(options_.gain) * worth;
        if (!(more > 0)) { return; }
        lobes.chance = std::min(static_cast<T>(options_.most), more / (more + rest));
    }

    const std::vector<mirrored_photon<T>>& photons_;
    kd_tree<T> tree_;
    T far_;
    path_guide_options options_;
};

}  // namespace detail

}  // namespace aglow
