#include <aglow/core/sobol.hpp>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <aglow/concepts/sampler.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

namespace {

using aglow::purpose;
using aglow::vec2;

static_assert(aglow::Sampler<aglow::sobol_sampler<float>> && aglow::Sampler<aglow::sobol_sampler<double>>);
static_assert(aglow::Numbers<aglow::sobol_numbers<float>> && aglow::Numbers<aglow::sobol_numbers<double>>);

/// Whether points [start, start + 2^m) have one in each of the 2^m boxes, for all m + 1 shapes of box.
template <typename T>
bool is_net(std::uint32_t start, int m, std::uint64_t seed) {
    for (int columns = 0; columns <= m; ++columns) {
        std::set<std::uint32_t> met;
        for (std::uint32_t i = 0; i < (1u << m); ++i) {
            const vec2<T> p = aglow::sobol_2d<T>(start + i, seed);
            const auto x = static_cast<std::uint32_t>(std::ldexp(p.x, columns));
            const auto y = static_cast<std::uint32_t>(std::ldexp(p.y, m - columns));
            met.insert((x << (m - columns)) | y);
        }
        if (met.size() != (std::size_t{1} << m)) { return false; }
    }
    return true;
}

}  // namespace

TEMPLATE_TEST_CASE("sobol: every aligned block of 2^m points has one in each elementary box", "", float, double) {
    for (const std::uint64_t seed :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{0x123456789abcdef}, ~std::uint64_t{0}}) {
        for (int m = 0; m <= 8; ++m) {
            for (const std::uint32_t block : {0u, 1u, 5u, (1u << 20) - 1}) {
                INFO("seed " << seed << ", 2^" << m << " points, block " << block);
                CHECK(is_net<TestType>(block << m, m, seed));
            }
        }
        CHECK(is_net<TestType>(0, 12, seed));
        CHECK(is_net<TestType>(~std::uint32_t{0} - 1023, 10, seed));
    }
}

TEST_CASE("sobol: without scrambling the second dimension is the known sequence") {
    // The direction numbers 1/2, 3/4, 5/8 of the second dimension (Joe & Kuo 2008), added without carry.
    const double expected[]{0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875};
    for (std::uint32_t i = 0; i < 8; ++i) {
        CHECK(aglow::reverse_bits(aglow::sobol_1_reversed(i)) * 0x1p-32 == expected[i]);
    }
}

TEST_CASE("sobol: bits are reversed") {
    CHECK(aglow::reverse_bits(1u) == 0x80000000u);
    CHECK(aglow::reverse_bits(0x12345678u) == 0x1e6a2c48u);
    CHECK(aglow::reverse_bits(aglow::reverse_bits(0xdeadbeefu)) == 0xdeadbeefu);
    CHECK(aglow::reverse_bits(std::uint64_t{1}) == 0x8000000000000000u);
    CHECK(aglow::reverse_bits(std::uint64_t{0x12345678deadbeef}) ==
          (std::uint64_t{aglow::reverse_bits(0xdeadbeefu)} << 32 | 0x1e6a2c48u));
}

TEST_CASE("sobol: scrambling is a bijection whose digits depend on higher ones alone") {
    for (const std::uint32_t seed : {0u, 1u, 0x9e3779b9u}) {
        std::set<std::uint32_t> met;
        for (std::uint32_t i = 0; i < 4096; ++i) { met.insert(aglow::owen_scramble(i << 20, seed) >> 20); }
        CHECK(met.size() == 4096);
        aglow::random_sampler<double> random{seed};
        for (int i = 0; i < 10'000; ++i) {
            const auto x = static_cast<std::uint32_t>(random.next_1d() * 0x1p32);
            const int kept = 1 + static_cast<int>(random.next_1d() * 31);
            const std::uint32_t changed =
                x ^ (~std::uint32_t{0} >> kept & (static_cast<std::uint32_t>(i) * 2654435761u));
            REQUIRE(aglow::owen_scramble(x, seed) >> (32 - kept) == aglow::owen_scramble(changed, seed) >> (32 - kept));
        }
    }
}

