// The best instructions of the machine that the program runs on, whatever the flags it was compiled with.
//
// A kernel is a template over the pack, `Kernel::run<Pack>(...)`, in which all that touches packs is always inlined. So
// it can be compiled once for each instruction set in the one function below that carries the set as its target, and
// the set is asked for when it is called. A kernel takes no code of the host: that keeps its own flags.
#pragma once

#include <type_traits>

#include <aglow/core/simd.hpp>
#include <aglow/core/simd_avx2.hpp>
#include <aglow/core/simd_avx512.hpp>
#include <aglow/core/simd_sse.hpp>

namespace aglow::simd {

#if defined(__x86_64__) && defined(__GNUC__)

template <typename Kernel, typename... Arguments>
[[gnu::target("avx512f,avx2,bmi,popcnt"), gnu::flatten]] auto run_avx512(Arguments&... arguments) {
    return Kernel::template run<avx512>(arguments...);
}
template <typename Kernel, typename... Arguments>
[[gnu::target("avx2,bmi,popcnt"), gnu::flatten]] auto run_avx2(Arguments&... arguments) {
    return Kernel::template run<avx2>(arguments...);
}
template <typename Kernel, typename... Arguments>
[[gnu::target("sse4.2,popcnt"), gnu::flatten]] auto run_sse(Arguments&... arguments) {
    return Kernel::template run<sse>(arguments...);
}

/// Runs `Kernel` with the widest pack of `T` that this machine has; every pack gives the same answers.
template <typename T, typename Kernel, typename... Arguments>
auto run_best(Arguments&&... arguments) {
    if constexpr (std::is_same_v<T, float>) {
        if (__builtin_cpu_supports("avx512f")) { return run_avx512<Kernel>(arguments...); }
        if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi")) { return run_avx2<Kernel>(arguments...); }
        if (__builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt")) {
            return run_sse<Kernel>(arguments...);
        }
    }
    return Kernel::template run<plain<T>>(arguments...);
}

#else

template <typename T, typename Kernel, typename... Arguments>
auto run_best(Arguments&&... arguments) {
    return Kernel::template run<plain<T>>(arguments...);
}

#endif

}  // namespace aglow::simd
