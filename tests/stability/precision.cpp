// Rows 66 to 80: numbers at the ends of their range, long sums, broken hosts, thin walls.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/algorithms/film.hpp>
#include <aglow/algorithms/path_trace.hpp>
#include <aglow/algorithms/photon_integrators.hpp>
#include <aglow/algorithms/progressive.hpp>
#include <aglow/algorithms/trace_photons.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/halton.hpp>
#include <aglow/core/warp.hpp>
#include <aglow/estimators/irradiance_cache.hpp>
#include <aglow/report/running_mean.hpp>

#include "stability/analytic.hpp"
#include "stability/closed_forms.hpp"
#include "support/broken_host.hpp"
#include "support/catch.hpp"
#include "support/furnace.hpp"

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

using namespace aglow;
using namespace stability;
using rgb = glm::vec3;

namespace {

/// As a foreign library may leave the processor: subnormal numbers are nothing.
class without_subnormals {
public:
#if defined(__SSE__)
    without_subnormals() : before_{_mm_getcsr()} {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    }
    ~without_subnormals() { _mm_setcsr(before_); }

private:
    unsigned before_;
#endif
};

/// A few pixels of the room of balls by photon mapping, summed, under light of `power`.
rgb mapped(float power) {
    const auto room = support::room_with_balls<rgb, float>({0.7f, 0.5f, 0.3f}, rgb{power});
    const photon_mapping integrator{room.scene, room.light, {.photons = {.indirect = 2000, .pilot_paths = 500}}};
    rgb sum{0};
    for (std::uint64_t i = 0; i < 32; ++i) {
        const random_numbers<float> numbers{{.path = i}};
        auto random = numbers.at(0, purpose::camera);
        sum += integrator(ray<float>{{0.1f, -0.5f, 0.2f}, uniform_sphere(random.next_2d())}, numbers).value;
    }
    return sum;
}

template <typename T>
landed_photon<T, T> landed(const vec3<T>& at, T power, const vec3<T>& side = {0, 0, 1}) {
    const packed_direction<std::int16_t> packed{side};
    return {at, {power, packed, packed}};
}

/// Hits that take away what `absorption` takes over the way back from where the ray started, and let the rest through.
struct haze_hit : support::toy_hit<double, double> {
    double passed{1};
    template <Sampler R>
    [[nodiscard]] auto sample(const vec3<double>& wo, R& random, lobe_set asked) const {
        auto s = toy_hit::sample(wo, random, asked);
        if (s) { s->weight *= passed; }
        return s;
    }
};
struct haze {
    using scalar = double;
    double absorption{};
    double depth{};
    support::material<double> air{.glass = 1};

    [[nodiscard]] std::optional<haze_hit> intersect(const ray<double>& r) const {
        const double t = (depth - r.origin.z) / r.direction.z;
        if (!(t > 0 && t < r.reach)) { return std::nullopt; }
        return haze_hit{{r.origin + r.direction * t, {0, 0, 1}, &air, depth * 1e-9}, std::exp(-absorption * depth)};
    }
    [[nodiscard]] bool occluded(const vec3<double>&, const vec3<double>&) const { return false; }
};

/// Particles of `power` W, all along one line.
struct beam {
    using scalar = float;
    float power{};
    template <Sampler R>
    [[nodiscard]] emission<float, float> emit(R&) const {
        return {{}, power};
    }
};

/// A million, and one more or less.
struct wave {
    using scalar = float;
    template <typename N>
    [[nodiscard]] estimate<float> operator()(const ray<float>&, const N& numbers) const {
        return {1e6f + (numbers.at(1, purpose::scatter).next_1d() < 0.5f ? -1.0f : 1.0f), 0};
    }
};

}  // namespace

TEST_CASE(
    "stability 66: radical inverses never reach one, to the last index, in a thousand dimensions, in any precision") {
    const halton_scrambling table{1, 0, 1000};
    for (const std::uint64_t i : {std::uint64_t{0xffffffff}, std::uint64_t{1} << 32, std::uint64_t{1} << 53,
                                  ~std::uint64_t{0}, std::uint64_t{33554431}}) {
        for (std::size_t d = 0; d < 1000; ++d) {
            const float f = table.number<float>(i, d);
            const double x = table.number<double>(i, d);
            if (!(f >= 0 && f < 1 && x >= 0 && x < 1)) { FAIL_CHECK("dimension " << d << " index " << i); }
            if (!(std::abs(static_cast<double>(f) - x) <= 0x1p-24)) { FAIL_CHECK("float is not double cut: " << d); }
        }
    }
}

