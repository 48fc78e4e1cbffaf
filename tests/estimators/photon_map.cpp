#include <aglow/estimators/photon_map.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/core/parallel.hpp>
#include <aglow/core/random.hpp>
#include <aglow/estimators/compact_photon.hpp>

#include "support/catch.hpp"
#include "support/statistics.hpp"

using namespace aglow;
using statistics::sample_mean;

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float broken = std::numeric_limits<float>::quiet_NaN();
constexpr auto all_kernels = {kernel_shape::constant, kernel_shape::cone, kernel_shape::epanechnikov,
                              kernel_shape::biweight, kernel_shape::gaussian};

template <typename S, typename T>
landed_photon<S, T> landed(const vec3<T>& at, const S& power, const vec3<T>& wi, const vec3<T>& normal) {
    return {at, {power, packed_direction<std::int16_t>{wi}, packed_direction<std::int16_t>{normal}}};
}

/// A photon on the floor z = 0, from above.
template <typename S, typename T>
landed_photon<S, T> on_floor(T x, T y, const S& power) {
    return landed<S, T>({x, y, 0}, power, {0, 0, 1}, {0, 0, 1});
}

/// As many events as fall before `mean` where one is due per unit of time.
int poisson(double mean, random_sampler<double>& random) {
    int n = -1;
    for (double time = 0; time < mean; ++n) { time -= std::log1p(-random.next_1d()); }
    return std::max(0, n);
}

/// Photons of unit power, Poisson with `density` per area over the square [-half, half]².
std::vector<landed_photon<double, double>> sprinkled(double density, double half, std::uint64_t seed) {
    random_sampler<double> random{mix(seed, 5)};
    std::vector<landed_photon<double, double>> photons;
    const int n = poisson(density * 4 * half * half, random);
    for (int i = 0; i < n; ++i) {
        const vec2<double> u = random.next_2d();
        photons.push_back(on_floor<double, double>(half * (2 * u.x - 1), half * (2 * u.y - 1), 1));
    }
    return photons;
}

/// One photon at a random place of every cell of a fine grid over [-1, 1]², with the power of `density` there.
template <typename Density>
photon_map<double, double> even_map(int side, Density&& density) {
    random_sampler<double> random{99};
    std::vector<landed_photon<double, double>> photons;
    const double step = 2.0 / side;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const vec2<double> u = random.next_2d();
            const double px = -1 + (x + u.x) * step;
            const double py = -1 + (y + u.y) * step;
            photons.push_back(on_floor<double, double>(px, py, density(px, py) * step * step));
        }
    }
    return photon_map<double, double>{photons};
}

std::vector<landed_photon<glm::vec3, float>> colourful(float length, float power, int count = 2000) {
    random_sampler<float> random{3};
    std::vector<landed_photon<glm::vec3, float>> photons;
    for (int i = 0; i < count; ++i) {
        const vec2<float> u = random.next_2d();
        const vec2<float> c = random.next_2d();
        const glm::vec3 watts = glm::vec3{0.1f + c.x, 0.2f + c.y, 0.3f * c.x} * power;
        photons.push_back(on_floor<glm::vec3, float>(length * (u.x - 0.5f), length * (u.y - 0.5f), watts));
    }
    return photons;
}

const vec3<double> up{0, 0, 1};
const vec3<float> upf{0, 0, 1};

}  // namespace

