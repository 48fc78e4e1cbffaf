// expect: satisf(action of|y) 'Intersector
#include <optional>

#include "support/archetypes.hpp"

namespace {

#ifdef MENDED
#define CONST const
#else
#define CONST
#endif

struct near_scene {
    std::optional<archetypes::hit<float>> intersect(const aglow::ray<float>&) CONST { return std::nullopt; }
    bool occluded(const aglow::vec3<float>&, const aglow::vec3<float>&) const { return false; }
};

template <aglow::Intersector S>
void shoot(const S&) {}

}  // namespace

int main() { shoot(near_scene{}); }
