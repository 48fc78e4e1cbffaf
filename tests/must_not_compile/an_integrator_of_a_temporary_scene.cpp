// expect: deleted function
#include <aglow/algorithms/path_trace.hpp>

#include "support/archetypes.hpp"

int main() {
    const archetypes::illuminator<float> light{archetypes::spectrum<float>::of(1, 1)};
#ifdef MENDED
    const archetypes::scene<float> scene;
    const aglow::path_tracer tracer{scene, light};
#else
    const aglow::path_tracer tracer{archetypes::scene<float>{}, light};
#endif
    (void)tracer;
}