TEST_CASE("stability 67: dimensions beyond the table are hashed and below one, and the table tells how many it has") {
    const halton_scrambling table{1, 0, 8};
    CHECK(table.dimensions() == 8);
    double sum = 0;
    for (std::uint64_t i = 0; i < 4096; ++i) {
        const double x = table.number<double>(i, 8 + i % 100);
        CHECK((x >= 0 && x < 1));
        sum += x;
    }
    CHECK(std::abs(sum / 4096 - 0.5) < 4 / std::sqrt(12 * 4096.0));
    CHECK_THROWS_AS((halton_scrambling{1, 0, 1001}), std::invalid_argument);
}

TEMPLATE_TEST_CASE("stability 68: at the edges of the square every warp gives a direction and a density above zero", "",
                   float, double) {
    using T = TestType;
    const T eps = std::numeric_limits<T>::epsilon();
    for (const T x : {T(0), T(0.5), one_below<T>}) {
        for (const T y : {T(0), T(0.5), one_below<T>}) {
            const vec2<T> u{x, y};
            const vec3<T> c = cosine_hemisphere(u);
            CHECK(std::abs(glm::length(c) - 1) <= 4 * eps);
            CHECK(cosine_hemisphere_pdf(c.z) > 0);
            for (const vec3<T> d : {uniform_sphere(u), uniform_hemisphere(u), uniform_cone(u, T(1e-6))}) {
                CHECK(std::abs(glm::length(d) - 1) <= 4 * eps);
            }
            CHECK(uniform_hemisphere(u).z > 0);
            const vec2<T> w = uniform_triangle(u);
            CHECK((w.x >= 0 && w.y >= 0 && w.x + w.y <= 1 + eps));
        }
    }
}

TEST_CASE(
    "stability 69: float and double make the same picture within their noise, and the same estimate to a hundred ulp") {
    const auto seen = [](auto one) {
        using T = decltype(one);
        const auto room = support::room_with_balls<T, T>(T(0.6), T(10));
        statistics::sample_mean mean;
        for (std::uint64_t i = 0; i < 4000; ++i) {
            const random_numbers<T> numbers{{.seed = sizeof(T), .path = i}};
            auto random = numbers.at(0, purpose::camera);
            mean.add(static_cast<double>(
                path_trace(room.scene, room.light, ray<T>{{}, uniform_sphere(random.next_2d())}, numbers)));
        }
        return mean;
    };
    const auto single = seen(1.0f);
    const auto twice = seen(1.0);
    CHECK(std::abs(single.mean() - twice.mean()) <= 4 * std::hypot(single.standard_error(), twice.standard_error()));

    std::vector<landed_photon<float, float>> coarse;
    std::vector<landed_photon<double, double>> fine;
    random_sampler<float> random{5};
    for (int i = 0; i < 2000; ++i) {
        const vec3<float> p{random.next_1d(), random.next_1d(), 0};
        coarse.push_back(landed<float>(p, 1));
        fine.push_back(landed<double>(vec3<double>(p), 1));
    }
    const density_options disc{.count = 0, .max_radius = 0.25};
    const float e32 = photon_map<float, float>{std::span<const landed_photon<float, float>>{coarse}}
                          .irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, disc)
                          .value;
    const double e64 = photon_map<double, double>{std::span<const landed_photon<double, double>>{fine}}
                           .irradiance({0.5, 0.5, 0}, {0, 0, 1}, disc)
                           .value;
    CHECK(std::abs(static_cast<double>(e32) - e64) <= 100 * 1.2e-7 * e64);
}

