// Places that keep their distance from those taken before.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <aglow/algorithms/gather.hpp>
#include <aglow/containers/octree.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/simd.hpp>

namespace aglow::detail {

/// Numbered places, each of which keeps others within `spacing` of it away where `bars(number, place)`.
template <typename T, typename Bars>
class spaced_places {
public:
    spaced_places(T spacing, const Bars& bars) : spacing_{spacing}, bars_{bars} {}

    [[nodiscard]] bool has_room(const gather_point<T>& at) {
        const auto bars = [&](const place& p) {
            return simd::distance2(p.position, at.position) < limit2_of(spacing_) && bars_(p.number, at);
        };
        if (std::any_of(lately_.begin(), lately_.begin() + std::min(met_, few), bars)) { return false; }
        bool room = true;
        near_.visit_covering(at.position, [&](const place& p) {
            room = !bars_(p.number, at);
            if (!room) { lately_[static_cast<std::size_t>(met_++ % few)] = p; }
            return room;
        });
        return room;
    }

    void add(std::size_t number, const gather_point<T>& at) {
        // What no tree can hold is gathered and refused at the door of the cache.
        (void)near_.insert({number, at.position}, at.position, spacing_);
    }

private:
    struct place {
        std::size_t number;
        vec3<T> position;
    };
    static constexpr std::ptrdiff_t few = 4;

    T spacing_;
    const Bars& bars_;
    octree<place, T> near_{};
    // Candidates of a row lie along it: what was in the way of the last ones mostly is again.
    std::array<place, few> lately_{};
    std::ptrdiff_t met_{0};
};

}  // namespace aglow::detail
