#include <aglow/estimators/kernel.hpp>

#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/statistics.hpp"

using namespace aglow;

namespace {

constexpr double turn = 2 * std::numbers::pi;

/// ∫ K(|x|²)^power |x|^moment dA over the unit disc.
double over_disc(kernel_shape shape, int power, int moment) {
    return with_kernel(shape, [&](auto kernel) {
        return statistics::integral(0, 1, 16, [&](double rho) {
            return std::pow(kernel(rho * rho), power) * std::pow(rho, moment) * turn * rho;
        });
    });
}

}  // namespace

TEST_CASE("kernel: every shape has unit mass over its disc") {
    for (const auto shape : {kernel_shape::constant, kernel_shape::cone, kernel_shape::epanechnikov,
                             kernel_shape::biweight, kernel_shape::gaussian}) {
        CAPTURE(static_cast<int>(shape));
        CHECK(std::abs(over_disc(shape, 1, 0) - 1) < 1e-12);
    }
}

TEST_CASE("kernel: chosen per photon or once, the weight is the same to the bit") {
    for (const auto shape : {kernel_shape::constant, kernel_shape::cone, kernel_shape::epanechnikov,
                             kernel_shape::biweight, kernel_shape::gaussian}) {
        CAPTURE(static_cast<int>(shape));
        for (const double rho2 : {0.0, 0.1, 0.5, 0.999}) {
            CHECK(any_kernel{shape}(rho2) == with_kernel(shape, [&](auto kernel) { return kernel(rho2); }));
        }
    }
}

TEST_CASE("kernel: second moments and roughness are those of the books") {
    const auto axis_moment = [](kernel_shape shape) { return over_disc(shape, 1, 2) / 2; };
    CHECK(axis_moment(kernel_shape::constant) == Approx(1.0 / 4).epsilon(1e-12));
    CHECK(axis_moment(kernel_shape::cone) == Approx(3.0 / 20).epsilon(1e-12));
    CHECK(axis_moment(kernel_shape::epanechnikov) == Approx(1.0 / 6).epsilon(1e-12));
    CHECK(axis_moment(kernel_shape::biweight) == Approx(1.0 / 8).epsilon(1e-12));
    const double pi2 = std::numbers::pi;
    CHECK(over_disc(kernel_shape::constant, 2, 0) == Approx(1 / pi2).epsilon(1e-12));
    CHECK(over_disc(kernel_shape::cone, 2, 0) == Approx(3 / (2 * pi2)).epsilon(1e-12));
    CHECK(over_disc(kernel_shape::epanechnikov, 2, 0) == Approx(4 / (3 * pi2)).epsilon(1e-12));
    CHECK(over_disc(kernel_shape::biweight, 2, 0) == Approx(9 / (5 * pi2)).epsilon(1e-12));
}

TEST_CASE("kernel: Jensen's Gaussian needs 1.7283 in place of his 0.918 to keep the light") {
    CHECK(gaussian_kernel{}(0.0) * std::numbers::pi == Approx(1.7283).epsilon(1e-4));
    const double rim = 1 - (1 - std::exp(-1.953 / 2)) / (1 - std::exp(-1.953));
    CHECK(gaussian_kernel{}(1.0) / gaussian_kernel{}(0.0) == Approx(rim).epsilon(1e-12));
    CHECK(0.918 / (gaussian_kernel{}(0.0) * std::numbers::pi) == Approx(0.531).epsilon(2e-3));
}

TEST_CASE("kernel: float and double agree") {
    for (const auto shape : {kernel_shape::constant, kernel_shape::cone, kernel_shape::epanechnikov,
                             kernel_shape::biweight, kernel_shape::gaussian}) {
        with_kernel(shape, [&](auto kernel) {
            for (double rho2 = 0; rho2 < 1; rho2 += 0.125) {
                CHECK(std::abs(static_cast<double>(kernel(static_cast<float>(rho2))) - kernel(rho2)) < 5e-7);
            }
            return 0;
        });
    }
}