TEST_CASE("stability 71: with subnormal numbers switched off the pictures are the same to 4 ulp") {
    for (const float power : {1.0f, 0x1p-60f, 0x1p60f}) {
        const rgb with = mapped(power);
        const rgb without = [&] {
            const without_subnormals foreign;
            return mapped(power);
        }();
        for (int b = 0; b < 3; ++b) { CHECK(std::abs(with[b] - without[b]) <= 4 * 1.2e-7f * with[b]); }
        CHECK(with.x > 0);
    }
}

TEST_CASE("stability 73: the radius after ten million passes is that of the closed form") {
    long double product = 1;
    const long double alpha = 2.0L / 3;
    const int passes = 10'000'000;
    for (int i = 1; i < passes; ++i) { product *= (i + alpha) / (i + 1); }
    CHECK(radius2_share(passes, 2.0 / 3) == Approx(static_cast<double>(product)).epsilon(1e-6));
    CHECK(radius2_share(1, 2.0 / 3) == 1);
}

TEST_CASE("stability 74: a spread of one around a million is seen, by means and by films") {
    running_mean mean;
    random_sampler<double> random{3};
    const double half = std::sqrt(3.0);
    for (int i = 0; i < 1'000'000; ++i) { mean.add(1e6 + half * (2 * random.next_1d() - 1)); }
    // The variance of a uniform law is known to sqrt(0.8 / n) of itself: 1e-3 is about one sigma of n = 1e6.
    CHECK(mean.variance() == Approx(1).epsilon(4 * std::sqrt(0.8e-6)));
    film<float> film{1, 1};
    film.expose([](const vec2<float>&) { return ray<float>{}; }, wave{}, {.samples = 4096});
    CHECK(film.error(0, 0) * 64 == Approx(1).epsilon(0.01));
}

TEST_CASE("stability 75: the powers of a hundred million photons sum to one part in a million") {
    // A hundred million particles through the emission and the books of tracing, in its blocks; 1 W in all, in float,
    // each power no round number.
    const std::size_t blocks = 97'657;
    const std::size_t count = blocks * 1024;
    const beam light{1 / static_cast<float>(count)};
    const double power = static_cast<double>(light.power);
    std::vector<energy_ledger<float>> books;
    for (std::size_t b = 0; b < blocks; ++b) {
        const auto walk = [&](std::size_t i, energy_ledger<float>& ledger) {
            detail::photon_state<float, float> at;
            (void)detail::emit_photon(light, random_numbers<float>{{.path = i}}, at, ledger);
        };
        books.push_back(kept_books<float>(b * 1024, (b + 1) * 1024, walk));
    }
    const auto all = joined<float>(books);
    CHECK(all.emitted == count);
    CHECK(std::abs(static_cast<double>(all.power_emitted) - power * static_cast<double>(count)) <= 1e-6);
    // And through tracing itself, as many as there is time for: nothing is met, all escapes.
    const auto traced = trace_photons(support::toy_scene<float, float>{}, light,
                                      {.direct = 1, .paths = {.direct = 2'000'000}, .seed = 1});
    CHECK(traced.ledger.escaped == 2'000'000);
    CHECK(static_cast<double>(traced.ledger.power_escaped) == Approx(power * 2e6).epsilon(1e-6));
    // A map's own sums, over two million photons on one disc: sets of 16, and these in double, however many there are.
    const std::vector<landed_photon<float, float>> gray(2'000'000, landed<float>({0, 0, 0}, 1e-3f / 3));
    const auto e = photon_map<float, float>{std::span<const landed_photon<float, float>>{gray}}.irradiance(
        {0, 0, 0}, {0, 0, 1}, {.count = 0, .max_radius = 1, .kernel = kernel_shape::constant});
    CHECK(static_cast<double>(e.value) * aglow::pi<double> ==
          Approx(2'000'000 * static_cast<double>(1e-3f / 3)).epsilon(1e-6));
}

