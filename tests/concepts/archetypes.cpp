// Each concept from both sides: the smallest host is accepted, and one that lacks a single thing is not.
#include "support/archetypes.hpp"

#include <memory>
#include <optional>
#include <type_traits>

#include "support/catch.hpp"

namespace {

using aglow::lobe_set;
using aglow::vec3;

template <typename T>
inline constexpr bool archetypes_satisfy = aglow::Spectrum<archetypes::spectrum<T>>&&
    aglow::Sampler<archetypes::sampler<T>>&& aglow::Numbers<archetypes::numbers<T>>&& aglow::Hit<archetypes::hit<T>>&&
        aglow::Surface<archetypes::surface<T>>&& aglow::Scene<archetypes::scene<T>>&&
            aglow::Emitter<archetypes::emitter<T>>&& aglow::Illuminator<archetypes::illuminator<T>>;

static_assert(archetypes_satisfy<float> && archetypes_satisfy<double>);
static_assert(aglow::Executor<archetypes::executor> && aglow::Executor<aglow::in_sequence> &&
              aglow::Executor<aglow::own_threads>);

/// What an algorithm may be tempted to ask for, and no concept promises.
template <typename S, typename K>
concept AsksTooMuchOfSpectrum = requires(S a, K k) {
    a - a;
}
|| requires(S a) { a += a; }
|| requires(S a, K k) { k* a; }
|| requires(S a, K k) { a / k; }
|| requires(S a) { a < a; }
|| requires(S a) { a[0]; }
|| requires(S a) { a * 2; }
|| std::constructible_from<S, K>;
static_assert(!AsksTooMuchOfSpectrum<archetypes::spectrum<float>, float>);
static_assert(!AsksTooMuchOfSpectrum<archetypes::spectrum<double>, double>);
static_assert(!std::copyable<archetypes::sampler<float>> && !std::movable<archetypes::numbers<float>>);
static_assert(!std::default_initializable<archetypes::surface<float>> &&
              !std::equality_comparable<archetypes::surface<float>>);
static_assert(!aglow::Surface<archetypes::hit<float>>, "a hit need not know of light");
static_assert(!std::movable<archetypes::scene<float>> && !std::movable<archetypes::emitter<float>> &&
              !std::movable<archetypes::illuminator<float>>);

}  // namespace

// Spectra.
namespace near_spectrum {

struct without_largest {
    friend bool operator==(const without_largest&, const without_largest&) = default;
    friend without_largest operator+(without_largest a, without_largest) { return a; }
    friend without_largest operator*(without_largest a, without_largest) { return a; }
    friend without_largest operator*(without_largest a, float) { return a; }
};
struct whole_numbers : without_largest {
    friend whole_numbers operator+(whole_numbers a, whole_numbers) { return a; }
    friend whole_numbers operator*(whole_numbers a, whole_numbers) { return a; }
    friend whole_numbers operator*(whole_numbers a, float) { return a; }
    friend int max_component(whole_numbers) { return 0; }
};
struct without_bands_product {
    friend bool operator==(const without_bands_product&, const without_bands_product&) = default;
    friend without_bands_product operator+(without_bands_product a, without_bands_product) { return a; }
    friend without_bands_product operator*(without_bands_product a, float) { return a; }
    friend float max_component(without_bands_product) { return 0; }
};
struct without_equality {
    friend without_equality operator+(without_equality a, without_equality) { return a; }
    friend without_equality operator*(without_equality a, without_equality) { return a; }
    friend without_equality operator*(without_equality a, float) { return a; }
    friend float max_component(without_equality) { return 0; }
};

static_assert(!aglow::Spectrum<without_largest>);
static_assert(!aglow::Spectrum<whole_numbers>);
static_assert(!aglow::Spectrum<without_bands_product>);
static_assert(!aglow::Spectrum<without_equality>);
static_assert(!aglow::Spectrum<int> && !aglow::Spectrum<const float> && !aglow::Spectrum<float&>);
static_assert(aglow::Spectrum<float> && aglow::Spectrum<double> && aglow::Spectrum<vec3<float>> &&
              aglow::Spectrum<vec3<double>>);

}  // namespace near_spectrum

// Numbers.
namespace near_numbers {

struct without_pairs {
    float next_1d();
};
struct closed_pairs {
    struct pair {
        float x;
        float y;
    };
    float next_1d();
    pair next_2d();
};
struct whole {
    int next_1d();
    aglow::vec2<int> next_2d();
};
struct without_fork {
    aglow::random_sampler<float> at(std::uint32_t, aglow::purpose) const;
};
struct changes_when_asked {
    aglow::random_sampler<float> at(std::uint32_t, aglow::purpose);
    changes_when_asked fork(std::uint64_t) const;
};

static_assert(!aglow::Sampler<without_pairs> && !aglow::Sampler<closed_pairs> && !aglow::Sampler<whole>);
static_assert(!aglow::Sampler<const aglow::random_sampler<float>>, "drawing changes a sampler");
static_assert(!aglow::Numbers<without_fork> && !aglow::Numbers<changes_when_asked>);

}  // namespace near_numbers

