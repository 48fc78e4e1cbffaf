// How many samples a picture takes at a time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace host {

/// Samples of the next pass, which is not interrupted: doubling, but so few that nobody waits long for its end, and no
/// more than fit into the `left` seconds, which may be infinite; one at least. `spent` are the seconds of those
/// `taken`.
[[nodiscard]] inline std::uint32_t samples_of_pass(std::uint32_t taken, double spent, double left) {
    constexpr double patience = 5;  // seconds of a pass
    if (taken == 0) { return left < std::numeric_limits<double>::infinity() ? 1 : 4; }
    const double had = taken;
    const double fit = std::min(had, std::clamp(left, 0.0, patience) * had / spent);
    return std::max(1u, static_cast<std::uint32_t>(fit));
}

}  // namespace host
