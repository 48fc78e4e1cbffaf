#include <aglow/estimators/compact_photon.hpp>

#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/core/frame.hpp>
#include <aglow/core/warp.hpp>
#include <aglow/estimators/photon_map.hpp>

#include "support/catch.hpp"

using namespace aglow;
using rgb = glm::vec3;

static_assert(sizeof(compact_photon<rgb>) == 16);
static_assert(sizeof(compact_photon<float>) == 16);
static_assert(std::is_trivially_copyable_v<compact_photon<rgb>>);
static_assert(PhotonItem<compact_photon<rgb>, rgb, float>);
static_assert(PhotonItem<compact_photon<rgb>, rgb, double>);
static_assert(!CompactSpectrum<double>);

namespace {

using compact_map = photon_map<rgb, float, compact_photon<rgb>>;
using full_map = photon_map<rgb, float>;
using photons = std::vector<landed_photon<rgb, float>>;

landed_photon<rgb, float> landed(const rgb& at, const rgb& power, const rgb& wi, const rgb& n) {
    return {at, {power, packed_direction<std::int16_t>{wi}, packed_direction<std::int16_t>{n}}};
}

/// Photons on the floor and on two walls of a unit room, of coloured power, from everywhere above their surface.
photons in_a_room(int count, std::uint64_t seed) {
    photons all;
    random_sampler<float> random{seed};
    for (int i = 0; i < count; ++i) {
        const rgb n = i % 3 == 0 ? rgb{0, 0, 1} : i % 3 == 1 ? rgb{1, 0, 0} : rgb{0, 1, 0};
        rgb at{random.next_1d(), random.next_1d(), random.next_1d()};
        at[i % 3 == 0 ? 2 : i % 3 - 1] = 0;
        const rgb wi = frame<float>{n}.to_world(cosine_hemisphere(random.next_2d()));
        const rgb power = rgb{0.7f, 0.2f, 0.01f} * (0.5f + random.next_1d());
        all.push_back(landed(at, power, wi, n));
    }
    return all;
}

/// Photons of a fold caustic of density 1 / (2 sqrt x) within a room ten thousand times as large.
photons in_a_caustic(int count, float room) {
    photons all;
    random_sampler<float> random{4};
    for (int i = 0; i < count; ++i) {
        const float u = (static_cast<float>(i) + random.next_1d()) / static_cast<float>(count);
        const rgb wi = glm::normalize(rgb{0.3f, random.next_1d() - 0.5f, 1});
        all.push_back(landed({u * u, random.next_1d(), 0}, rgb{1, 0.9f, 0.5f}, wi, {0, 0, 1}));
    }
    all.push_back(landed({room, room, room}, rgb{1}, {0, 0, 1}, {0, 0, 1}));
    return all;
}

struct compared {
    double worst{0};  ///< what compactness changes, as a share of the error that the full map tells
    double shift{0};  ///< its mean over all places, relative
};

/// Both maps asked at places of `photons`.
compared compare(const photons& all, const density_options& options) {
    const full_map full{all, 1.0f / static_cast<float>(all.size())};
    const compact_map compact{all, 1.0f / static_cast<float>(all.size())};
    compared c;
    double sum = 0;
    double both = 0;
    for (std::size_t i = 0; i < all.size(); i += all.size() / 400) {
        const rgb n = glm::normalize(all[i].what.normal.direction<float>());
        const auto a = full.irradiance(all[i].position, n, options);
        const auto b = compact.irradiance(all[i].position, n, options);
        const rgb off = b.value - a.value;
        c.worst = std::max(c.worst, static_cast<double>(max_abs(off) / a.error));
        sum += static_cast<double>(a.value.x);
        both += static_cast<double>(b.value.x);
    }
    c.shift = both / sum - 1;
    return c;
}

}  // namespace

