// What all that is read from one cache is off by together: the records' noise and their interpolation's bias, in the
// mean over a picture.
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>
#include <aglow/estimators/estimate.hpp>
#include <aglow/estimators/irradiance_record.hpp>
#include <aglow/estimators/record_blend.hpp>
#include <aglow/estimators/record_neighbours.hpp>

namespace aglow::detail {

/// What the records around a point blend to, in the largest band, and who had what share in it.
template <std::floating_point T>
struct weighed_records {
    struct share {
        std::size_t index;
        T weight;
    };
    std::vector<share> shares{};
    T weight{0};
    T level{0};  ///< weighed, not yet divided

    /// Asks all records but `except`. `tree` visits items with `.record`, and tells their number.
    template <typename Tree>
    weighed_records(const Tree& tree, const vec3<T>& point, const vec3<T>& normal, const lookup_limits<T>& limits,
                    std::size_t except = ~std::size_t{0}) {
        tree.visit_covering(point, [&](const auto& item, std::uint32_t index) {
            const record_view<T> view = look(item.record, point, normal, limits);
            if (view.judged != verdict::used || index == except) { return; }
            const T w = record_weight(limits.metric, view.t2, view.turn / limits.turn);
            if (!(w > 0)) { return; }
            shares.push_back({index, w});
            weight += w;
            level += w * static_cast<T>(max_component(item.record.extrapolate(view.local, view.normal)));
        });
    }
    [[nodiscard]] double mean() const { return weight > 0 ? static_cast<double>(level / weight) : 0.0; }
};

/// What lookups at `places` (anything with `.position` and `.normal`) are off by together: each record's noise by its
/// share in all of them, by what a record's neighbours would miss it, were it not there, and by what smoothing took
/// from it. `tree[i].record` are the records as they were gathered, `smooth[i]` the same as they are read.
template <typename Tree, typename Smooth, std::floating_point T, typename Places>
[[nodiscard]] shared_error shared_by_records(const Tree& tree, const Smooth& smooth, const Places& places,
                                             const lookup_limits<T>& limits) {
    const auto level = [](const auto& record) { return static_cast<double>(max_component(record.irradiance())); };
    std::vector<double> share(tree.size());
    double all = 0;
    for (const auto& place : places) {
        const weighed_records<T> here{tree, place.position, place.normal, limits};
        for (const auto& [index, weight] : here.shares) { share[index] += static_cast<double>(weight / here.weight); }
        all += here.mean();
    }
    if (!(all > 0)) { return {}; }
    double variance = 0;
    double bias = 0;
    for (std::uint32_t i = 0; i < tree.size(); ++i) {
        if (!(share[i] > 0)) { continue; }
        const auto& record = tree[i].record;
        variance += square(share[i]) * variance_of(record);
        bias += share[i] * (level(smooth[i]) - level(record));
        const weighed_records<T> others{tree, record.position(), record.normal(), limits, i};
        if (others.weight > limits.weight) { bias += share[i] * (others.mean() - level(record)); }
    }
    return {std::sqrt(variance) / all, bias / all};
}

}  // namespace aglow::detail
