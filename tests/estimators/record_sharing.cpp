#include <aglow/estimators/record_sharing.hpp>

#include <cmath>
#include <vector>

#include <aglow/core/random.hpp>
#include <aglow/estimators/irradiance_cache.hpp>
#include <aglow/report/running_mean.hpp>

#include "support/catch.hpp"

using namespace aglow;

namespace {

using cache = irradiance_cache<float>;

struct place {
    vec3<float> position{};
    vec3<float> normal{0, 0, 1};
};

constexpr int side = 8;

/// Records on a grid of the unit square, each reaching over its neighbours, of what `irradiance(x, y)` says.
template <typename Irradiance>
cache filled(Irradiance&& irradiance, float noise) {
    irradiance_cache_options o;
    o.reach = {.metric = error_metric::split_sphere, .accuracy = 1, .minimum_radius = 1e-4, .minimum_footprints = 0};
    cache result{10.f, o};
    for (int i = 0; i < side * side; ++i) {
        irradiance_estimate<float, float> e;
        e.position = {(static_cast<float>(i % side) + 0.5f) / side, (static_cast<float>(i / side) + 0.5f) / side, 0};
        e.axes = frame<float>{vec3<float>{0, 0, 1}};
        e.irradiance = irradiance(e.position.x, e.position.y);
        e.mean_inverse_distance = side / 2.0f;
        e.relative_noise = noise;
        e.rays = 100;
        CHECK(result.insert(e) == record_status::inserted);
    }
    return result;
}

/// Everywhere on the square but for a rim of `rim`.
std::vector<place> everywhere(float rim = 0) {
    std::vector<place> all;
    random_sampler<float> random{5};
    for (int i = 0; i < 2000; ++i) {
        const auto u = random.next_2d();
        all.push_back({{rim + (1 - 2 * rim) * u.x, rim + (1 - 2 * rim) * u.y, 0}});
    }
    return all;
}

shared_error shared_of(const cache& c, const std::vector<place>& places) { return c.shared(c.freeze(), places); }

double mean_of(const cache& c, const std::vector<place>& places) {
    double sum = 0;
    for (const place& p : places) {
        sum += static_cast<double>(c.lookup(p.position, p.normal).irradiance) / static_cast<double>(places.size());
    }
    return sum;
}

}  // namespace

TEST_CASE("record_sharing: sure records of even light have no error in common, and an empty cache has none either") {
    const shared_error sure = shared_of(filled([](float, float) { return 2.0f; }, 0), everywhere());
    CHECK(sure.common == 0);
    CHECK(std::abs(sure.bias) < 1e-6);
    const shared_error nothing = shared_of(cache{10.f}, everywhere());
    CHECK(nothing.common == 0);
    CHECK(nothing.bias == 0);
}

TEST_CASE("record_sharing: the mean of a picture strays from cache to cache as far as is said") {
    const float noise = 0.1f;
    running_mean seen;
    running_mean said;
    for (std::uint64_t seed = 0; seed < 128; ++seed) {
        random_sampler<float> random{mix(7, seed)};
        // Even between -sqrt(3) and sqrt(3): variance one.
        const cache c =
            filled([&](float, float) { return 3 + 3 * noise * std::sqrt(3.0f) * (2 * random.next_1d() - 1); }, noise);
        seen.add(mean_of(c, everywhere()) / 3);
        said.add(shared_of(c, everywhere()).common);
    }
    // A standard deviation of 128 is known to 6 %.
    CHECK(std::sqrt(seen.variance()) == Approx(said.mean()).epsilon(0.25));
}

TEST_CASE(
    "record_sharing: light that curves upwards is read too bright, and the records say so within a factor of two") {
    // By records that know no slope.
    const auto curved = [](float x, float y) { return 1 + 8 * ((x - 0.5f) * (x - 0.5f) + (y - 0.5f) * (y - 0.5f)); };
    const cache c = filled(curved, 0);
    const std::vector<place> inner = everywhere(0.2f);
    double truth = 0;
    for (const place& p : inner) {
        truth += static_cast<double>(curved(p.position.x, p.position.y)) / static_cast<double>(inner.size());
    }
    const double off = mean_of(c, inner) / truth - 1;
    const double said = shared_of(c, inner).bias;
    CAPTURE(off, said);
    CHECK(off > 0.01);
    CHECK(said > off / 2);
    CHECK(said < 2 * off);
}