TEST_CASE("photon_map: an even density is estimated without bias, found or not found k, shrunk or not") {
    for (const std::uint32_t k : {2u, 5u, 10u, 50u}) {
        // As many are due within the reach as are asked for: both rules are at work.
        const double reach = 1;
        const double density = k / (pi<double> * reach * reach);
        std::array<sample_mean, 6> means;
        sample_mean naive;
        const int trials = k < 50 ? 12000 : 4000;
        for (int trial = 0; trial < trials; ++trial) {
            const auto photons = sprinkled(density, 1.25, static_cast<std::uint64_t>(trial) + 1000000ull * k);
            const photon_map<double, double> map{photons};
            std::size_t i = 0;
            for (const auto kernel : {kernel_shape::constant, kernel_shape::epanechnikov, kernel_shape::cone}) {
                for (const double shrink : {1.0, 0.6}) {
                    const density_options options{.count = k, .max_radius = reach, .shrink = shrink, .kernel = kernel};
                    means[i++].add(map.irradiance({0, 0, 0}, up, options).value);
                }
            }
            std::vector<double> distances2;
            for (const auto& p : photons) { distances2.push_back(length2(p.position)); }
            std::sort(distances2.begin(), distances2.end());
            if (distances2.size() >= k) { naive.add(k / (pi<double> * distances2[k - 1])); }
        }
        for (const sample_mean& mean : means) {
            CAPTURE(k, mean.mean() / density, mean.standard_error() / density);
            CHECK(mean.agrees(density));
        }
        // The k-th photon counted too, as everywhere: k / (k - 1) too bright.
        if (k <= 10) { CHECK(naive.mean() - 4 * naive.standard_error() > density); }
    }
}

TEST_CASE("photon_map: k nearest have the relative variance 1 / (k - 2)") {
    const double density = 100;
    sample_mean mean;
    for (int trial = 0; trial < 3000; ++trial) {
        const photon_map<double, double> map{sprinkled(density, 0.8, static_cast<std::uint64_t>(trial))};
        mean.add(
            map.irradiance({0, 0, 0}, up, {.count = 50, .max_radius = 0.8, .kernel = kernel_shape::constant}).value);
    }
    CHECK(mean.agrees(density));
    CHECK(mean.variance() / (density * density) == Approx(1.0 / 48).epsilon(0.12));
}

TEST_CASE("photon_map: the error it guesses covers nine in ten of its errors") {
    const double density = 400;
    int covered = 0;
    const int trials = 500;
    for (int trial = 0; trial < trials; ++trial) {
        const photon_map<double, double> map{sprinkled(density, 0.6, static_cast<std::uint64_t>(trial))};
        const auto e = map.irradiance({0, 0, 0}, up);
        covered += std::abs(e.value - density) <= e.error ? 1 : 0;
    }
    CHECK(covered >= 450);
}

TEST_CASE("photon_map: local bias is half the second moment times the Laplacian") {
    // Of x² + y², whose Laplacian is 4: r²/2 (constant), r²/3 (Epanechnikov), 3r²/10 (cone), r²/4 (biweight).
    const auto map = even_map(400, [](double x, double y) { return x * x + y * y; });
    const double r = 0.5;
    const auto at_centre = [&](kernel_shape kernel) {
        return map.irradiance({0, 0, 0}, up, {.count = 0, .max_radius = r, .kernel = kernel}).value;
    };
    CHECK(at_centre(kernel_shape::constant) == Approx(r * r / 2).epsilon(0.01));
    CHECK(at_centre(kernel_shape::epanechnikov) == Approx(r * r / 3).epsilon(0.01));
    CHECK(at_centre(kernel_shape::cone) == Approx(3 * r * r / 10).epsilon(0.01));
    CHECK(at_centre(kernel_shape::biweight) == Approx(r * r / 4).epsilon(0.01));
}

TEST_CASE("photon_map: at the edge of a surface, the share of the disc that it covers is seen") {
    const auto map = even_map(400, [](double, double) { return 1.0; });
    const double r = 0.4;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const auto e =
            map.irradiance({1 - t * r, 0, 0}, up, {.count = 0, .max_radius = r, .kernel = kernel_shape::constant});
        CAPTURE(t);
        CHECK(e.value == Approx(1 - (std::acos(t) - t * std::sqrt(1 - t * t)) / pi<double>).epsilon(0.01));
    }
    const auto corner = map.irradiance({1, 1, 0}, up, {.count = 0, .max_radius = r, .kernel = kernel_shape::constant});
    CHECK(corner.value == Approx(0.25).epsilon(0.02));
}

