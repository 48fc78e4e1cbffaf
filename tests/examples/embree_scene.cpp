#include "embree/embree_scene.hpp"

#include <vector>

#include <aglow/concepts/lambert.hpp>

#include "common/scenes/registry.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

namespace {

using aglow::vec3;

struct as_lambert {
    aglow::lambert<vec3<float>> operator()(const host::embree_hit& h) const {
        return {.position = h.position, .normal = h.normal, .albedo = vec3<float>{0.5f}};
    }
};

struct as_found {
    host::embree_hit operator()(const host::embree_hit& h) const { return h; }
};

template <typename Shade>
host::embree_scene<Shade> traced(const host::scene_description<float>& s) {
    host::embree_scene<Shade> scene{Shade{}};
    for (const auto& q : s.quads) {
        const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
        scene.add_mesh(q.corners, triangles);
    }
    scene.commit();
    return scene;
}

static_assert(aglow::Intersector<host::embree_scene<as_found>>);
static_assert(aglow::Scene<host::embree_scene<as_lambert>>);

}  // namespace

TEST_CASE("embree_scene: keeps the laws of intersectors") {
    const auto scene = traced<as_found>(host::scenes::cornell_diffuse<float>());
    const laws::verdict v = laws::intersector(scene, scene.bounds());
    INFO(v.message);
    CHECK(v.ok);
}

TEST_CASE("embree_scene: finds what the plain list of polygons finds") {
    const auto description = host::scenes::cornell_diffuse<float>();
    const auto scene = traced<as_found>(description);
    const host::scene<float> plain{description};
    aglow::random_sampler<float> random{2};
    int at_odds = 0;
    for (int i = 0; i < 20000; ++i) {
        const vec3<float> u{random.next_1d(), random.next_1d(), random.next_1d()};
        const aglow::ray<float> r{scene.bounds().low + scene.bounds().extent() * u,
                                  aglow::uniform_sphere(random.next_2d())};
        const auto a = scene.intersect(r);
        const auto b = plain.intersect(r);
        if (!a || !b) {
            at_odds += static_cast<bool>(a) != static_cast<bool>(b);
            continue;
        }
        const float facing = std::max(1e-3f, std::abs(glm::dot(a->normal, r.direction)));
        at_odds += std::abs(a->distance - b->distance) > 2 * a->position_error / facing;
        at_odds += glm::dot(a->normal, b->normal) < 0.999f;
    }
    CHECK(at_odds <= 1);
}

TEST_CASE("embree_scene: no ray slips between neighbours") {
    host::scene_description<float> box{.name = "box", .about = ""};
    host::scenes::add_room<float>(box, {-1.1f, 0.3f, 2.7f}, {3.3f, 1.9f, 7.1f}, box.add({}));
    const auto scene = traced<as_found>(box);
    const auto& b = scene.bounds();
    aglow::random_sampler<float> random{5};
    int escaped = 0;
    for (int i = 0; i < 100000; ++i) {
        const vec3<float> u{random.next_1d(), random.next_1d(), random.next_1d()};
        vec3<float> at = b.low + b.extent() * vec3<float>{random.next_1d(), random.next_1d(), random.next_1d()};
        at[i % 3] = i & 4 ? b.low[i % 3] : b.high[i % 3];
        at[(i + 1) % 3] = i & 8 ? b.low[(i + 1) % 3] : b.high[(i + 1) % 3];
        const vec3<float> from = b.low + b.extent() * u;
        escaped += !scene.intersect({from, glm::normalize(at - from)});
    }
    CHECK(escaped == 0);
}