TEST_CASE("stability 76: no light, black walls and walls that take all are exactly black, and store nothing") {
    const support::toy_scene<rgb, float> black{.balls = {{.radius = 1}}};
    const support::bulb<rgb, float> light{.intensity = rgb{1}};
    const auto maps = trace_photons(black, light, {.direct = 100, .caustic = 100, .indirect = 100, .pilot_paths = 100});
    CHECK(maps.size() == 0);
    CHECK(path_trace(black, light, ray<float>{}, random_numbers<float>{{}}) == rgb{0});
    const support::no_light<rgb, float> nobody;
    const auto room = support::room_with_balls<rgb, float>(rgb{0.5f}, rgb{0});
    const auto dark = trace_photons(room.scene, nobody, {.direct = 100, .indirect = 100, .pilot_paths = 100});
    CHECK(dark.size() == 0);
    CHECK(dark.ledger.power_emitted == rgb{0});
    const photon_mapping integrator{room.scene, nobody, {.photons = {.indirect = 100, .pilot_paths = 100}}};
    for (std::uint64_t i = 0; i < 50; ++i) {
        const random_numbers<float> numbers{{.path = i}};
        auto random = numbers.at(0, purpose::camera);
        const ray<float> eye{{}, uniform_sphere(random.next_2d())};
        CHECK(integrator(eye, numbers).value == rgb{0});
        CHECK(path_trace(room.scene, nobody, eye, numbers) == rgb{0});
    }
}

TEST_CASE("stability 77: an eye within a wall, a picture of one pixel and one of none are no trouble") {
    const auto room = support::room_with_balls<rgb, float>(rgb{0.5f}, rgb{10});
    const path_tracer tracer{room.scene, room.light};
    const auto in_the_wall = [](const vec2<float>& film) {
        return ray<float>{{1, 0, 0}, glm::normalize(rgb{-1, film.x - 0.5f, film.y - 0.5f})};
    };
    film<rgb> one{1, 1};
    one.expose(in_the_wall, tracer, {.samples = 64});
    CHECK(one.dropped() == 0);
    CHECK(is_radiance(one.radiance(0, 0)));
    film<rgb> none{0, 0};
    none.expose(in_the_wall, tracer, {.samples = 4});
    CHECK(none.samples() == 4);
}

TEST_CASE("stability 78: whatever a host gets wrong is left out, counted by kind, and told with the light lost") {
    const auto room = support::room_with_balls<rgb, float>(rgb{0.6f}, rgb{10});
    const auto kind_of = [](support::flaw f) {
        using support::flaw;
        if (f == flaw::nan_position || f == flaw::behind) { return host_fault::place; }
        if (f == flaw::long_normal || f == flaw::nan_normal) { return host_fault::normal; }
        if (f == flaw::nan_direction || f == flaw::long_direction) { return host_fault::direction; }
        if (f == flaw::nan_evaluate || f == flaw::nan_emitted) { return host_fault::radiance; }
        return host_fault::weight;
    };
    for (const support::flaw wrong : support::all_flaws) {
        const support::flawed_scene scene{room.scene, wrong};
        CAPTURE(static_cast<int>(wrong));
        host_faults faults;
        const auto see = [&](const auto& integrator) {
            film<rgb> picture{4, 4};
            picture.expose(
                [](const vec2<float>& f) {
                    return ray<float>{{0, -0.9f, 0}, glm::normalize(rgb{f.x / 2 - 1, 1, f.y / 2 - 1})};
                },
                integrator, {.samples = 16});
            bool sound = true;
            for (std::size_t p = 0; p < 16; ++p) { sound = sound && is_radiance(picture.radiance(p % 4, p / 4)); }
            CHECK(sound);
        };
        const path_options noting{.faults = &faults};
        see(path_tracer{scene, room.light, noting});
        CHECK(faults.count(kind_of(wrong)) > 0);
        CHECK(faults.count() == faults.count(kind_of(wrong)));
        CHECK(faults.lost() > 0);
        CHECK(faults.lost() <= static_cast<double>(faults.count()) * 4);
        CHECK(statement(faults).find(words(kind_of(wrong))) != std::string::npos);

        const photon_mapping maps{
            scene, room.light, {.photons = {.caustic = 200, .indirect = 500, .pilot_paths = 500}, .paths = noting}};
        see(maps);
        const auto& ledger = maps.maps().ledger;
        std::uint64_t by_kind = 0;
        for (const std::uint64_t n : ledger.faults) { by_kind += n; }
        CHECK(by_kind == ledger.dropped);
        CHECK(ledger.faults[static_cast<std::size_t>(kind_of(wrong))] == ledger.dropped);
        CHECK((ledger.dropped > 0) == (ledger.power_dropped.x > 0));
    }
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -1.0f, std::numeric_limits<float>::infinity()}) {
        const support::flawed_bulb light{{.position = {0, 0, 0.5f}, .intensity = rgb{1}}, bad, false};
        const auto maps = trace_photons(room.scene, light, {.direct = 500, .pilot_paths = 500});
        CHECK(maps.ledger.faults[static_cast<std::size_t>(host_fault::power)] > 200);
        CHECK(maps.ledger.faults[static_cast<std::size_t>(host_fault::power)] == maps.ledger.dropped);
    }
}

