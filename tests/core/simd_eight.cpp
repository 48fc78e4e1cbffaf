// The machine's vectors of eight are compared with the plain ones, which do one number after another.
#include <aglow/core/simd_eight.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using eight_words = std::array<std::int32_t, 8>;
using eight_rows = std::array<std::array<std::int32_t, 9>, 8>;

/// The bits of all that vectors say of two times eight floats and of the words in eight rows.
struct facts {
    std::array<eight_words, 27> told;
    std::array<float, 5> sums;
    double squares;
    std::uint32_t holds;
};

struct tell_facts {
    template <typename V>
    [[gnu::always_inline]] static void run(const float* x, const float* y, const eight_rows& rows, facts& all) {
        using words = typename V::words;
        const V a = V::load(x), b = V::load(y);
        const words less = a < b, bits = words::column(start(rows, 0), 32);
        const V parts[5] = {a, b, a + b, V::where(less, a), V::abs(b)};
        V::add_sums(parts, all.sums);
        all.squares = V::sum_of_squares(a);
        all.holds = words::count_of(less);
        std::size_t n = 0;
        put(a + b, all, n), put(a - b, all, n), put(a * b, all, n), put(a / b, all, n);
        put(V::min(a, b), all, n), put(V::max(a, b), all, n), put(V::abs(a), all, n), put(V::where(less, a), all, n);
        put(V::root(V::abs(a)), all, n), put(V::all(x[3]), all, n), put(V::of(bits), all, n);
        put_words(less, all, n), put_words(a <= b, all, n), put_words(bits, all, n);
        put_words(bits & words::all(0xffff), all, n), put_words(bits >> 3, all, n), put_words(bits << 3, all, n);
        put_words(words::first_half(bits), all, n), put_words(words::last_half(bits), all, n);
        put_words(words::pick(words::below(5), bits, less), all, n);
        put(V::picked(y, bits & words::all(7)), all, n);
        put_words(words::load(rows[2].data()), all, n), put_words(bits - less, all, n);
        words four[4];
        words::columns(start(rows, 0), 12, &four[0]);
        for (const words& w : four) { put_words(w, all, n); }
    }

private:
    static const char* const* start(const eight_rows& rows, std::size_t first) {
        thread_local std::array<const char*, 8> starts;
        for (std::size_t i = 0; i < 8; ++i) { starts[i] = reinterpret_cast<const char*>(&rows[first + i]); }
        return starts.data();
    }
    template <typename W>
    [[gnu::always_inline]] static void put_words(const W& w, facts& all, std::size_t& n) {
        W::store(all.told[n++].data(), w);
    }
    template <typename V>
    [[gnu::always_inline]] static void put(const V& v, facts& all, std::size_t& n) {
        float each[8];
        V::store(each, v);
        std::memcpy(all.told[n++].data(), each, sizeof(each));
    }
};

}  // namespace

TEST_CASE("simd_eight: whatever the machine, eight at a time are what one after another are, to the bit") {
    std::mt19937 random{1};
    std::uniform_real_distribution<float> number{-10, 10};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (int turn = 0; turn < 500; ++turn) {
        std::array<float, 8> x, y;
        for (auto* some : {&x, &y}) {
            for (float& one : *some) { one = number(random); }
        }
        if (turn % 2 != 0) { y[2] = x[2], x[5] = 0; }
        eight_rows rows;
        for (auto& row : rows) {
            for (auto& word : row) { word = static_cast<std::int32_t>(random()); }
        }
        facts plain{}, best{};
        tell_facts::run<simd::plain_eight>(x.data(), y.data(), rows, plain);
        simd::run_best<simd::eight, tell_facts>(x.data(), y.data(), rows, best);
        CHECK(plain.told == best.told);
        CHECK(plain.sums == best.sums);
        CHECK(plain.squares == Approx(best.squares).epsilon(1e-14));  // products may be fused with sums
        CHECK(plain.holds == best.holds);
    }
    facts told{};
    const std::array<float, 8> none{nan, nan, nan, nan, nan, nan, nan, nan}, one{1, 1, 1, 1, 1, 1, 1, 1};
    simd::run_best<simd::eight, tell_facts>(none.data(), one.data(), eight_rows{}, told);
    CHECK(told.holds == 0);
}
