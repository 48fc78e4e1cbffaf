#include <aglow/algorithms/plan.hpp>

#include <algorithm>

#include "support/catch.hpp"

using namespace aglow;

namespace {

bool left_out(const render_plan& plan, const std::string& part) {
    return std::any_of(plan.left_out.begin(), plan.left_out.end(), [&](const auto& o) { return o.part == part; });
}

std::string reason(const render_plan& plan, const std::string& part) {
    for (const auto& o : plan.left_out) {
        if (o.part == part) { return o.why; }
    }
    return "";
}

}  // namespace

TEST_CASE("plan: a scene with every lobe leaves nothing out") {
    const render_plan plan = plan_for(lobe_set::all);
    CHECK(plan.left_out.empty());
    CHECK((plan.caustic_map && plan.diffuse && plan.transmission && plan.glossy && plan.specular));
}

TEST_CASE("plan: matte walls need neither caustics nor recursion nor gloss nor a far hemisphere") {
    const render_plan plan = plan_for(lobe_set::diffuse_reflection);
    CHECK(plan.diffuse);
    CHECK((!plan.caustic_map && !plan.specular && !plan.glossy && !plan.transmission));
    CHECK(plan.left_out.size() == 4);
    CHECK(reason(plan, "caustic map") == "no specular surface");
}

TEST_CASE("plan: a hall of mirrors needs no maps, and says that nothing sees its caustics") {
    const render_plan plan = plan_for(lobe_set::specular);
    CHECK(plan.specular);
    CHECK((!plan.diffuse && !plan.caustic_map));
    CHECK(reason(plan, "caustic map") == "nothing to see caustics on");
    CHECK(left_out(plan, "maps and caches"));
}

TEST_CASE("plan: every part is either in or left out with a reason, for all 64 sets of lobes") {
    for (unsigned bits = 0; bits < 64; ++bits) {
        const auto lobes = static_cast<lobe_set>(bits);
        const render_plan plan = plan_for(lobes);
        const int in = plan.caustic_map + plan.diffuse + plan.transmission + plan.glossy + plan.specular;
        CHECK(static_cast<std::size_t>(5 - in) == plan.left_out.size());
        for (const auto& o : plan.left_out) { CHECK_FALSE(o.why.empty()); }
        CHECK(plan.diffuse == any(lobes, lobe_set::diffuse));
        CHECK(plan.transmission == any(lobes, lobe_set::diffuse_transmission));
        CHECK(plan.caustic_map == (any(lobes, lobe_set::specular) && any(lobes, lobe_set::smooth)));
    }
}
