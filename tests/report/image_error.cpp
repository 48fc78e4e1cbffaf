#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/report/image_error.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;

namespace {

image_view<float> seen(const std::vector<float>& values, std::size_t channels = 1) {
    return {values, values.size() / channels, 1, channels};
}
image_view<double> row(const std::vector<double>& values) { return {values, values.size(), 1, 1}; }

/// A picture that is off by 0.01 of normal law, the truth, and two halves of a reference, off by `noise` each.
struct halved {
    static constexpr int n = 40'000;
    std::vector<double> image{}, truth{}, first{}, second{};

    halved(std::uint64_t seed, double noise) {
        random_sampler<double> random{seed};
        for (int i = 0; i < n; ++i) {
            truth.push_back(0.5 + random.next_1d());
            image.push_back(truth.back() + 0.01 * synthetic::normal(random));
            first.push_back(truth.back() + noise * synthetic::normal(random));
            second.push_back(truth.back() + noise * synthetic::normal(random));
        }
    }
};

}  // namespace

TEST_CASE("image_error: two pixels by hand") {
    const std::vector<float> image{1.5f, 2.0f};
    const std::vector<float> reference{1.0f, 3.0f};
    const image_error e = compare(seen(image), seen(reference));
    const double floor = 0.02 * 2;
    CHECK(e.mape == Approx((0.5 / (1 + floor) + 1 / (3 + floor)) / 2));
    CHECK(e.smape == Approx((0.5 / (1.25 + floor) + 1 / (2.5 + floor)) / 2));
    CHECK(e.relmse == Approx((0.25 / 1.01 + 1 / 9.01) / 2));
    CHECK(e.mse == Approx(0.625));
    CHECK(e.rmse == Approx(std::sqrt(0.625)));
    CHECK(e.energy_bias == Approx(-0.5 / 4));
    CHECK(e.relative_max == Approx(0.5 / (1 + floor)));
    CHECK(e.absolute_max == 1);
    CHECK(e.pixels == 2);
    CHECK(compare(seen(image), seen(reference), {.epsilon = 1}).relmse == Approx((0.25 / 2 + 1.0 / 10) / 2));
}

TEST_CASE("image_error: a picture is not wrong against itself, black pixels included") {
    const std::vector<float> image{0, 0, 0.5f, 2};
    const image_error e = compare(seen(image, 2), seen(image, 2));
    CHECK(e.mape == 0);
    CHECK(e.relmse == 0);
    CHECK(e.energy_bias == 0);
    CHECK(compare(seen({0, 0}), seen({0, 0})).mape == 0);
}

TEST_CASE("image_error: light where the whole reference is black is infinitely wrong, not right") {
    const double inf = std::numeric_limits<double>::infinity();
    const image_error e = compare(seen({0, 0, 0, 1}), seen({0, 0, 0, 0}));
    CHECK(e.mape == inf);
    CHECK(e.smape == 0.5);
    CHECK(e.relative_q50 == 0);
    CHECK(e.relative_max == inf);
    const image_error all = compare(seen({1, 1}), seen({0, 0}));
    CHECK(all.mape == inf);
    CHECK(all.relative_q95 == inf);
}

TEST_CASE("image_error: a picture without a usable pixel is not right but wrong without end") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const image_error e = compare(seen({nan, nan}), seen({1, 2}), seen({1, 2}));
    CHECK(e.pixels == 0);
    CHECK(e.broken == 2);
    CHECK(e.mape == std::numeric_limits<double>::infinity());
    CHECK(e.relmse == std::numeric_limits<double>::infinity());
}

TEST_CASE("image_error: broken pixels are counted and left out of everything") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> image{1, 1, nan, 1, 2, 2, 3, inf};
    const std::vector<float> reference{1, 1, 1, 1, inf, 2, 3, 3};
    const image_error e = compare(seen(image, 2), seen(reference, 2));
    CHECK(e.broken == 2);
    CHECK(e.broken_reference == 1);
    CHECK(e.pixels == 1);
    CHECK(e.relmse == 0);
    CHECK(e.absolute_max == 0);
}

