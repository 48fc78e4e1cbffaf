#include <aglow/estimators/density_sum.hpp>

#include <cmath>
#include <initializer_list>

#include <aglow/core/numbers.hpp>
#include <aglow/core/random.hpp>
#include <aglow/estimators/kernel.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using vec = vec3<double>;

constexpr auto watt = [](double power) { return power; };

/// The sum of photons of one watt each at these distances in x, over a disc of radius 2.
template <typename Kernel>
density_estimate<double, double> sum_of(std::initializer_list<double> at, Kernel kernel) {
    detail::density_sum<double, double, Kernel> sum{kernel, 4.0, 1.0};
    for (const double x : at) { sum.add(x * x, vec{x, 0, 0}, 1.0, watt); }
    return sum.result();
}

}  // namespace

TEST_CASE("density_sum: light is the flux over the disc, and who lies on its rim does not count") {
    const auto e = sum_of({0, -1, 1.5, 2, 3}, constant_kernel{});
    CHECK(e.count == 3);
    CHECK(e.radius == 2);
    CHECK(e.value == Approx(3 / (pi<double> * 4)).epsilon(1e-14));
}

TEST_CASE("density_sum: a kernel that falls weighs each photon by its own distance") {
    // Epanechnikov's by hand: 2/pi (1 - x²/4) / 4.
    const double expected = 2 / pi<double> * ((1 - 0.25) + (1 - 0.5625)) / 4;
    CHECK(sum_of({1, -1.5}, epanechnikov_kernel{}).value == Approx(expected).epsilon(1e-14));
    CHECK(sum_of({1, -1.5}, any_kernel{kernel_shape::epanechnikov}).value == Approx(expected).epsilon(1e-14));
}

TEST_CASE("density_sum: a border through the disc, which two radii cannot see, widens the error") {
    // As many, as far and as bright: once all around, once all on one side.
    const auto even = sum_of({-1.9, -1.3, -0.7, -0.2, 0.2, 0.7, 1.3, 1.9, -1.6, 1.6, -1.0, 1.0}, constant_kernel{});
    const auto side = sum_of({1.9, 1.3, 0.7, 0.2, 0.2, 0.7, 1.3, 1.9, 1.6, 1.6, 1.0, 1.0}, constant_kernel{});
    CHECK(even.value == side.value);
    CHECK(side.error > even.error + 0.5 * even.value);
}

TEST_CASE("density_sum: the bias is twice, the error at least four thirds of what the half radius gives less") {
    // Nine in a cross around the middle, so that nothing leans.
    const std::initializer_list<double> at{0, 0.3, -0.3, 0.8, -0.8, 1.2, -1.2, 1.9, -1.9};
    const auto whole = sum_of(at, epanechnikov_kernel{});
    detail::density_sum<double, double, epanechnikov_kernel> half{{}, 1.0, 1.0};
    double noise2 = 0;
    for (const double x : at) {
        half.add(x * x, vec{x, 0, 0}, 1.0, watt);
        noise2 += square(epanechnikov_kernel{}(x * x / 4) / 4);
    }
    const double apart = whole.value - half.result().value;
    CHECK(std::abs(apart) > 0.01 * whole.value);
    CHECK(whole.bias == Approx(2 * apart).epsilon(1e-12));
    CHECK(whole.error == Approx(4.0 / 3 * std::abs(apart) + 2 * std::sqrt(noise2)).epsilon(1e-12));
}

TEST_CASE("density_sum: as much is feared missing as is there where half of the disc is dark, and little by chance") {
    random_sampler<double> random{1};
    const auto hidden = [&](int count, bool half) {
        detail::density_sum<double, double, constant_kernel> sum{{}, 4.0, 1.0};
        for (int i = 0; i < count; ++i) {
            const vec2<double> u = random.next_2d();
            const double r = 2 * std::sqrt(u.x);
            const double angle = (half ? 1 : 2) * pi<double> * u.y;
            sum.add(r * r, {r * std::cos(angle), r * std::sin(angle), 0}, 1.0, watt);
        }
        return sum.hidden();
    };
    CHECK(hidden(20000, true) == Approx(1).epsilon(0.05));
    // The squared lean of n even photons is exponential with mean 8 / n; above that mean lies 1 / e of it.
    double mean = 0;
    for (int i = 0; i < 4000; ++i) { mean += hidden(50, false) / 4000; }
    CHECK(mean == Approx(0.35 * 8 / 50 / std::exp(1.0)).epsilon(0.08));
}

TEST_CASE("density_sum: a million photons of one float each are all in the sum") {
    detail::density_sum<float, float, constant_kernel> sum{{}, 1.0f, 1.0f};
    const auto tenth = [](float power) { return power; };
    for (int i = 0; i < 1'000'000; ++i) { sum.add(0.5f, {0.7f, 0, 0}, 0.1f, tenth); }
    CHECK(sum.result().value == Approx(100'000 / pi<double>).epsilon(1e-6));
}
