// How many paths a photon map is worth, by what a pilot found.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <aglow/algorithms/photon_options.hpp>
#include <aglow/algorithms/photon_walk.hpp>
#include <aglow/core/numbers.hpp>

namespace aglow::detail {

/// The relative noise of the sum of `paths` numbers: half the way to where the sum may lie with 95 % confidence. Few
/// paths that bounce for long, as between white walls, bring many photons and know little.
[[nodiscard]] inline double shared_noise(double paths, double sum, double sum2) {
    const double degrees = std::max(1.0, paths - 1);
    // At or above Student's quantile over 2, for any number of degrees of freedom.
    const double few = 1 + 1.2 / degrees + 4.2 / square(degrees);
    if (paths < 2) { return few; }
    const double excess = paths * (sum2 / sum / sum) - 1;
    return few * std::sqrt(std::max(0.0, excess) / degrees);
}

/// What a pilot knows of the light. Keeps a reference.
struct photon_demand {
    const photon_options& options;
    std::array<double, 4> met{};  ///< power that landed, by history, wanted or not
    bool endless{false};          ///< whether most paths do not end within sight

    /// The share of light once more reflected in itself and the light that it comes from; 1 for other.
    [[nodiscard]] double share_of_light(photon_history kind) const {
        const auto of = [&](photon_history h) { return met[static_cast<std::size_t>(h)]; };
        double from = 0;
        if (kind == photon_history::reflected) { from = of(photon_history::caustic); }
        if (kind == photon_history::indirect) { from = of(photon_history::direct) + of(photon_history::caustic); }
        return from > 0 ? of(kind) / (from + of(kind)) : 1;
    }

    /// Whether light of such a share was met, and so little that it need not be sought for long.
    [[nodiscard]] bool is_spared(double share) const { return share > 0 && share < options.full_share; }

    /// Paths for `wanted` photons that bring such a share of the light, where the pilot's paths would have stored
    /// `found`: fewer where the share is so small that the noise of them all is no more than what full maps bring
    /// elsewhere, but as many as are walked in search of what the pilot did not find.
    [[nodiscard]] std::size_t paths_worth(std::size_t wanted, std::size_t found, double share) const {
        const double photons = static_cast<double>(wanted);
        const std::size_t all = paths_needed(photons, found);
        if (!is_spared(share)) { return all; }
        // Noise of all light: share / sqrt(photons).
        const double enough = photons * square(share / options.full_share);
        return std::min(all, std::max(paths_needed(enough, found), paths_needed(photons, 0)));
    }

    /// Paths for `wanted` photons, whatever they are worth.
    [[nodiscard]] std::size_t paths_needed(double wanted, std::size_t found) const {
        const double pilots = static_cast<double>(options.pilot_paths);
        const double most = static_cast<double>(options.most_paths);
        const double hard = endless ? pilots : 32 * pilots;
        const double needed = found == 0 ? hard : std::ceil(wanted * pilots / static_cast<double>(found));
        return static_cast<std::size_t>(std::min(needed, most));
    }
};

}  // namespace aglow::detail
