// What a kd-tree does with packs, as kernels that are compiled for each instruction set.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <aglow/containers/kd_boxes.hpp>
#include <aglow/containers/kd_halve.hpp>
#include <aglow/containers/kd_layout.hpp>
#include <aglow/containers/kd_nearest_one.hpp>
#include <aglow/containers/kd_search.hpp>
#include <aglow/core/simd_best.hpp>

namespace aglow::detail {

/// Runs kernels with the best pack of the machine.
template <typename T>
struct kd_best_runner {
    template <typename Kernel, typename... Arguments>
    static auto run(Arguments&&... arguments) {
        return simd::run_best<T, Kernel>(arguments...);
    }
};

/// Runs kernels with one pack.
template <typename P>
struct kd_pack_runner {
    template <typename Kernel, typename... Arguments>
    static auto run(Arguments&&... arguments) {
        return Kernel::template run<P>(arguments...);
    }
};

/// What is asked for, from outside: at most `count` items closer than `limit`; `hint2` as in kd_reach.
template <typename T>
struct kd_task {
    std::uint32_t count;
    T limit, hint2;
};

struct halve_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_move<T>& move, std::uint32_t left, kd_room<T>& room) {
        halve<P>(move, left, room);
    }
};

struct finish_nodes_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(kd_storage<T>& tree, int level, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) { finish_node<P>(tree, level, static_cast<std::uint32_t>(i)); }
    }
};

/// Squared radius to start with: a neighbour's k-th distance and some more, or a guess.
template <typename P, typename T>
[[nodiscard, gnu::always_inline]] inline T first_radius2(const kd_storage<T>& tree, const kd_probe<T>& probe,
                                                         kd_task<T> task) {
    const T radius2 = task.hint2 > 0 ? task.hint2 * (1 + T(2.6) / std::sqrt(static_cast<T>(task.count)))
                                     : guess_radius2<P>(tree, probe, task.count);
    return std::min(std::max(radius2, std::numeric_limits<T>::min()), task.limit);
}

/// One whole search; returns the distance2 of the last found, or the limit.
struct nearest_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline T run(const kd_storage<T>& tree, kd_probe<T>& probe, kd_task<T> task,
                                               kd_candidates<T>& found, const kd_filter<T>& filter) {
        probe.at_home = !(task.hint2 > 0);
        if (probe.at_home) { go_home<P>(tree, probe); }
        start(probe, tree.height, 0);
        const T radius2 = first_radius2<P>(tree, probe, task);
        return find_nearest<P>(tree, probe, task.count, radius2, task.limit, found, filter);
    }
};

/// Brings searches side by side to where their leaves are listed and asked for: while one waits for memory the others
/// compute.
struct approach_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline void run(const kd_storage<T>& tree, std::span<kd_probe<T>> probes,
                                                  kd_task<T> task, std::span<T> radius2) {
        const bool hinted = task.hint2 > 0;
        for (kd_probe<T>& probe : probes) {
            probe.at_home = !hinted;
            probe.home[static_cast<std::size_t>(tree.height)] = 0;
            start(probe, tree.height, 0);
        }
        for (int level = hinted ? 0 : tree.height; level > 0; --level) {
            const auto l = static_cast<std::size_t>(level);
            for (kd_probe<T>& probe : probes) {
                step_home<P>(tree, probe, l);
                if (level > 1) { prefetch_all(tree.node(level - 1, probe.home[l - 1])); }
            }
        }
        for (std::size_t i = 0; i < probes.size(); ++i) {
            radius2[i] = first_radius2<P>(tree, probes[i], task);
            advance<P>(tree, probes[i], radius2[i], 1);
            prefetch_listed(tree, probes[i], 1);
        }
        for (std::size_t i = 0; i < probes.size(); ++i) {
            advance<P>(tree, probes[i], radius2[i], 0);
            prefetch_listed(tree, probes[i], 0);
        }
    }
};

/// The rest of a search that has been brought to its leaves.
struct finish_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline T run(const kd_storage<T>& tree, kd_probe<T>& probe, kd_task<T> task,
                                               T radius2, kd_candidates<T>& found, const kd_filter<T>& filter) {
        return find_nearest<P>(tree, probe, task.count, radius2, task.limit, found, filter);
    }
};

struct nearest_one_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline kd_best<T> run(const kd_storage<T>& tree, kd_probe<T>& probe, T limit,
                                                        const kd_filter<T>& filter) {
        return find_nearest_one<P>(tree, probe, limit, filter);
    }
};

/// Fills the list with what comes next closer than `limit`; false when there is no more.
struct scan_kernel {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline bool run(const kd_storage<T>& tree, kd_probe<T>& probe, T limit,
                                                  kd_list<T>& found) {
        found.count = 0;
        if (!advance<P>(tree, probe, limit, 0)) { return false; }
        scan<P>(tree, probe, limit, found);
        return true;
    }
};

}  // namespace aglow::detail
