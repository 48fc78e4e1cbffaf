// expect: satisf(action of|y) 'Intersector
#include <optional>

#include "support/archetypes.hpp"

namespace {

struct near_scene {
#ifdef MENDED
    using scalar = double;
#endif
    std::optional<archetypes::hit<double>> intersect(const auto&) const { return std::nullopt; }
    bool occluded(const auto&, const auto&) const { return false; }
};

template <aglow::Intersector S>
void shoot(const S&) {}

}  // namespace

int main() { shoot(near_scene{}); }
