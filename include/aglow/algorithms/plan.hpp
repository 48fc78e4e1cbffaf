// What a scene does not need, found once before anything is done, and said.
#pragma once

#include <string>
#include <vector>

#include <aglow/concepts/intersector.hpp>

namespace aglow {

/// Which parts of the machinery a scene uses. Immutable: made once per scene.
struct render_plan {
    /// A part that is left out, and the reason in a clause for people.
    struct omission {
        std::string part;
        std::string why;
    };

    bool caustic_map{true};   ///< photons over specular surfaces
    bool diffuse{true};       ///< maps and caches at all
    bool transmission{true};  ///< the far hemisphere
    bool glossy{true};        ///< following and weighing glossy lobes
    bool specular{true};      ///< recursion through mirrors and glass
    std::vector<omission> left_out{};
};

/// The plan of a scene with `lobes`.
[[nodiscard]] inline render_plan plan_for(lobe_set lobes) {
    render_plan plan;
    const auto keep = [&](bool& part, bool needed, const char* name, const char* why) {
        part = needed;
        if (!needed) { plan.left_out.push_back({name, why}); }
    };
    const bool specular = any(lobes, lobe_set::specular);
    const bool smooth = any(lobes, lobe_set::smooth);
    keep(plan.specular, specular, "specular recursion", "no specular surface");
    keep(plan.caustic_map, specular && smooth, "caustic map",
         specular ? "nothing to see caustics on" : "no specular surface");
    keep(plan.diffuse, any(lobes, lobe_set::diffuse), "maps and caches", "no diffuse surface");
    keep(plan.glossy, any(lobes, lobe_set::glossy), "glossy sampling", "no glossy surface");
    keep(plan.transmission, any(lobes, lobe_set::diffuse_transmission), "far hemisphere",
         "nothing transmits diffusely");
    return plan;
}

/// The plan of `scene`, by what its type or it itself says of its lobes.
template <Intersector World>
[[nodiscard]] render_plan plan_for(const World& scene) {
    return plan_for(possible_lobes(scene));
}

}  // namespace aglow
