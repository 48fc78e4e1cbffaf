#include <aglow/containers/kd_median.hpp>
#include <aglow/containers/kd_select.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace aglow;

namespace {

/// Numbers in [0, 1) spread in ways that a guess of evenness gets wrong.
template <typename T>
std::vector<T> spread(const std::string& how, std::uint32_t count, std::uint32_t seed) {
    std::mt19937 random{seed};
    std::vector<T> all(count);
    for (T& x : all) {
        x = static_cast<T>(random() >> 8) / T(1 << 24);
        if (how == "steep") { x = x * x * x * x * x * x; }
        if (how == "few values") { x = static_cast<T>(random() % 5) / 8; }
        if (how == "one value") { x = T(0.25); }
        if (how == "one far") { x = random() % 50 == 0 ? T(0.9) : x * T(1e-6); }
        if (how == "half tied" && random() % 2 == 0) { x = T(0.5); }
    }
    return all;
}

const std::vector<std::string> ways{"even", "steep", "few values", "one value", "one far", "half tied"};
const std::vector<std::uint32_t> counts{1, 2, 31, 32, 33, 64, 65, 100, 333, 1000, 5000, 20'000};

/// A few ranks of each count: the ends, the middle and others.
std::vector<std::uint32_t> ranks(std::uint32_t count) {
    std::vector<std::uint32_t> all{1, count, (count + 1) / 2, count / 3 + 1, count - count / 10};
    all.erase(std::remove_if(all.begin(), all.end(), [&](auto k) { return k < 1 || k > count; }), all.end());
    return all;
}

}  // namespace

TEMPLATE_TEST_CASE("kd_select: the k-th smallest is what sorting finds", "[kd_tree]", simd::best<float>,
                   simd::plain<float>, simd::plain<double>) {
    using T = typename TestType::scalar;
    for (const std::string& how : ways) {
        for (const std::uint32_t count : counts) {
            const auto numbers = spread<T>(how, count, count);
            auto sorted = numbers;
            std::sort(sorted.begin(), sorted.end());
            std::vector<T> spare(count + simd::lanes);
            std::vector<T> other(count + simd::lanes);
            for (const std::uint32_t k : ranks(count)) {
                for (const T bound : {T(1), T(1e9)}) {
                    auto copy = numbers;
                    copy.resize(count + simd::lanes);
                    CAPTURE(how, count, k, bound);
                    REQUIRE(detail::kth_smallest<TestType>(copy.data(), count, k, bound, spare.data(), other.data()) ==
                            sorted[k - 1]);
                }
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_median: value, fewer and equal are what counting finds", "[kd_tree]", simd::best<float>,
                   simd::plain<float>, simd::plain<double>) {
    using T = typename TestType::scalar;
    for (const std::string& how : ways) {
        for (const std::uint32_t count : counts) {
            auto numbers = spread<T>(how, count, 3 * count);
            for (T& x : numbers) { x = 2 * x - 1; }
            auto sorted = numbers;
            std::sort(sorted.begin(), sorted.end());
            const T low = sorted.front();
            const T high = sorted.back();
            numbers.resize(count + simd::lanes, std::numeric_limits<T>::max());
            detail::kd_median<TestType> find{count};
            for (const std::uint32_t k : ranks(count)) {
                CAPTURE(how, count, k);
                const detail::kd_rank<T> rank = find(numbers.data(), count, k, low, high);
                REQUIRE(rank.value == sorted[k - 1]);
                const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), rank.value);
                REQUIRE(rank.less == static_cast<std::uint32_t>(first - sorted.begin()));
                REQUIRE(rank.equal == static_cast<std::uint32_t>(last - first));
            }
        }
    }
}
