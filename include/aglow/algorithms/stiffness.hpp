// How hard a scene is: how many bounces its light lives for, and how slowly its parts come to agree.
//
// Particles go from place to place; which eighth of the scene they leave and which they come to makes a small matrix
// of power (Ulam 1960). Its largest eigenvalue is what one bounce leaves of the light, the second one how slowly
// differences between places fade. Both by power iteration.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <aglow/algorithms/path_walk.hpp>
#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/significant.hpp>

namespace aglow {

/// How stiffness is measured.
struct stiffness_options {
    std::size_t paths{4096};          ///< particles followed; at least 1
    std::uint32_t most_bounces{256};  ///< surfaces each is followed over; at least 2
    double wanted_error{0.01};        ///< relative error that a rendering is meant to have
    std::uint64_t seed{0};
};

/// What was measured.
struct stiffness {
    double dominant{0};     ///< share of the light that one more bounce leaves, in the long run; 1 and above never ends
    double second{0};       ///< the second eigenvalue: near `dominant`, parts of the scene hardly exchange light
    std::size_t seen{0};    ///< eighths of the scene that light came to
    double resolution{0};   ///< differences of eigenvalues below this were not seen: three over the bounces followed
    double bounces{0};      ///< bounces after which what is left out is below the wanted error; infinite where never
    double lost_at_cap{0};  ///< share of all light that a depth cap loses, as asked for by the path options
    std::vector<std::string> warnings{};  ///< in words; empty where nothing is to be feared

