#include <aglow/algorithms/progressive.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <glm/vec3.hpp>

#include <aglow/algorithms/path_trace.hpp>

#include "support/archetypes.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"
#include "support/scenes.hpp"

using namespace aglow;

namespace {

using S = glm::vec3;

/// A camera in the room, for pictures of 8 x 8 pixels.
constexpr auto eye = [](const vec2<float>& film) {
    return ray<float>{{0, -0.95f, 0}, glm::normalize(vec3<float>{film.x / 4 - 1, 1.5f, 1 - film.y / 4})};
};

template <typename Run = in_sequence>
film<S> rendered(const support::ball_room<S, float>& room, int passes, const progressive_options& options,
                 const Run& run = {}) {
    film<S> picture{8, 8};
    progressive_photon_mapping mapping{room.scene, room.light, options};
    for (int i = 0; i < passes; ++i) { mapping.pass(picture, eye, run); }
    CHECK(mapping.passes() == static_cast<std::uint64_t>(passes));
    return picture;
}

support::ball_room<S, float> room() { return support::room_with_balls<S, float>({0.7f, 0.5f, 0.3f}, {10, 12, 14}); }

double mean_of(const film<S>& picture) {
    double sum = 0;
    for (std::size_t y = 0; y < 8; ++y) {
        for (std::size_t x = 0; x < 8; ++x) { sum += double(picture.radiance(x, y).x) / 64; }
    }
    return sum;
}

}  // namespace

TEST_CASE("progressive: the radius of any pass is the product of all shrinkings before it") {
    for (const double alpha : {0.3, 2.0 / 3, 0.9}) {
        long double product = 1;
        CHECK(radius2_share(1, alpha) == Approx(1).epsilon(1e-14));
        for (int i = 1; i < 200000; ++i) {
            product *= (i + static_cast<long double>(alpha)) / (i + 1);
            if (i < 10 || i % 49999 == 0) {
                CHECK(radius2_share(i + 1, alpha) == Approx(double(product)).epsilon(1e-8));
            }
        }
        // Far out: i^(alpha - 1) / Gamma(1 + alpha).
        const double far = std::pow(1e7, alpha - 1) / std::tgamma(1 + alpha);
        CHECK(radius2_share(1e7, alpha) == Approx(far).epsilon(1e-6));
    }
}

TEST_CASE("progressive: 1, 2, 3 and 8 threads and any executor render the same picture") {
    const progressive_options few{.caustic = 500, .indirect = 2000};
    const auto one = rendered(room(), 3, few);
    const auto check = [&](const auto& run) {
        const auto other = rendered(room(), 3, few, run);
        for (std::size_t y = 0; y < 8; ++y) {
            for (std::size_t x = 0; x < 8; ++x) {
                CHECK(one.radiance(x, y) == other.radiance(x, y));
                CHECK(one.error(x, y) == other.error(x, y));
            }
        }
    };
    for (const unsigned threads : {1u, 2u, 3u, 8u}) { check(own_threads{threads}); }
    check(archetypes::executor{});
}

TEST_CASE("progressive: passes differ from each other and add up to what path tracing sees") {
    const auto r = room();
    film<S> truth{8, 8};
    truth.expose(eye, path_tracer{r.scene, r.light}, {.samples = 1024});
    const auto picture = rendered(r, 24, {.caustic = 4000, .indirect = 10000});
    const auto once = rendered(r, 1, {.caustic = 4000, .indirect = 10000});
    CHECK(picture.samples() == 24);
    CHECK(picture.radiance(3, 6) != once.radiance(3, 6));
    int covered = 0;
    for (std::size_t y = 0; y < 8; ++y) {
        for (std::size_t x = 0; x < 8; ++x) {
            const float off = std::abs(picture.radiance(x, y).x - truth.radiance(x, y).x);
            covered += off <= picture.error(x, y) + 2 * truth.error(x, y) ? 1 : 0;
        }
    }
    CAPTURE(mean_of(picture), mean_of(truth));
    CHECK(covered >= 60);
    // Discs of 0.12 m in the mean reach over the edges of a room of 2 m: 3 % of the light lies beyond.
    CHECK(mean_of(picture) == Approx(mean_of(truth)).epsilon(0.05));
}

TEST_CASE("progressive: more passes bring the picture nearer to the truth") {
    const auto r = room();
    film<S> truth{8, 8};
    truth.expose(eye, path_tracer{r.scene, r.light}, {.samples = 1024, .seed = 9});
    const auto error2 = [&](const film<S>& p) {
        double sum = 0;
        for (std::size_t y = 0; y < 8; ++y) {
            for (std::size_t x = 0; x < 8; ++x) {
                const double t = double(truth.radiance(x, y).y);
                const double d = double(p.radiance(x, y).y) - t;
                sum += d * d / (t * t + 1e-4);
            }
        }
        return sum / 64;
    };
    const progressive_options options{.caustic = 1000, .indirect = 3000, .seed = 5};
    const double few = error2(rendered(r, 2, options));
    const double many = error2(rendered(r, 32, options));
    CAPTURE(few, many);
    // Noise and smooth bias fall to a sixth; what edges lose, only with the radius.
    CHECK(many < few / 2);
}

TEST_CASE("progressive: an alpha outside (0, 1) is refused by name") {
    const auto r = room();
    for (const double alpha : {0.0, 1.0, -0.5, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
        std::string why;
        try {
            static_cast<void>(progressive_photon_mapping{r.scene, r.light, {.alpha = alpha}});
        } catch (const std::invalid_argument& e) { why = e.what(); }
        CHECK(why.find("progressive_options.alpha") != std::string::npos);
    }
}

TEST_CASE("progressive: a furnace of double is 1 / (1 - rho) bright") {
    const testing::furnace_sphere<double, double> scene{.radius = 2, .albedo = 0.5, .glow = 1};
    const testing::furnace_light<double, double> light{.radius = 2, .glow = 1};
    progressive_photon_mapping mapping{scene, light, {.indirect = 20000}};
    film<double> picture{4, 4};
    const auto around = [](const vec2<double>& film) {
        return ray<double>{{0.1, 0.2, -0.3}, uniform_sphere(film * 0.25)};
    };
    for (int i = 0; i < 8; ++i) { mapping.pass(picture, around); }
    double mean = 0;
    double error = 0;
    for (std::size_t i = 0; i < 16; ++i) {
        mean += picture.radiance(i % 4, i / 4) / 16;
        error += picture.error(i % 4, i / 4) / 16;
    }
    CHECK(std::abs(mean - 2) <= error);
    CHECK(mean == Approx(2).epsilon(0.03));
}
