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
    direct,   ///< straight from the light
    caustic,  ///< over specular surfaces only
    indirect  ///< with at least one diffuse or glossy bounce
};

/// The history after one more scattering at `lobe`.
[[nodiscard]] constexpr photon_history after(photon_history before, lobe_set lobe) {
    if (any(lobe, lobe_set::smooth)) { return photon_history::indirect; }
    return before == photon_history::direct ? photon_history::caustic : before;
}

/// Whether a hit can be trusted: finite place, unit normal, not behind the ray.
template <Hit H, typename T>
[[nodiscard]] bool is_sound(const H& hit, const ray<T>& from) {
    const vec3<T> p = hit.position;
    const T norm2 = length2(vec3<T>(hit.normal));
    if (!is_finite(p.x + p.y + p.z) || !(norm2 > T(0.99)) || !(norm2 < T(1.01))) { return false; }
    return glm::dot(p - from.origin, from.direction) >= -error_of(hit, from.origin);
}

/// Follows the particle of `numbers` from `lights` until it is gone. Calls
/// `land(hit, wi, power, history) -> bool` at each surface with a diffuse or glossy lobe; false ends the walk early
/// (nobody needs the rest). `most_bounces` = 0 means no cap. Books everything into `ledger`.
template <Scene World, Emitter Lights, Numbers N, typename Land>
void walk_photon(const World& scene, const Lights& lights, const N& numbers, std::uint32_t most_bounces,
                 energy_ledger<spectrum_of<World>>& ledger, Land&& land) {
    using S = spectrum_of<World>;
    using T = scalar_of<World>;
    using B = band_of<S>;
    auto emission_numbers = numbers.at(0, purpose::emission);
    const auto start = lights.emit(emission_numbers);
    ray<T> path = start.path;
    S power = start.power;
    ++ledger.emitted;
    if (!is_radiance(power)) { return void(++ledger.dropped); }
    ledger.power_emitted = ledger.power_emitted + power;

    photon_history history = photon_history::direct;
    for (std::uint32_t bounce = 1;; ++bounce) {
        const auto hit = scene.intersect(path);
        if (!hit) {
            ledger.power_escaped = ledger.power_escaped + power;
            return void(++ledger.escaped);
        }
        if (!is_sound(*hit, path)) { return void(++ledger.dropped); }
        ++ledger.bounces;
        const vec3<T> wo = -path.direction;
        if (any(hit->lobes(), lobe_set::smooth) && !land(*hit, wo, power, history)) { return void(++ledger.unneeded); }
        if (most_bounces != 0 && bounce > most_bounces) {
            ledger.power_capped = ledger.power_capped + power;
            return void(++ledger.capped);
        }
        auto scatter_numbers = numbers.at(bounce, purpose::scatter);
        const auto next = hit->sample(wo, scatter_numbers, lobe_set::all);
        if (!next) {
            ledger.power_absorbed = ledger.power_absorbed + power;
            return void(++ledger.absorbed);
        }
        const S scattered = power * (next->weight * B(adjoint(*hit, wo, vec3<T>(next->wi))));
        if (!is_radiance(scattered)) { return void(++ledger.dropped); }
        ledger.power_absorbed = ledger.power_absorbed + (power + scattered * B(-1));
        const B q = survival(max_component(power), max_component(scattered));
        if (!(numbers.at(bounce, purpose::roulette).next_1d() < q)) { return void(++ledger.roulette); }
        power = scattered * (1 / q);
        history = after(history, next->lobe);
        path = {lift(vec3<T>(hit->position), vec3<T>(hit->normal), vec3<T>(next->wi), error_of(*hit, path.origin)),
                next->wi};
    }
}

}  // namespace aglow
