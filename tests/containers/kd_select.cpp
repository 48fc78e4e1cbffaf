#include <aglow/containers/kd_median.hpp>
#include <aglow/containers/kd_select.hpp>
#include <aglow/core/simd_best.hpp>

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

template <typename Runner, typename T>
T kth(std::vector<T> numbers, std::uint32_t k, T bound) {
    const auto count = static_cast<std::uint32_t>(numbers.size());
    std::vector<T> spare(count + simd::lanes);
    std::vector<T> other(count + simd::lanes);
    numbers.resize(count + simd::lanes);
    return detail::kth_smallest<Runner>(numbers.data(), count, k, bound, spare.data(), other.data());
}

template <typename Runner, typename T>
detail::kd_rank<T> median(std::vector<T> numbers, std::uint32_t k) {
    const auto count = static_cast<std::uint32_t>(numbers.size());
    const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
    const detail::kd_interval<T> range{*low, *high};
    numbers.resize(count + simd::lanes, std::numeric_limits<T>::max());
    detail::kd_room<T> room{count};
    return detail::find_median<Runner>(room, numbers.data(), count, k, range);
}

template <typename T>
using best = detail::kd_best_runner<T>;
template <typename T>
using one_by_one = detail::kd_pack_runner<simd::plain<T>>;

}  // namespace

TEMPLATE_TEST_CASE("kd_select: the k-th smallest is what sorting finds", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& how : ways) {
        for (const std::uint32_t count : counts) {
            const auto numbers = spread<T>(how, count, count);
            auto sorted = numbers;
            std::sort(sorted.begin(), sorted.end());
            for (const std::uint32_t k : ranks(count)) {
                for (const T bound : {T(1), T(1e9)}) {
                    CAPTURE(how, count, k, bound);
                    REQUIRE(kth<best<T>>(numbers, k, bound) == sorted[k - 1]);
                    REQUIRE(kth<one_by_one<T>>(numbers, k, bound) == sorted[k - 1]);
                }
            }
        }
    }
}

TEMPLATE_TEST_CASE("kd_median: value, fewer and equal are what counting finds", "[kd_tree]", float, double) {
    using T = TestType;
    for (const std::string& how : ways) {
        for (const std::uint32_t count : counts) {
            auto numbers = spread<T>(how, count, 3 * count);
            for (T& x : numbers) { x = 2 * x - 1; }
            auto sorted = numbers;
            std::sort(sorted.begin(), sorted.end());
            for (const std::uint32_t k : ranks(count)) {
                CAPTURE(how, count, k);
                const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), sorted[k - 1]);
                for (const detail::kd_rank<T>& rank :
                     {median<best<T>>(numbers, k), median<one_by_one<T>>(numbers, k)}) {
                    REQUIRE(rank.value == sorted[k - 1]);
                    REQUIRE(rank.less == static_cast<std::uint32_t>(first - sorted.begin()));
                    REQUIRE(rank.equal == static_cast<std::uint32_t>(last - first));
                }
            }
        }
    }
}
