// expect: deleted
#include <aglow/algorithms/final_gather.hpp>

#include "support/archetypes.hpp"

namespace {

struct even_source {};

}  // namespace

int main() {
#ifdef MENDED
    const even_source source;
    (void)aglow::gather_layer{source};
#else
    (void)aglow::gather_layer{even_source{}};
#endif
}
