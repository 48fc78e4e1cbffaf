// Every pack is compared with the plain one, which does one number after another.
#include <aglow/core/simd.hpp>

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

template <typename P>
using numbers = std::array<typename P::scalar, simd::lanes>;

/// Numbers with ties, signs, zeros and a wide range of sizes.
template <typename P>
numbers<P> some(std::mt19937& random) {
    using T = typename P::scalar;
    numbers<P> a;
    for (T& x : a) {
        const auto kind = random() % 4;
        x = static_cast<T>(random() % 5);
        if (kind == 0) { x = -x; }
        if (kind > 1) { x = std::ldexp(static_cast<T>(random() >> 8), static_cast<int>(random() % 40) - 44); }
    }
    return a;
}

template <typename P>
numbers<P> as_array(const P& p) {
    numbers<P> a;
    P::store(a.data(), p);
    return a;
}

template <typename P>
bool same(const P& p, const numbers<P>& truth) {
    return as_array(p) == truth;
}

}  // namespace

TEMPLATE_TEST_CASE("simd: every pack has the bits of one number after another", "[simd]", simd::best<float>,
                   simd::best<double>, simd::plain<float>, simd::plain<double>) {
    using P = TestType;
    using T = typename P::scalar;
    std::mt19937 random{1};
    for (int round = 0; round < 2000; ++round) {
        const auto x = some<P>(random);
        const auto y = some<P>(random);
        const auto z = some<P>(random);
        const P a = P::load(x.data());
        const P b = P::load(y.data());
        numbers<P> difference;
        numbers<P> least;
        numbers<P> most;
        numbers<P> length2;
        std::uint32_t less = 0;
        std::uint32_t equal = 0;
        for (unsigned i = 0; i < simd::lanes; ++i) {
            difference[i] = x[i] - y[i];
            least[i] = std::min(x[i], y[i]);
            most[i] = std::max(x[i], y[i]);
            length2[i] = simd::length2(x[i], y[i], z[i]);
            less |= std::uint32_t{x[i] < y[i]} << i;
            equal |= std::uint32_t{x[i] == y[i]} << i;
        }
        REQUIRE(same(P::sub(a, b), difference));
        REQUIRE(same(P::min(a, b), least));
        REQUIRE(same(P::max(a, b), most));
        REQUIRE(same(P::length2(a, b, P::load(z.data())), length2));
        REQUIRE(P::less(a, b) == less);
        REQUIRE(P::equal(a, b) == equal);
        REQUIRE(P::smallest(a) == *std::min_element(x.begin(), x.end()));
        REQUIRE(P::largest(a) == *std::max_element(x.begin(), x.end()));
        REQUIRE(same(P::all(x[3]), [&] {
            numbers<P> all;
            all.fill(x[3]);
            return all;
        }()));
        auto without = x;
        without[static_cast<std::size_t>(round) % simd::lanes] = std::numeric_limits<T>::max();
        REQUIRE(same(P::without(a, static_cast<std::uint32_t>(round) % simd::lanes), without));
    }
}

TEMPLATE_TEST_CASE("simd: compressing keeps the lanes of every mask in their order", "[simd]", simd::best<float>,
                   simd::best<double>, simd::plain<float>) {
    using P = TestType;
    using T = typename P::scalar;
    numbers<P> x;
    std::array<std::uint32_t, simd::lanes> n;
    for (std::uint32_t i = 0; i < simd::lanes; ++i) {
        x[i] = static_cast<T>(100 + i);
        n[i] = 7 * i + 3;
    }
    for (std::uint32_t mask = 0; mask < 0x10000; ++mask) {
        numbers<P> kept;
        std::array<std::uint32_t, simd::lanes> kept_n;
        std::array<std::uint32_t, simd::lanes> counted;
        P::compress(kept.data(), P::load(x.data()), mask);
        P::compress(kept_n.data(), n.data(), mask);
        P::compress_numbers(counted.data(), 5000, mask);
        std::size_t to = 0;
        bool right = true;
        for (std::uint32_t i = 0; i < simd::lanes; ++i) {
            if ((mask >> i & 1u) == 0) { continue; }
            right = right && kept[to] == x[i] && kept_n[to] == n[i] && counted[to] == 5000 + i;
            ++to;
        }
        if (!right) { FAIL("mask " << mask); }
    }
    SUCCEED();
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

TEST_CASE("simd: next_above is the next number", "[simd]") {
    CHECK(simd::next_above(0.0f) == std::numeric_limits<float>::denorm_min());
    CHECK(simd::next_above(1.0f) == 1.0f + std::numeric_limits<float>::epsilon());
    CHECK(simd::next_above(1.0) == 1.0 + std::numeric_limits<double>::epsilon());
    CHECK(simd::next_above(std::nextafter(3.0f, 0.0f)) == 3.0f);
}
