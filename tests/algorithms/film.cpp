#include <aglow/algorithms/film.hpp>

#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <glm/vec3.hpp>

#include <aglow/report/running_mean.hpp>

#include "support/archetypes.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

using S = glm::vec3;

/// What any function of the ray and its numbers says.
template <typename F>
struct painter {
    using scalar = float;
    F paint;
    template <typename N>
    [[nodiscard]] estimate<S> operator()(const ray<float>& eye, const N& numbers) const {
        return paint(eye, numbers);
    }
};
template <typename F>
painter(F) -> painter<F>;

/// The point on the film is where the ray starts.
constexpr auto flat_eye = [](const vec2<float>& film) { return ray<float>{{film.x, film.y, 0}, {0, 0, 1}}; };

const painter noise{[](const ray<float>&, const auto& numbers) {
    const float x = numbers.at(1, purpose::scatter).next_1d();
    return estimate<S>{{x, 2 * x, x * x}, 0.25f};
}};

template <typename A>
bool same(const A& a, const A& b) {
    for (std::size_t y = 0; y < a.height(); ++y) {
        for (std::size_t x = 0; x < a.width(); ++x) {
            if (a.radiance(x, y) != b.radiance(x, y) || a.error(x, y) != b.error(x, y)) { return false; }
        }
    }
    return true;
}

}  // namespace

TEST_CASE("film: every pixel sees its own square, row 0 on top") {
    film<S> picture{5, 3};
    const painter where{[](const ray<float>& r, const auto&) { return estimate<S>{{r.origin.x, r.origin.y, 1}, 0}; }};
    picture.expose(flat_eye, where, {.samples = 64});
    for (std::size_t y = 0; y < 3; ++y) {
        for (std::size_t x = 0; x < 5; ++x) {
            CHECK(picture.radiance(x, y).x == Approx(static_cast<float>(x) + 0.5f).margin(0.01));
            CHECK(picture.radiance(x, y).y == Approx(static_cast<float>(y) + 0.5f).margin(0.01));
        }
    }
    CHECK(picture.samples() == 64);
}

TEST_CASE("film: 1, 2, 3 and 8 threads and any executor expose the same picture") {
    film<S> one{17, 13};
    one.expose(flat_eye, noise);
    const auto check = [&](const auto& run) {
        film<S> other{17, 13};
        other.expose(flat_eye, noise, {}, run);
        CHECK(same(one, other));
    };
    for (const unsigned threads : {1u, 2u, 3u, 8u}) { check(own_threads{threads}); }
    check(archetypes::executor{});
}

TEST_CASE("film: exposed twice is exposed once for longer") {
    film<S> once{4, 4};
    once.expose(flat_eye, noise, {.samples = 24});
    film<S> twice{4, 4};
    twice.expose(flat_eye, noise, {.samples = 8});
    twice.expose(flat_eye, noise, {.samples = 16});
    CHECK(same(once, twice));
    CHECK(twice.samples() == 24);
    film<S> other{4, 4};
    other.expose(flat_eye, noise, {.samples = 24, .seed = 1});
    CHECK_FALSE(same(once, other));
}

TEST_CASE("film: the error is the guess and the standard error of the mean") {
    // Alternating 1 and 3 in the brightest band: variance 1.
    std::atomic<int> turn{0};
    const painter alternating{[&](const ray<float>&, const auto&) {
        return estimate<S>{{0, turn++ % 2 == 0 ? 1.0f : 3.0f, 0}, 0.25f};
    }};
    film<S> picture{1, 1};
    CHECK(picture.error(0, 0) == 0);
    picture.expose(flat_eye, alternating, {.samples = 1});
    CHECK(picture.error(0, 0) == Approx(0.25f + 1));
    picture.expose(flat_eye, alternating, {.samples = 99});
    CHECK(picture.error(0, 0) == Approx(0.25 + 1 / std::sqrt(99.0)));
    CHECK(picture.radiance(0, 0).y == 2);
}

