// How a material scatters light: Lambert, GGX, mirror, glass and their mixtures, split into the library's lobes.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <aglow/concepts/surface.hpp>
#include <aglow/core/frame.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/warp.hpp>

#include "fresnel.hpp"
#include "ggx.hpp"
#include "material.hpp"

namespace host {

/// A material ready to scatter. All functions take the unit geometric normal; `Possible` names the lobes that the scene
/// can have, so that the code of the others is left out. Safe from many threads.
template <typename T>
class bsdf {
public:
    using sample_type = aglow::scatter_sample<vec3<T>, T>;

    /// Throws `std::invalid_argument` for a material that cannot be (see `check`).
    explicit bsdf(const material<T>& m) : m_{m}, lobes_{lobes_of(m)} { check(m); }

    [[nodiscard]] const material<T>& made_of() const { return m_; }
    [[nodiscard]] lobe_set lobes() const { return lobes_; }

    /// The same with its diffuse part times `colour`, whose bands are in [0, 1].
    [[nodiscard]] bsdf tinted(const vec3<T>& colour) const {
        bsdf made = *this;
        made.m_.diffuse *= colour;
        return made;
    }

    [[nodiscard]] vec3<T> emitted(const vec3<T>& normal, const vec3<T>& wo) const {
        return glm::dot(normal, wo) > 0 ? m_.radiance : vec3<T>{0};
    }

    template <lobe_set Possible = lobe_set::all>
    [[nodiscard]] vec3<T> evaluate(const vec3<T>& normal, const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        const lobe_set open = asked & lobes_ & Possible;
        const T out = glm::dot(normal, wo);
        const T in = glm::dot(normal, wi);
        if (out * in > 0) { return reflection<Possible>(normal, wo, wi, std::abs(out), std::abs(in), open); }
        if (!(out * in < 0) || !aglow::any(Possible & open, lobe_set::diffuse_transmission)) { return vec3<T>{0}; }
        return m_.translucent * (1 / aglow::pi<T>);
    }

    template <lobe_set Possible = lobe_set::all>
    [[nodiscard]] T pdf(const vec3<T>& normal, const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        const T out = glm::dot(normal, wo);
        const T in = glm::dot(normal, wi);
        if (out == 0 || in == 0) { return 0; }
        return density<Possible>(out > 0 ? normal : -normal, wo, wi, shares_of<Possible>(out, asked));
    }

    template <lobe_set Possible = lobe_set::all, typename R>
    [[nodiscard]] std::optional<sample_type> sample(const vec3<T>& normal, const vec3<T>& wo, R& random,
                                                    lobe_set asked) const {
        const T out = glm::dot(normal, wo);
        const shares share = shares_of<Possible>(out, asked);
        if (share.none() || out == 0) { return std::nullopt; }
        const vec3<T> up = out > 0 ? normal : -normal;
        if constexpr (aglow::any(Possible, lobe_set::specular)) {
            const T choice = share.single() ? T(0) : random.next_1d();
            if (choice < share.mirror) { return mirrored(up, wo, out, share.mirror); }
            if (choice < share.mirror + share.refracted) { return bent(up, wo, out, share.refracted); }
            return smooth<Possible>(up, wo, random.next_2d(), choice - share.mirror - share.refracted, share, asked);
        } else {
            const vec2<T> u = random.next_2d();
            return smooth<Possible>(up, wo, u, share.single() ? T(0) : random.next_1d(), share, asked);
        }
    }

private:
    /// With what probability each part is sampled; they sum to 1, or to 0 where nothing is open.
    struct shares {
        T diffuse{0}, through{0}, glossy{0}, mirror{0}, refracted{0};

        [[nodiscard]] T sum() const { return diffuse + through + glossy + mirror + refracted; }
        [[nodiscard]] bool none() const { return !(sum() > 0); }
        [[nodiscard]] bool single() const {
            return diffuse == 1 || through == 1 || glossy == 1 || mirror == 1 || refracted == 1;
        }
    };

    template <lobe_set Possible>
    [[nodiscard]] shares shares_of(T out, lobe_set asked) const {
        const lobe_set open = asked & lobes_ & Possible;
        if (open == lobe_set::diffuse_reflection) { return {.diffuse = 1}; }
        if constexpr (Possible == lobe_set::diffuse_reflection) { return {}; }
        const T cosine = std::abs(out);
        const auto has = [open](lobe_set lobe) { return aglow::any(Possible, lobe) && aglow::any(open, lobe); };
        shares s;
        if (has(lobe_set::diffuse_reflection)) { s.diffuse = aglow::max_component(m_.diffuse); }
        if (has(lobe_set::diffuse_transmission)) { s.through = aglow::max_component(m_.translucent); }
        if (has(lobe_set::glossy_reflection)) { s.glossy = aglow::max_component(facet_reflectance(cosine)); }
        if (has(lobe_set::specular_reflection)) { s.mirror = mirror_reflectance(out); }
        if (has(lobe_set::specular_transmission)) { s.refracted = 1 - mirror_reflectance(out); }
        const T sum = s.sum();
        if (!(sum > 0)) { return {}; }
        return {s.diffuse / sum, s.through / sum, s.glossy / sum, s.mirror / sum, s.refracted / sum};
    }

    /// At grazing angles facets reflect what a diffuse part leaves them, so that both never make more than 1, and the
    /// diffuse part stays Lambert's.
    [[nodiscard]] vec3<T> facet_reflectance(T cosine) const {
        return schlick(m_.glossy, vec3<T>{1} - m_.diffuse, cosine);
    }

