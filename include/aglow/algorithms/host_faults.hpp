// What a host gave that cannot be: counted by kind, with the light that was lost by leaving it out.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace aglow {

/// What can be wrong with a host's answer.
enum class host_fault : std::uint8_t {
    place,      ///< a hit whose position is NaN, infinite or behind the ray
    normal,     ///< a hit whose normal is not of unit length
    weight,     ///< a scattering weight that is NaN, infinite or negative
    direction,  ///< a scattered direction that is not of unit length
    radiance,   ///< emitted or reflected light that is NaN, infinite or negative
    emission,   ///< a particle that starts nowhere or flies no direction
    power       ///< a particle whose power is NaN, infinite or negative
};
inline constexpr std::size_t host_fault_kinds = 7;

/// Counts of host faults, by kind.
using fault_counts = std::array<std::uint64_t, host_fault_kinds>;

/// Faults met by paths from the eye, and what these carried when they were cut: 1 is all that a pixel's sample could
/// have brought. May be noted from many threads; the same totals for any number of them.
class host_faults {
public:
    void note(host_fault kind, double carried) {
        const std::size_t k = static_cast<std::size_t>(kind);
        ++counts_[k];
        // Whole steps, so that the order of adding shows in no bit.
        lost_[k] += static_cast<std::uint64_t>(std::clamp(carried, 0.0, 0x1p16) * step);
    }

    [[nodiscard]] std::uint64_t count(host_fault kind) const { return counts_[static_cast<std::size_t>(kind)]; }
    [[nodiscard]] double lost(host_fault kind) const {
        return static_cast<double>(lost_[static_cast<std::size_t>(kind)]) / step;
    }

    /// All kinds together.
    [[nodiscard]] std::uint64_t count() const {
        std::uint64_t all = 0;
        for (const auto& c : counts_) { all += c; }
        return all;
    }
    [[nodiscard]] double lost() const {
        double all = 0;
        for (const auto& l : lost_) { all += static_cast<double>(l) / step; }
        return all;
    }

private:
    static constexpr double step = 0x1p24;
    std::array<std::atomic<std::uint64_t>, host_fault_kinds> counts_{};
    std::array<std::atomic<std::uint64_t>, host_fault_kinds> lost_{};
};

[[nodiscard]] inline const char* words(host_fault kind) {
    switch (kind) {
        case host_fault::place: return "hits at no place or behind the ray";
        case host_fault::normal: return "normals that are not unit";
        case host_fault::weight: return "scattering weights that are no light";
        case host_fault::direction: return "scattered directions that are not unit";
        case host_fault::radiance: return "radiance that is no light";
        case host_fault::emission: return "particles that start nowhere or fly in no unit direction";
        default: return "particles whose power is no light";
    }
}

/// One line for each kind that occurred; empty where the host never failed.
[[nodiscard]] inline std::string statement(const host_faults& faults) {
    std::string text;
    for (std::size_t k = 0; k < host_fault_kinds; ++k) {
        const auto kind = static_cast<host_fault>(k);
        if (faults.count(kind) == 0) { continue; }
        text += std::to_string(faults.count(kind)) + ' ' + words(kind) + ", " + std::to_string(faults.lost(kind)) +
                " samples' worth of light left out\n";
    }
    return text;
}

}  // namespace aglow