TEST_CASE("photon_map: fewer photons than k on a small wall are spread over it, not over what lies beyond") {
    // Forty on the average, of which 50 are asked for; all but 8 of a second wall far away, which makes the map wide.
    sample_mean near;
    sample_mean asked;
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
        auto photons = sprinkled(10, 1, seed);
        for (int i = 0; i < 8; ++i) { photons.push_back(on_floor<double, double>(100 + i % 2, i / 2, 1)); }
        const photon_map<double, double> map{photons};
        near.add(map.irradiance({0, 0, 0}, {0, 0, 1}).value / 10);
        asked.add(map.irradiance({0, 0, 0}, {0, 0, 1}, {.max_radius = 0.8}).value / 10);
    }
    CHECK(asked.agrees(1));
    // Of those in the corners little is missed.
    CHECK(near.mean() == Approx(0.8).margin(0.2));
}

TEST_CASE("photon_map: photons of another side, plane or normal never count and never shrink the radius") {
    auto photons = colourful(2, 1);
    const photon_map<glm::vec3, float> clean{photons};
    random_sampler<float> random{8};
    for (int i = 0; i < 2000; ++i) {
        const vec2<float> u = random.next_2d() * 2.0f - 1.0f;
        const glm::vec3 watts{1000};
        photons.push_back(landed<glm::vec3, float>({u.x, u.y, 0}, watts, {0, 0, -1}, {0, 0, -1}));
        photons.push_back(landed<glm::vec3, float>({u.x, u.y, -0.001f}, watts, {0, 0, -1}, {0, 0, -1}));
        photons.push_back(landed<glm::vec3, float>({u.x, u.y, 0}, watts, {0.8f, 0, 0.6f}, {1, 0, 0}));
        photons.push_back(landed<glm::vec3, float>({0, 0, 0.3f * (u.y + 1.1f)}, watts, {0, 0, 1}, {0, 0, 1}));
    }
    const photon_map<glm::vec3, float> crowded{photons};
    for (const density_options& options :
         {density_options{.count = 50, .max_radius = 0.5}, density_options{.count = 0, .max_radius = 0.25}}) {
        for (const float x : {0.0f, 0.31f, -0.5f}) {
            const auto a = clean.irradiance({x, 0.1f, 0}, upf, options);
            const auto b = crowded.irradiance({x, 0.1f, 0}, upf, options);
            CHECK(a.count == b.count);
            CHECK(a.radius == b.radius);
            CHECK(a.value.x == Approx(b.value.x).epsilon(1e-5));
            CHECK(a.count > 20);
        }
    }
    CHECK(crowded.irradiance({0.3f, 0.1f, 0}, -upf, {.max_radius = 0.5}).value.x > 1000);
}

TEST_CASE("photon_map: bad numbers are dropped and counted, and the rest is as without them") {
    auto photons = colourful(2, 1);
    const photon_map<glm::vec3, float> clean{photons};
    photons.push_back(on_floor<glm::vec3, float>(0, 0, {broken, 1, 1}));
    photons.push_back(on_floor<glm::vec3, float>(0, 0, {1, infinite, 1}));
    photons.push_back(on_floor<glm::vec3, float>(0, 0, {1, 1, -1}));
    photons.push_back(on_floor<glm::vec3, float>(0, 0, {-infinite, 1, 1}));
    photons.push_back(on_floor<glm::vec3, float>(broken, 0, {1, 1, 1}));
    photons.push_back(on_floor<glm::vec3, float>(0, infinite, {1, 1, 1}));
    const photon_map<glm::vec3, float> map{photons};
    CHECK(map.dropped() == 6);
    CHECK(map.size() == clean.size());
    const auto a = clean.irradiance({0, 0, 0}, upf);
    const auto b = map.irradiance({0, 0, 0}, upf);
    CHECK(a.value == b.value);
    CHECK(a.error == b.error);
}

TEST_CASE("photon_map: power that a scale makes infinite is dropped too") {
    const std::vector<landed_photon<float, float>> photons{on_floor<float, float>(0, 0, 1e30f),
                                                           on_floor<float, float>(0, 0.1f, 1.0f)};
    CHECK(photon_map<float, float>{photons, 1e20f}.dropped() == 1);
    CHECK(photon_map<float, float>{photons, broken}.size() == 0);
    CHECK(photon_map<float, float>{photons, -1.0f}.size() == 0);
}

