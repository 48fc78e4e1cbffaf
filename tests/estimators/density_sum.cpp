#include <aglow/estimators/density_sum.hpp>

#include <initializer_list>

#include <aglow/core/numbers.hpp>
#include <aglow/estimators/kernel.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using vec = vec3<double>;

/// The sum of photons of one watt each at these distances in x, over a disc of radius 2.
template <typename Kernel>
density_estimate<double, double> sum_of(std::initializer_list<double> at, Kernel kernel) {
    detail::density_sum<double, double, Kernel> sum{kernel, 4.0, 1.0};
    const auto watt = [](double power) { return power; };
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
