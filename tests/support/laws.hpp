// The laws that a host's types must keep, as checks for any test framework.
//
// A concept says what compiles; these say what must be true. Copy this header and statistics.hpp beside your tests, put
// aglow's include folder on the path, and call in your own framework:
//
//     const laws::verdict v = laws::surface(my_hit);
//     REQUIRE_MESSAGE(v.ok, v.message);          // or: if (!v) { std::puts(v.message.c_str()); return 1; }
//
//     laws::sampler(make)                        make(i): the sampler of stream i
//     laws::surface(hit)                         a hit on your material; do one for each kind
//     laws::intersector(scene, box)              rays start in the box
//     laws::emitter(light, power)                power: what it sends out in all, in watts
//     laws::illuminator(light, scene, p, n, E)   E: the direct irradiance at p on the side of n, in W/m²
//     laws::illuminator_meets_rays(light, scene, p, n)    the same against rays that meet what glows: no E needed
//
// Every check has its options last, all with defaults. Chance is bounded: the seeds are fixed, and with other seeds a
// lawful type is refused about once in a thousand calls. The first law that is broken is told, with its figures.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <ostream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/concepts/surface.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/warp.hpp>

#include "statistics.hpp"

namespace laws {

using aglow::lobe_set;
using aglow::max_component;
using aglow::vec3;

/// Whether the laws were kept; else the first that was not, with its figures.
struct verdict {
    bool ok{true};
    std::string message{};
    explicit operator bool() const { return ok; }
};

struct sampler_options {
    std::size_t streams{20'000};  ///< how many samplers are made; each is asked for two pairs and one number
    double least_p{1e-4};         ///< below which a χ² test refuses
};

struct surface_options {
    std::size_t samples{20'000};  ///< per outgoing direction and set of lobes
    int grid{64};                 ///< steps of quadrature a quarter turn, a multiple of 16; more for very narrow lobes
    std::uint64_t seed{1};        ///< of the samples
    double sigmas{4.5};           ///< of a mean
    double least_p{1e-5};         ///< below which a χ² test refuses
    double tolerance{4e-3};       ///< relative, where two computations of one number are compared
    double albedo_slack{2e-3};    ///< by how much an albedo may be above one
};

struct intersector_options {
    std::size_t rays{4096};      ///< how many are shot
    std::uint64_t seed{1};       ///< of the rays
    double grazing_share{1e-3};  ///< of rays that may disagree: they pass an edge within the rounding
    unsigned threads{4};         ///< that ask the same at once
};

struct light_options {
    std::size_t samples{100'000};  ///< how often the light is asked
    std::uint64_t seed{1};         ///< of the samples
    double sigmas{4.5};            ///< of a mean
    double tolerance{2e-3};        ///< relative, beside chance
};

namespace detail {

template <typename T>
void put(std::ostream& out, const T& part) {
    out << part;
}
template <typename T>
void put(std::ostream& out, const vec3<T>& v) {
    out << '(' << v.x << ' ' << v.y << ' ' << v.z << ')';
}

template <typename T>
struct where_pair {
    vec3<T> wo;
    vec3<T> wi;
};
template <typename T>
void put(std::ostream& out, const where_pair<T>& where) {
    put(out << " (wo ", where.wo);
    put(out << ", wi ", where.wi);
    out << ')';
}

template <typename T>
struct where_ray {
    aglow::ray<T> shot;
    vec3<T> hit;
};
template <typename T>
void put(std::ostream& out, const where_ray<T>& where) {
    put(out << " (from ", where.shot.origin);
    put(out << " along ", where.shot.direction);
    put(out << ", hit at ", where.hit);
    out << ')';
}

/// Holds the first law that was broken. Nothing is made into text before.
class checks {
public:
    template <typename... Parts>
    void require(bool kept, const Parts&... parts) {
        if (kept || !verdict_.ok) { return; }
        std::ostringstream out;
        (put(out, parts), ...);
        verdict_ = {false, out.str()};
    }
    [[nodiscard]] bool ok() const { return verdict_.ok; }
    [[nodiscard]] const verdict& result() const { return verdict_; }

private:
    verdict verdict_{};
};

template <typename T>
bool is_unit(const vec3<T>& v) {
    return std::abs(double(aglow::length2(v)) - 1) < 1e-4;
}

template <aglow::Spectrum S>
double largest(const S& a) {
    return double(max_component(a));
}

/// The largest difference of any two bands.
template <aglow::Spectrum S>
double difference(const S& a, const S& b) {
    const aglow::band_of<S> minus(-1);
    return std::max(largest(S(a + S(b * minus))), largest(S(b + S(a * minus))));
}

/// The mean of spectra. `spread` is the largest standard error of any band.
template <aglow::Spectrum S>
class spectrum_mean {
public:
    void add(const S& a) {
        sum_ = sum_ + a;
        squares_ = squares_ + S(a * a);
        ++n_;
    }
    [[nodiscard]] S mean() const { return sum_ * share(); }
    [[nodiscard]] double spread() const {
        const S m = mean();
        const S variance = S(squares_ * share()) + S(S(m * m) * aglow::band_of<S>(-1));
        return std::sqrt(std::max(0.0, largest(variance)) / double(n_));
    }

private:
    [[nodiscard]] aglow::band_of<S> share() const { return aglow::band_of<S>(1 / double(n_)); }
    S sum_{};
    S squares_{};
    std::size_t n_{0};
};

template <aglow::Spectrum S>
void require_mean(checks& law, const std::string& what, const spectrum_mean<S>& found, const S& truth, double sigmas,
                  double slack) {
    const double off = difference(found.mean(), truth);
    const double allowed = sigmas * found.spread() + slack;
    law.require(off <= allowed, what, ": mean ", largest(found.mean()), ", should be ", largest(truth),
                "; largest difference ", off, ", allowed ", allowed);
}

constexpr std::array<lobe_set, 6> single_lobes{lobe_set::diffuse_reflection,  lobe_set::glossy_reflection,
                                               lobe_set::specular_reflection, lobe_set::diffuse_transmission,
                                               lobe_set::glossy_transmission, lobe_set::specular_transmission};

inline bool is_single(lobe_set a) {
    return std::find(single_lobes.begin(), single_lobes.end(), a) != single_lobes.end();
}
inline bool is_specular(lobe_set a) { return any(a, lobe_set::specular); }
inline int number(lobe_set a) { return static_cast<int>(a); }

/// Directions over the whole sphere around a normal, in cells for counting.
template <typename T>
struct sphere_cells {
    static constexpr int rows = 16;
    static constexpr int columns = 16;