TEST_CASE("photon_map: nothing there is black, not broken") {
    const photon_map<float, float> empty;
    CHECK(empty.irradiance({0, 0, 0}, upf).value == 0);
    CHECK(empty.irradiance({0, 0, 0}, upf).count == 0);
    CHECK(empty.natural_radius(50) == 0);
    const std::vector<landed_photon<float, float>> one{on_floor<float, float>(1, 2, 3)};
    const photon_map<float, float> lone{one};
    CHECK(lone.irradiance({5, 5, 0}, upf).value == 0);
    // Asked for more than there are: all of it over the disc asked for.
    const auto e = lone.irradiance({1, 2, 0}, upf, {.max_radius = 0.5, .kernel = kernel_shape::constant});
    CHECK(e.value == Approx(3 / (pi<float> * 0.25f)));
    CHECK(e.count == 1);
    CHECK(e.radius == Approx(0.5f));
    CHECK(lone.irradiance({1, 2, 5}, upf, {.max_radius = 0.5}).count == 0);
}

TEST_CASE("photon_map: light piled up at one point is finite, and all of it is there") {
    for (const vec3<float> place : {vec3<float>{0, 0, 0}, vec3<float>{1, 2, 0}, vec3<float>{-1e6f, 3e-6f, 0}}) {
        std::vector<landed_photon<float, float>> photons(20000, on_floor<float, float>(place.x, place.y, 0.5f));
        photons.push_back(on_floor<float, float>(place.x + 50, place.y, 1.0f));
        const photon_map<float, float> map{photons};
        for (const auto kernel : all_kernels) {
            for (const std::uint32_t count : {0u, 1u, 2u, 50u, 40000u}) {
                const auto e = map.irradiance(place, upf, {.count = count, .max_radius = 0.5, .kernel = kernel});
                CAPTURE(place.x, count, static_cast<int>(kernel));
                REQUIRE(is_finite(e.value));
                REQUIRE(is_finite(e.error));
                CHECK(e.radius > 0);
                CHECK(e.count == 20000);
                const float at_centre = with_kernel(kernel, [](auto k) { return k(0.0f); });
                CHECK(e.value * e.radius * e.radius / at_centre == Approx(10000).epsilon(1e-3));
            }
        }
    }
}

TEST_CASE("photon_map: photons all at the origin do not divide by nothing") {
    const std::vector<landed_photon<float, float>> photons(100, on_floor<float, float>(0, 0, 1));
    const auto e = photon_map<float, float>{photons}.irradiance({0, 0, 0}, upf);
    CHECK(is_finite(e.value));
    CHECK(is_finite(e.error));
}

TEST_CASE("photon_map: a search may reach as far as one likes, and finds the nearest photons still") {
    random_sampler<float> random{9};
    std::vector<landed_photon<float, float>> photons;
    for (int i = 0; i < 10'000; ++i) {
        photons.push_back(on_floor<float, float>(random.next_1d(), random.next_1d(), 1));
    }
    const photon_map<float, float> map{photons};
    const auto near = map.irradiance({0.5f, 0.5f, 0}, upf, {.count = 50});
    for (const double far : {10.0, 1e4, 1e8, 1e15}) {
        const auto e = map.irradiance({0.5f, 0.5f, 0}, upf, {.count = 50, .max_radius = far});
        CAPTURE(far);
        CHECK(e.value == near.value);
        CHECK(e.radius == near.radius);
    }
}

TEST_CASE("photon_map: one photon asked for is a density of two") {
    const photon_map<glm::vec3, float> map{colourful(2, 1)};
    CHECK(map.irradiance({0, 0, 0}, upf, {.count = 1}).value == map.irradiance({0, 0, 0}, upf, {.count = 2}).value);
    CHECK(map.irradiance({0, 0, 0}, upf, {.count = 1}).value.x > 0);
}

