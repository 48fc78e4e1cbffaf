#include <aglow/core/random.hpp>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <aglow/concepts/sampler.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

namespace {

using aglow::path_key;
using aglow::purpose;
using aglow::random_numbers;

static_assert(aglow::Sampler<aglow::random_sampler<float>> && aglow::Sampler<aglow::random_sampler<double>>);
static_assert(aglow::Numbers<random_numbers<float>> && aglow::Numbers<random_numbers<double>>);
static_assert(aglow::unit_interval<float>(~std::uint64_t{0}) == aglow::one_below<float>);
static_assert(aglow::unit_interval<double>(~std::uint64_t{0}) == aglow::one_below<double>);
static_assert(aglow::unit_interval<float>(0) == 0 && aglow::unit_interval<double>(0) == 0);

constexpr purpose purposes[]{purpose::camera,       purpose::emission, purpose::light,
                             purpose::scatter,      purpose::roulette, purpose::gather,
                             purpose::continuation, purpose::audit,    purpose::host};

template <typename A, typename B>
double independence(A&& a, B&& b, std::uint64_t count = 50'000) {
    std::vector<double> counts(256);
    for (std::uint64_t i = 0; i < count; ++i) {
        counts[static_cast<std::size_t>(a(i) * 16) * 16 + static_cast<std::size_t>(b(i) * 16)] += 1;
    }
    return statistics::chi2_uniform(counts).p;
}

double first(const path_key& key, std::uint32_t bounce, purpose why) {
    return random_numbers<double>{key}.at(bounce, why).next_1d();
}

}  // namespace

TEMPLATE_TEST_CASE("random: numbers are uniform from 0 to below 1, alone and in pairs, along a stream and across", "",
                   float, double) {
    using T = TestType;
    aglow::random_sampler<T> along{1};
    statistics::sample_mean mean;
    std::vector<double> counts(1024);
    for (int i = 0; i < 500'000; ++i) {
        const T u = along.next_1d();
        REQUIRE((u >= 0 && u < 1));
        mean.add(double(u));
        counts[static_cast<std::size_t>(u * 1024)] += 1;
    }
    CHECK(mean.agrees(0.5, 4));
    CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    const auto across = [](std::uint64_t i) { return double(aglow::random_sampler<T>{aglow::mix(i)}.next_1d()); };
    CHECK(independence(across, [&](std::uint64_t i) { return across(i + 1); }) > 1e-4);
    aglow::random_sampler<T> pairs{2};
    T x = 0;
    const auto next = [&](std::uint64_t) {
        const aglow::vec2<T> u = pairs.next_2d();
        x = u.x;
        return double(u.y);
    };
    CHECK(independence(next, [&](std::uint64_t) { return double(x); }) > 1e-4);
}

TEST_CASE("random: each two purposes of one bounce are independent") {
    for (const purpose a : purposes) {
        for (const purpose b : purposes) {
            if (a >= b) { continue; }
            INFO(static_cast<int>(a) << " and " << static_cast<int>(b));
            CHECK(independence(
                      [&](std::uint64_t i) {
                          return first({1, 0, i}, 2, a);
                      },
                      [&](std::uint64_t i) {
                          return first({1, 0, i}, 2, b);
                      },
                      20'000) > 1e-5);
        }
    }
}

TEST_CASE("random: bounces, paths, passes, seeds and branches are independent") {
    const auto base = [](std::uint64_t i) { return first({i, i, i}, 1, purpose::light); };
    const auto of = [](auto&& key) { return [key](std::uint64_t i) { return first(key(i), 1, purpose::light); }; };
    CHECK(independence(base, of([](std::uint64_t i) { return path_key{i + 1, i, i}; })) > 1e-4);
    CHECK(independence(base, of([](std::uint64_t i) { return path_key{i, i + 1, i}; })) > 1e-4);
    CHECK(independence(base, of([](std::uint64_t i) { return path_key{i, i, i + 1}; })) > 1e-4);
    CHECK(independence(base, [](std::uint64_t i) { return first({i, i, i}, 2, purpose::light); }) > 1e-4);
    const auto branch = [](std::uint64_t b) {
        return [b](std::uint64_t i) {
            return random_numbers<double>{{i, i, i}}.fork(b).at(1, purpose::light).next_1d();
        };
    };
    CHECK(independence(base, branch(0)) > 1e-4);
    CHECK(independence(branch(0), branch(1)) > 1e-4);
    CHECK(independence(branch(1), [](std::uint64_t i) {
              return random_numbers<double>{{i, i, i}}.fork(1).fork(1).at(1, purpose::light).next_1d();
          }) > 1e-4);
}

TEST_CASE("random: no two names share their numbers") {
    std::set<std::uint64_t> words;
    std::size_t count = 0;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        for (std::uint64_t pass = 0; pass < 4; ++pass) {
            for (std::uint64_t path = 0; path < 64; ++path) {
                for (std::uint32_t bounce = 0; bounce < 8; ++bounce) {
                    for (const purpose why : purposes) {
                        words.insert(mix(path_key{seed, pass, path}, bounce, why));
                        ++count;
                    }
                }
            }
        }
    }
    CHECK(words.size() == count);
    CHECK(aglow::mix(1, 2) != aglow::mix(2, 1));
}

TEST_CASE("random: the same name gives the same numbers, whoever asks and however often") {
    const random_numbers<float> numbers{{1, 2, 3}};
    auto once = numbers.at(4, purpose::gather);
    auto again = random_numbers<float>{{1, 2, 3}}.at(4, purpose::gather);
    for (int i = 0; i < 10; ++i) { CHECK(once.next_1d() == again.next_1d()); }
    auto copy = once;
    CHECK(copy.next_1d() == once.next_1d());
}

TEST_CASE("random: mixing is the published one") {
    // SplitMix64 (Steele et al. 2014) from state 0: its first two outputs, as published with the generator.
    CHECK(aglow::mix(std::uint64_t{0x9e3779b97f4a7c15}) == std::uint64_t{0xe220a8397b1dcdaf});
    CHECK(aglow::mix(2 * std::uint64_t{0x9e3779b97f4a7c15}) == std::uint64_t{0x6e789e6aa1b965f4});
}