TEST_CASE("image_error: one firefly in a thousand values is all of relMSE and nothing of the trimmed one") {
    std::vector<float> image(2000, 1.0f);
    const std::vector<float> reference(2000, 1.0f);
    image[77] = 101.0f;
    const image_error e = compare(seen(image), seen(reference));
    CHECK(e.relmse == Approx(1e4 / 1.01 / 2000));
    CHECK(e.relmse_trimmed == 0);
    CHECK(e.relative_q99 == 0);
    CHECK(e.relative_max == Approx(100 / 1.02));
}

TEST_CASE("image_error: two halves take their own noise out of the squared error") {
    const halved h{9, 0.1};
    const image_error exact = compare(row(h.image), row(h.truth));
    const image_error halves = compare(row(h.image), row(h.first), row(h.second));
    const image_error plain = compare(row(h.image), row(h.first));
    // The product's standard deviation is about 0.1 · 0.1.
    CHECK(std::abs(halves.mse - exact.mse) < 4 * 0.0102 / std::sqrt(halved::n));
    CHECK(plain.mse > 50 * exact.mse);
    CHECK(halves.reference_relmse == Approx(0.005 * (exact.relmse / exact.mse)).epsilon(0.05));
}

TEST_CASE("image_error: two halves take their own noise out of relMSE, and their mean is the truth of all else") {
    const halved h{10, 0.02};
    const image_error exact = compare(row(h.image), row(h.truth));
    const image_error halves = compare(row(h.image), row(h.first), row(h.second));
    // A term's standard deviation is about 0.0005, over squares of 0.5 to 1.5.
    CHECK(std::abs(halves.relmse - exact.relmse) < 4 * 0.0009 / std::sqrt(halved::n));
    const image_error one = compare(seen({3}), seen({1}), seen({3}));
    CHECK(one.mape == Approx(1 / (2 + 0.02 * 2)));
    CHECK(one.reference_mape == Approx(1 / (2 + 0.02 * 2)));
    CHECK(one.energy_bias == 0.5);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const image_error broken = compare(seen({3, 2}), seen({1, 2}), seen({nan, 2}));
    CHECK(broken.broken_reference == 1);
    CHECK(broken.pixels == 1);
    CHECK(broken.mape == 0);
}

TEST_CASE("image_error: just the asked share of the largest terms is trimmed") {
    const std::vector<float> black(10, 0.0f);
    const std::vector<float> image{1, 10, 2, 9, 3, 8, 4, 7, 5, 6};
    // Squares over 1 as it is added to the reference: 1 + 4 + ... + 64.
    CHECK(compare(seen(image), seen(black), {.epsilon = 1, .trimmed = 0.2}).relmse_trimmed == Approx(204.0 / 8));
    CHECK(compare(seen(image), seen(black), {.epsilon = 1, .trimmed = 0}).relmse_trimmed == Approx(385.0 / 10));
}

TEST_CASE("image_error: relative measures do not change when the picture is scaled by a power of two") {
    const synthetic::field field{synthetic::damage::outliers};
    std::vector<double> image = field.picture;
    std::vector<double> truth = field.truth;
    for (double& x : image) { x *= 0x1p-30; }
    for (double& x : truth) { x *= 0x1p-30; }
    const auto view = [](const std::vector<double>& v) { return image_view<double>{v, 64, 64, 1}; };
    const image_error a = compare(view(field.picture), view(field.truth));
    const image_error b = compare(view(image), view(truth), {.epsilon = 0.01 * 0x1p-60});
    CHECK(a.mape == b.mape);
    CHECK(a.smape == b.smape);
    CHECK(a.relmse == b.relmse);
    CHECK(a.relmse_trimmed == b.relmse_trimmed);
    CHECK(a.energy_bias == b.energy_bias);
    CHECK(a.relative_q95 == b.relative_q95);
}

TEST_CASE("image_error: pictures of different shapes are refused by name") {
    const std::vector<float> four(4, 1.0f);
    const std::vector<float> six(6, 1.0f);
    CHECK_THROWS_AS(compare(seen(four), seen(six)), std::invalid_argument);
    CHECK_THROWS_AS(compare(image_view<float>{four, 3, 1, 1}, seen(four)), std::invalid_argument);
    CHECK_THROWS_AS(compare(seen(four), seen(four), {.trimmed = 1}), std::invalid_argument);
}