TEST_CASE("photon_map: a shrunk estimate is spread over that share of the radius") {
    const photon_map<glm::vec3, float> map{colourful(2, 1)};
    const auto whole = map.irradiance({0, 0, 0}, upf);
    CHECK(map.irradiance({0, 0, 0}, upf, {.shrink = 0.5}).radius == 0.5f * whole.radius);
}

TEST_CASE("photon_map: without a count, a shrunk radius is that of the search") {
    const photon_map<glm::vec3, float> map{colourful(2, 1)};
    for (const float largest : {0.0f, 0.5f}) {
        const float whole = largest > 0 ? largest : map.natural_radius(50);
        const auto shrunk = map.irradiance({0, 0, 0}, upf, {.count = 0, .max_radius = largest, .shrink = 0.25});
        const auto narrow = map.irradiance({0, 0, 0}, upf, {.count = 0, .max_radius = 0.25 * whole});
        CHECK(shrunk.radius == narrow.radius);
        CHECK(shrunk.count == narrow.count);
        CHECK(shrunk.value == narrow.value);
        CHECK(narrow.count > 0);
    }
}

TEST_CASE("photon_map: where nobody came, as much is feared as three of the brightest photons, or bunches, make") {
    std::vector<landed_photon<float, float>> photons(40, on_floor<float, float>(0, 0, 0.5f));
    photons.push_back(on_floor<float, float>(0, 0, 2));
    for (const float faint : {1.0f, 0x1p-120f}) {
        photon_map<float, float> map{photons, faint};
        const auto nobody = [&] { return map.irradiance({5, 0, 0}, upf, {.max_radius = 0.5}); };
        CHECK(nobody().count == 0);
        CHECK(nobody().value == 0);
        CHECK(nobody().error == Approx(3 * 2 * faint / (pi<float> * 0.25f)));
        map.come_in_bunches(40);
        CHECK(nobody().error == Approx(40 * 3 * 2 * faint / (pi<float> * 0.25f)));
    }
}

TEST_CASE("photon_map: scaling the scene by a power of two scales the answer exactly") {
    const photon_map<glm::vec3, float> map{colourful(2, 1e-3f)};
    for (const density_options& options : {density_options{}, density_options{.count = 7, .shrink = 0.5},
                                           density_options{.kernel = kernel_shape::gaussian}}) {
        const auto here = map.irradiance({0.1f, -0.2f, 0}, upf, options);
        for (int k = -30; k <= 30; ++k) {
            const float s = std::ldexp(1.0f, k);
            const photon_map<glm::vec3, float> scaled{colourful(2 * s, 1e-3f)};
            const auto there = scaled.irradiance(vec3<float>{0.1f, -0.2f, 0} * s, upf, options);
            CHECK(there.value * s * s == here.value);
            CHECK(there.error * s * s == here.error);
            CHECK(there.radius == here.radius * s);
            CHECK(there.count == here.count);
        }
    }
}

TEST_CASE("photon_map: scaling the light by a power of two scales value and error exactly") {
    const auto here = photon_map<glm::vec3, float>{colourful(2, 1e-3f)}.irradiance({0.1f, -0.2f, 0}, upf);
    for (int k = -60; k <= 60; k += 5) {
        const float s = std::ldexp(1.0f, k);
        const auto there = photon_map<glm::vec3, float>{colourful(2, 1e-3f * s)}.irradiance({0.1f, -0.2f, 0}, upf);
        CAPTURE(k);
        CHECK(there.value == here.value * s);
        CHECK(there.error == here.error * s);
    }
}

TEST_CASE("photon_map: permuted bands give permuted light") {
    const auto photons = colourful(2, 1);
    auto turned = photons;
    for (auto& p : turned) { p.what.power = {p.what.power.z, p.what.power.x, p.what.power.y}; }
    const auto a = photon_map<glm::vec3, float>{photons}.irradiance({0.1f, 0, 0}, upf);
    const auto b = photon_map<glm::vec3, float>{turned}.irradiance({0.1f, 0, 0}, upf);
    CHECK(b.value == glm::vec3{a.value.z, a.value.x, a.value.y});
    CHECK(a.error == b.error);
}