TEMPLATE_TEST_CASE("sobol: over the seeds each point is uniform over the square", "", float, double) {
    using T = TestType;
    for (const std::uint32_t index : {0u, 1u, 7u, 1000u, ~0u}) {
        std::vector<double> counts(256);
        statistics::sample_mean x;
        statistics::sample_mean y;
        for (std::uint64_t seed = 0; seed < 50'000; ++seed) {
            const vec2<T> p = aglow::sobol_2d<T>(index, aglow::mix(seed, 5));
            REQUIRE((p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1));
            counts[static_cast<std::size_t>(p.x * 16) * 16 + static_cast<std::size_t>(p.y * 16)] += 1;
            x.add(double(p.x));
            y.add(double(p.y));
        }
        INFO("index " << index);
        CHECK(statistics::chi2_uniform(counts).p > 1e-4);
        CHECK(x.agrees(0.5, 4));
        CHECK(y.agrees(0.5, 4));
    }
}

TEMPLATE_TEST_CASE("sobol: decisions of one pixel, and draws for one, are as independent as random numbers", "", float,
                   double) {
    using T = TestType;
    std::vector<double> counts(256);
    std::vector<double> counts_of_one(256);
    const auto count = [](std::vector<double>& of, T a, T b) {
        of[static_cast<std::size_t>(a * 16) * 16 + static_cast<std::size_t>(b * 16)] += 1;
    };
    for (std::uint64_t pixel = 0; pixel < 500; ++pixel) {
        for (std::uint32_t i = 0; i < 64; ++i) {
            const aglow::sobol_numbers<T> numbers{{1, 0, pixel}, i};
            auto sampler = numbers.at(0, purpose::light);
            const T a = sampler.next_2d().x;
            count(counts, a, numbers.at(1, purpose::light).next_2d().x);
            count(counts_of_one, a, sampler.next_2d().x);
        }
    }
    CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    CHECK(statistics::chi2_uniform(counts_of_one).p > 1e-4);
}

TEMPLATE_TEST_CASE("sobol: one decision is stratified over a pixel's samples, forked or not", "", float, double) {
    using T = TestType;
    for (const bool forked : {false, true}) {
        std::set<int> first;
        std::set<int> second;
        for (std::uint32_t i = 0; i < 64; ++i) {
            const aglow::sobol_numbers<T> numbers{{1, 2, 3}, i};
            auto sampler = (forked ? numbers.fork(7) : numbers).at(2, purpose::scatter);
            const vec2<T> p = sampler.next_2d();
            first.insert(static_cast<int>(p.x * 8) * 8 + static_cast<int>(p.y * 8));
            second.insert(static_cast<int>(sampler.next_1d() * 64));
        }
        CHECK(first.size() == 64);
        CHECK(second.size() == 64);
    }
}

TEST_CASE("sobol: the same key draws the same numbers, any other key others") {
    const auto first = [](const aglow::path_key& key, std::uint32_t bounce, purpose why) {
        return aglow::sobol_numbers<double>{key, 5}.at(bounce, why).next_1d();
    };
    CHECK(first({1, 2, 3}, 4, purpose::light) == first({1, 2, 3}, 4, purpose::light));
    std::set<double> drawn;
    drawn.insert(first({1, 2, 3}, 4, purpose::light));
    drawn.insert(first({2, 2, 3}, 4, purpose::light));
    drawn.insert(first({1, 3, 3}, 4, purpose::light));
    drawn.insert(first({1, 2, 4}, 4, purpose::light));
    drawn.insert(first({1, 2, 3}, 5, purpose::light));
    drawn.insert(first({1, 2, 3}, 4, purpose::scatter));
    const aglow::sobol_numbers<double> trunk{{1, 2, 3}, 5};
    drawn.insert(trunk.fork(0).at(4, purpose::light).next_1d());
    drawn.insert(trunk.fork(1).at(4, purpose::light).next_1d());
    CHECK(drawn.size() == 8);
}

TEST_CASE("sobol: integrates a smooth function at 1024 points a tenth as wrong as random numbers do") {
    double squares = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        double sum = 0;
        for (std::uint32_t i = 0; i < 1024; ++i) {
            const vec2<double> p = aglow::sobol_2d<double>(i, aglow::mix(seed));
            sum += std::exp(p.x + p.y);
        }
        squares += aglow::square(sum / 1024 - aglow::square(std::exp(1.0) - 1));
    }
    const double mean = aglow::square(std::exp(1.0) - 1);
    const double variance = aglow::square((std::exp(2.0) - 1) / 2) - mean * mean;
    CHECK(std::sqrt(squares / 50) < 0.1 * std::sqrt(variance / 1024));
}
