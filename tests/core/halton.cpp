#include <aglow/core/halton.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <aglow/concepts/sampler.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

namespace {

using aglow::halton_numbers;
using aglow::halton_scrambling;
using aglow::purpose;

static_assert(aglow::Sampler<aglow::halton_sampler<float>> && aglow::Sampler<aglow::halton_sampler<double>>);
static_assert(aglow::Numbers<halton_numbers<float>> && aglow::Numbers<halton_numbers<double>>);

const halton_scrambling& thousand() {
    static const halton_scrambling table{7, 3, 1000};
    return table;
}

constexpr std::uint64_t two_32 = std::uint64_t{1} << 32;
constexpr std::uint64_t far_indices[]{
    1, 2, 63, two_32 - 1, two_32, two_32 + 1, 1u << 24, 999'999'937, std::uint64_t{1} << 53, ~std::uint64_t{0}};

/// Every permuted digit of one dimension as far as a double tells them, seen from outside: the number of d b^place
/// differs from that of 0 in that one digit.
std::vector<std::vector<double>> seen_digits(const halton_scrambling& table, std::size_t dimension) {
    const std::uint64_t base = table.base(dimension);
    const double zero = table.number<double>(0, dimension);
    std::vector<std::vector<double>> places;
    for (std::uint64_t weight = 1; weight * base <= std::uint64_t{1} << 44; weight *= base) {
        std::vector<double> digits;
        for (std::uint64_t d = 0; d < base; ++d) {
            digits.push_back((table.number<double>(d * weight, dimension) - zero) * double(weight * base));
        }
        places.push_back(digits);
    }
    return places;
}

/// Whether `digits` are whole, all different, and `base` in a row.
bool is_permutation(std::vector<double> digits) {
    std::sort(digits.begin(), digits.end());
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (std::abs(digits[i] - std::round(digits[0]) - double(i)) > 0.01) { return false; }
    }
    return true;
}

/// The index whose every digit is the one that makes the number largest.
std::uint64_t largest_index(const halton_scrambling& table, std::size_t dimension) {
    const std::uint64_t base = table.base(dimension);
    std::uint64_t index = 0;
    for (std::uint64_t weight = 1; weight <= ~std::uint64_t{0} / base / base; weight *= base) {
        std::uint64_t best = 0;
        for (std::uint64_t d = 1; d < base; ++d) {
            const double candidate = table.number<double>(index + d * weight, dimension);
            if (candidate > table.number<double>(index + best * weight, dimension)) { best = d; }
        }
        index += best * weight;
    }
    return index;
}

}  // namespace

TEST_CASE("halton: the bases of the first thousand dimensions are the first thousand primes") {
    CHECK(thousand().base(0) == 2);
    CHECK(thousand().base(1) == 3);
    CHECK(thousand().base(25) == 101);
    CHECK(thousand().base(63) == 311);
    CHECK(thousand().base(999) == 7919);
}

TEST_CASE("halton: numbers are the permuted digits of long division, in a thousand dimensions and to the last index") {
    for (std::size_t dimension = 0; dimension < 1000; ++dimension) {
        const std::uint64_t base = thousand().base(dimension);
        INFO("base " << base);
        const auto places = seen_digits(thousand(), dimension);
        REQUIRE(std::all_of(places.begin(), places.end(), is_permutation));
        const double beyond = std::pow(double(base), -double(places.size()));
        for (const std::uint64_t index : far_indices) {
            double expected = thousand().number<double>(0, dimension);
            double weight = 1;
            std::uint64_t rest = index;
            for (const auto& digits : places) {
                weight /= double(base);
                expected += std::round(digits[rest % base]) * weight;
                rest /= base;
            }
            INFO("index " << index);
            REQUIRE(std::abs(thousand().number<double>(index, dimension) - expected) <= beyond + 0x1p-50);
        }
    }
}

