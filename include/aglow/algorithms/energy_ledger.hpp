// The books of a particle simulation: where every emitted particle ended, to the last one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <aglow/algorithms/host_faults.hpp>
#include <aglow/concepts/spectrum.hpp>

namespace aglow {

/// What became of the emitted particles. Counts are exact: emitted = escaped + absorbed + roulette + unneeded + capped
/// + dropped.
/// Powers are in the unit of the lights' power summed over paths; divide by `emitted` for watts. They balance in the
/// mean: roulette takes as much as it gives.
template <Spectrum S>
struct energy_ledger {
    std::uint64_t emitted{0};   ///< particles that lights sent out
    std::uint64_t escaped{0};   ///< left the scene
    std::uint64_t absorbed{0};  ///< met a surface that scattered nothing on
    std::uint64_t roulette{0};  ///< ended by Russian roulette, their power carried by the survivors
    std::uint64_t unneeded{0};  ///< cut short where nobody wanted the rest of the path
    std::uint64_t capped{0};    ///< cut off at the caller's depth cap: this power is lost, the result darker
    std::uint64_t dropped{0};   ///< had power that was NaN, infinite or negative, or met a broken hit
    std::uint64_t bounces{0};   ///< surfaces met in all
    fault_counts faults{};      ///< what was wrong with the dropped ones, by `host_fault`
    S power_emitted{};
    S power_escaped{};
    S power_absorbed{};  ///< expected absorption: what scattering took, surface by surface
    S power_unneeded{};
    S power_capped{};
    S power_dropped{};  ///< as far as it was known: what a particle carried when it met the broken hit

    /// Joins the books of two disjoint sets of paths.
    energy_ledger& operator+=(const energy_ledger& other) {
        emitted += other.emitted;
        escaped += other.escaped;
        absorbed += other.absorbed;
        roulette += other.roulette;
        unneeded += other.unneeded;
        capped += other.capped;
        dropped += other.dropped;
        bounces += other.bounces;
        for (std::size_t k = 0; k < faults.size(); ++k) { faults[k] += other.faults[k]; }
        power_emitted = power_emitted + other.power_emitted;
        power_escaped = power_escaped + other.power_escaped;
        power_absorbed = power_absorbed + other.power_absorbed;
        power_unneeded = power_unneeded + other.power_unneeded;
        power_capped = power_capped + other.power_capped;
        power_dropped = power_dropped + other.power_dropped;
        return *this;
    }
};

/// What the books say of light that a host never gave or gave wrongly, as a clause for people that begins with a comma;
/// empty where all is well.
template <Spectrum S>
[[nodiscard]] std::string complaint(const energy_ledger<S>& ledger) {
    if (ledger.dropped > 0) {
        const auto most = std::max_element(ledger.faults.begin(), ledger.faults.end());
        const auto kind = static_cast<host_fault>(most - ledger.faults.begin());
        return ", " + std::to_string(ledger.dropped) + " of " + std::to_string(ledger.emitted) +
               " particles dropped: " + words(kind);
    }
    return ledger.emitted > 0 && is_black(ledger.power_emitted) ? ", the lights send out no power" : "";
}

/// The books of paths `first` to `last`, kept by `walk(path, ledger)`: those of few at a time are added to the others,
/// since a long sum of floats loses what is small beside it.
template <Spectrum S, typename Walk>
[[nodiscard]] energy_ledger<S> kept_books(std::size_t first, std::size_t last, Walk&& walk) {
    energy_ledger<S> all;
    while (first < last) {
        energy_ledger<S> few;
        for (const std::size_t end = std::min(last, first + 32); first < end; ++first) { walk(first, few); }
        all += few;
    }
    return all;
}

/// The books of all `ledgers` together, joined two by two: one long sum of floats would stand still.
template <Spectrum S>
[[nodiscard]] energy_ledger<S> joined(std::span<const energy_ledger<S>> ledgers) {
    if (ledgers.empty()) { return {}; }
    if (ledgers.size() == 1) { return ledgers.front(); }
    const std::size_t half = ledgers.size() / 2;
    energy_ledger<S> both = joined<S>(ledgers.first(half));
    return both += joined<S>(ledgers.subspan(half));
}

}  // namespace aglow
