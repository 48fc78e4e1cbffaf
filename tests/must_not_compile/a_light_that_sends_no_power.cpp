// expect: satisf(action of|y) 'Emitter
#include "support/archetypes.hpp"

namespace {

struct near_light {
    struct particle {
        aglow::ray<float> path{};
#ifdef MENDED
        float power{};
#endif
    };
    template <aglow::Sampler R>
    particle emit(R&) const {
        return {};
    }
};

template <aglow::Emitter L>
void shine(const L&) {}

}  // namespace

int main() { shine(near_light{}); }