    aglow::frame<T> around;

    [[nodiscard]] vec3<T> direction(double theta, double phi) const {
        const double r = std::sin(theta);
        return around.to_world({T(r * std::cos(phi)), T(r * std::sin(phi)), T(std::cos(theta))});
    }
    [[nodiscard]] std::size_t cell(const vec3<T>& w) const {
        const vec3<T> local = around.to_local(w);
        const double theta = std::atan2(std::hypot(double(local.x), double(local.y)), double(local.z));
        const double phi = std::atan2(double(local.y), double(local.x)) / (2 * aglow::pi<double>);
        const int row = std::clamp(static_cast<int>(theta / aglow::pi<double> * rows), 0, rows - 1);
        const int column = std::clamp(static_cast<int>((phi < 0 ? phi + 1 : phi) * columns), 0, columns - 1);
        return static_cast<std::size_t>(row * columns + column);
    }
};

template <typename S>
struct scattering_integral {
    S weight{};                     ///< ∫ f |cos|
    std::vector<double> density{};  ///< ∫ pdf in each cell
};

/// ∫ f |cos| and ∫ pdf over the sphere by the midpoint rule, `grid` steps a quarter turn.
template <aglow::Surface H, typename T = aglow::hit_scalar<H>, typename S = aglow::surface_spectrum<H>>
scattering_integral<S> integrate(const H& hit, const vec3<T>& wo, lobe_set asked, const sphere_cells<T>& cells,
                                 int grid) {
    constexpr int rows = sphere_cells<T>::rows;
    constexpr int columns = sphere_cells<T>::columns;
    scattering_integral<S> result;
    result.density.resize(rows * columns);
    const double step = aglow::pi<double> / (2 * grid);
    for (int i = 0; i < 2 * grid; ++i) {
        const double theta = (i + 0.5) * step;
        const double area = step * step * std::sin(theta);
        S row{};
        for (int j = 0; j < 4 * grid; ++j) {
            const vec3<T> wi = cells.direction(theta, (j + 0.5) * step);
            row = row + S(hit.evaluate(wo, wi, asked));
            const int cell = i * rows / (2 * grid) * columns + j * columns / (4 * grid);
            result.density[static_cast<std::size_t>(cell)] += double(hit.pdf(wo, wi, asked)) * area;
        }
        result.weight = result.weight + S(row * aglow::band_of<S>(std::abs(std::cos(theta)) * area));
    }
    return result;
}

/// What many samples of one outgoing direction and set of lobes came to.
template <typename S>
struct sample_sums {
    spectrum_mean<S> smooth{};     ///< weights, specular ones as black
    spectrum_mean<S> power{};      ///< all weights, as light carries them
    std::vector<double> counts{};  ///< smooth ones in each cell of the sphere; specular and empty ones in one more
};

/// One sample is of a lobe that was asked for, on that lobe's side, unit, and may be summed.
template <aglow::Surface H, typename Sample, typename T = aglow::hit_scalar<H>>
void check_lobe(checks& law, const H& hit, const vec3<T>& wo, lobe_set asked, const Sample& s,
                const std::string& where) {
    const vec3<T> wi = s->wi;
    const lobe_set lobe = s->lobe;
    law.require(is_single(lobe), "sample: not one lobe, but the set ", number(lobe), where);
    law.require(any(lobe, asked & hit.lobes()), "sample: lobe ", number(lobe), " was not asked for or is not there",
                where);
    law.require(aglow::is_radiance(s->weight), "sample: the weight is negative, infinite or NaN", where);
    law.require(is_unit(wi), "sample: wi is not unit: ", wi, where);
    const T side = glm::dot(wi, vec3<T>(hit.normal)) * glm::dot(wo, vec3<T>(hit.normal));
    law.require(std::abs(side) < T(1e-4) || (side > 0) == any(lobe, lobe_set::reflection), "sample: lobe ",
                number(lobe), " on the wrong side, wi ", wi, where);
}

/// One smooth sample is of one mind with `pdf` and `evaluate`.
template <aglow::Surface H, typename Sample, typename T = aglow::hit_scalar<H>>
void check_density(checks& law, const H& hit, const vec3<T>& wo, lobe_set asked, const Sample& s, double tolerance,
                   const std::string& where) {
    using S = aglow::surface_spectrum<H>;
    const vec3<T> wi = s->wi;
    const double cosine = std::abs(double(glm::dot(wi, vec3<T>(hit.normal))));
    // At the horizon the rounding of wi decides the side and the cosine.
    if (cosine < 10 * std::sqrt(double(std::numeric_limits<T>::epsilon()))) { return; }
    const double pdf = double(s->pdf);
    law.require(pdf > 0 && aglow::is_finite(pdf), "sample: pdf = ", pdf, where);
    const double again = double(hit.pdf(wo, wi, asked));
    law.require(std::abs(again - pdf) <= tolerance * pdf, "sample and pdf disagree: ", pdf, " and ", again, ", wi ", wi,
                where);
    const S f_cos = hit.evaluate(wo, wi, asked) * aglow::band_of<S>(cosine);
    const S claimed = s->weight * aglow::band_of<S>(pdf);
    law.require(difference(f_cos, claimed) <= tolerance * largest(f_cos) + 1e-6,
                "sample and evaluate disagree: weight pdf = ", largest(claimed), ", f cos = ", largest(f_cos), ", wi ",
                wi, where);
}

/// Draws the samples, each checked by itself.
template <aglow::Surface H, typename T = aglow::hit_scalar<H>, typename S = aglow::surface_spectrum<H>>
sample_sums<S> draw(checks& law, const H& hit, const vec3<T>& wo, lobe_set asked, const sphere_cells<T>& cells,
                    const surface_options& options, const std::string& where) {
    sample_sums<S> sums;
    sums.counts.resize(sphere_cells<T>::rows * sphere_cells<T>::columns + 1);
    for (std::size_t i = 0; i < options.samples && law.ok(); ++i) {
        const aglow::path_key key{options.seed, static_cast<std::uint64_t>(asked), i};
        aglow::random_sampler<T> random{mix(key, 0, aglow::purpose::host)};
        const auto s = hit.sample(wo, random, asked);
        if (s) {
            check_lobe(law, hit, wo, asked, s, where);
            const auto as_power = aglow::band_of<S>(aglow::adjoint(hit, wo, vec3<T>(s->wi)));
            sums.power.add(s->weight * as_power);
        } else {
            sums.power.add(S{});
        }
        if (!s || any(s->lobe, lobe_set::specular)) {
            sums.smooth.add(S{});
            sums.counts.back() += 1;
            continue;
        }
        check_density(law, hit, wo, asked, s, options.tolerance, where);
        sums.smooth.add(s->weight);
        sums.counts[cells.cell(vec3<T>(s->wi))] += 1;
    }
    return sums;
}

/// Counts of directions against the integral of the density over each cell; the last count is of no smooth direction.
inline void check_directions(checks& law, std::vector<double> counts, const std::vector<double>& density,
                             const surface_options& options, const std::string& where) {
    double within = 0;
    std::vector<double> expected;
    for (const double share : density) {
        within += share;
        expected.push_back(share * double(options.samples));
    }
    law.require(within <= 1 + options.tolerance, "pdf integrates to ", within, ", above one", where);
    expected.push_back((1 - within) * double(options.samples));
    // A share within the error of quadrature is no share to expect.
    if (1 - within < options.tolerance) {
        law.require(counts.back() <= 2 * options.tolerance * double(options.samples), "sample: empty or specular ",
                    counts.back(), " times, though pdf integrates to one", where);
        expected.pop_back();
        counts.pop_back();
    }
    const auto chi2 = statistics::chi2_test(counts, expected);
    law.require(chi2.p >= options.least_p, "directions do not follow pdf: chi2 = ", chi2.chi2, " with ", chi2.degrees,
                " degrees of freedom, p = ", chi2.p, where);
}

/// Samples of one direction and set of lobes against their density and their integral.
template <aglow::Surface H, typename T = aglow::hit_scalar<H>>
void check_scattering(checks& law, const H& hit, const vec3<T>& wo, lobe_set asked, const surface_options& options) {
    std::ostringstream place;
    put(place << " (wo ", wo);
    place << ", lobes asked " << number(asked) << ')';
    const std::string where = place.str();
    const sphere_cells<T> cells{aglow::frame<T>{vec3<T>(hit.normal)}};
    const auto sums = draw(law, hit, wo, asked, cells, options, where);
    if (!law.ok()) { return; }
    const auto exact = integrate(hit, wo, asked, cells, options.grid);
    const auto coarse = integrate(hit, wo, asked, cells, options.grid / 2);
    const double quadrature = 2 * difference(exact.weight, coarse.weight) + 1e-4 * largest(exact.weight);
    require_mean(law, "mean weight is not the integral of f cos" + where, sums.smooth, exact.weight, options.sigmas,
                 quadrature);
    const double albedo = largest(sums.power.mean());
    law.require(albedo <= 1 + options.albedo_slack + options.sigmas * sums.power.spread(), "albedo above one: ", albedo,
                where);
    check_directions(law, sums.counts, exact.density, options, where);
}

/// Pairs of directions: reciprocity, additivity over the lobes, and nothing where nothing is asked.
template <aglow::Surface H>
void check_pairs(checks& law, const H& hit, const surface_options& options) {
    using T = aglow::hit_scalar<H>;
    using S = aglow::surface_spectrum<H>;
    aglow::random_sampler<T> random{aglow::mix(options.seed)};
    const vec3<T> normal = hit.normal;
    for (int i = 0; i < 2000 && law.ok(); ++i) {
        const vec3<T> wo = aglow::uniform_sphere(random.next_2d());
        const vec3<T> wi = aglow::uniform_sphere(random.next_2d());
        const where_pair<T> where{wo, wi};
        const S f = hit.evaluate(wo, wi, lobe_set::all);
        law.require(aglow::is_radiance(f), "evaluate: negative, infinite or NaN", where);
        const double density = double(hit.pdf(wo, wi, lobe_set::all));
        law.require(aglow::is_finite(density) && density >= 0, "pdf = ", density, where);
        law.require(hit.evaluate(wo, wi, lobe_set::none) == S{}, "evaluate of no lobes is not black", where);
        law.require(!(hit.pdf(wo, wi, lobe_set::none) > 0), "pdf of no lobes is not 0", where);
        law.require(!hit.sample(wo, random, lobe_set::none), "sample of no lobes is not empty", where);
        S sum{};
        for (const lobe_set lobe : single_lobes) {
            const S alone = hit.evaluate(wo, wi, lobe);
            law.require(!is_specular(lobe) || alone == S{}, "evaluate of a specular lobe is not black", where);
            law.require(any(hit.lobes(), lobe) || alone == S{}, "evaluate of lobe ", number(lobe),
                        ", which is not in lobes(), is not black", where);
            sum = sum + alone;
        }
        law.require(difference(f, sum) <= options.tolerance * largest(f) + 1e-6,
                    "evaluate of all lobes is not the sum over the lobes: ", largest(f), " and ", largest(sum), where);
        if (std::abs(glm::dot(wo, normal)) < T(0.01) || std::abs(glm::dot(wi, normal)) < T(0.01)) { continue; }
        const S back = hit.evaluate(wi, wo, lobe_set::all);
        const S forth = f * aglow::band_of<S>(aglow::adjoint(hit, wo, wi));
        law.require(difference(back, forth) <= options.tolerance * largest(back) + 1e-6,
                    "not reciprocal: f(wi, wo) = ", largest(back), ", f(wo, wi) adjoint = ", largest(forth), where);
    }
}

}  // namespace detail

/// A `Sampler`: every number in [0, 1), uniform one by one and in pairs. `make(i)` gives the sampler of stream i.
template <typename Make>
verdict sampler(Make&& make, const sampler_options& options = {}) {
    detail::checks law;
    statistics::sample_mean mean;
    std::vector<double> line(64);
    std::vector<double> square(16 * 16);
    const auto in_range = [&](double u) {
        law.require(u >= 0 && u < 1, "sampler: ", u, " is not in [0, 1)");
        mean.add(u);
        return law.ok();
    };
    const auto cell_of = [](double u, std::size_t cells) {
        return std::min(static_cast<std::size_t>(u * double(cells)), cells - 1);
    };
    for (std::size_t i = 0; i < options.streams && law.ok(); ++i) {
        auto random = make(i);
        static_assert(aglow::Sampler<decltype(random)>);
        const double u = double(random.next_1d());
        if (!in_range(u)) { break; }
        line[cell_of(u, 64)] += 1;
        for (int k = 0; k < 2; ++k) {
            const auto pair = random.next_2d();
            if (!in_range(double(pair.x)) || !in_range(double(pair.y))) { break; }
            square[cell_of(double(pair.x), 16) * 16 + cell_of(double(pair.y), 16)] += 1;
        }
    }
    law.require(mean.agrees(0.5, 4.5), "sampler: mean ", mean.mean(), ", should be 0.5 (z = ", mean.z(0.5), ")");
    const auto line_test = statistics::chi2_uniform(line);
    law.require(line_test.p >= options.least_p, "sampler: next_1d is not uniform, p = ", line_test.p);
    const auto square_test = statistics::chi2_uniform(square);
    law.require(square_test.p >= options.least_p, "sampler: next_2d is not uniform, p = ", square_test.p);
    return law.result();
}

/// A `Surface` at one place: reciprocity up to `adjoint`, albedo at most one, mean weight = ∫ f |cos| dω by quadrature,
/// directions that follow `pdf` (χ²), and lobes that are honoured. Six outgoing directions, both
/// sides; some tenths of a second.
template <aglow::Surface H>
verdict surface(const H& hit, const surface_options& options = {}) {
    using T = aglow::hit_scalar<H>;
    detail::checks law;
    law.require(detail::is_unit(vec3<T>(hit.normal)), "the normal is not unit");
    detail::check_pairs(law, hit, options);

    std::vector<lobe_set> sets;
    const auto ask = [&](lobe_set asked) {
        const bool there = std::any_of(sets.begin(), sets.end(),
                                       [&](lobe_set s) { return (s & hit.lobes()) == (asked & hit.lobes()); });
        if (any(asked, hit.lobes()) && !there) { sets.push_back(asked); }
    };
    for (const lobe_set set : {lobe_set::all, lobe_set::smooth, lobe_set::reflection, lobe_set::transmission}) {
        ask(set);
    }
    for (const lobe_set lobe : detail::single_lobes) { ask(lobe); }

    const detail::sphere_cells<T> around{aglow::frame<T>{vec3<T>(hit.normal)}};
    for (const double theta : {0.1, 0.8, 1.3, 1.9, 2.4, 3.0}) {
        const vec3<T> wo = around.direction(theta, 1 + theta);
        for (const lobe_set asked : sets) {
            if (law.ok()) { detail::check_scattering(law, hit, wo, asked, options); }
        }
    }
    return law.result();
}

namespace detail {

template <typename T>
aglow::ray<T> ray_in(const aglow::bounds<T>& box, std::uint64_t seed, std::size_t i) {
    aglow::random_sampler<T> random{mix({seed, 0, i}, 0, aglow::purpose::host)};
    const aglow::vec2<T> u = random.next_2d();
    const vec3<T> origin = box.low + box.extent() * vec3<T>{u.x, u.y, random.next_1d()};
    return {origin, aglow::uniform_sphere(random.next_2d())};
}

/// What a scene answers to one ray, for comparing bit by bit.
template <typename T>
struct answer {
    bool hit{false};
    bool occluded{false};
    vec3<T> position{};
    vec3<T> normal{};
    bool operator==(const answer&) const = default;
};

template <aglow::Intersector Scene, typename T = aglow::scalar_of<Scene>>
answer<T> ask(const Scene& scene, const aglow::ray<T>& r, const vec3<T>& other) {
    const bool occluded = scene.occluded(r.origin, other);
    const auto found = scene.intersect(r);
    if (!found) { return {false, occluded}; }
    return {true, occluded, vec3<T>(found->position), vec3<T>(found->normal)};
}

/// One ray: its hit lies on it, is the nearest, and is seen from where it was shot. Returns whether all agree.
template <aglow::Intersector Scene, typename T = aglow::scalar_of<Scene>>
bool check_ray(checks& law, const Scene& scene, const aglow::ray<T>& r) {
    const auto found = scene.intersect(r);
    if (!found) { return true; }
    const vec3<T> p = found->position;
    const vec3<T> n = found->normal;
    const where_ray<T> where{r, p};
    const T t = glm::dot(p - r.origin, r.direction);
    const T error = aglow::error_of(*found, r.origin);
    law.require(aglow::is_finite(t) && t >= -error, "intersect: the hit lies behind the origin", where);
    law.require(glm::length(r.origin + r.direction * t - p) <= 4 * error, "intersect: the hit lies ",
                double(glm::length(r.origin + r.direction * t - p)), " off the ray, allowed ", double(4 * error),
                where);
    law.require(is_unit(n), "intersect: the normal ", n, " is not unit", where);
    if constexpr (aglow::Surface<aglow::hit_of<Scene>>) {
        law.require(!any(found->lobes() & ~aglow::possible_lobes(scene)),
                    "possible_lobes: a hit has lobes that the scene says it cannot have", where);
    }
    // Flat to the ray, a place and its depth say little of each other.
    const T facing = std::abs(glm::dot(n, r.direction));
    if (facing < T(0.05) || t < 100 * error) { return true; }
    const T slack = 8 * error / facing;

    const bool nothing_nearer = !scene.intersect({r.origin, r.direction, t - slack});
    const auto again = scene.intersect({r.origin, r.direction, t + slack});
    const bool same = again && glm::length(vec3<T>(again->position) - p) <= 2 * slack;
    const vec3<T> lifted = aglow::lift(p, n, -r.direction, 4 * error);
    const vec3<T> back = r.origin - lifted;
    const T distance = glm::length(back);
    const bool free_back = !scene.intersect({lifted, back / distance, distance - slack});
    const bool seen = !scene.occluded(lifted, r.origin) && !scene.occluded(r.origin, lifted);
    return nothing_nearer && same && free_back && seen;
}

/// Whether what a ray meets has the same normal where it is met from behind too, if it is.
template <aglow::Intersector Scene, typename T = aglow::scalar_of<Scene>>
bool keeps_normal(const Scene& scene, const aglow::ray<T>& r) {
    const auto found = scene.intersect(r);
    if (!found) { return true; }
    const vec3<T> p = found->position;
    const vec3<T> n = found->normal;
    const T facing = std::abs(glm::dot(n, r.direction));
    if (facing < T(0.05)) { return true; }
    const T slack = 8 * aglow::error_of(*found, r.origin) / facing;
    const auto behind = scene.intersect({p + r.direction * (2 * slack), -r.direction, 4 * slack});
    if (!behind || glm::length(vec3<T>(behind->position) - p) > slack) { return true; }
    return glm::dot(n, vec3<T>(behind->normal)) > 0;
}

/// Two points: the answer is the same from both, and `intersect` gives it too.
template <aglow::Intersector Scene, typename T = aglow::scalar_of<Scene>>
bool check_segment(const Scene& scene, const vec3<T>& a, const vec3<T>& b) {
    const bool forth = scene.occluded(a, b);
    const bool back = scene.occluded(b, a);
    const T distance = glm::length(b - a);
    const bool met = static_cast<bool>(scene.intersect({a, (b - a) / distance, distance}));
    return forth == back && forth == met;
}

}  // namespace detail

/// An `Intersector`: hits on the ray, with unit normals that are the same from both sides, the nearest ones (told by
/// shooting again, forth and back); `occluded` symmetric and of one mind with `intersect`; the same answers, bit by
/// bit, from several threads at once. Rays start evenly in `box`.
template <aglow::Intersector Scene>
verdict intersector(const Scene& scene, const aglow::bounds<aglow::scalar_of<Scene>>& box,
                    const intersector_options& options = {}) {
    using T = aglow::scalar_of<Scene>;
    detail::checks law;
    std::size_t hits = 0;
    std::size_t rays_at_odds = 0;
    std::size_t normals_at_odds = 0;
    std::size_t segments_at_odds = 0;
    std::vector<detail::answer<T>> answers(options.rays);
    const auto ray_of = [&](std::size_t i) { return detail::ray_in(box, options.seed, i); };
    const auto end_of = [&](std::size_t i) { return detail::ray_in(box, options.seed + 1, i).origin; };
    for (std::size_t i = 0; i < options.rays && law.ok(); ++i) {
        answers[i] = detail::ask(scene, ray_of(i), end_of(i));
        hits += answers[i].hit ? 1 : 0;
        rays_at_odds += detail::check_ray(law, scene, ray_of(i)) ? 0 : 1;
        normals_at_odds += detail::keeps_normal(scene, ray_of(i)) ? 0 : 1;
        segments_at_odds += detail::check_segment(scene, ray_of(i).origin, end_of(i)) ? 0 : 1;
    }
    const auto few = static_cast<std::size_t>(options.grazing_share * double(options.rays));
    law.require(hits > 0, "intersect: not one of ", options.rays, " rays hits anything: nothing is shown");
    law.require(rays_at_odds <= few, "intersect: ", rays_at_odds, " of ", hits,
                " hits are not the nearest, or not seen from where they were shot");
    law.require(normals_at_odds <= few, "intersect: ", normals_at_odds, " of ", hits,
                " normals turn to where the ray comes from: they must be the same from both sides");
    law.require(segments_at_odds <= few, "occluded: ", segments_at_odds, " of ", options.rays,
                " answers are not symmetric, or differ from intersect's");
    if (!law.ok()) { return law.result(); }

    std::vector<std::size_t> differing(options.threads);
    {
        std::vector<std::jthread> crew;
        for (unsigned thread = 0; thread < options.threads; ++thread) {
            crew.emplace_back([&, thread] {
                for (std::size_t i = 0; i < options.rays; ++i) {
                    const bool same = detail::ask(scene, ray_of(i), end_of(i)) == answers[i];
                    differing[thread] += same ? 0 : 1;
                }
            });
        }
    }
    for (const std::size_t n : differing) {
        law.require(n == 0, "from several threads at once ", n, " of ", options.rays, " answers differ");
    }
    return law.result();
}

/// An `Emitter`: powers that may be summed, unit directions, and a mean power of `power` watts.
template <aglow::Emitter Light, aglow::Spectrum S>
verdict emitter(const Light& light, const S& power, const light_options& options = {}) {
    using T = aglow::scalar_of<Light>;
    detail::checks law;
    detail::spectrum_mean<S> mean;
    for (std::size_t i = 0; i < options.samples && law.ok(); ++i) {
        aglow::random_sampler<T> random{mix({options.seed, 0, i}, 0, aglow::purpose::emission)};
        const auto particle = light.emit(random);
        const aglow::ray<T> path = particle.path;
        const S carried = particle.power;
        law.require(aglow::is_radiance(carried), "emit: the power is negative, infinite or NaN");
        law.require(detail::is_unit(path.direction), "emit: the direction ", path.direction, " is not unit");
        law.require(aglow::is_finite(path.origin.x + path.origin.y + path.origin.z), "emit: the origin ", path.origin,
                    " is not finite");
        mean.add(carried);
    }
    const double slack = options.tolerance * detail::largest(power);
    detail::require_mean(law, "emit: mean power is not the light's", mean, power, options.sigmas, slack);
    return law.result();
}

namespace detail {

/// The density with which the light says that it looks along `towards`, where it says so; else -1.
template <typename Light, typename Scene, typename T>
double density_towards(const Light& light, const Scene& scene, const vec3<T>& point, const vec3<T>& towards) {
    const auto met = scene.intersect({point, towards});
    if (!met) {
        if constexpr (requires { light.escaped_pdf(point, towards); }) {
            return double(light.escaped_pdf(point, towards));
        } else {
            return -1;
        }
    }
    if constexpr (requires { light.pdf(point, towards, *met); }) {
        return double(light.pdf(point, towards, *met));
    } else {
        return -1;
    }
}

/// One look at a light: unit, finite, at a distance, and with the density that the light itself tells for it.
template <typename Look, typename Light, typename Scene, typename T>
void check_look(checks& law, const Look& look, const Light& light, const Scene& scene, const vec3<T>& point,
                double tolerance) {
    const vec3<T> towards = look->towards;
    const double density = double(look->pdf);
    law.require(is_unit(towards), "illuminate: towards ", towards, " is not unit");
    law.require(look->distance > 0, "illuminate: distance ", double(look->distance));
    law.require(aglow::is_finite(density) && density >= 0, "illuminate: pdf = ", density);
    law.require(aglow::is_radiance(look->radiance_over_pdf), "illuminate: radiance negative, infinite or NaN");
    if (!(density > 0)) { return; }
    const double told = density_towards(light, scene, point, towards);
    const auto met = scene.intersect({point, towards});
    // At the rim of a light a place and its distance say little of each other.
    const bool plain = told > 0 && met && std::abs(glm::dot(vec3<T>(met->normal), towards)) > T(0.05);
    if (plain && aglow::is_finite(T(look->distance))) {
        const double way = double(glm::length(vec3<T>(met->position) - point));
        law.require(std::abs(double(look->distance) - way) <= tolerance * way, "illuminate: distance ",
                    double(look->distance), ", but the light is met after ", way, ", towards ", towards);
    }
    // 0: the ray met something else than the light, which is in its right.
    law.require(told <= 0 || std::abs(told - density) <= tolerance * density, "illuminate: pdf = ", density,
                ", but asked for the same direction the light says ", told, ", towards ", towards);
}

/// Mean irradiance of `point` on the side of `normal` by asking the light.
template <aglow::Spectrum S, typename Light, typename Scene, typename T>
spectrum_mean<S> direct(checks& law, const Light& light, const Scene& scene, const vec3<T>& point,
                        const vec3<T>& normal, const light_options& options) {
    spectrum_mean<S> mean;
    for (std::size_t i = 0; i < options.samples && law.ok(); ++i) {
        aglow::random_sampler<T> random{mix({options.seed, 0, i}, 0, aglow::purpose::light)};
        const auto look = light.illuminate(point, random);
        if (!look) {
            mean.add(S{});
            continue;
        }
        check_look(law, look, light, scene, point, options.tolerance);
        const vec3<T> towards = look->towards;
        const T cosine = glm::dot(normal, towards);
        // The light's own surface is no obstacle: stop short of it. A light beyond the scene is met by no ray.
        const T reach = T(look->distance);
        const bool endless = !aglow::is_finite(reach);
        const bool visible = cosine > 0 && (endless ? !scene.intersect({point, towards})
                                                    : !scene.occluded(point, point + towards * (reach * T(0.9999))));
        mean.add(visible ? S(look->radiance_over_pdf * aglow::band_of<S>(cosine)) : S{});
    }
    return mean;
}

}  // namespace detail

/// An `Illuminator`: looks that are unit, finite and of the density it tells, and whose mean, where `scene` does not
/// occlude them, is the direct `irradiance` of `point` on the side of `normal`.
template <aglow::Illuminator Light, aglow::Intersector Scene, aglow::Spectrum S, typename T = aglow::scalar_of<Light>>
verdict illuminator(const Light& light, const Scene& scene, const vec3<T>& point, const vec3<T>& normal,
                    const S& irradiance, const light_options& options = {}) {
    detail::checks law;
    const auto mean = detail::direct<S>(law, light, scene, point, normal, options);
    if (!law.ok()) { return law.result(); }
    const double slack = options.tolerance * detail::largest(irradiance);
    detail::require_mean(law, "illuminate: mean is not the direct irradiance", mean, irradiance, options.sigmas, slack);
    return law.result();
}

/// An `Illuminator` against rays: the mean over looks is the mean over rays that meet what glows (`emitted` of
/// surfaces, `escaped` of lights), and the density that the light tells integrates to at most one. For lights that rays
/// can meet.
template <aglow::Illuminator Light, aglow::Scene Scene, typename T = aglow::scalar_of<Light>>
verdict illuminator_meets_rays(const Light& light, const Scene& scene, const vec3<T>& point, const vec3<T>& normal,
                               const light_options& options = {}) {
    using S = aglow::spectrum_of<Scene>;
    detail::checks law;
    const auto looks = detail::direct<S>(law, light, scene, point, normal, options);
    detail::spectrum_mean<S> rays;
    statistics::sample_mean density;
    const aglow::frame<T> around{normal};
    for (std::size_t i = 0; i < options.samples && law.ok(); ++i) {
        aglow::random_sampler<T> random{mix({options.seed, 1, i}, 0, aglow::purpose::light)};
        const vec3<T> towards = around.to_world(aglow::cosine_hemisphere(random.next_2d()));
        const auto met = scene.intersect({point, towards});
        const S radiance = met ? aglow::emitted(*met, vec3<T>(-towards)) : aglow::escaped_radiance<S>(light, towards);
        rays.add(radiance * aglow::band_of<S>(aglow::pi<double>));
        const vec3<T> anywhere = aglow::uniform_sphere(random.next_2d());
        density.add(std::max(0.0, detail::density_towards(light, scene, point, anywhere)) * 4 * aglow::pi<double>);
    }
    if (!law.ok()) { return law.result(); }
    const double slack = options.sigmas * rays.spread() + options.tolerance * detail::largest(rays.mean());
    detail::require_mean(law, "illuminate: mean is not what rays meet", looks, rays.mean(), options.sigmas, slack);
    law.require(density.mean() <= 1 + options.tolerance + options.sigmas * density.standard_error(),
                "illuminate: its densities integrate to ", density.mean(), ", above one");
    return law.result();
}

}  // namespace laws