TEST_CASE("photon_map: a faint light keeps its photons beside one 1e30 times as strong") {
    std::vector<landed_photon<float, float>> photons;
    for (int i = 0; i < 400; ++i) {
        const float x = 0.01f * static_cast<float>(i % 20);
        const float y = 0.01f * static_cast<float>(i / 20);
        photons.push_back(on_floor<float, float>(x, y, 1e-15f));
        photons.push_back(on_floor<float, float>(x + 10, y, 1e15f));
    }
    const photon_map<float, float> map{photons};
    const density_options within{.count = 0, .max_radius = 0.05, .kernel = kernel_shape::constant};
    const auto faint = map.irradiance({0.095f, 0.095f, 0}, upf, within);
    const auto strong = map.irradiance({10.095f, 0.095f, 0}, upf, within);
    CHECK(faint.value == Approx(1e-15f * static_cast<float>(faint.count) / (pi<float> * 0.0025f)).epsilon(1e-5));
    CHECK(strong.value / faint.value == Approx(1e30f).epsilon(1e-2));
}

namespace {

struct floor_place {
    vec3<float> position, normal;
};

/// Places above, below, beside and far off photons on a floor of the unit square.
std::vector<floor_place> floor_places(std::size_t count) {
    random_sampler<float> random{21};
    std::vector<floor_place> places;
    while (places.size() < count) {
        const vec2<float> u = random.next_2d() * 1.4f - 0.7f;
        const std::size_t i = places.size();
        places.push_back({{u.x, u.y, i % 7 == 0 ? 0.01f : 0.0f}, i % 5 == 0 ? -upf : upf});
        if (i % 11 == 0) { places.back().position += glm::vec3{50, 0, 0}; }
        if (i % 13 == 0) { places.back().normal = {1, 0, 0}; }
    }
    return places;
}

template <typename Map>
void check_batches(const Map& map, const density_options& options) {
    using estimate = density_estimate<glm::vec3, float>;
    const auto same = [](const estimate& a, const estimate& b) {
        return a.value == b.value && a.error == b.error && a.common == b.common && a.bias == b.bias &&
               a.count == b.count && a.radius == b.radius;
    };
    const auto odd = [](std::size_t place, std::size_t photon) { return (place + photon) % 3 != 0; };
    for (const std::size_t count : {0u, 1u, 7u, 1000u}) {
        const std::vector<floor_place> places = floor_places(count);
        const std::span<const floor_place> all{places};
        std::vector<estimate> each(count), some(count);
        map.irradiance_each(all, std::span<estimate>{each}, options);
        map.irradiance_each(all, std::span<estimate>{some}, options, odd);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto here = [&](std::size_t photon) { return odd(i, photon); };
            wrong += !same(each[i], map.irradiance(places[i].position, places[i].normal, options));
            wrong += !same(some[i], map.irradiance(places[i].position, places[i].normal, options, here));
        }
        CAPTURE(count, map.size(), options.count);
        CHECK(wrong == 0);
    }
}

}  // namespace

TEST_CASE("photon_map: many places asked at once get what each gets alone, to the bit") {
    const auto many = {density_options{}, density_options{.count = 7, .shrink = 0.5, .kernel = kernel_shape::cone},
                       density_options{.count = 3, .max_radius = 0.02}, density_options{.count = 0},
                       density_options{.count = 5000}};
    // None, fewer than are asked for, many, and so many that memory is asked for them ahead.
    for (const int count : {0, 1, 20, 2000, 80000}) {
        auto photons = colourful(1, 1e-3f, count);
        for (std::size_t i = 0; i < photons.size(); i += 3) {
            photons[i].what.wi = packed_direction<std::int16_t>{-upf};
        }
        const photon_map<glm::vec3, float> full{photons};
        const photon_map<glm::vec3, float, compact_photon<glm::vec3>> compact{full};
        for (const density_options& options : many) {
            check_batches(full, options);
            check_batches(compact, options);
        }
    }
    // So close together that positions can not tell them apart.
    const std::vector<landed_photon<glm::vec3, float>> pile(20000, on_floor<glm::vec3, float>(0.1f, 0.2f, {1, 2, 3}));
    check_batches(photon_map<glm::vec3, float>{pile}, {.max_radius = 1});
}

