// Every pack is compared with the plain one, which does one number after another.
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"

using namespace aglow;

namespace {

template <typename T>
using numbers = std::array<T, simd::lanes>;

/// All that a pack says of three arrays.
template <typename T>
struct facts {
    numbers<T> sub, min, max, length2, all, without, step;
    std::uint32_t less, equal;
    T smallest, largest;
    bool operator==(const facts&) const = default;
};

struct tell_facts {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline facts<T> run(const numbers<T>& x, const numbers<T>& y, const numbers<T>& z) {
        const P a = P::load(x.data());
        const P b = P::load(y.data());
        facts<T> told{};
        P::store(told.sub.data(), P::sub(a, b));
        P::store(told.min.data(), P::min(a, b));
        P::store(told.max.data(), P::max(a, b));
        P::store(told.length2.data(), P::length2(a, b, P::load(z.data())));
        P::store(told.all.data(), P::all(x[3]));
        P::store(told.without.data(), P::without(a, 11));
        P::store(told.step.data(), P::step(P::all(T(1.5)), a, b));
        told.less = P::less(a, b);
        told.equal = P::equal(a, b);
        told.smallest = P::smallest(a);
        told.largest = P::largest(a);
        return told;
    }
};

/// The first mask, of all, whose lanes are not compressed right; 0x10000 if none.
struct find_wrong_mask {
    template <typename P, typename T>
    [[gnu::always_inline]] static inline std::uint32_t run(const numbers<T>& x, const numbers<std::uint32_t>& n) {
        for (std::uint32_t mask = 0; mask < 0x10000; ++mask) {
            numbers<T> kept;
            numbers<std::uint32_t> kept_n;
            numbers<std::uint32_t> counted;
            P::compress(kept.data(), P::load(x.data()), mask);
            P::compress(kept_n.data(), n.data(), mask);
            P::compress_numbers(counted.data(), 5000, mask);
            std::size_t to = 0;
            for (std::uint32_t i = 0; i < simd::lanes; ++i) {
                if ((mask >> i & 1u) == 0) { continue; }
                if (kept[to] != x[i] || kept_n[to] != n[i] || counted[to] != 5000 + i) { return mask; }
                ++to;
            }
        }
        return 0x10000;
    }
};

/// Asks every pack of `T` that this machine has; the plain one first.
template <typename T, typename Kernel, typename... Arguments>
auto ask_all(const Arguments&... arguments) {
    std::vector<decltype(Kernel::template run<simd::plain<T>>(arguments...))> told;
    told.push_back(Kernel::template run<simd::plain<T>>(arguments...));
    told.push_back(simd::run_best<T, Kernel>(arguments...));
#if defined(__x86_64__) && defined(__GNUC__)
    using packs = simd::packs_of<T>;
    if (__builtin_cpu_supports("avx2")) { told.push_back(simd::call<typename packs::avx2, Kernel>(arguments...)); }
    told.push_back(simd::call<typename packs::any, Kernel>(arguments...));
#endif
    return told;
}

/// Numbers with ties, signs, zeros and a wide range of sizes.
template <typename T>
numbers<T> some(std::mt19937& random) {
    numbers<T> a;
    for (T& x : a) {
        const auto kind = random() % 4;
        x = static_cast<T>(random() % 5);
        if (kind == 0) { x = -x; }
        if (kind > 1) { x = std::ldexp(static_cast<T>(random() >> 8), static_cast<int>(random() % 40) - 44); }
    }
    return a;
}

/// What is true of three arrays, one number after another.
template <typename T>
facts<T> truth(const numbers<T>& x, const numbers<T>& y, const numbers<T>& z) {
    facts<T> t{};
    for (unsigned i = 0; i < simd::lanes; ++i) {
        t.sub[i] = x[i] - y[i];
        t.min[i] = std::min(x[i], y[i]);
        t.max[i] = std::max(x[i], y[i]);
        t.length2[i] = simd::length2(x[i], y[i], z[i]);
        t.all[i] = x[3];
        t.step[i] = x[i] < y[i] ? std::nextafter(T(1.5), T(2)) : T(1.5);
        t.less |= std::uint32_t{x[i] < y[i]} << i;
        t.equal |= std::uint32_t{x[i] == y[i]} << i;
    }
    t.without = x;
    t.without[11] = std::numeric_limits<T>::max();
    t.smallest = *std::min_element(x.begin(), x.end());
    t.largest = *std::max_element(x.begin(), x.end());
    return t;
}

}  // namespace

TEMPLATE_TEST_CASE("simd: every pack has the bits of one number after another", "[simd]", float, double) {
    using T = TestType;
    std::mt19937 random{1};
    for (int round = 0; round < 2000; ++round) {
        const auto x = some<T>(random);
        const auto y = some<T>(random);
        const auto z = some<T>(random);
        const facts<T> right = truth(x, y, z);
        for (const facts<T>& told : ask_all<T, tell_facts>(x, y, z)) { REQUIRE(told == right); }
    }
}

TEMPLATE_TEST_CASE("simd: compressing keeps the lanes of every mask in their order", "[simd]", float, double) {
    using T = TestType;
    numbers<T> x;
    numbers<std::uint32_t> n;
    for (std::uint32_t i = 0; i < simd::lanes; ++i) {
        x[i] = static_cast<T>(100 + i);
        n[i] = 7 * i + 3;
    }
    for (const std::uint32_t wrong : ask_all<T, find_wrong_mask>(x, n)) { CHECK(wrong == 0x10000); }
}

TEST_CASE("simd: a squared length is not fused", "[simd]") {
    // With a fused multiply-add the square of one would keep the bits below the last place of the other.
    const float x = 1 + 0x1p-12f;
    const float xx = x * x;
    CHECK(simd::length2(x, x, 0.0f) == simd::rounded(xx + xx));
    const volatile float y = 1 + 0x1p-23f;
    const volatile float yy = y * y;
    const volatile float sum = yy + yy;
    CHECK(simd::length2<float>(y, y, 0) == sum);
}

TEST_CASE("simd: next_above is the next normal number", "[simd]") {
    CHECK(simd::next_above(0.0f) == std::numeric_limits<float>::min());
    CHECK(simd::next_above(1.0f) == 1.0f + std::numeric_limits<float>::epsilon());
    CHECK(simd::next_above(1.0) == 1.0 + std::numeric_limits<double>::epsilon());
    CHECK(simd::next_above(std::nextafter(3.0f, 0.0f)) == 3.0f);
}
