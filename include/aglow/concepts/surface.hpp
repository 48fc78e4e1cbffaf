// What is known where a ray meets the scene: a place, and how light scatters there.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>
#include <utility>

#include <aglow/concepts/sampler.hpp>
#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/random.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// A set of the six lobes that a BSDF is partitioned into: {diffuse, glossy, specular} x {reflection, transmission}.
/// Specular lobes are perfect (a Dirac delta in direction); everything else has a finite density.
enum class lobe_set : std::uint8_t {
    none = 0,
    diffuse_reflection = 1,
    glossy_reflection = 2,
    specular_reflection = 4,
    diffuse_transmission = 8,
    glossy_transmission = 16,
    specular_transmission = 32,
    diffuse = diffuse_reflection | diffuse_transmission,
    glossy = glossy_reflection | glossy_transmission,
    specular = specular_reflection | specular_transmission,
    reflection = diffuse_reflection | glossy_reflection | specular_reflection,
    transmission = diffuse_transmission | glossy_transmission | specular_transmission,
    smooth = diffuse | glossy,
    all = 63
};

[[nodiscard]] constexpr lobe_set operator|(lobe_set a, lobe_set b) {
    return static_cast<lobe_set>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
[[nodiscard]] constexpr lobe_set operator&(lobe_set a, lobe_set b) {
    return static_cast<lobe_set>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}
/// All lobes but those of `a`.
[[nodiscard]] constexpr lobe_set operator~(lobe_set a) {
    return static_cast<lobe_set>(~static_cast<unsigned>(a) & static_cast<unsigned>(lobe_set::all));
}
/// Whether `a` has any lobe of `b`.
[[nodiscard]] constexpr bool any(lobe_set a, lobe_set b = lobe_set::all) { return (a & b) != lobe_set::none; }

/// Where a ray met the scene. `position` = origin + t direction; `normal` is the unit geometric normal, the same from
/// both sides; where it is not unit to half a per cent the hit is dropped and counted as a `host_fault`. May carry
/// anything more: a shading normal, ids, and
/// - `position_error`: how far `position` may lie from the true surface (see `position_error()`); else a guess is made
///   from the largest coordinate of the ray's origin and the position.
template <typename H>
concept Hit = std::copyable<H> && requires(const H& hit) {
    hit.position.x;
    requires std::floating_point<std::remove_cvref_t<decltype(hit.position.x)>>;
    { hit.normal } -> std::convertible_to<vec3<std::remove_cvref_t<decltype(hit.position.x)>>>;
    { hit.position } -> std::convertible_to<vec3<std::remove_cvref_t<decltype(hit.position.x)>>>;
};

template <Hit H>
using hit_scalar = std::remove_cvref_t<decltype(std::declval<const H&>().position.x)>;

/// One scattered direction. From a smooth `lobe`: `weight` = f |cos| / `pdf`, with f and `pdf` (per steradian) both
/// counted over all smooth lobes asked for, whichever of them was drawn. From a specular `lobe`: `weight` = its
/// reflectance over the probability that it was drawn, and `pdf` is unused (any value).
template <Spectrum S, std::floating_point T>
struct scatter_sample {
    vec3<T> wi{};
    S weight{};
    T pdf{};
    lobe_set lobe{};
};

/// A hit that knows how it scatters light. `wo`, `wi`: unit, both pointing away from the surface. The BSDF is meant
/// against the geometric normal: scattered radiance = ∫ evaluate(wo, wi) L(wi) |wi·normal| dwi, so a host with shading
/// normals multiplies its f by |wi·Ns| / |wi·Ng|, and light travelling the other way is `evaluate` with its arguments
/// swapped.
///
/// - `lobes()`: the lobes that this point has.
/// - `evaluate(wo, wi, lobes)`: f in 1/sr, of those lobes; specular ones count nothing.
/// - `sample(wo, random, lobes)`: an optional `scatter_sample`; empty where nothing scatters. `random` is any
///   `Sampler`: a virtual material draws its numbers first and hands them on.
/// - `pdf(wo, wi, lobes)`: the density of `sample`, specular lobes apart (they take their share of the probability).
/// - optional `emitted(wo)`: radiance that leaves towards `wo` by itself, W/(m² sr).
/// - optional `adjoint(wo, wi)`: by what a specular or sampled `weight` differs when light, not importance, comes along
///   `wo`: |wo·Ns||wi·Ng| / (|wo·Ng||wi·Ns|) for shading normals (Veach 1997, 5.3), (η_i/η_o)² more where radiance
///   weights of refraction carry the square of the indices. 1 when absent.
///
/// Must be true: mean of weight = ∫ f |cos|; albedo <= 1; reciprocity up to `adjoint`; directions follow `pdf`.
template <typename H>
concept Surface = Hit<H> && requires(const H& hit, vec3<hit_scalar<H>> w, random_sampler<hit_scalar<H>>& random) {
    { hit.lobes() } -> std::same_as<lobe_set>;
    requires Spectrum<std::remove_cvref_t<decltype(hit.evaluate(w, w, lobe_set::all))>>;
    { hit.pdf(w, w, lobe_set::all) } -> std::convertible_to<hit_scalar<H>>;
    static_cast<bool>(hit.sample(w, random, lobe_set::all));
    { hit.sample(w, random, lobe_set::all)->wi } -> std::convertible_to<vec3<hit_scalar<H>>>;
    requires Spectrum<std::remove_cvref_t<decltype(hit.sample(w, random, lobe_set::all)->weight)>>;
    { hit.sample(w, random, lobe_set::all)->pdf } -> std::convertible_to<hit_scalar<H>>;
    { hit.sample(w, random, lobe_set::all)->lobe } -> std::convertible_to<lobe_set>;
};

/// The colour of a surface, or of anything else with `evaluate`.
template <Surface H>
using surface_spectrum = std::remove_cvref_t<decltype(std::declval<const H&>().evaluate(
    vec3<hit_scalar<H>>{}, vec3<hit_scalar<H>>{}, lobe_set::all))>;

/// Radiance that `hit` itself sends towards `wo`; black where the surface type has no `emitted`.
template <Surface H>
[[nodiscard]] surface_spectrum<H> emitted(const H& hit, const vec3<hit_scalar<H>>& wo) {
    if constexpr (requires { hit.emitted(wo); }) {
        return hit.emitted(wo);
    } else {
        return {};
    }
}

/// The factor of `Surface::adjoint`; 1 where the surface type has none.
template <Surface H>
[[nodiscard]] hit_scalar<H> adjoint(const H& hit, const vec3<hit_scalar<H>>& wo, const vec3<hit_scalar<H>>& wi) {
    if constexpr (requires { hit.adjoint(wo, wi); }) {
        return hit.adjoint(wo, wi);
    } else {
        return 1;
    }
}

}  // namespace aglow