TEST_CASE("stability 79: absorption along the way is exp(-s d) from 1e-12 to 1e4, and ends in nothing, not NaN") {
    const even_sky<double> sky;
    for (double d = 1e-12; d < 2e4; d *= 100) {
        const haze scene{1, d};
        const auto mean = looks_along(path_tracer{scene, sky}, ray<double>{{0, 0, 0}, {0, 0, 1}}, 1);
        CAPTURE(d, mean.mean());
        CHECK(std::abs(mean.mean() - std::exp(-d)) <= 8 * 2.3e-16);
    }
    const haze thick{1, 1e4};
    CHECK(looks_along(path_tracer{thick, sky}, ray<double>{{0, 0, 0}, {0, 0, 1}}, 1).mean() == 0);
}

TEST_CASE("stability 80: through a wall a hundredth as thin as its radius a photon map leaks, less the less it looks") {
    // Light floor x < 0, a wall of 1e-3, dark floor x > 1e-3, looked at a hundredth behind the wall and right behind
    // it.
    std::vector<landed_photon<float, float>> photons;
    random_sampler<float> random{17};
    const int count = 40000;
    for (int i = 0; i < count; ++i) {
        photons.push_back(landed<float>({-random.next_1d(), random.next_1d(), 0}, 1.0f / count));
    }
    const photon_map<float, float> map{std::span<const landed_photon<float, float>>{photons}};
    const rgb dark{1e-3f + 0.01f, 0.5f, 0};
    for (const float x : {0.001f, 0.003f, 0.02f, 0.05f, 0.09f}) {
        for (const std::uint32_t k : {0u, 50u, 400u}) {
            const auto e = map.irradiance({x, 0.5f, 0}, {0, 0, 1}, {.count = k, .max_radius = 0.1});
            CAPTURE(x, k, e.value, e.error);
            CHECK(e.value <= e.error);
        }
    }
    float before = 1e30f;
    for (const float r : {0.1f, 0.05f, 0.025f, 0.012f}) {
        const auto e = map.irradiance(dark, {0, 0, 1}, {.count = 0, .max_radius = double(r)});
        CAPTURE(r, e.value, e.error);
        CHECK(e.value < before);
        // The truth is nothing, so all that is seen is error.
        CHECK(e.value <= e.error);
        before = e.value;
    }
    CHECK(map.irradiance(dark, {0, 0, 1}, {.count = 0, .max_radius = 0.01}).value == 0);
    // A slab: its lower side sees nothing of what lies on the upper one, a wall at right angles nothing either.
    const rgb above{-0.5f, 0.5f, 0};
    CHECK(map.irradiance(above, {0, 0, 1}, {.count = 0, .max_radius = 0.1}).value > 0.5f);
    CHECK(map.irradiance(above - rgb{0, 0, 1e-3f}, {0, 0, -1}, {.count = 0, .max_radius = 0.1}).value == 0);
    CHECK(map.irradiance({0, 0.5f, 0.02f}, {1, 0, 0}, {.count = 0, .max_radius = 0.1}).value == 0);
    irradiance_cache<float> cache{1.0f};
    irradiance_estimate<float, float> e;
    e.irradiance = 1;
    e.rays = 100;
    REQUIRE(cache.insert(e) == record_status::inserted);
    CHECK(cache.lookup(rgb{0.05f, 0, 0}, {0, 0, 1}));
    CHECK_FALSE(cache.lookup(rgb{0.05f, 0, -1e-3f}, {0, 0, -1}));
    CHECK_FALSE(cache.lookup(rgb{0.05f, 0, 0}, {1, 0, 0}));
}
