// The machine's widest vectors are compared with the plain ones, which do one number after another.
#include <aglow/core/simd_sixteen.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

#include "support/catch.hpp"

using namespace aglow;

namespace {

constexpr std::size_t count = 16;
using floats = std::array<float, count>;
using row = std::array<std::int32_t, 9>;

/// The bits of all that vectors say of two times sixteen floats and of the words in sixteen rows.
using facts = std::array<std::array<std::int32_t, count>, 30>;

template <typename V>
struct into {
    facts& told;
    std::size_t at, n = 0;

    [[gnu::always_inline]] void operator()(const typename V::words& w) { V::words::store(&told[n++][at], w); }
    [[gnu::always_inline]] void operator()(const V& v) {
        float each[V::count];
        V::store(each, v);
        std::memcpy(&told[n++][at], each, sizeof(each));
    }
};

struct tell_facts {
    template <typename V>
    [[gnu::always_inline]] static void run(const floats& x, const floats& y, const std::array<row, count>& rows,
                                           facts& told) {
        for (std::size_t i = 0; i < count; i += V::count) { tell<V>(&x[i], &y[i], &rows[i], told, i); }
    }

private:
    template <typename V>
    [[gnu::always_inline]] static void tell(const float* x, const float* y, const row* rows, facts& told,
                                            std::size_t at) {
        using words = typename V::words;
        const char* starts[V::count];
        for (std::size_t i = 0; i < V::count; ++i) { starts[i] = reinterpret_cast<const char*>(&rows[i]); }
        const V a = V::load(x), b = V::load(y);
        const words less = a < b, bits = words::column(starts, 32);
        into<V> put{told, at};
        put(a + b), put(a - b), put(a * b), put(a / b), put(a * b + a), put(V::min(a, b)), put(V::max(a, b));
        put(V::abs(a)), put(V::root(V::abs(a))), put(V::where(less, a)), put(V::all(2.5f)), put(V::of(bits));
        put(V::from_bits(words::all(0x40490fdb)));
        put(less), put(a <= b), put(bits), put(bits & words::all(0xffff));
        put(bits >> 3), put(bits << 3), put(bits - less), put(words::pick(less, bits, less));
        put(words::first_half(bits)), put(words::last_half(bits));
        words columns[8];
        for (std::size_t c = 0; c < 8; c += words::together) { words::columns(starts, 4 + 4 * c, columns + c); }
        for (std::size_t c = 0; c < 7; ++c) { put(columns[c]); }
    }
};

struct pick_backwards {
    template <typename V>
    [[gnu::always_inline]] static void run(const float* table, const std::int32_t* places, float* picked) {
        for (std::size_t i = 0; i < count; i += V::count) {
            V::store(picked + i, V::picked(table + i, V::words::load(places + i)));
        }
    }
};

}  // namespace

TEST_CASE("simd_sixteen: whatever the machine, sixteen at a time are what one after another are, to the bit") {
    std::mt19937 random{1};
    std::uniform_real_distribution<float> number{-10, 10};
    for (int turn = 0; turn < 500; ++turn) {
        floats x, y;
        for (auto* some : {&x, &y}) {
            for (float& one : *some) { one = number(random); }
        }
        if (turn % 2 != 0) { y[2] = x[2], x[5] = 0, x[9] = std::numeric_limits<float>::quiet_NaN(); }
        std::array<row, count> rows;
        for (row& r : rows) {
            for (std::int32_t& word : r) { word = static_cast<std::int32_t>(random()); }
        }
        facts plain{}, best{};
        tell_facts::run<simd::plain_eight>(x, y, rows, plain);
        simd::run_best<simd::sixteen, tell_facts>(x, y, rows, best);
        std::size_t wrong = 0;
        for (std::size_t n = 0; n < plain.size(); ++n) {
            for (std::size_t i = 0; i < count; ++i) {
                wrong += plain[n][i] != best[n][i] && !(turn % 2 != 0 && i == 9);
            }
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("simd_sixteen: numbers are picked from where they are said to lie") {
    floats table, picked;
    std::array<std::int32_t, count> places;
    for (std::size_t i = 0; i < count; ++i) {
        table[i] = static_cast<float>(i);
        places[i] = static_cast<std::int32_t>(7 - i % 8);  // below the least number of lanes
    }
    simd::run_best<simd::sixteen, pick_backwards>(table.data(), places.data(), picked.data());
    CHECK(picked[0] == 7);
    CHECK(picked[3] == 4);
    CHECK((picked[15] == 0 || picked[15] == 8));  // as many tables as packs
}
