// What a kd-tree does with packs, as kernels that are compiled for each instruction set.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_halve.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_nearest_one.hpp>
#include <aglow/containers/kd_probe.hpp>
#include <aglow/containers/kd_search.hpp>
#include <aglow/core/simd_best.hpp>

namespace aglow::detail {

/// What is asked for, from outside: at most `count` items closer than `limit`; `hint2` as in kd_reach.
template <typename T>
struct kd_task {
    std::uint32_t count;
    T limit, hint2;
};

/// Squared radius to start with: a neighbour's k-th distance and some more, or a guess.
template <typename T>
[[nodiscard]] T first_radius2(const kd_storage<T>& tree, const kd_probe<T>& probe, kd_task<T> task) {
    const T radius2 = task.hint2 > 0 ? task.hint2 * (1 + T(2.6) / std::sqrt(static_cast<T>(task.count)))
                                     : guess_radius2(tree, probe, task.count);
    return std::min(std::max(radius2, std::numeric_limits<T>::min()), task.limit);
}

/// Sends a probe home unless a hint spares it the way, and stands it at the start of its search; returns the squared
/// radius to start with.
struct set_off_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline T run(const kd_storage<T>& tree, kd_probe<T>& probe, kd_task<T> task) {
        probe.at_home = false;
        probe.elsewhere = false;
        if (!(task.hint2 > 0)) { move_home_kernel::run<P>(tree, probe); }
        const T radius2 = first_radius2(tree, probe, task);
        start_around<P>(tree, probe, radius2);
        return radius2;
    }
};

/// One whole search; returns the distance2 of the last found, or the limit.
template <typename Runner, typename T>
T search(const kd_storage<T>& tree, kd_probe<T>& probe, kd_task<T> task, kd_candidates<T>& found,
         const kd_filter<T>& filter) {
    const T radius2 = Runner::template run<set_off_kernel>(tree, probe, task);
    return find_nearest<Runner>(tree, probe, task.count, radius2, task.limit, found, filter);
}

/// Brings searches side by side to where their leaves are listed and asked for: while one waits for memory the others
/// compute.
struct approach_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_storage<T>& tree, std::span<kd_probe<T>> probes,
                                                  kd_task<T> task, std::span<T> radius2) {
        const bool hinted = task.hint2 > 0;
        for (kd_probe<T>& probe : probes) {
            probe.at_home = !hinted;
            probe.elsewhere = false;
            probe.home[static_cast<std::size_t>(tree.height)] = 0;
        }
        for (int level = hinted ? 0 : tree.height; level > 0; --level) {
            const auto l = static_cast<std::size_t>(level);
            // The first is held against the last of the group: eight that live together ask for nothing ahead.
            std::uint32_t last = probes.back().home[l];
            for (kd_probe<T>& probe : probes) {
                step_home<P>(tree, probe, l);
                if (level == 2) { probe.elsewhere = probe.home[2] != std::exchange(last, probe.home[2]); }
                if (probe.elsewhere && level > 1) { simd::prefetch_all(tree.node(level - 1, probe.home[l - 1])); }
            }
        }
        for (std::size_t i = 0; i < probes.size(); ++i) {
            radius2[i] = first_radius2(tree, probes[i], task);
            start_around<P>(tree, probes[i], radius2[i]);
            advance<P>(tree, probes[i], radius2[i], 1);
            if (probes[i].elsewhere) { prefetch_listed(tree, probes[i], 1); }
        }
        for (std::size_t i = 0; i < probes.size(); ++i) {
            advance<P>(tree, probes[i], radius2[i], 0);
            if (probes[i].elsewhere) { prefetch_listed(tree, probes[i], 0); }
            probes[i].elsewhere = false;
        }
    }
};

struct nearest_one_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_best<T> run(const kd_storage<T>& tree, kd_probe<T>& probe, T limit,
                                                        const kd_filter<T>& filter) {
        return find_nearest_one<P>(tree, probe, limit, filter);
    }
};

}  // namespace aglow::detail