// Hits and surfaces.
namespace near_surface {

struct whole_position {
    vec3<int> position;
    vec3<float> normal;
};
struct without_normal {
    vec3<float> position;
};
struct kept_alone {
    vec3<float> position;
    vec3<float> normal;
    std::unique_ptr<int> id;
};

static_assert(!aglow::Hit<whole_position> && !aglow::Hit<without_normal> && !aglow::Hit<kept_alone>);
static_assert(aglow::Hit<aglow::ray<float>> == false);

/// A whole surface, from which the near misses take one thing each.
template <int Missing>
struct surface {
    vec3<float> position{};
    vec3<float> normal{};
    lobe_set lobes() const requires(Missing != 1);
    float evaluate(const vec3<float>&, const vec3<float>&, lobe_set) const requires(Missing != 2);
    float pdf(const vec3<float>&, const vec3<float>&, lobe_set) const requires(Missing != 3);
    template <aglow::Sampler R>
    std::optional<aglow::scatter_sample<float, float>> sample(const vec3<float>&, R&, lobe_set) const
        requires(Missing != 4);
};
struct lobes_as_number : surface<1> {
    int lobes() const;
};
struct colour_of_strings : surface<2> {
    const char* evaluate(const vec3<float>&, const vec3<float>&, lobe_set) const;
};
struct always_scatters : surface<4> {
    template <aglow::Sampler R>
    aglow::scatter_sample<float, float> sample(const vec3<float>&, R&, lobe_set) const;
};
struct gives_a_reference : surface<2> {
    const float& evaluate(const vec3<float>&, const vec3<float>&, lobe_set) const;
};

static_assert(aglow::Surface<surface<0>>);
static_assert(!aglow::Surface<surface<1>> && !aglow::Surface<surface<2>> && !aglow::Surface<surface<3>> &&
              !aglow::Surface<surface<4>>);
static_assert(!aglow::Surface<lobes_as_number> && !aglow::Surface<colour_of_strings> &&
              !aglow::Surface<always_scatters>);
static_assert(aglow::Surface<gives_a_reference>);
static_assert(std::is_same_v<aglow::surface_spectrum<gives_a_reference>, float>);

}  // namespace near_surface

// Scenes.
namespace near_scene {

using found = near_surface::surface<0>;
using hit = archetypes::hit<float>;

struct without_occluded {
    std::optional<found> intersect(const aglow::ray<float>&) const;
};
struct changes_when_asked {
    std::optional<found> intersect(const aglow::ray<float>&);
    bool occluded(const vec3<float>&, const vec3<float>&) const;
};
struct finds_numbers {
    std::optional<float> intersect(const aglow::ray<float>&) const;
    bool occluded(const vec3<float>&, const vec3<float>&) const;
};
struct forgot_its_scalar {
    std::optional<archetypes::surface<double>> intersect(const auto&) const;
    bool occluded(const auto&, const auto&) const;
};
struct by_pointer {
    const found* intersect(const aglow::ray<float>&) const;
    bool occluded(const vec3<float>&, const vec3<float>&) const;
};
struct without_light {
    std::optional<hit> intersect(const aglow::ray<float>&) const;
    bool occluded(const vec3<float>&, const vec3<float>&) const;
};

static_assert(!aglow::Intersector<without_occluded> && !aglow::Intersector<changes_when_asked> &&
              !aglow::Intersector<finds_numbers> && !aglow::Intersector<forgot_its_scalar>);
static_assert(aglow::Scene<by_pointer>);
static_assert(aglow::Intersector<without_light> && !aglow::Scene<without_light>);

}  // namespace near_scene

// Lights.
namespace near_light {

struct powerless {
    struct particle {
        aglow::ray<float> path;
    };
    particle emit(aglow::random_sampler<float>&) const;
};
struct undirected {
    struct particle {
        vec3<float> path;
        float power;
    };
    particle emit(aglow::random_sampler<float>&) const;
};
struct without_density {
    struct look {
        vec3<float> towards;
        float distance;
        float radiance_over_pdf;
    };
    std::optional<look> illuminate(const vec3<float>&, aglow::random_sampler<float>&) const;
};

static_assert(!aglow::Emitter<powerless> && !aglow::Emitter<undirected> && !aglow::Illuminator<without_density>);
static_assert(!aglow::Emitter<archetypes::illuminator<float>> && !aglow::Illuminator<archetypes::emitter<float>>);

}  // namespace near_light

TEMPLATE_TEST_CASE("archetypes: the sphere's inside is found from everywhere inside, and from outside the near wall",
                   "", float, double) {
    using T = TestType;
    const archetypes::scene<T> scene;
    aglow::random_sampler<T> random{1};
    for (int i = 0; i < 1000; ++i) {
        const vec3<T> origin = aglow::uniform_sphere(random.next_2d()) * random.next_1d();
        const vec3<T> towards = aglow::uniform_sphere(random.next_2d());
        const auto hit = scene.intersect({origin, towards});
        REQUIRE(hit);
        CHECK(aglow::length2(vec3<T>(hit->position)) == Approx(1).epsilon(1e-5));
        CHECK(glm::dot(towards, vec3<T>(hit->normal)) < 0);
    }
    const auto outer = scene.intersect({{0, 0, 3}, {0, 0, -1}});
    REQUIRE(outer);
    CHECK(outer->position.z == 1);
    CHECK(scene.occluded({0, 0, 3}, {0, 0, -3}));
    CHECK_FALSE(scene.occluded({0, 0, 3}, {0, 3, 3}));
}