TEST_CASE("film: a small spread on a bright ground is seen, and faint light as well as strong") {
    for (const float level : {1e4f, 1.0f, 1e-18f, 1e18f}) {
        std::atomic<int> turn{0};
        const painter ripple{[&](const ray<float>&, const auto&) {
            return estimate<S>{S{turn++ % 2 == 0 ? level : level * 1.001f}, 0};
        }};
        film<S> picture{1, 1};
        picture.expose(flat_eye, ripple, {.samples = 1000});
        CAPTURE(level);
        CHECK(picture.error(0, 0) / level == Approx(0.0005 / std::sqrt(999.0)).epsilon(1e-3));
    }
}

TEST_CASE("film: broken samples are left out and counted, broken guesses count nothing") {
    const float broken = std::numeric_limits<float>::quiet_NaN();
    std::atomic<int> turn{0};
    const painter flawed{[&](const ray<float>&, const auto&) {
        switch (turn++ % 4) {
            case 0: return estimate<S>{{1, broken, 1}, 0};
            case 1: return estimate<S>{{1, 1, -1}, 0};
            case 2: return estimate<S>{S{std::numeric_limits<float>::infinity()}, 0};
            default: return estimate<S>{S{5}, broken};
        }
    }};
    film<S> picture{3, 2};
    picture.expose(flat_eye, flawed, {.samples = 16});
    CHECK(picture.dropped() == 3 * 2 * 12);
    for (std::size_t x = 0; x < 3; ++x) {
        CHECK(picture.radiance(x, 1) == S{5});
        CHECK(picture.error(x, 1) == 0);
    }
}

TEST_CASE("film: progress goes up to one, and false stops") {
    film<S> picture{2, 10};
    double last = 0;
    picture.expose(flat_eye, noise, {.samples = 1, .progress = [&](double share) {
                                         CHECK(share > last);
                                         last = share;
                                         return true;
                                     }});
    CHECK(last == 1);
    int rows = 0;
    film<S> stopped{2, 10};
    stopped.expose(flat_eye, noise, {.samples = 1, .progress = [&](double) { return ++rows < 3; }});
    CHECK(rows == 3);
    CHECK(stopped.radiance(0, 2) != S{0});
    CHECK(stopped.radiance(0, 3) == S{0});
}

TEST_CASE("film: a picture of no pixels, or of no samples, is no trouble") {
    film<S> none{0, 0};
    none.expose(flat_eye, noise);
    film<S> column{0, 4};
    column.expose(flat_eye, noise);
    film<S> dark{2, 2};
    dark.expose(flat_eye, noise, {.samples = 0});
    CHECK(dark.radiance(1, 1) == S{0});
    CHECK(dark.error(1, 1) == 0);
}

TEST_CASE("film: light brighter by a power of two gives picture and error brighter by it, exactly") {
    const auto exposed = [](float scale) {
        const painter scaled{[=](const ray<float>& r, const auto& numbers) {
            const auto e = noise(r, numbers);
            return estimate<S>{e.value * scale, e.error * scale};
        }};
        film<S> picture{3, 3};
        picture.expose(flat_eye, scaled);
        return picture;
    };
    const auto here = exposed(1);
    for (int k = -60; k <= 60; k += 4) {
        const float s = std::ldexp(1.0f, k);
        const auto there = exposed(s);
        CHECK(there.radiance(1, 2) == here.radiance(1, 2) * s);
        CHECK(there.error(1, 2) == here.error(1, 2) * s);
    }
}

