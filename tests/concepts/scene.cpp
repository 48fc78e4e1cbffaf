// What the concepts tell of hosts: stated lobes, errors of hits, and what is taken for granted where a host is silent.
#include <optional>

#include <aglow/concepts/intersector.hpp>
#include <aglow/concepts/lambert.hpp>
#include <aglow/concepts/light.hpp>

#include "support/archetypes.hpp"
#include "support/catch.hpp"

namespace {

using aglow::lobe_set;
using aglow::vec3;

struct bare : archetypes::scene<float> {};
struct states_constant : bare {
    static constexpr lobe_set possible_lobes = lobe_set::diffuse_reflection;
};
struct states_by_function : bare {
    lobe_set may{lobe_set::diffuse};
    [[nodiscard]] lobe_set possible_lobes() const { return may; }
};
struct states_variable : bare {
    static inline lobe_set possible_lobes = lobe_set::diffuse;
};
struct states_number : bare {
    static constexpr int possible_lobes = 1;
};

static_assert(!aglow::StatesLobes<bare> && aglow::static_lobes<bare> == lobe_set::all);
static_assert(aglow::StatesLobes<states_constant>);
static_assert(aglow::StatesLobes<const states_constant&>);
static_assert(aglow::static_lobes<states_constant> == lobe_set::diffuse_reflection);
static_assert(!aglow::StatesLobes<states_by_function> && aglow::static_lobes<states_by_function> == lobe_set::all);
static_assert(!aglow::StatesLobes<states_variable>, "what can change is not known at compile time");
static_assert(!aglow::StatesLobes<states_number>);

static_assert(std::is_same_v<aglow::scalar_of<bare>, float>);
static_assert(std::is_same_v<aglow::scalar_of<const archetypes::scene<double>&>, double>);
static_assert(std::is_same_v<aglow::hit_of<bare>, archetypes::surface<float>>);
static_assert(std::is_same_v<aglow::spectrum_of<bare>, archetypes::spectrum<float>>);

struct careful_hit : archetypes::hit<double> {
    double position_error;
};

struct glowing : archetypes::surface<double> {
    using archetypes::surface<double>::surface;
    [[nodiscard]] archetypes::spectrum<double> emitted(const vec3<double>&) const {
        return archetypes::spectrum<double>::of(3, 4);
    }
    [[nodiscard]] double adjoint(const vec3<double>&, const vec3<double>&) const { return 2; }
};

struct sky {
    [[nodiscard]] vec3<float> escaped(const vec3<float>& direction) const { return direction; }
};

}  // namespace

TEST_CASE("scene: the lobes it can have are stated by its type, by its function, or all") {
    CHECK(aglow::possible_lobes(bare{}) == lobe_set::all);
    CHECK(aglow::possible_lobes(states_constant{}) == lobe_set::diffuse_reflection);
    const states_by_function by_function;
    CHECK(aglow::possible_lobes(by_function) == lobe_set::diffuse);
}

TEST_CASE("scene: the error of a hit is the host's, else some ulps of the largest coordinate on the way") {
    const careful_hit careful{{{1, 2, 3}, archetypes::direction<double>{{0, 0, 1}}}, 0.25};
    CHECK(aglow::error_of(careful, {9, 9, 9}) == 0.25);
    const archetypes::hit<double> silent{{1, -2, 0}, archetypes::direction<double>{{0, 0, 1}}};
    CHECK(aglow::error_of(silent, {0, 0, 0}) == aglow::position_error(2.0));
    CHECK(aglow::error_of(silent, {0, 0, -100}) == aglow::position_error(100.0));
}

TEST_CASE("scene: what a host does not say is black, or changes nothing") {
    const vec3<double> up{0, 0, 1};
    const archetypes::surface<double> silent{{0, 0, 0}, up};
    CHECK(aglow::emitted(silent, up) == archetypes::spectrum<double>{});
    CHECK(aglow::adjoint(silent, up, up) == 1);
    const glowing host{{0, 0, 0}, up};
    CHECK(aglow::emitted(host, up) == archetypes::spectrum<double>::of(3, 4));
    CHECK(aglow::adjoint(host, up, up) == 2);
    CHECK(aglow::escaped_radiance<vec3<float>>(bare{}, vec3<float>{1, 0, 0}) == vec3<float>{});
    CHECK(aglow::escaped_radiance<vec3<float>>(sky{}, vec3<float>{1, 0, 0}) == vec3<float>{1, 0, 0});
}

TEST_CASE("lobes: sets are joined, met and turned over, and the six are apart") {
    CHECK((lobe_set::diffuse | lobe_set::glossy | lobe_set::specular) == lobe_set::all);
    CHECK((lobe_set::reflection | lobe_set::transmission) == lobe_set::all);
    CHECK((lobe_set::reflection & lobe_set::transmission) == lobe_set::none);
    CHECK((lobe_set::diffuse & lobe_set::reflection) == lobe_set::diffuse_reflection);
    CHECK((lobe_set::specular & lobe_set::transmission) == lobe_set::specular_transmission);
    CHECK(~lobe_set::smooth == lobe_set::specular);
    CHECK(~lobe_set::all == lobe_set::none);
    CHECK(any(lobe_set::all, lobe_set::glossy_transmission));
    CHECK_FALSE(any(lobe_set::diffuse, lobe_set::specular));
    CHECK_FALSE(any(lobe_set::none));
    CHECK(any(lobe_set::glossy_reflection));
}

TEMPLATE_TEST_CASE("lambert: what it reflects is its albedo on the side of the asker, in any bands", "", float,
                   double) {
    using T = TestType;
    using colour = archetypes::spectrum<T>;
    const aglow::lambert<colour, T> wall{{}, {0, 0, 1}, colour::of(T(0.5), T(0.25))};
    static_assert(aglow::Surface<aglow::lambert<colour, T>>);
    const vec3<T> up{0, 0, 1};
    CHECK(wall.evaluate(up, up, lobe_set::all) == colour::of(T(0.5), T(0.25)) * (1 / aglow::pi<T>));
    CHECK(wall.evaluate(-up, -up, lobe_set::all) == wall.evaluate(up, up, lobe_set::all));
    CHECK(wall.evaluate(up, -up, lobe_set::all) == colour{});
    CHECK(wall.evaluate(up, up, lobe_set::specular) == colour{});
    archetypes::sampler<T> random{1};
    CHECK(wall.sample(-up, random, lobe_set::all)->wi.z < 0);
    const aglow::lambert<colour, T> black;
    CHECK_FALSE(black.sample(up, random, lobe_set::all));
    CHECK(black.lobes() == lobe_set::none);
}