TEST_CASE("halton: each dimension and place has a permutation of its own") {
    const halton_scrambling table{1};
    std::set<std::vector<double>> permutations;
    for (const auto& digits : seen_digits(table, 5)) {  // base 13: 13! orders, so none should come twice
        std::vector<double> order;
        for (const double d : digits) {
            order.push_back(std::round(d - *std::min_element(digits.begin(), digits.end())));
        }
        permutations.insert(order);
    }
    CHECK(permutations.size() == seen_digits(table, 5).size());
    CHECK(halton_scrambling{1, 0, 1}.number<double>(1, 0) == table.number<double>(1, 0));
    std::set<double> others;
    for (std::uint64_t pass = 0; pass < 10; ++pass) {
        others.insert(halton_scrambling{1, pass, 8}.number<double>(1, 7));
    }
    for (std::uint64_t seed = 1; seed < 10; ++seed) {
        others.insert(halton_scrambling{seed + 1, 0, 8}.number<double>(1, 7));
    }
    CHECK(others.size() == 19);
}

TEST_CASE("halton: never below zero and never one, in the table and past it") {
    for (std::size_t dimension = 0; dimension < 1100; ++dimension) {
        for (const std::uint64_t index : far_indices) {
            const double x = thousand().number<double>(index, dimension);
            const float y = thousand().number<float>(index, dimension);
            REQUIRE((x >= 0 && x < 1));
            REQUIRE((y >= 0 && y < 1));
            REQUIRE(std::abs(x - double(y)) <= 0x1p-24);
        }
    }
}

TEST_CASE("halton: the largest number of a dimension is just below one, not one") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const halton_scrambling table{seed, 0, 20};
        for (std::size_t dimension = 0; dimension < 20; ++dimension) {
            const std::uint64_t index = largest_index(table, dimension);
            INFO("seed " << seed << ", dimension " << dimension << ", index " << index);
            CHECK(table.number<double>(index, dimension) < 1);
            CHECK(table.number<double>(index, dimension) >= 1 - 0x1p-50);
            CHECK(table.number<float>(index, dimension) == aglow::one_below<float>);
        }
    }
}