TEST_CASE("film: what all samples have in common does not average out of the mean, unless each exposure's is its own") {
    // Of every exposure: half of a map's error of 0.125 everywhere, and no noise else.
    const painter even{[](const ray<float>&, const auto&) { return estimate<S>{S{1}, 0.5f, 0.125f, -0.25f}; }};
    for (const bool fresh : {false, true}) {
        film<S> picture{8, 4};
        for (int i = 0; i < 4; ++i) { picture.expose(flat_eye, even, {.samples = 1, .fresh = fresh}); }
        const mean_error error = picture.error_of_mean();
        CHECK(error.bias == -0.25);
        CHECK(error.noise == Approx(fresh ? 0.0625 : 0.125).epsilon(1e-12));
        CHECK(error.within(2) == Approx(0.25 + 2 * error.noise).epsilon(1e-12));
        // A pixel: its guess, or where maps are fresh, its bias alone, since its samples' spread would tell the rest.
        CHECK(picture.error(3, 2) == (fresh ? 0.25f : 0.5f));
    }
    CHECK(film<S>{2, 2}.error_of_mean().within() == 0);
    // Samples of one exposure have the map's noise in common, which their spread does not tell.
    film<S> twice{8, 4};
    for (int i = 0; i < 4; ++i) { twice.expose(flat_eye, even, {.samples = 2, .fresh = true}); }
    CHECK(twice.error(3, 2) == 0.5f);
    // Not every exposure was fresh: what the others have in common no spread tells.
    for (const bool first : {false, true}) {
        film<S> mixed{8, 4};
        mixed.expose(flat_eye, even, {.samples = 1, .fresh = first});
        mixed.expose(flat_eye, even, {.samples = 1, .fresh = !first});
        CHECK(mixed.error(3, 2) == 0.5f);
    }
}

TEST_CASE("film: the noise of samples is in the error of the mean, as far as it strays") {
    running_mean mean;
    running_mean noise_said;
    for (std::uint64_t seed = 0; seed < 64; ++seed) {
        film<S> picture{8, 8};
        // Numbers that no set of samples evens out.
        const painter coin{[&](const ray<float>& r, const auto&) {
            const float x = static_cast<float>(mix(seed, std::bit_cast<std::uint32_t>(r.origin.x) * 31ull +
                                                             std::bit_cast<std::uint32_t>(r.origin.y)) %
                                               1024) /
                            1024;
            return estimate<S>{S{x}, 0};
        }};
        picture.expose(flat_eye, coin, {.samples = 4, .seed = seed});
        double sum = 0;
        for (std::size_t i = 0; i < 64; ++i) { sum += static_cast<double>(picture.radiance(i % 8, i / 8).x) / 64; }
        mean.add(sum);
        noise_said.add(picture.error_of_mean().noise);
    }
    // A standard deviation of 64 is known to 9 %.
    CHECK(std::sqrt(mean.variance()) == Approx(noise_said.mean()).epsilon(0.35));
}

TEST_CASE("film: the last of a million samples counts as much as the first") {
    film<S> picture{1, 1};
    const painter coin{[](const ray<float>&, const auto& numbers) {
        return estimate<S>{S{numbers.at(1, purpose::scatter).next_1d() < 0.5f ? 0.f : 0.2f}, 0};
    }};
    for (int i = 0; i < 4; ++i) { picture.expose(flat_eye, coin, {.samples = 1u << 20}); }
    // As many heads as tails, but for one, in a sequence of so many.
    CHECK(picture.radiance(0, 0).x == Approx(0.1).epsilon(1e-5));
}

TEST_CASE("film: after an exception no sample is taken twice") {
    film<S> picture{4, 4};
    bool breaks = true;
    const painter fragile{[&](const ray<float>& eye, const auto& numbers) {
        if (breaks && eye.origin.y > 2) { throw std::runtime_error("broken"); }
        return noise.paint(eye, numbers);
    }};
    CHECK_THROWS_AS(picture.expose(flat_eye, fragile, {.samples = 16}), std::runtime_error);
    breaks = false;
    picture.expose(flat_eye, fragile, {.samples = 16});
    film<S> whole{4, 4};
    whole.expose(flat_eye, fragile, {.samples = 32});
    film<S> late{4, 4};
    late.expose(flat_eye, fragile, {.samples = 16});
    CHECK(picture.radiance(1, 0) == whole.radiance(1, 0));
    CHECK(picture.error(1, 0) == whole.error(1, 0));
    CHECK(picture.radiance(1, 3) != late.radiance(1, 3));  // what is missing stays missing
    CHECK(picture.samples() == 32);
}