    /// Whether each bounce takes something away, as far as could be told.
    [[nodiscard]] bool dissipative() const { return dominant + resolution < 1; }
    /// Share of all light that is met after more than `cap` bounces.
    [[nodiscard]] double lost_after(std::uint32_t cap) const {
        return dominant >= 1 ? 1 : std::pow(dominant, static_cast<double>(cap) + 1);
    }
};

namespace detail {

inline constexpr std::size_t eighths = 8;
using power_matrix = std::array<std::array<double, eighths>, eighths>;
using power_vector = std::array<double, eighths>;

/// `m` applied to `v`, row by row.
[[nodiscard]] inline power_vector times(const power_matrix& m, const power_vector& v) {
    power_vector out{};
    for (std::size_t i = 0; i < eighths; ++i) {
        for (std::size_t j = 0; j < eighths; ++j) { out[i] += m[i][j] * v[j]; }
    }
    return out;
}

[[nodiscard]] inline double dot(const power_vector& a, const power_vector& b) {
    double sum = 0;
    for (std::size_t i = 0; i < eighths; ++i) { sum += a[i] * b[i]; }
    return sum;
}

/// Growth of a vector under many products with `m`, kept free of what `left` projects on `right`.
[[nodiscard]] inline double growth(const power_matrix& m, power_vector& v, const power_vector& left,
                                   const power_vector& right) {
    const double norm = dot(left, right);
    const auto cleanse = [&](power_vector& x) {
        const double share = norm != 0 ? dot(left, x) / norm : 0;
        for (std::size_t i = 0; i < eighths; ++i) { x[i] -= share * right[i]; }
    };
    const auto shrink = [](power_vector& x) {
        const double length = std::sqrt(dot(x, x));
        for (double& a : x) { a = length > 0 ? a / length : 0; }
        return length;
    };
    constexpr int rounds = 2048;
    double logarithm = 0;
    int counted = 0;
    for (int i = 0; i < rounds; ++i) {
        cleanse(v);
        if (!(shrink(v) > 1e-200)) { return 0; }
        v = times(m, v);
        const double length = shrink(v);
        if (!(length > 1e-12)) { return 0; }
        // A complex pair turns while it shrinks: the mean over many rounds is its size.
        if (i >= rounds / 2) { logarithm += std::log(length), ++counted; }
    }
    return std::exp(logarithm / counted);
}

/// One step of a particle: from where to where, and what it carried.
template <std::floating_point T>
struct power_step {
    vec3<T> from;
    vec3<T> to;
    double before;
    double after;
};

/// The share of the power that left eighth j and came to eighth i, for all pairs.
template <std::floating_point T>
[[nodiscard]] power_matrix exchange(const std::vector<power_step<T>>& steps, stiffness& result) {
    bounds<T> box;
    for (const auto& s : steps) { box.add(s.from); }
    const vec3<T> middle = box.centre();
    const auto eighth = [&](const vec3<T>& p) {
        return (p.x > middle.x ? 1u : 0u) + (p.y > middle.y ? 2u : 0u) + (p.z > middle.z ? 4u : 0u);
    };
    power_matrix moved{};
    power_vector left{};
    for (const auto& s : steps) {
        left[eighth(s.from)] += s.before;
        moved[eighth(s.to)][eighth(s.from)] += s.after;
    }
    for (std::size_t j = 0; j < eighths; ++j) {
        result.seen += left[j] > 0 ? 1 : 0;
        for (std::size_t i = 0; i < eighths; ++i) { moved[i][j] = left[j] > 0 ? moved[i][j] / left[j] : 0; }
    }
    return moved;
}

/// Puts into words what is to be feared.
inline void warn(stiffness& s, const path_options& paths, double wanted) {
    if (!s.dissipative()) {
        s.warnings.push_back("not dissipative: one bounce leaves " + significant(s.dominant) +
                             " of the light, so no number of bounces is enough");
    }
    if (s.lost_at_cap > wanted) {
        s.warnings.push_back("a cap of " + std::to_string(paths.most_bounces) + " bounces loses " +
                             significant(100 * s.lost_at_cap, 3) + " % of the light; " + std::to_string(s.bounces) +
                             " bounces are needed");
    }
    if (s.bounces > endless_bounces) {
        s.warnings.push_back("photon paths longer than " + std::to_string(endless_bounces) +
                             " surfaces may be cut, which loses " +
                             significant(100 * s.lost_after(endless_bounces), 3) + " % of the light");
    }
    if (s.dominant > 0 && s.second > (1 - wanted) * s.dominant - s.resolution) {
        s.warnings.push_back("parts of the scene hardly exchange light: the second eigenvalue is " +
                             significant(s.second) + " beside " + significant(s.dominant));
    }
}

/// What the steps of many particles tell.
template <std::floating_point T>
[[nodiscard]] stiffness judge(const std::vector<power_step<T>>& steps, const path_options& paths,
                              const stiffness_options& options) {
    stiffness result;
    if (steps.empty()) { return result; }
    const power_matrix m = exchange(steps, result);
    power_matrix transposed{};
    for (std::size_t i = 0; i < eighths; ++i) {
        for (std::size_t j = 0; j < eighths; ++j) { transposed[i][j] = m[j][i]; }
    }
    power_vector right{1, 1, 1, 1, 1, 1, 1, 1};
    power_vector left = right;
    const power_vector none{};
    result.dominant = growth(m, right, none, none);
    (void)growth(transposed, left, none, none);
    power_vector other{1, -0.5, 0.25, -1, 0.75, -0.25, 0.5, -0.75};
    result.second = growth(m, other, left, right);
    result.resolution = 3 / static_cast<double>(steps.size());
    const double wanted = options.wanted_error;
    result.bounces = result.dominant <= 0   ? 0
                     : result.dominant >= 1 ? std::numeric_limits<double>::infinity()
                                            : std::max(0.0, std::log(wanted) / std::log(result.dominant) - 1);
    result.lost_at_cap = paths.most_bounces == 0 ? 0 : result.lost_after(paths.most_bounces);
    warn(result, paths, wanted);
    return result;
}

/// Follows one particle without roulette, so that all of its power is seen; its power starts at one.
template <Scene World, Numbers N, std::floating_point T>
void follow(const World& scene, ray<T> path, const N& numbers, std::uint32_t most_bounces,
            std::vector<power_step<T>>& steps) {
    double power = 1;
    double before = 0;
    vec3<T> from{};
    for (std::uint32_t bounce = 1; bounce <= most_bounces; ++bounce) {
        const auto hit = scene.intersect(path);
        if (hit && !is_sound(*hit, path)) { return; }
        if (bounce > 1) { steps.push_back({from, hit ? vec3<T>(hit->position) : from, before, hit ? power : 0}); }
        if (!hit) { return; }
        from = vec3<T>(hit->position);
        before = power;
        auto random = numbers.at(bounce, purpose::scatter);
        const auto next = hit->sample(vec3<T>(-path.direction), random, lobe_set::all);
        const auto weight = next ? max_component(next->weight) : 0;
        if (!next || !is_radiance(next->weight) || !is_direction(vec3<T>(next->wi)) || !(weight > 0)) {
            steps.push_back({from, from, before, 0});
            return;
        }
        // Relative to what came, so that a long walk neither fades out nor grows beyond numbers.
        before = 1;
        power = static_cast<double>(weight);
        path = {lift(from, vec3<T>(hit->normal), vec3<T>(next->wi), error_of(*hit, path.origin)), next->wi};
    }
}

}  // namespace detail

/// Measures `scene` by particles of `lights`, and with `eye` given also by rays `eye(i)` of the picture, which find
/// rooms that the lights hardly reach. `paths` are the options of the rendering that is meant.
/// Throws `std::invalid_argument` for no paths or fewer than two bounces.
template <Scene World, Emitter Lights, typename Eye>
[[nodiscard]] stiffness measure_stiffness(const World& scene, const Lights& lights, const path_options& paths,
                                          const stiffness_options& options, const Eye& eye) {
    using T = scalar_of<World>;
    if (options.paths == 0 || options.most_bounces < 2) {
        throw std::invalid_argument("stiffness_options ask for " + std::to_string(options.paths) + " paths of " +
                                    std::to_string(options.most_bounces) + " bounces");
    }
    std::vector<detail::power_step<T>> steps;
    for (std::size_t i = 0; i < options.paths; ++i) {
        const random_numbers<T> numbers{{options.seed, 0, i}};
        auto random = numbers.at(0, purpose::emission);
        const ray<T> start = i % 2 == 0 ? ray<T>(lights.emit(random).path) : ray<T>(eye(i / 2));
        detail::follow(scene, start, numbers, options.most_bounces, steps);
    }
    return detail::judge(steps, paths, options);
}
template <Scene World, Emitter Lights>
[[nodiscard]] stiffness measure_stiffness(const World& scene, const Lights& lights, const path_options& paths = {},
                                          const stiffness_options& options = {}) {
    const auto again = [&](std::size_t i) {
        const random_numbers<scalar_of<World>> numbers{{options.seed, 1, i}};
        auto random = numbers.at(0, purpose::emission);
        return ray<scalar_of<World>>(lights.emit(random).path);
    };
    return measure_stiffness(scene, lights, paths, options, again);
}

}  // namespace aglow
