// The best instructions of the machine that the program runs on, whatever the flags it was compiled with.
//
// A kernel is a template over the pack, `Kernel::run<Pack>(...)`, in which all that touches packs is always inlined. So
// it can be compiled once for each instruction set in the one function below that carries the set as its target, and
// the set is asked for when it is called. Instructions that the flags do without are left out where the flags promise
// better ones. A kernel takes no code of the host: that keeps its own flags.
#pragma once

#include <type_traits>

#include <aglow/core/simd.hpp>
#include <aglow/core/simd_avx2.hpp>
#include <aglow/core/simd_avx512.hpp>
#include <aglow/core/simd_sse.hpp>

namespace aglow::simd {

/// The packs of `T`, from the widest registers down; the last runs everywhere.
template <typename T>
struct packs_of {
    using avx512 = plain<T>;
    using avx2 = plain<T>;
    using any = plain<T>;
};

#if defined(__x86_64__) && defined(__GNUC__)

template <>
struct packs_of<float> {
    using avx512 = simd::avx512;
    using avx2 = simd::avx2;
    using any = sse;
};
template <>
struct packs_of<double> {
    using avx512 = avx512d;
    using avx2 = avx2d;
    using any = plain<double>;
};

#if defined(__AVX2__) && defined(__BMI__) && defined(__POPCNT__)
inline constexpr bool always_avx2 = true;
#else
inline constexpr bool always_avx2 = false;
#endif
#if defined(__AVX512F__)
inline constexpr bool always_avx512 = always_avx2;
#else
inline constexpr bool always_avx512 = false;
#endif

template <typename P, typename Kernel, typename... Arguments>
[[gnu::target("avx512f,avx2,bmi,popcnt"), gnu::flatten, gnu::noinline]] auto run_avx512(Arguments... arguments) {
    return Kernel::template run<P>(arguments...);
}
template <typename P, typename Kernel, typename... Arguments>
[[gnu::target("avx2,bmi,popcnt"), gnu::flatten, gnu::noinline]] auto run_avx2(Arguments... arguments) {
    return Kernel::template run<P>(arguments...);
}
template <typename P, typename Kernel, typename... Arguments>
[[gnu::flatten, gnu::noinline]] auto run_any(Arguments... arguments) {
    return Kernel::template run<P>(arguments...);
}

/// Numbers and pointers go by value, all else by reference.
template <typename A>
using as_passed =
    std::conditional_t<std::is_scalar_v<std::remove_cvref_t<A>>, std::remove_cvref_t<A>, std::remove_reference_t<A>&>;

/// Calls `Kernel` with pack `P`: from outside, for who knows the machine, or from a kernel of the same pack, which
/// keeps this part of it out of line.
template <typename P, typename Kernel, typename... Arguments>
[[gnu::always_inline]] inline auto call(Arguments&&... arguments) {
    using packs = packs_of<typename P::scalar>;
    if constexpr (std::is_same_v<P, typename packs::any>) {
        return run_any<P, Kernel, as_passed<Arguments>...>(arguments...);
    } else if constexpr (std::is_same_v<P, typename packs::avx2>) {
        return run_avx2<P, Kernel, as_passed<Arguments>...>(arguments...);
    } else if constexpr (std::is_same_v<P, typename packs::avx512>) {
        return run_avx512<P, Kernel, as_passed<Arguments>...>(arguments...);
    } else {
        return Kernel::template run<P>(arguments...);
    }
}

/// Runs `Kernel` with the widest pack of `T` that this machine has; every pack gives the same answers.
template <typename T, typename Kernel, typename... Arguments>
[[gnu::always_inline]] inline auto run_best(Arguments&&... arguments) {
    using packs = packs_of<T>;
    if constexpr (std::is_same_v<typename packs::avx2, typename packs::any>) {
        return call<typename packs::any, Kernel>(arguments...);
    } else if constexpr (always_avx512) {
        return call<typename packs::avx512, Kernel>(arguments...);
    } else {
        if (__builtin_cpu_supports("avx512f")) { return call<typename packs::avx512, Kernel>(arguments...); }
        if constexpr (always_avx2) {
            return call<typename packs::avx2, Kernel>(arguments...);
        } else {
            if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi")) {
                return call<typename packs::avx2, Kernel>(arguments...);
            }
            return call<typename packs::any, Kernel>(arguments...);
        }
    }
}

#else

template <typename P, typename Kernel, typename... Arguments>
auto call(Arguments&&... arguments) {
    return Kernel::template run<P>(arguments...);
}

template <typename T, typename Kernel, typename... Arguments>
auto run_best(Arguments&&... arguments) {
    return Kernel::template run<typename packs_of<T>::any>(arguments...);
}

#endif

}  // namespace aglow::simd
