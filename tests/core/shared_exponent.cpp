#include <aglow/core/shared_exponent.hpp>

#include <cmath>
#include <limits>

#include <aglow/core/numbers.hpp>

#include "support/catch.hpp"

using namespace aglow;

static_assert(sizeof(shared_exponent) == 4);

TEST_CASE("shared_exponent: the mean over its chances is the value, in bright and in faint bands") {
    for (const vec3<float> v :
         {vec3<float>{0.7f, 0.013f, 0.0004f}, {1e-12f, 3e-11f, 2.2e-11f}, {255.9f, 254.3f, 0.1f}}) {
        vec3<double> sum{};
        const int count = 1 << 16;
        for (int i = 0; i < count; ++i) {
            // Every chance once: the words are spread evenly.
            const std::uint64_t word = static_cast<std::uint64_t>(i) << 48;
            sum += vec3<double>{shared_exponent{v, word}.value()};
        }
        const double top = static_cast<double>(max_abs(v));
        // A step of 2^-16 of a chance, each worth less than 1/127 of the largest band.
        for (int b = 0; b < 3; ++b) {
            CHECK(std::abs(sum[b] / count - static_cast<double>(v[b])) <= top / 127 * 0x1p-16 + 1e-7 * top);
        }
    }
}

TEST_CASE("shared_exponent: off by less than 1/127 of the largest band, whatever the chance") {
    std::uint64_t word = 1;
    bool within = true;
    for (int i = 0; i < 200'000; ++i) {
        word = mix(word);
        const vec3<float> v = vec3<float>{unit_interval<float>(word), unit_interval<float>(word << 13),
                                          unit_interval<float>(word << 27)} *
                              std::ldexp(1.0f, static_cast<int>(word % 200) - 100);
        const vec3<float> off = shared_exponent{v, mix(word)}.value() - v;
        within = within && max_abs(off) <= max_abs(v) / 127;
    }
    CHECK(within);
}

TEST_CASE("shared_exponent: gray stays gray, what fits is exact, black is black, and the ends of the range hold") {
    for (std::uint64_t word : {std::uint64_t{0}, ~std::uint64_t{0}, mix(7)}) {
        const vec3<float> gray = shared_exponent{vec3<float>{0.3f}, word}.value();
        CHECK((gray.x == gray.y && gray.y == gray.z));
        CHECK(shared_exponent{vec3<float>{0.75f, 0.5f, 0}, word}.value() == vec3<float>{0.75f, 0.5f, 0});
        CHECK(shared_exponent{vec3<float>{255, 1, 254}, word}.value() == vec3<float>{255, 1, 254});
        CHECK(shared_exponent{vec3<float>{0}, word}.value() == vec3<float>{0});
        const float most = std::numeric_limits<float>::max();
        CHECK(shared_exponent{vec3<float>{most}, word}.value().x == Approx(most).epsilon(1.0 / 127));
        CHECK(is_finite(shared_exponent{vec3<float>{most}, word}.value().x));
        const float least = std::numeric_limits<float>::min();
        CHECK(shared_exponent{vec3<float>{least}, word}.value().x == least);
    }
    CHECK(shared_exponent{}.value() == vec3<float>{0});
}

TEST_CASE("shared_exponent: scaling by a power of two is exact") {
    for (const int k : {-60, -1, 1, 60}) {
        const vec3<float> v{0.3f, 0.01f, 0.9f};
        const float scale = std::ldexp(1.0f, k);
        CHECK(shared_exponent{v * scale, mix(5)}.value() == shared_exponent{v, mix(5)}.value() * scale);
    }
}
