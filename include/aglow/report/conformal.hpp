// From a rough guess of each pixel's error and a few true errors to error bars that hold as often as they say.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <aglow/report/quantiles.hpp>

namespace aglow {

/// The ⌈(n+1)·confidence⌉-th smallest score: a fresh score of the same kind exceeds it with probability at most
/// 1 - `confidence` (Vovk, Gammerman & Shafer 2005). Nothing where that would be beyond the largest, below 19 scores
/// for 95 %.
[[nodiscard]] inline std::optional<double> conformal_quantile(std::span<const double> scores, double confidence) {
    const auto rank = static_cast<std::size_t>(std::ceil(static_cast<double>(scores.size() + 1) * confidence));
    if (rank == 0 || rank > scores.size()) { return std::nullopt; }
    return sorted(scores)[rank - 1];
}

/// What turns guesses of one class of pixels into error bars: bar = `scale` · guess.
struct class_scale {
    std::uint32_t id{0};
    double scale{0};        ///< infinite where there were too few scores to say anything
    std::size_t scores{0};  ///< how many scores `scale` rests on
    bool merged{false};     ///< too few of its own, so all classes' scores were taken together
};

/// The members of a class, by index.
struct class_list {
    std::uint32_t id;
    std::vector<std::size_t> members;
};

/// The members of class `id` in lists by rising id; an empty list is put in where there is none.
[[nodiscard]] inline std::vector<std::size_t>& members_of(std::vector<class_list>& lists, std::uint32_t id) {
    auto at = std::lower_bound(lists.begin(), lists.end(), id, [](const class_list& l, auto i) { return l.id < i; });
    if (at == lists.end() || at->id != id) { at = lists.insert(at, {id, {}}); }
    return at->members;
}

/// Which of those that were added are of which class; classes of fewer than `least` share one list of everything.
class class_lists {
public:
    explicit class_lists(std::size_t least) : least_{least} {}

    /// Adds one more, of class `id`.
    void add(std::uint32_t id) {
        members_of(own_, id).push_back(everything_.size());
        everything_.push_back(everything_.size());
    }

    /// Calls `visit(id, members, merged)` for every class in rising order of id.
    template <typename Visit>
    void for_each(const Visit& visit) const {
        for (const auto& [id, members] : own_) {
            const bool merged = members.size() < least_;
            visit(id, merged ? everything_ : members, merged);
        }
    }

private:
    std::size_t least_;
    std::vector<class_list> own_{};
    std::vector<std::size_t> everything_{};
};

/// One scale a class (Mondrian conformal prediction); `scores[i]` = |error| / guess of a randomly drawn pixel of class
/// `classes[i]`. Classes with fewer than `least` scores are merged. In rising order of id.
[[nodiscard]] inline std::vector<class_scale> conformal_scales(std::span<const double> scores,
                                                               std::span<const std::uint32_t> classes,
                                                               double confidence, std::size_t least = 60) {
    class_lists lists{least};
    for (const std::uint32_t id : classes) { lists.add(id); }
    std::vector<class_scale> scales;
    lists.for_each([&](std::uint32_t id, const std::vector<std::size_t>& members, bool merged) {
        std::vector<double> own;
        for (const std::size_t i : members) { own.push_back(scores[i]); }
        const double scale = conformal_quantile(own, confidence).value_or(std::numeric_limits<double>::infinity());
        scales.push_back({id, scale, own.size(), merged});
    });
    return scales;
}

/// The scale of class `id`; nothing for a class that is not in the list.
[[nodiscard]] inline std::optional<double> scale_of(std::span<const class_scale> scales, std::uint32_t id) {
    for (const class_scale& s : scales) {
        if (s.id == id) { return s.scale; }
    }
    return std::nullopt;
}

}  // namespace aglow