TEST_CASE("photon_map: a batch tells how far from black it may be where no photons are") {
    photon_map<glm::vec3, float> map{colourful(1, 1e-3f)};
    map.come_in_bunches(4);
    const std::array<floor_place, 2> places{{{{9, 9, 0}, upf}, {{0, 0, 0}, upf}}};
    std::array<density_estimate<glm::vec3, float>, 2> found;
    map.irradiance_each(std::span<const floor_place>{places}, std::span{found}, {.max_radius = 0.5});
    CHECK(found[0].count == 0);
    CHECK(found[0].value == glm::vec3{0});
    CHECK(found[0].error > 0);
    CHECK(found[1].count > 0);
}

TEST_CASE("photon_map: several threads ask batches of one map at the same time and hear the same") {
    const photon_map<glm::vec3, float> map{colourful(1, 1e-3f, 50000)};
    const std::vector<floor_place> places = floor_places(4096);
    std::vector<density_estimate<glm::vec3, float>> one(places.size()), crew(places.size());
    map.irradiance_each(std::span<const floor_place>{places}, std::span{one});
    for_each_block(own_threads{4}, places.size(), 100, [&](std::size_t, std::size_t first, std::size_t last) {
        map.irradiance_each(std::span<const floor_place>{places}.subspan(first, last - first),
                            std::span{crew}.subspan(first, last - first));
    });
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < places.size(); ++i) { wrong += one[i].value != crew[i].value; }
    CHECK(wrong == 0);
}

TEST_CASE("photon_map: radiance is each photon's power times the BSDF, of both sides where asked") {
    auto photons = colourful(2, 1);
    const std::size_t above = photons.size();
    for (std::size_t i = 0; i < above; ++i) {
        photons.push_back(photons[i]);
        photons.back().what.wi = packed_direction<std::int16_t>{-upf};
        photons.back().what.normal = packed_direction<std::int16_t>{-upf};
        photons.back().what.power *= 3.0f;
    }
    const photon_map<glm::vec3, float> map{photons};
    const density_options options{.count = 0, .max_radius = 0.4};
    const float e = map.irradiance({0, 0, 0}, upf, options).value.x;
    const auto constant = [](const vec3<float>&) { return 0.25f; };
    CHECK(map.radiance({0, 0, 0}, upf, false, constant, options).value.x == Approx(0.25f * e));
    CHECK(map.radiance({0, 0, 0}, upf, true, constant, options).value.x == Approx(0.25f * 4 * e));
    const auto from_below = [](const vec3<float>& wi) { return wi.z < 0 ? 1.0f : 0.0f; };
    CHECK(map.radiance({0, 0, 0}, upf, true, from_below, options).value.x == Approx(3 * e));
    CHECK(map.radiance({0, 0, 0}, upf, false, from_below, options).value.x == 0);
}

TEST_CASE("photon_map: one thread and three build the same map") {
    const auto photons = colourful(2, 1, 50000);
    const photon_map<glm::vec3, float> one{photons};
    const photon_map<glm::vec3, float> three{photons, 1.0f, own_threads{3}};
    REQUIRE(one.size() == three.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        REQUIRE(one.position(i) == three.position(i));
        REQUIRE(one.photons()[i].power == three.photons()[i].power);
    }
}

TEST_CASE("photon_map: the natural radius holds about sixteen times as many as asked for on an even floor") {
    const auto map = even_map(300, [](double, double) { return 1.0; });
    const double r = map.natural_radius(50);
    // The box has two faces of the floor's size: four radii of 100 photons.
    CHECK(pi<double> * r * r / 4 * 90000 == Approx(16 * 100).epsilon(0.02));
}