TEST_CASE("compact_photon: what it changes is less than a tenth of the error that a map tells, anywhere") {
    for (const std::uint32_t k : {20u, 50u, 200u}) {
        for (const kernel_shape shape : {kernel_shape::epanechnikov, kernel_shape::constant}) {
            const auto room = compare(in_a_room(30'000, k), {.count = k, .kernel = shape});
            CAPTURE(k, room.worst, room.shift);
            CHECK(room.worst < 0.1);
            CHECK(std::abs(room.shift) < 1e-3);
        }
    }
    // A bright spot in a large room, where cells are as coarse beside the photons' spacing as they get.
    for (const float size : {1.0f, 30.0f, 300.0f}) {
        const auto spot = compare(in_a_caustic(20'000, size), {.count = 50});
        CAPTURE(size, spot.worst, spot.shift);
        CHECK(spot.worst < 0.1);
        CHECK(std::abs(spot.shift) < 1e-3);
    }
}

TEST_CASE("compact_photon: power is right in the sum, places and directions have no shift") {
    const photons all = in_a_room(60'000, 1);
    const compact_map map{all};
    const full_map full{all};
    vec3<double> power{};
    vec3<double> exact{};
    vec3<double> towards{};
    vec3<double> from{};
    for (std::size_t i = 0; i < all.size(); ++i) {
        power += vec3<double>{map.photons()[i].flux() * map.unit()};
        towards += vec3<double>{map.photons()[i].towards<float>()};
        exact += vec3<double>{full.photons()[i].flux()};
        from += vec3<double>{full.photons()[i].towards<float>()};
    }
    const double n = static_cast<double>(all.size());
    // A step is at most 1/127 of the largest band, rounded by chance: at most half of it as a standard deviation.
    for (int b = 0; b < 3; ++b) { CHECK(std::abs(power[b] - exact[b]) <= 4 * 1.05 / 127 / 2 * std::sqrt(n)); }
    CHECK(glm::length(towards - from) / n <= 4 * 0.0168 / std::sqrt(n));
}

TEST_CASE("compact_photon: a map made of another map's photons is the map made of these") {
    const photons all = in_a_room(5000, 2);
    const compact_map direct{all};
    const compact_map once_more{full_map{all}};
    CHECK(once_more.size() == direct.size());
    // Rounded by other chances, and yet within the same error.
    for (std::size_t i = 0; i < all.size(); i += 50) {
        const rgb n = glm::normalize(all[i].what.normal.direction<float>());
        const auto a = direct.irradiance(all[i].position, n);
        const auto b = once_more.irradiance(all[i].position, n);
        CHECK(max_abs(a.value - b.value) <= 0.1f * a.error);
    }
    CHECK(full_map{direct}.size() == direct.size());
}

TEST_CASE("compact_photon: the same map for any number of threads, and a scaled scene is scaled exactly") {
    const photons all = in_a_room(20'000, 5);
    photons larger = all;
    for (auto& p : larger) {
        p.position *= 0x1p10f;
        p.what.power *= 0x1p-7f;
    }
    const compact_map one{all};
    const compact_map three{all, 1.0f, own_threads{3}};
    const compact_map scaled{larger};
    bool same = true;
    for (std::size_t i = 0; i < one.size(); ++i) {
        same = same && one.photons()[i].flux() == three.photons()[i].flux() && one.position(i) == three.position(i);
        same = same && scaled.photons()[i].flux() == one.photons()[i].flux() * 0x1p-7f;
        same = same && scaled.position(i) == one.position(i) * 0x1p10f;
    }
    CHECK(same);
}

TEST_CASE("compact_photon: bad photons are dropped, and light of 1e-42 W is there in the mean") {
    photons all = in_a_room(3000, 6);
    all[5].what.power.y = std::numeric_limits<float>::quiet_NaN();
    all[6].position.x = std::numeric_limits<float>::infinity();
    all[7].position.x = 1e20f;  // a number, but one that no tree takes, and cells would be as wide as that
    const compact_map map{all};
    CHECK(map.dropped() == 3);
    CHECK(max_abs(map.box().high) <= 1);
    for (auto& p : all) { p.what.power *= 1e-38f; }
    const auto faint = compact_map{all}.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, {.count = 200});
    const auto full = full_map{all}.irradiance({0.5f, 0.5f, 0}, {0, 0, 1}, {.count = 200});
    CHECK(full.value.x > 0);
    CHECK(faint.value.x == Approx(full.value.x).epsilon(0.01));
}

TEST_CASE("compact_photon: gray power is kept to the bit, and an RGB map takes 8 bytes less for each photon") {
    std::vector<landed_photon<float, float>> gray;
    random_sampler<float> random{8};
    const packed_direction<std::int16_t> up{rgb{0, 0, 1}};
    for (int i = 0; i < 1000; ++i) {
        gray.push_back({{random.next_1d(), random.next_1d(), 0}, {random.next_1d(), up, up}});
    }
    const photon_map<float, float, compact_photon<float>> map{gray};
    const photon_map<float, float> full{gray};
    double sum = 0;
    double exact = 0;
    for (const auto& p : map.photons()) { sum += double(p.flux()); }
    for (const auto& p : full.photons()) { exact += double(p.flux()); }
    CHECK(sum == Approx(exact).epsilon(1e-15));
    const photons all = in_a_room(100'000, 7);
    const double saved = double(full_map{all}.memory() - compact_map{all}.memory()) / double(all.size());
    CHECK(saved == Approx(8).epsilon(0.01));
}

TEST_CASE("compact_photon: what came from just above its surface still does when it is rounded") {
    random_sampler<float> random{8};
    const place_cells<float> cells{bounds<float>{{0, 0, 0}, {1, 1, 1}}};
    for (int i = 0; i < 20000; ++i) {
        const rgb n = uniform_sphere(random.next_2d());
        const float up = 1e-3f * random.next_1d() + 1e-5f;
        const float angle = 6.28f * random.next_1d();
        const rgb wi = glm::normalize(frame<float>{n}.to_world({std::cos(angle), std::sin(angle), up}));
        const auto full = landed({0.5f, 0.5f, 0.5f}, rgb{1}, wi, n);
        const rgb facing = full.what.facing<float>();
        if (!full.what.arrived_on(facing)) { continue; }
        CHECK(compact_photon<rgb>{full, rgb{1}, cells, 1}.arrived_on(facing));
    }
}

TEST_CASE("compact_photon: it faces what is within the cosine of its normal, blunt angles too") {
    random_sampler<float> random{9};
    const place_cells<float> cells{bounds<float>{{0, 0, 0}, {1, 1, 1}}};
    for (int i = 0; i < 2000; ++i) {
        const rgb n = uniform_sphere(random.next_2d());
        const compact_photon<rgb> p{landed({0.5f, 0.5f, 0.5f}, rgb{1}, n, n), rgb{1}, cells, 1};
        const rgb other = uniform_sphere(random.next_2d());
        const float d = glm::dot(p.facing<float>(), other);
        for (const float cosine : {-0.8f, -0.2f, 0.0f, 0.3f, 0.9f}) {
            if (std::abs(d - cosine) > 1e-5f) { CHECK(p.faces(other, cosine) == (d > cosine)); }
        }
    }
}

TEST_CASE("compact_photon: piled up off the middle of their cell, photons still give all of their light there") {
    const vec3<double> place{0.3, 1.0 / 3, 0};
    const auto up = packed_direction<std::int16_t>{vec3<double>{0, 0, 1}};
    std::vector<landed_photon<float, double>> all(20000, {place, {0.5f, up, up}});
    all.push_back({{1, 1, 0}, {1, up, up}});
    const photon_map<float, double, compact_photon<float>> map{all};
    const auto e = map.irradiance(place, {0, 0, 1}, {.max_radius = 0.1, .kernel = kernel_shape::constant});
    CHECK(static_cast<double>(e.value) * pi<double> * e.radius * e.radius == Approx(10000).epsilon(1e-5));
}
