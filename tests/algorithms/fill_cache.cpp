#include <aglow/algorithms/fill_cache.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/glowing_room.hpp"

using namespace aglow;
using support::glowing_room;
using support::point3;

namespace {

using rgb = vec3<float>;
using cache = irradiance_cache<rgb>;
using candidates = std::vector<cache_candidate<float>>;

/// Five walls of the room (not the light, +z), in float.
gather_point<float> somewhere(random_sampler<float>& random, float size) {
    const int wall = std::min(4, static_cast<int>(random.next_1d() * 5));
    gather_point<float> p;
    for (int i = 0; i < 3; ++i) { p.position[i] = (random.next_1d() * 2 - 1) * size; }
    p.position[wall / 2] = wall % 2 ? size : -size;
    p.normal = rgb{0};
    p.normal[wall / 2] = wall % 2 ? -1.f : 1.f;
    p.position_error = position_error(size);
    return p;
}

candidates around(int count, float size = 1) {
    random_sampler<float> random{1};
    candidates result;
    for (int i = 0; i < count; ++i) { result.push_back({somewhere(random, size), 0, static_cast<std::uint64_t>(i)}); }
    return result;
}

struct glow_of {
    glowing_room room{};
    incoming_light<rgb, float> operator()(const ray<float>& r, const random_numbers<float>&) const {
        const auto [wall, distance] = room.meet(r);
        return {rgb(room.glow[static_cast<std::size_t>(wall)]), distance};
    }
};

/// Where x < 0 all rays bring 1; elsewhere few bring much and the others nothing.
struct flickering {
    double chance{0.05};
    double mean{1};
    glowing_room room{};
    incoming_light<rgb, float> operator()(const ray<float>& r, const random_numbers<float>& numbers) const {
        const float bright = numbers.at(1, purpose::light).next_1d() < static_cast<float>(chance)
                                 ? static_cast<float>(mean / chance)
                                 : 0;
        return {rgb{r.origin.x < 0 ? 1 : bright}, room.meet(r).second};
    }
    [[nodiscard]] double scatter() const { return std::sqrt(1 / chance - 1); }
};

bool same(const cache& a, const cache& b) {
    if (a.size() != b.size()) { return false; }
    for (std::uint32_t i = 0; i < a.size(); ++i) {
        if (a[i].position() != b[i].position() || a[i].irradiance() != b[i].irradiance() ||
            a[i].radius() != b[i].radius()) {
            return false;
        }
    }
    return true;
}

double relative_rmse(const cache::frozen& filled, const glowing_room& room, int probes) {
    random_sampler<float> random{77};
    double off2 = 0;
    double all2 = 0;
    for (int i = 0; i < probes; ++i) {
        const gather_point<float> p = somewhere(random, static_cast<float>(room.size));
        const point3 exact = room.irradiance(point3(p.position), point3(p.normal));
        const auto a = filled.lookup(p.position, p.normal);
        if (!a) { continue; }
        off2 += square(glm::length(point3(a.irradiance) - exact));
        all2 += square(glm::length(exact));
    }
    return std::sqrt(off2 / all2);
}

}  // namespace

TEST_CASE("fill_cache: one, two, three and eight threads make the same records to the bit") {
    const auto where = around(2000);
    cache one{1.732f};
    const fill_result result = fill_cache(one, where, glow_of{}, {.rays = 100});
    CHECK(result.records == one.size());
    CHECK(result.records > 50);
    CHECK(result.uncovered == 0);
    CHECK(result.rays >= result.records * 95);
    CHECK(result.rejected == 0);
    CHECK_FALSE(result.cancelled);
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        cache other{1.732f};
        fill_cache(other, where, glow_of{}, {.rays = 100}, own_threads{threads});
        CHECK(same(one, other));
        const auto a = one.freeze();
        const auto b = other.freeze(own_threads{threads});
        random_sampler<float> random{3};
        for (int i = 0; i < 100; ++i) {
            const auto p = somewhere(random, 1);
            CHECK(a.lookup(p.position, p.normal).irradiance == b.lookup(p.position, p.normal).irradiance);
            CHECK(a.lookup(p.position, p.normal).error == b.lookup(p.position, p.normal).error);
        }
    }
}

TEST_CASE("fill_cache: the filled cache agrees with Lambert's formula, better with more records and more rays") {
    const glow_of incoming;
    const auto error = [&](double accuracy, std::uint32_t rays) {
        irradiance_cache_options o;
        o.reach.accuracy = accuracy;
        cache c{1.732f, o};
        fill_cache(c, around(8000), incoming, {.rays = rays});
        return relative_rmse(c.freeze(), incoming.room, 2000);
    };
    const double coarse = error(0.15, 200);
    const double fine = error(0.06, 1000);
    CHECK(coarse < 0.04);
    CHECK(fine < 0.012);
}

