// What a surface is made of, as an author writes it down.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/concepts/surface.hpp>
#include <aglow/core/vec.hpp>

namespace host {

using aglow::lobe_set;
using aglow::vec2;
using aglow::vec3;

/// The parts that scatter, each black unless said; a mixture has several. Both sides of a surface are the same but for
/// `radiance`, which leaves on the side of the normal, and `index`, which is inside.
template <typename T>
struct material {
    /// Share of the light that is reflected evenly (Lambert).
    vec3<T> diffuse{0};
    /// Share of the light that comes out evenly on the other side (Lambert).
    vec3<T> translucent{0};
    /// Reflectance of rough facets (GGX) at normal incidence; rises towards grazing angles to all that `diffuse`
    /// leaves.
    vec3<T> glossy{0};
    /// Width of the facets' distribution, alpha; not its square root.
    T roughness{T(0.2)};
    /// Reflectance of a perfect mirror, the same for every angle.
    vec3<T> mirror{0};
    /// Index of refraction of a clear smooth body, which has no other part; 0 for none.
    T index{0};
    /// Radiance that the surface sends out itself.
    vec3<T> radiance{0};
};

/// The lobes that a material has.
template <typename T>
[[nodiscard]] lobe_set lobes_of(const material<T>& m) {
    lobe_set lobes = lobe_set::none;
    if (!aglow::is_black(m.diffuse)) { lobes = lobes | lobe_set::diffuse_reflection; }
    if (!aglow::is_black(m.translucent)) { lobes = lobes | lobe_set::diffuse_transmission; }
    if (!aglow::is_black(m.glossy)) { lobes = lobes | lobe_set::glossy_reflection; }
    if (!aglow::is_black(m.mirror)) { lobes = lobes | lobe_set::specular_reflection; }
    if (m.index > 0) { lobes = lobes | lobe_set::specular; }
    return lobes;
}

/// Throws `std::invalid_argument` for a material that would send out more light than it gets, or that cannot be.
template <typename T>
void check(const material<T>& m) {
    const auto refuse = [](const std::string& why) { throw std::invalid_argument("material: " + why); };
    for (const vec3<T>* part : {&m.diffuse, &m.translucent, &m.glossy, &m.mirror, &m.radiance}) {
        if (!aglow::is_radiance(*part)) { refuse("a part is negative or not finite"); }
    }
    const vec3<T> sum = m.diffuse + m.translucent + m.glossy + m.mirror;
    if (aglow::max_component(sum) > 1) { refuse("the parts reflect more than they receive"); }
    if (!aglow::is_black(m.glossy)) {
        if (!(m.roughness > T(1e-3)) || m.roughness > 1) { refuse("roughness outside (0.001, 1]"); }
        if (!aglow::is_black(m.translucent + m.mirror)) { refuse("glossy beside translucent or mirror"); }
    }
    if (m.index < 0 || (m.index > 0 && !aglow::is_black(sum))) { refuse("a clear body has no other part"); }
}

}  // namespace host
