#include <aglow/concepts/spectrum.hpp>

#include <array>
#include <cstddef>
#include <type_traits>

#include "core/hard_numbers.hpp"
#include "support/archetypes.hpp"
#include "support/catch.hpp"

namespace host {

/// A host's own spectrum of many bands, an aggregate.
template <typename T, std::size_t N>
struct bands {
    std::array<T, N> values{};

    friend bool operator==(const bands&, const bands&) = default;
    friend bands operator+(bands a, const bands& b) {
        for (std::size_t i = 0; i < N; ++i) { a.values[i] += b.values[i]; }
        return a;
    }
    friend bands operator*(bands a, const bands& b) {
        for (std::size_t i = 0; i < N; ++i) { a.values[i] *= b.values[i]; }
        return a;
    }
    friend bands operator*(bands a, T k) {
        for (T& v : a.values) { v *= k; }
        return a;
    }
    friend T max_component(const bands& a) {
        T m = a.values[0];
        for (const T v : a.values) {
            if (!aglow::is_finite(v)) { return v; }
            m = v > m ? v : m;
        }
        return m;
    }
    friend bands white(std::type_identity<bands>) {
        bands all;
        all.values.fill(T(1));
        return all;
    }
};

/// An aggregate of bands by name, which braces would fill in part.
struct warm_and_cold {
    float warm{};
    float cold{};

    friend bool operator==(const warm_and_cold&, const warm_and_cold&) = default;
    friend warm_and_cold operator+(warm_and_cold a, warm_and_cold b) { return {a.warm + b.warm, a.cold + b.cold}; }
    friend warm_and_cold operator*(warm_and_cold a, warm_and_cold b) { return {a.warm * b.warm, a.cold * b.cold}; }
    friend warm_and_cold operator*(warm_and_cold a, float k) { return {a.warm * k, a.cold * k}; }
    friend float max_component(warm_and_cold a) { return a.warm > a.cold ? a.warm : a.cold; }
    friend warm_and_cold white(std::type_identity<warm_and_cold>) { return {1, 1}; }
};

}  // namespace host

namespace {

using aglow::max_component;
using namespace hard_numbers;

template <typename T>
using eight = host::bands<T, 8>;

static_assert(aglow::Spectrum<eight<float>> && aglow::Spectrum<eight<double>> && aglow::Spectrum<host::warm_and_cold>);
static_assert(std::is_same_v<aglow::band_of<eight<double>>, double>);
static_assert(std::is_same_v<aglow::band_of<aglow::vec3<float>>, float>);

/// A spectrum that is `fill` in every band but one.
template <typename S>
struct maker;
template <std::floating_point T>
struct maker<T> {
    static constexpr int bands = 1;
    static T one_other(T, int, T other) { return other; }
};
template <typename T>
struct maker<aglow::vec3<T>> {
    static constexpr int bands = 3;
    static aglow::vec3<T> one_other(T fill, int band, T other) {
        aglow::vec3<T> s(fill);
        s[band] = other;
        return s;
    }
};
template <typename T>
struct maker<eight<T>> {
    static constexpr int bands = 8;
    static eight<T> one_other(T fill, int band, T other) {
        eight<T> s;
        s.values.fill(fill);
        s.values[static_cast<std::size_t>(band)] = other;
        return s;
    }
};
template <typename T>
struct maker<archetypes::spectrum<T>> {
    static constexpr int bands = 2;
    static archetypes::spectrum<T> one_other(T fill, int band, T other) {
        return archetypes::spectrum<T>::of(band == 0 ? other : fill, band == 1 ? other : fill);
    }
};

}  // namespace

TEMPLATE_TEST_CASE("spectrum: one bad band is enough, in each band and of each kind", "", float, double,
                   aglow::vec3<float>, aglow::vec3<double>, eight<float>, eight<double>, archetypes::spectrum<float>,
                   archetypes::spectrum<double>) {
    using S = TestType;
    using T = aglow::band_of<S>;
    for (int band = 0; band < maker<S>::bands; ++band) {
        const auto with = [&](T other) { return maker<S>::one_other(T(0.5), band, other); };
        INFO("band " << band);
        CHECK_FALSE(aglow::is_radiance(with(nan<T>())));
        CHECK_FALSE(aglow::is_radiance(with(minus_nan<T>())));
        CHECK_FALSE(aglow::is_radiance(with(infinity<T>())));
        CHECK_FALSE(aglow::is_radiance(with(minus_infinity<T>())));
        CHECK_FALSE(aglow::is_radiance(with(T(-1))));
        CHECK_FALSE(aglow::is_radiance(with(-smallest<T>())));
        CHECK(aglow::is_radiance(with(T(0))));
        CHECK(aglow::is_radiance(with(minus_zero<T>())));
        CHECK(aglow::is_radiance(with(T(1))));
        CHECK(aglow::is_radiance(with(largest<T>())));
        CHECK(aglow::is_radiance(with(smallest<T>())));
        CHECK(max_component(with(T(7))) == 7);
        CHECK_FALSE(aglow::is_black(with(T(0.5))));
        CHECK(aglow::is_black(maker<S>::one_other(T(0), band, T(0))));
        CHECK_FALSE(aglow::is_black(maker<S>::one_other(T(0), band, smallest<T>())));
    }
}

TEMPLATE_TEST_CASE("spectrum: black adds nothing, white multiplies without change, sums and products commute", "",
                   float, double, aglow::vec3<float>, aglow::vec3<double>, eight<float>, eight<double>,
                   archetypes::spectrum<float>) {
    using S = TestType;
    using T = aglow::band_of<S>;
    const S a = maker<S>::one_other(T(0.3), 0, T(0.7));
    const S b = maker<S>::one_other(T(0.2), maker<S>::bands - 1, T(5));
    CHECK(S{} + a == a);
    CHECK(a * aglow::white<S>() == a);
    CHECK(a + b == b + a);
    CHECK(a * b == b * a);
    CHECK(aglow::is_black(S{}));
    CHECK(max_component(aglow::white<S>()) == 1);
}

TEST_CASE("spectrum: white fills every band of an aggregate, which one scalar in its braces would not") {
    CHECK(aglow::white<host::warm_and_cold>() == host::warm_and_cold{1, 1});
}
