// expect: satisf(action of|y) 'Surface
#include <optional>

#include "support/archetypes.hpp"

namespace {

#ifdef MENDED
using found = archetypes::surface<float>;
#else
using found = archetypes::hit<float>;
#endif

struct near_scene {
    std::optional<found> intersect(const aglow::ray<float>&) const { return std::nullopt; }
    bool occluded(const aglow::vec3<float>&, const aglow::vec3<float>&) const { return false; }
};

template <aglow::Scene S>
void light(const S&) {}

}  // namespace

int main() { light(near_scene{}); }
