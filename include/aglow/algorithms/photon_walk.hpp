// One particle on its way from a light, and whoever wants to know where it lands.
//
// Flux weight of a photon: Jensen 2001, ch. 5; adjoint scattering: Veach 1997, 5.3. Roulette by the ratio of throughput
// keeps all photons near the same power.
#pragma once

#include <algorithm>
#include <cstdint>

#include <aglow/algorithms/energy_ledger.hpp>
#include <aglow/concepts/light.hpp>
#include <aglow/core/roulette.hpp>

namespace aglow {

/// How a particle came to where it lands.
enum class photon_history : std::uint8_t {
    direct,    ///< straight from the light
    caustic,   ///< over specular surfaces only
    indirect,  ///< with a diffuse or glossy bounce, but not as the next
    reflected  ///< a caustic that was reflected once by a diffuse or glossy surface, and then over mirrors at most
};

/// The history after one more scattering at `lobe`.
[[nodiscard]] constexpr photon_history after(photon_history before, lobe_set lobe) {
    if (any(lobe, lobe_set::smooth)) {
        return before == photon_history::caustic ? photon_history::reflected : photon_history::indirect;
    }
    return before == photon_history::direct ? photon_history::caustic : before;
}

/// Whether `v` is finite and about as long as a direction must be.
template <typename T>
[[nodiscard]] bool is_direction(const vec3<T>& v) {
    const T norm2 = length2(v);
    return is_finite(norm2) && norm2 > T(0.99) && norm2 < T(1.01);
}

/// Whether a hit whose position may be off by `error` is at a place: finite, and not behind the ray. No error is
/// below zero.
template <Hit H, typename T>
[[nodiscard]] inline bool is_placed(const H& hit, const ray<T>& from, T error) {
    const T along = glm::dot(vec3<T>(hit.position) - from.origin, from.direction);
    // Only what a host tells by itself can be below zero.
    if constexpr (requires { hit.position_error; }) {
        if (!(error >= 0)) { return false; }
    }
    return is_finite(along) && along >= -error;
}

/// Whether a hit can be trusted: finite place, unit normal, not behind the ray.
template <Hit H, typename T>
[[nodiscard]] bool is_sound(const H& hit, const ray<T>& from, T error) {
    return is_placed(hit, from, error) && is_direction(vec3<T>(hit.normal));
}
template <Hit H, typename T>
[[nodiscard]] bool is_sound(const H& hit, const ray<T>& from) {
    return is_sound(hit, from, error_of(hit, from.origin));
}

/// What is wrong with a hit that is not sound: its normal, or else its place.
template <Hit H>
[[nodiscard]] host_fault fault_of(const H& hit) {
    return is_direction(vec3<hit_scalar<H>>(hit.normal)) ? host_fault::place : host_fault::normal;
}

/// Most surfaces that a path meets before roulette may end it even where nothing is absorbed.
inline constexpr std::uint32_t endless_bounces = 4096;

/// The largest probability with which a path goes on after `bounce` surfaces: a hair below one in the end, so that
/// light between perfect mirrors ends too, and nothing is lost in the mean.
template <std::floating_point B>
[[nodiscard]] constexpr B survival_ceiling(std::uint32_t bounce) {
    return bounce < endless_bounces ? B(1) : 1 - B(0x1p-20);
}

namespace detail {

/// Where a particle stands, and what it carries.
template <Spectrum S, std::floating_point T>
struct photon_state {
    ray<T> path{};
    S power{};
    photon_history history{photon_history::direct};
};

/// Books what ended, and says that it did.
template <Spectrum S>
[[nodiscard]] bool book(std::uint64_t& count, S& sum, const S& power) {
    ++count;
    sum = sum + power;
    return false;
}

/// Books a particle that a broken answer of the host ended.
template <Spectrum S>
[[nodiscard]] bool drop(energy_ledger<S>& ledger, host_fault why, const S& power) {
    ++ledger.faults[static_cast<std::size_t>(why)];
    return book(ledger.dropped, ledger.power_dropped, power);
}

/// Sends a particle out; false where there is none to follow.
template <Emitter Lights, Numbers N, Spectrum S, std::floating_point T>
[[nodiscard]] bool emit_photon(const Lights& lights, const N& numbers, photon_state<S, T>& at,
                               energy_ledger<S>& ledger) {
    auto emission_numbers = numbers.at(0, purpose::emission);
    const auto start = lights.emit(emission_numbers);
    at.path = start.path;
    at.power = start.power;
    ++ledger.emitted;
    const T place = length2(at.path.origin);
    if (!is_radiance(at.power)) { return drop(ledger, host_fault::power, S{}); }
    ledger.power_emitted = ledger.power_emitted + at.power;
    if (!is_finite(place) || !is_direction(at.path.direction)) { return drop(ledger, host_fault::emission, at.power); }
    return is_black(at.power) ? book(ledger.unneeded, ledger.power_unneeded, at.power) : true;
}

/// Scatters a particle at `hit`, its surface number `bounce`; false where it ends.
template <lobe_set Possible = lobe_set::all, Surface H, Numbers N, Spectrum S, std::floating_point T>
[[nodiscard]] bool scatter_photon(const H& hit, T error, const N& numbers, std::uint32_t bounce, photon_state<S, T>& at,
                                  energy_ledger<S>& ledger) {
    using B = band_of<S>;
    const vec3<T> wo = -at.path.direction;
    auto scatter_numbers = numbers.at(bounce, purpose::scatter);
    const auto next = hit.sample(wo, scatter_numbers, Possible);
    if (!next) { return book(ledger.absorbed, ledger.power_absorbed, at.power); }
    const vec3<T> wi = next->wi;
    const S scattered = at.power * (next->weight * B(adjoint(hit, wo, wi)));
    if (!is_radiance(scattered)) { return drop(ledger, host_fault::weight, at.power); }
    if (!is_direction(wi)) { return drop(ledger, host_fault::direction, at.power); }
    ledger.power_absorbed = ledger.power_absorbed + (at.power + scattered * B(-1));
    const B q = survival(max_component(at.power), max_component(scattered), survival_ceiling<B>(bounce));
    if (!(numbers.at(bounce, purpose::roulette).next_1d() < q)) {
        return book(ledger.roulette, ledger.power_absorbed, S{});
    }
    at.power = scattered * (1 / q);
    at.history = after(at.history, next->lobe);
    at.path = {lift(vec3<T>(hit.position), vec3<T>(hit.normal), wi, error), wi};
    return true;
}

}  // namespace detail

/// Follows the particle of `numbers` from `lights` until it is gone. Calls
/// `land(hit, wi, power, history) -> bool` at each surface with a diffuse or glossy lobe; false ends the walk early
/// (nobody needs the rest). `most_bounces` = 0 means no cap. Books everything into `ledger`.
template <Scene World, Emitter Lights, Numbers N, typename Land>
void walk_photon(const World& scene, const Lights& lights, const N& numbers, std::uint32_t most_bounces,
                 energy_ledger<spectrum_of<World>>& ledger, Land&& land) {
    using T = scalar_of<World>;
    detail::photon_state<spectrum_of<World>, T> at;
    bool going = detail::emit_photon(lights, numbers, at, ledger);
    for (std::uint32_t bounce = 1; going; ++bounce) {
        const auto hit = scene.intersect(at.path);
        if (!hit) { return void(detail::book(ledger.escaped, ledger.power_escaped, at.power)); }
        const T error = error_of(*hit, at.path.origin);
        if (!is_sound(*hit, at.path, error)) { return void(detail::drop(ledger, fault_of(*hit), at.power)); }
        ++ledger.bounces;
        if (any(hit->lobes(), lobe_set::smooth) && !land(*hit, vec3<T>(-at.path.direction), at.power, at.history)) {
            return void(detail::book(ledger.unneeded, ledger.power_unneeded, at.power));
        }
        if (most_bounces != 0 && bounce > most_bounces) {
            return void(detail::book(ledger.capped, ledger.power_capped, at.power));
        }
        going = detail::scatter_photon<static_lobes<World>>(*hit, error, numbers, bounce, at, ledger);
    }
}

}  // namespace aglow