TEST_CASE("halton: any base^k points in a row have one in each base^k-th") {
    const halton_scrambling table{5};
    for (std::size_t dimension = 0; dimension < 12; ++dimension) {
        const std::uint64_t base = table.base(dimension);
        for (std::uint64_t count = base; count <= 4000; count *= base) {
            for (const std::uint64_t start : {std::uint64_t{0}, std::uint64_t{12'345}, two_32 - 500}) {
                std::set<std::uint64_t> met;
                for (std::uint64_t i = 0; i < count; ++i) {
                    met.insert(static_cast<std::uint64_t>(table.number<double>(start + i, dimension) * double(count)));
                }
                INFO("base " << base << ", " << count << " from " << start);
                CHECK(met.size() == count);
                CHECK(*met.rbegin() == count - 1);
            }
        }
    }
}

TEST_CASE("halton: any 2^a 3^b 5^c points in a row have one in each such box") {
    const halton_scrambling table{5};
    for (const std::uint64_t start : {std::uint64_t{0}, std::uint64_t{77'777}, two_32 - 100}) {
        std::set<int> met;
        for (std::uint64_t i = 0; i < 8 * 9 * 5; ++i) {
            const int x = static_cast<int>(table.number<double>(start + i, 0) * 8);
            const int y = static_cast<int>(table.number<double>(start + i, 1) * 9);
            const int z = static_cast<int>(table.number<double>(start + i, 2) * 5);
            met.insert((x * 9 + y) * 5 + z);
        }
        CHECK(met.size() == 8 * 9 * 5);
    }
}

TEST_CASE("halton: over the seeds each point is uniform with mean one half") {
    for (const std::size_t dimension : {std::size_t{0}, std::size_t{1}, std::size_t{4}, std::size_t{8}}) {
        statistics::sample_mean mean;
        std::vector<double> counts(20);
        for (std::uint64_t seed = 0; seed < 2000; ++seed) {
            const double x =
                halton_scrambling{seed, 1, dimension < 4 ? dimension + 1 : dimension}.number<double>(12'345, dimension);
            mean.add(x);
            counts[static_cast<std::size_t>(x * 20)] += 1;
        }
        INFO("dimension " << dimension << ", mean " << mean.mean());
        CHECK(mean.agrees(0.5, 4));
        CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    }
}

TEST_CASE("halton: integrates a product of five waves a third as wrong as random numbers do, at any count") {
    const auto wave = [](double x) { return 1 + std::sin(2 * aglow::pi<double> * x); };
    for (const std::uint64_t count : {1000u, 4096u, 5000u}) {
        double squares = 0;
        for (std::uint64_t seed = 0; seed < 20; ++seed) {
            const halton_scrambling table{seed, 0, 5};
            double sum = 0;
            for (std::uint64_t i = 0; i < count; ++i) {
                double product = 1;
                for (std::size_t d = 0; d < 5; ++d) { product *= wave(table.number<double>(i, d)); }
                sum += product;
            }
            squares += aglow::square(sum / double(count) - 1);
        }
        // The variance of the product is (3/2)^5 - 1.
        const double random = std::sqrt((std::pow(1.5, 5) - 1) / double(count));
        INFO(count << " points: " << std::sqrt(squares / 20) << ", random " << random);
        CHECK(std::sqrt(squares / 20) < 0.33 * random);
    }
}

TEST_CASE("halton: neighbouring dimensions of high bases are as independent as random numbers") {
    const halton_scrambling table{2};
    for (std::size_t dimension = 40; dimension < 62; dimension += 3) {
        std::vector<double> counts(64);
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            const auto x = static_cast<std::size_t>(table.number<double>(i, dimension) * 8);
            const auto y = static_cast<std::size_t>(table.number<double>(i, dimension + 1) * 8);
            counts[x * 8 + y] += 1;
        }
        INFO("dimension " << dimension);
        CHECK(statistics::chi2_uniform(counts).p > 1e-4);
    }
}

TEST_CASE("halton: more than a thousand dimensions are refused, none are all hashed") {
    try {
        const halton_scrambling refused{1, 0, 1001};
        FAIL("accepted " << refused.dimensions() << " dimensions");
    } catch (const std::invalid_argument& error) {
        CHECK(std::string{error.what()} == "halton_scrambling: dimensions = 1001, above 1000");
    }
    const halton_scrambling none{1, 0, 0};
    CHECK(none.dimensions() == 0);
    CHECK(none.number<double>(1, 0) != none.number<double>(2, 0));
    CHECK(none.number<double>(1, 0) != none.number<double>(1, 1));
}

TEMPLATE_TEST_CASE("halton: each decision of a path has dimensions of its own, and hashed numbers after them", "",
                   float, double) {
    using T = TestType;
    const halton_scrambling table{4, 2, 20};
    const std::uint64_t index = 123'456;
    const halton_numbers<T> path{table, index};
    const auto expect = [&](std::uint32_t bounce, purpose why, std::size_t first, std::size_t count) {
        auto numbers = path.at(bounce, why);
        aglow::random_sampler<T> random{mix({4, 2, index}, bounce, why)};
        for (std::size_t d = first; d < first + count; ++d) {
            CHECK(numbers.next_1d() == table.template number<T>(index, d));
        }
        for (int i = 0; i < 3; ++i) { CHECK(numbers.next_1d() == random.next_1d()); }
    };
    expect(0, purpose::emission, 0, 8);
    expect(1, purpose::scatter, 8, 3);
    expect(1, purpose::roulette, 11, 1);
    expect(2, purpose::scatter, 12, 3);
    expect(3, purpose::roulette, 19, 1);
    expect(4, purpose::scatter, 20, 0);
    expect(1'000'000, purpose::scatter, 20, 0);
    expect(0, purpose::scatter, 0, 0);
    expect(1, purpose::emission, 0, 0);
    expect(2, purpose::light, 0, 0);
}

TEST_CASE("halton: what branches off a path shares no number with it or with another branch") {
    const halton_scrambling table{4};
    const halton_numbers<double> path{table, 9};
    std::set<double> drawn;
    int count = 0;
    const auto draw = [&](const halton_numbers<double>& numbers) {
        for (const auto& [bounce, why] : {std::pair{0u, purpose::emission}, std::pair{1u, purpose::scatter}}) {
            auto sampler = numbers.at(bounce, why);
            for (int i = 0; i < 12; ++i, ++count) { drawn.insert(sampler.next_1d()); }
        }
    };
    draw(path);
    for (std::uint64_t branch = 0; branch < 20; ++branch) { draw(path.fork(branch)); }
    draw(path.fork(3).fork(5));
    draw(path.fork(5).fork(3));
    CHECK(static_cast<int>(drawn.size()) == count);
    CHECK(path.fork(3).at(1, purpose::scatter).next_1d() == path.fork(3).at(1, purpose::scatter).next_1d());
}
