// expect: satisf(action of|y) 'Surface
#include <type_traits>

#include "support/archetypes.hpp"

namespace {

struct near_surface : archetypes::surface<float> {
    using archetypes::surface<float>::surface;
#ifndef MENDED
    [[nodiscard]] int lobes() const { return 1; }
#endif
};

}  // namespace

int main() {
    const near_surface hit{{0, 0, 0}, {0, 0, 1}};
    return aglow::adjoint(hit, {0, 0, 1}, {0, 0, 1}) > 0 ? 0 : 1;
}