TEST_CASE("fill_cache: where rays scatter, records get more of them and stay right in the mean") {
    const flickering incoming;
    cache even{1.732f};
    cache keen{1.732f};
    const auto first = fill_cache(even, around(4000), incoming, {.rays = 100, .scatter = 0});
    const auto second = fill_cache(keen, around(4000), incoming, {.rays = 100});
    REQUIRE(even.size() == keen.size());
    CHECK(second.rays > 4 * first.rays);
    double light = 0;
    double rays = 0;
    std::uint32_t calm = 0;
    std::uint32_t more = 0;
    std::uint32_t wild = 0;
    for (std::uint32_t i = 0; i < keen.size(); ++i) {
        CHECK(keen[i].position() == even[i].position());
        CHECK(keen[i].radius() == even[i].radius());
        if (keen[i].position().x == -1) {
            ++calm;
            CHECK(keen[i].rays() == even[i].rays());
            CHECK(keen[i].irradiance() == even[i].irradiance());
        }
        if (keen[i].position().x < 1) { continue; }
        ++wild;
        more += keen[i].rays() > 3 * even[i].rays();
        light += static_cast<double>(keen[i].irradiance().x) * keen[i].rays();
        rays += keen[i].rays();
    }
    CHECK(calm > 10);
    CHECK(wild > 10);
    CHECK(more > 0.9 * wild);
    // Four standard errors of all rays together.
    CHECK(std::abs(light / rays / pi<double> / incoming.mean - 1) < 4 * incoming.scatter() / std::sqrt(rays));
}

TEST_CASE("fill_cache: rays for records that scatter are told of as they go, and can be stopped") {
    const auto where = around(4000);
    std::vector<double> told;
    cache whole{1.732f};
    const auto all = fill_cache(whole, where, flickering{}, {.rays = 100}, in_sequence{}, [&](const fill_progress& p) {
        told.push_back(p.sharpened);
        return true;
    });
    CHECK(told.front() == 0);
    CHECK(std::is_sorted(told.begin(), told.end()));
    CHECK(std::count_if(told.begin(), told.end(), [](double x) { return x > 0 && x < 1; }) >= 1);
    CHECK(told.back() == 1);
    cache cut{1.732f};
    const auto some = fill_cache(cut, where, flickering{}, {.rays = 100}, in_sequence{},
                                 [](const fill_progress& p) { return p.sharpened == 0; });
    CHECK(some.cancelled);
    CHECK(some.uncovered == 0);
    CHECK(cut.size() == whole.size());
    CHECK(some.rays < all.rays);
}

TEST_CASE("fill_cache: where rays scatter, records that have enough of them get no more") {
    const flickering incoming{.chance = 0.25};
    const auto rays = [&](std::uint32_t each, double noise) {
        cache c{1.732f};
        const fill_result filled =
            fill_cache(c, around(300), incoming, {.rays = each, .noise = noise, .minimum_weight = 0.1});
        return static_cast<double>(filled.rays) / static_cast<double>(filled.records);
    };
    CHECK(rays(100, 0.048) > 200);
    CHECK(rays(2500, 0.048) < 2600);
    CHECK(rays(2500, 0) > 5000);
}

TEST_CASE("fill_cache: in a furnace every place has pi times the radiance") {
    glow_of incoming;
    incoming.room.glow.fill({1, 1, 1});
    cache c{1.732f};
    fill_cache(c, around(1000), incoming, {.rays = 64});
    const auto filled = c.freeze();
    random_sampler<float> random{4};
    for (int i = 0; i < 300; ++i) {
        const auto p = somewhere(random, 1);
        const auto a = filled.lookup(p.position, p.normal);
        if (a) { CHECK(a.irradiance.x == Approx(pi<float>)); }
    }
}

TEST_CASE("fill_cache: a scene 2^k larger gets the same records 2^k larger, to the bit") {
    const auto filled = [](int k) {
        const float size = std::ldexp(1.f, k);
        glow_of incoming;
        incoming.room.size = size;
        cache c{1.732f * size};
        fill_cache(c, around(1000, size), incoming, {.rays = 64});
        return c;
    };
    const cache one = filled(0);
    for (const int k : {-12, 5}) {
        const cache other = filled(k);
        REQUIRE(other.size() == one.size());
        const float size = std::ldexp(1.f, k);
        for (std::uint32_t i = 0; i < one.size(); ++i) {
            CHECK(other[i].position() == one[i].position() * size);
            CHECK(other[i].irradiance() == one[i].irradiance());
            CHECK(other[i].radius() == one[i].radius() * size);
        }
    }
}

