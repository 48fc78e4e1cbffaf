#include <aglow/algorithms/path_trace.hpp>

#include <aglow/core/sobol.hpp>
#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"
#include "support/furnace.hpp"

using namespace aglow;
using testing::furnace_light;
using testing::furnace_sphere;

namespace {

template <typename S, typename T>
running_mean radiance_in_furnace(S albedo, int paths) {
    const furnace_sphere<S, T> scene{.radius = T(2), .albedo = albedo, .glow = white<S>()};
    const furnace_light<S, T> light{.radius = T(2), .glow = white<S>()};
    const path_tracer tracer{scene, light};
    running_mean mean;
    for (int i = 0; i < paths; ++i) {
        const random_numbers<T> numbers{{.seed = 1, .path = static_cast<std::uint64_t>(i)}};
        const ray<T> eye{{T(0.1), T(0.2), T(-0.3)}, glm::normalize(vec3<T>{1, T(i % 7), -2})};
        mean.add(static_cast<double>(max_component(tracer(eye, numbers).value)));
    }
    return mean;
}

}  // namespace

TEMPLATE_TEST_CASE("path_trace: a furnace of albedo rho is 1 / (1 - rho) bright everywhere", "", float, double) {
    using T = TestType;
    for (const double albedo : {0.5, 0.9, 0.99}) {
        const running_mean mean = radiance_in_furnace<T, T>(T(albedo), 20000);
        CAPTURE(albedo, mean.mean(), mean.standard_error());
        CHECK(std::abs(mean.mean() * (1 - albedo) - 1) <= 4 * mean.standard_error() * (1 - albedo) + 1e-5);
    }
}

TEST_CASE("path_trace: a black furnace is exactly as bright as its glow") {
    const running_mean mean = radiance_in_furnace<glm::vec3, float>(glm::vec3{0}, 100);
    CHECK(mean.mean() == 1.0);
    CHECK(mean.variance() == 0.0);
}
