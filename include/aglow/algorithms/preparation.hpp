// How far an integrator is with what it makes before the first picture, and the host's word to make do with that.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <utility>

#include <aglow/core/callback.hpp>

namespace aglow {

/// What is made ahead, in this order; an integrator leaves out what it does not need.
enum class preparation_phase : std::uint8_t {
    photons,     ///< traced into maps
    irradiance,  ///< worked out at photons, for gather rays to read
    places,      ///< where the picture will ask the cache, looked for
    records      ///< gathered into the cache
};

/// How far a preparation is.
struct preparation {
    preparation_phase phase{};
    double share{};  ///< of this phase, in [0, 1], never falling
};

/// A host's ear: told when a phase begins and of its progress, from any thread, one call at a time. False ends the
/// phase early; what was found until then is used, and the next phase begins and asks again.
using preparation_progress = callback<const preparation&>;

namespace detail {

/// Puts the calls of all threads into one row that never falls, and makes one word to the host of it.
class preparation_report {
public:
    explicit preparation_report(const preparation_progress& host) : host_{host} {}

    /// Begins a phase: what is to be told the share done of it. `own` is told too, where the phase has such. Empty
    /// where nobody listens.
    [[nodiscard]] callback<double> phase(preparation_phase now, callback<double> own = {}) {
        if (!host_) { return own; }
        told_ = {now, 0};
        ended_ = false;
        (void)tell(0);
        return [this, own = std::move(own)](double share) {
            const bool more = tell(share);
            return (!own || own(share)) && more;
        };
    }

private:
    bool tell(double share) {
        const std::scoped_lock lock{guard_};
        told_.share = std::max(told_.share, std::min(share, 1.0));
        ended_ = ended_ || !host_(told_);
        return !ended_;
    }

    const preparation_progress& host_;
    std::mutex guard_{};
    preparation told_{};
    bool ended_{false};
};

}  // namespace detail

}  // namespace aglow