TEST_CASE("fill_cache: a crevice takes no more records than its area over the smallest reach allows") {
    // Two floors that meet at an ever narrower angle: the distance to the other goes to zero.
    const auto incoming = [](const ray<float>& r, const auto&) {
        const float slope = 0.2f;
        const float t = (slope * r.origin.x - r.origin.z) / (r.direction.z - slope * r.direction.x);
        return incoming_light<rgb, float>{rgb{1, 1, 1}, t > 0 ? t : std::numeric_limits<float>::infinity()};
    };
    irradiance_cache_options o;
    o.reach.metric = error_metric::split_sphere;
    o.reach.accuracy = 0.1;
    o.reach.minimum_radius = 0.02;
    cache c{1.f, o};
    candidates where;
    random_sampler<float> random{5};
    for (int i = 0; i < 20000; ++i) {
        where.push_back({{{random.next_1d() * 0.3f, random.next_1d() * 0.3f, 0}, {0, 0, 1}, 1e-7f},
                         0,
                         static_cast<std::uint64_t>(i)});
    }
    const fill_result result = fill_cache(c, where, incoming, {.rays = 24});
    CHECK(result.uncovered == 0);
    // Records lie at least half the smallest reach apart: discs of a quarter of it do not overlap.
    CHECK(static_cast<double>(c.size()) < square(0.3 + 0.02) / (pi<double> * square(0.02 / 4)));
    for (std::uint32_t i = 0; i < c.size(); ++i) { CHECK(c[i].radius() >= 0.02f); }
}

TEST_CASE("fill_cache: what a later record bares is covered again") {
    struct place {
        rgb position;
        rgb normal;
        float reach;
    };
    // The second covers the third until the fourth, close to the second, clamps it.
    const std::vector<place> places{{{0, 0, 0}, {0, 0, 1}, 0.2f},
                                    {{0.09f, 0, 0}, {0, 0, 1}, 0.2f},
                                    {{-0.02f, 0, 0.22f}, {1, 0, 0}, 0.05f},
                                    {{-0.02f, 0, 0.01f}, {1, 0, 0}, 0.03f}};
    candidates where;
    for (const place& p : places) { where.push_back({{p.position, p.normal, 1e-6f}, 0, where.size()}); }
    const auto reach = [&](const ray<float>& r, const random_numbers<float>&) {
        float nearest = 1;
        float found = 0;
        for (const place& p : places) {
            const float away = glm::distance(p.position, r.origin);
            if (away < nearest) { nearest = away, found = p.reach; }
        }
        return incoming_light<rgb, float>{rgb{1}, found};
    };
    irradiance_cache_options o;
    o.reach = {.metric = error_metric::split_sphere, .accuracy = 1};
    cache c{1.f, o};
    const fill_result result = fill_cache(c, where, reach, {.rays = 64});
    CHECK(result.uncovered == 0);
    for (const place& p : places) { CHECK(c.lookup(p.position, p.normal)); }
}

TEST_CASE("fill_cache: irradiance that no ray brings has its error told, and makes that of rays no greater") {
    struct half_seen {
        float rays;
        float error;
        glow_of room{};
        incoming_light<rgb, float> operator()(const ray<float>& r, const random_numbers<float>& numbers) const {
            const float bright = numbers.at(1, purpose::light).next_1d() < 0.25f ? 4 * rays : 0;
            return {rgb{bright}, room(r, numbers).distance};
        }
        [[nodiscard]] estimate<rgb> unseen(const gather_point<float>&) const { return {rgb{1}, error}; }
    };
    const auto where = around(200);
    const auto filled = [&](const half_seen& light) {
        cache c{1.732f};
        const fill_result result = fill_cache(c, where, light, {.rays = 100});
        return std::pair{static_cast<double>(c[0].relative_noise()), double(result.rays) / double(result.records)};
    };
    CHECK(filled({0, 0.1f}).first == Approx(0.05).epsilon(0.01));
    CHECK(filled({0, 0}).first == 0);
    // Ten rays in a hundred say how noisy they are to a third or so; what no ray brings is twenty times their light.
    const auto [noise, rays] = filled({0.05f / pi<float>, 0});
    CHECK(noise == Approx(std::sqrt(3.0 / 100) * 0.05 / 1.05).epsilon(0.4));
    CHECK(rays < 110);
}