    /// The index beyond over the index on the side of `wo`, whose cosine with the normal is `out`.
    [[nodiscard]] T relative_index(T out) const { return out > 0 ? m_.index : 1 / m_.index; }

    [[nodiscard]] T mirror_reflectance(T out) const {
        return m_.index > 0 ? fresnel(std::abs(out), relative_index(out)) : aglow::max_component(m_.mirror);
    }

    [[nodiscard]] sample_type mirrored(const vec3<T>& up, const vec3<T>& wo, T out, T share) const {
        const vec3<T> f = m_.index > 0 ? vec3<T>{mirror_reflectance(out)} : m_.mirror;
        return {reflected(wo, up), f / share, T(0), lobe_set::specular_reflection};
    }

    [[nodiscard]] std::optional<sample_type> bent(const vec3<T>& up, const vec3<T>& wo, T out, T share) const {
        const auto wi = refracted(wo, up, relative_index(out));
        if (!wi) { return std::nullopt; }
        const vec3<T> f{1 - mirror_reflectance(out)};
        return sample_type{*wi, f / share, T(0), lobe_set::specular_transmission};
    }

    template <lobe_set Possible>
    [[nodiscard]] std::optional<sample_type> smooth(const vec3<T>& up, const vec3<T>& wo, const vec2<T>& u, T choice,
                                                    const shares& share, lobe_set asked) const {
        const aglow::frame<T> local{up};
        vec3<T> wi{};
        lobe_set lobe = lobe_set::diffuse_reflection;
        if (aglow::any(Possible, lobe_set::glossy_reflection) && choice < share.glossy) {
            const vec3<T> down = local.to_local(wo);
            wi = local.to_world(reflected(down, ggx<T>{m_.roughness}.facet(down, u)));
            lobe = lobe_set::glossy_reflection;
            if (glm::dot(up, wi) <= 0) { return std::nullopt; }
        } else {
            vec3<T> d = aglow::cosine_hemisphere(u);
            if (aglow::any(Possible, lobe_set::diffuse_transmission) && choice - share.glossy < share.through) {
                d.z = -d.z;
                lobe = lobe_set::diffuse_transmission;
            }
            wi = local.to_world(d);
        }
        const T p = density<Possible>(up, wo, wi, share);
        if (!(p > 0)) { return std::nullopt; }
        const vec3<T> f = evaluate<Possible>(up, wo, wi, asked);
        return sample_type{wi, f * (std::abs(glm::dot(up, wi)) / p), p, lobe};
    }

    template <lobe_set Possible>
    [[nodiscard]] T density(const vec3<T>& up, const vec3<T>& wo, const vec3<T>& wi, const shares& share) const {
        const T in = glm::dot(up, wi);
        if (in < 0) { return share.through * aglow::cosine_hemisphere_pdf(-in); }
        T p = share.diffuse * aglow::cosine_hemisphere_pdf(in);
        if constexpr (aglow::any(Possible, lobe_set::glossy_reflection)) {
            if (share.glossy > 0) {
                const aglow::frame<T> local{up};
                const vec3<T> h = local.to_local(glm::normalize(wo + wi));
                p += share.glossy * ggx<T>{m_.roughness}.reflection_pdf(local.to_local(wo), h);
            }
        }
        return p;
    }

    /// Of the parts that reflect; `out` and `in` are cosines above zero.
    template <lobe_set Possible>
    [[nodiscard]] vec3<T> reflection(const vec3<T>& normal, const vec3<T>& wo, const vec3<T>& wi, T out, T in,
                                     lobe_set open) const {
        vec3<T> f{0};
        if (aglow::any(open, lobe_set::diffuse_reflection)) { f = m_.diffuse * (1 / aglow::pi<T>); }
        if constexpr (aglow::any(Possible, lobe_set::glossy_reflection)) {
            if (aglow::any(open, lobe_set::glossy_reflection)) { f += facets(normal, wo, wi, out, in); }
        }
        return f;
    }

    [[nodiscard]] vec3<T> facets(const vec3<T>& normal, const vec3<T>& wo, const vec3<T>& wi, T out, T in) const {
        const ggx<T> distribution{m_.roughness};
        const aglow::frame<T> local{normal};
        const vec3<T> a = local.to_local(wo);
        const vec3<T> b = local.to_local(wi);
        const vec3<T> h = glm::normalize(a + b);
        const T unit = distribution.density(h) * distribution.seen(a, b) / (4 * out * in);
        return facet_reflectance(std::abs(glm::dot(a, h))) * unit;
    }

    material<T> m_;
    lobe_set lobes_;
};

/// What a ray meets: a place and its material. The library's `Surface`.
template <typename T, lobe_set Possible = lobe_set::all>
struct surface_hit {
    vec3<T> position{};
    vec3<T> normal{};
    T position_error{};
    T distance{};
    const bsdf<T>* scatterer{};
    std::uint32_t primitive{};

    [[nodiscard]] lobe_set lobes() const { return scatterer->lobes() & Possible; }
    [[nodiscard]] vec3<T> evaluate(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        return scatterer->template evaluate<Possible>(normal, wo, wi, asked);
    }
    [[nodiscard]] T pdf(const vec3<T>& wo, const vec3<T>& wi, lobe_set asked) const {
        return scatterer->template pdf<Possible>(normal, wo, wi, asked);
    }
    template <typename R>
    [[nodiscard]] auto sample(const vec3<T>& wo, R& random, lobe_set asked) const {
        return scatterer->template sample<Possible>(normal, wo, random, asked);
    }
    [[nodiscard]] vec3<T> emitted(const vec3<T>& wo) const { return scatterer->emitted(normal, wo); }
};

}  // namespace host
