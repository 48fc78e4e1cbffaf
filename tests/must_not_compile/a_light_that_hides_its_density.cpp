// expect: satisf(action of|y) 'Illuminator
#include <optional>

#include "support/archetypes.hpp"

namespace {

struct near_light {
    struct look {
        aglow::vec3<float> towards{};
        float distance{};
        float radiance_over_pdf{};
#ifdef MENDED
        float pdf{};
#endif
    };
    template <aglow::Sampler R>
    std::optional<look> illuminate(const aglow::vec3<float>&, R&) const {
        return std::nullopt;
    }
};

template <aglow::Illuminator L>
void shine(const L&) {}

}  // namespace

int main() { shine(near_light{}); }