TEST_CASE("fill_cache: candidates that are no places, and light that is no number, are refused and end") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    auto where = around(50);
    where[0].place.position.x = nan;
    where[1].place.normal = {0, 0, 0};
    cache c{1.732f};
    const fill_result result = fill_cache(c, where, glow_of{}, {.rays = 64});
    CHECK(result.refused == 2);
    CHECK(result.uncovered == 0);
    cache dark{1.732f};
    const auto no_number = [&](const ray<float>&, const auto&) { return incoming_light<rgb, float>{rgb{nan}, 1}; };
    const fill_result none = fill_cache(dark, where, no_number, {.rays = 64});
    CHECK(none.records == 0);
    CHECK(none.rejected == none.rays);
    CHECK(dark.size() == 0);
}

TEST_CASE("fill_cache: places in rows keep apart as asking all that were taken before says, and only from their like") {
    random_sampler<float> random{5};
    std::vector<gather_point<float>> places;
    for (int i = 0; i < 2500; ++i) {
        const rgb at{static_cast<float>(i % 50) + random.next_1d(), static_cast<float>(i / 50), random.next_1d()};
        places.push_back({at, random.next_1d() < 0.8f ? rgb{0, 0, 1} : rgb{1, 0, 0}});
    }
    for (const float spacing : {0.5f, 2.0f, 7.0f, 100.0f}) {
        const auto alike = [&](std::size_t other, const gather_point<float>& here) {
            return places[other].normal == here.normal;
        };
        detail::spaced_places<float, decltype(alike)> apart{spacing, alike};
        std::vector<std::size_t> taken;
        std::size_t differ = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const bool room = std::none_of(taken.begin(), taken.end(), [&](std::size_t other) {
                const double distance = glm::distance(point3(places[other].position), point3(places[i].position));
                return distance <= static_cast<double>(spacing) && alike(other, places[i]);
            });
            differ += apart.has_room(places[i]) != room;
            if (!room) { continue; }
            apart.add(i, places[i]);
            taken.push_back(i);
        }
        CHECK(differ == 0);
        CHECK(taken.size() > 1);
    }
}

TEST_CASE("fill_cache: stopped at any report, any number of threads keeps the same records and counts the same rays") {
    const auto filled = [](unsigned threads, int reports, cache& c) {
        int left = reports;
        return fill_cache(c, around(3000), flickering{}, {.rays = 40}, own_threads{threads},
                          [&](const fill_progress&) { return --left > 0; });
    };
    for (const int reports : {1, 2, 4, 7}) {
        cache one{1.732f};
        const fill_result alone = filled(1, reports, one);
        for (const unsigned threads : {2u, 3u, 8u}) {
            cache other{1.732f};
            const fill_result many = filled(threads, reports, other);
            CHECK(same(one, other));
            CHECK(many.rays == alone.rays);
            CHECK(many.records == alone.records);
            CHECK(many.cancelled == alone.cancelled);
        }
    }
}

TEST_CASE("fill_cache: stops when told to, and never beyond the most records asked for") {
    const auto where = around(3000);
    cache c{1.732f};
    const fill_result stopped = fill_cache(c, where, glow_of{}, {.rays = 64}, in_sequence{},
                                           [](const fill_progress& p) { return p.records < 20; });
    CHECK(stopped.cancelled);
    CHECK(stopped.uncovered > 0);
    cache few{1.732f};
    const fill_result limited = fill_cache(few, where, glow_of{}, {.rays = 64, .maximum_records = 30});
    CHECK(few.size() == 30);
    CHECK(limited.uncovered > 0);
}

TEST_CASE("fill_cache: both sides of a sheet are two records that do not mix") {
    const auto incoming = [](const ray<float>& r, const auto&) {
        return incoming_light<rgb, float>{r.direction.z > 0 ? rgb{1, 0, 0} : rgb{0, 0, 1}, 1};
    };
    candidates where{{{{0, 0, 0}, {0, 0, 1}, 1e-6f}, 0, 1}, {{{0, 0, 0}, {0, 0, -1}, 1e-6f}, 0, 2}};
    cache c{1.f};
    fill_cache(c, where, incoming, {.rays = 64});
    REQUIRE(c.size() == 2);
    CHECK(c.lookup(vec3<float>{0}, {0, 0, 1}).irradiance.z == 0);
    CHECK(c.lookup(vec3<float>{0}, {0, 0, -1}).irradiance.x == 0);
}

TEST_CASE("irradiance_or: asks the cache first and the fallback only where it is silent") {
    cache c{1.732f};
    const auto fallback = [] { return rgb{7, 7, 7}; };
    CHECK(irradiance_or(c, vec3<float>{0, 0, -1}, vec3<float>{0, 0, 1}, fallback).x == 7);
    fill_cache(c, around(500), glow_of{}, {.rays = 64});
    CHECK(irradiance_or(c, c[0].position(), c[0].normal(), fallback).x < 7);
}
