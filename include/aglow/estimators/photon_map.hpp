// Photons that landed, and the irradiance that they make: density estimation on a kd-tree.
//
// Jensen 1996; counting rules that make the estimate unbiased where the density is even: García Hernández et al. 2012.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/estimators/density.hpp>
#include <aglow/estimators/density_sum.hpp>
#include <aglow/estimators/photon.hpp>
#include <aglow/estimators/photon_store.hpp>

namespace aglow {

/// A photon map of spectrum `S` in a scene of scalar `T`. Knows no rays: it is handed photons, and gives irradiance.
/// Estimates are `const` and safe from many threads, O(k + log n). What it keeps of a photon is an `Item`: all of it
/// (`photon`), or sixteen bytes (`compact_photon`).
template <Spectrum S, std::floating_point T = float, PhotonItem<S, T> Item = photon<S>>
class photon_map {
public:
    using spectrum = S;
    using scalar = T;
    using item = Item;

    photon_map() = default;

    /// A map of `photons`, their power times `scale` (1 / emitted paths). Photons whose scaled power is NaN, infinite
    /// or negative, or whose position is not finite, are dropped and counted. The same map for any executor.
    template <Executor Run = in_sequence>
    explicit photon_map(std::span<const landed_photon<S, T>> photons, T scale = 1, const Run& run = {})
        : stored_{photons, scale, run} {}

    /// The photons of another map, kept in another way; where they lie in that map decides how they are rounded.
    template <typename Other, Executor Run = in_sequence>
        requires(!std::same_as<Other, Item>)
    explicit photon_map(const photon_map<S, T, Other>& other, const Run& run = {})
        : photon_map{detail::landed_from(other), T(1), run} {}

    [[nodiscard]] std::size_t size() const { return stored_.photons().size(); }
    [[nodiscard]] bool empty() const { return stored_.photons().empty(); }
    /// Photons refused for bad numbers.
    [[nodiscard]] std::size_t dropped() const { return stored_.dropped(); }
    /// Tight box of all photons.
    [[nodiscard]] const bounds<T>& box() const { return stored_.box(); }
    /// Photons in the map's own order, near ones near each other, and where they lie.
    [[nodiscard]] std::span<const Item> photons() const { return stored_.photons(); }
    /// What the powers of `photons()` are counted in, W: 1, or a power of two where they would be too faint to be
    /// normal numbers.
    [[nodiscard]] band_of<S> unit() const { return stored_.unit(); }
    [[nodiscard]] vec3<T> position(std::size_t i) const { return stored_.tree().position(static_cast<kd_slot>(i)); }
    /// Bytes in all.
    [[nodiscard]] std::size_t memory() const {
        return stored_.tree().memory() + stored_.photons().capacity() * sizeof(Item);
    }

    /// Tells the map how many photons come together, where single paths bring many: what may be where none came.
    void come_in_bunches(double photons) { bunch_ = std::max(1.0, photons); }

    /// Irradiance at `point` in W/m², from photons that arrived on the side that unit `normal` points out of; black
    /// where none are near. k nearest within the largest radius: with all k found, or 8 and more within a radius that
    /// the map chose by itself, all but the farthest over the disc that ends there; with fewer, all over the largest
    /// disc. Together they are unbiased where the density is even. Where k
    /// photons lie closer together than positions can tell, all that do are spread over the least disc that can be
    /// told.
    [[nodiscard]] density_estimate<S, T> irradiance(const vec3<T>& point, const vec3<T>& normal,
                                                    const density_options& options = {}) const {
        return irradiance(point, normal, options, [](std::size_t) { return true; });
    }

    /// The same from photons whose index `counts` alone: what the caller knows to be hidden does not count.
    template <std::predicate<std::size_t> Counts>
    [[nodiscard]] density_estimate<S, T> irradiance(const vec3<T>& point, const vec3<T>& normal,
                                                    const density_options& options, Counts&& counts) const {
        const auto weigh = [](const Item& p) { return p.flux(); };
        const auto accept = [&](kd_slot i) { return accepts(i, point, normal, options) && counts(i); };
        return or_none(sum(point, options, accept, weigh));
    }

    /// Irradiance at every place, which has a `position` and a unit `normal`: `estimates[i]` becomes what `irradiance`
    /// says of `places[i]`, to the bit. Memory is asked for ahead, so that places in no order are answered up to one
    /// and a half times as fast where the photons take more than the caches hold; of places in a row that lie
    /// together there is next to nothing to gain. Expects as many estimates as places.
    template <typename Place>
    void irradiance_each(std::span<const Place> places, std::span<density_estimate<S, T>> estimates,
                         const density_options& options = {}) const {
        irradiance_each(places, estimates, options, [](std::size_t, std::size_t) { return true; });
    }

    /// The same from photons that `counts(i, photon)` for place i, an index each, alone.
    template <typename Place, std::predicate<std::size_t, std::size_t> Counts>
    void irradiance_each(std::span<const Place> places, std::span<density_estimate<S, T>> estimates,
                         const density_options& options, Counts&& counts) const {
        if (empty() || options.count == 0) {
            for (std::size_t i = 0; i < places.size(); ++i) {
                const auto counts_here = [&](std::size_t photon) { return counts(i, photon); };
                estimates[i] = irradiance(places[i].position, places[i].normal, options, counts_here);
            }
            return;
        }
        constexpr std::size_t most = 64;
        for (std::size_t first = 0; first < places.size(); first += most) {
            const std::size_t some = std::min(most, places.size() - first);
            const auto counts_here = [&](std::size_t i, std::size_t photon) { return counts(first + i, photon); };
            nearest_each(places.subspan(first, some), estimates.subspan(first, some), options, counts_here);
        }
    }

    /// Radiance that a surface sends out of the photons around `point`, for lobes that depend on where light comes
    /// from: each photon's power times `f(wi)`, the BSDF in 1/sr. Photons on the side of unit `normal` count, and with
    /// `both_sides` those of the other side too. No cosine: flux through the surface has it already (Jensen 1996, eq.
    /// 7).
    template <std::invocable<vec3<T>> Bsdf>
    [[nodiscard]] density_estimate<S, T> radiance(const vec3<T>& point, const vec3<T>& normal, bool both_sides,
                                                  Bsdf&& f, const density_options& options = {}) const {
        const auto accept = [&](kd_slot i) {
            return accepts(i, point, normal, options) || (both_sides && accepts(i, point, -normal, options));
        };
        const auto weigh = [&](const Item& p) { return p.flux() * f(p.template towards<T>()); };
        return sum(point, options, accept, weigh);
    }

    /// The search radius that an estimate of `count` photons uses when it is given none: four times what it would need
    /// if the photons lay evenly on the faces of their box.
    [[nodiscard]] T natural_radius(std::uint32_t count) const {
        if (empty()) { return 0; }
        const T even = std::sqrt(stored_.area() * static_cast<T>(count) / (pi<T> * static_cast<T>(size())));
        return std::max(4 * even, stored_.least_radius());
    }

private:
    /// `e`, with the error of black where nobody came: with 95 % confidence up to three were to be expected (the rule
    /// of three), photons, or bunches of them, where they come by few paths.
    [[nodiscard]] density_estimate<S, T> or_none(density_estimate<S, T> e) const {
        if (e.count == 0 && e.radius > 0) {
            e.error = 3 / pi<band_of<S>> * stored_.brightest() * unit() * band_of<S>(bunch_) *
                      band_of<S>(1 / square(e.radius));
        }
        return e;
    }

    /// The least radius that positions can tell; where all are at the origin, which tell nothing, for a search as far
    /// as `reach`.
    [[nodiscard]] T least_radius(T reach) const {
        return stored_.least_radius() > 0 ? stored_.least_radius() : position_error(reach);
    }

    /// Side, plane and normal: what makes a photon one of this surface. Refused ones never count.
    [[nodiscard]] bool accepts(kd_slot i, const vec3<T>& point, const vec3<T>& normal,
                               const density_options& options) const {
        const Item& p = stored_.photons()[i];
        const vec3<T> away = position(i) - point;
        const T height = std::abs(glm::dot(away, normal)) - stored_.least_radius();
        // Without a branch where the ground is bumpy, since a processor would guess one in three wrong.
        const bool side = int{p.arrived_on(normal)} & int{p.faces(normal, static_cast<T>(options.normal_cosine))};
        if (height <= 0) { return side; }
        return int{side} & int{height * height <= square(static_cast<T>(options.plane_tolerance)) * length2(away)};
    }

    template <typename Accept, typename Weigh>
    [[nodiscard]] density_estimate<S, T> sum(const vec3<T>& point, const density_options& options, Accept&& accept,
                                             Weigh&& weigh) const {
        if (empty()) { return {}; }
        return options.count == 0 ? within(point, options, accept, weigh) : nearest(point, options, accept, weigh);
    }

    template <typename Accept, typename Weigh>
    [[nodiscard]] density_estimate<S, T> nearest(const vec3<T>& point, const density_options& options, Accept& accept,
                                                 Weigh& weigh) const {
        // Scratch only: what it holds never shows in a result.
        static thread_local kd_scratch<T> scratch;
        const T reach = reach_of(options);
        const auto found =
            stored_.tree().nearest(point, count_of(options), scratch, {.radius2 = square(reach)}, accept);
        return sum_of(found, point, reach, options, accept, weigh);
    }

    /// The same for up to 64 places, in one batch of searches.
    template <typename Place, typename Counts>
    void nearest_each(std::span<const Place> places, std::span<density_estimate<S, T>> estimates,
                      const density_options& options, const Counts& counts) const {
        static thread_local kd_scratch<T> scratch;
        std::array<vec3<T>, 64> points;
        std::transform(places.begin(), places.end(), points.begin(), [](const Place& p) { return p.position; });
        const auto weigh = [](const Item& p) { return p.flux(); };
        const auto accept = [&](std::size_t i, kd_slot slot) {
            return accepts(slot, points[i], places[i].normal, options) && counts(i, slot);
        };
        const T reach = reach_of(options);
        const auto take = [&](std::size_t i, const kd_neighbours<T>& found) {
            const auto accept_here = [&](kd_slot slot) { return accept(i, slot); };
            estimates[i] = or_none(sum_of(found, points[i], reach, options, accept_here, weigh));
        };
        stored_.tree().nearest(std::span<const vec3<T>>{points.data(), places.size()}, count_of(options), scratch,
                               {.radius2 = square(reach)}, take, kd_accept_ahead{photons(), accept});
    }

    [[nodiscard]] static std::uint32_t count_of(const density_options& options) { return std::max(2u, options.count); }
    [[nodiscard]] T reach_of(const density_options& options) const {
        return options.max_radius > 0 ? static_cast<T>(options.max_radius) : natural_radius(count_of(options));
    }

    /// The squared radius of the disc over which `found` are spread. A largest radius that nobody asked for may reach
    /// far beyond the surface: then the farthest found ends the disc, unless they are so few that this is mostly noise.
    [[nodiscard]] static T disc2_of(const kd_neighbours<T>& found, const density_options& options) {
        const bool is_cut = found.size() < count_of(options) && options.max_radius <= 0;
        if (!is_cut || found.size() < fewest_on_rim) { return found.radius2; }
        return *std::max_element(found.distances2.begin(), found.distances2.end());
    }
    static constexpr std::size_t fewest_on_rim = 8;

    /// What the nearest that a search `found` within `reach` make.
    template <typename Accept, typename Weigh>
    [[nodiscard]] density_estimate<S, T> sum_of(const kd_neighbours<T>& found, const vec3<T>& point, T reach,
                                                const density_options& options, Accept& accept, Weigh& weigh) const {
        const T radius2 = disc2_of(found, options) * square(static_cast<T>(options.shrink));
        const T least2 = square(least_radius(reach));
        if (radius2 < least2) { return over(point, least2, options.kernel, accept, weigh); }
        return with_kernel(options.kernel, [&](auto kernel) {
            detail::density_sum<S, T, decltype(kernel)> sum{kernel, radius2, unit()};
            for (std::size_t i = 0; i < found.size(); ++i) {
                const kd_slot slot = found.slots[i];
                sum.add(found.distances2[i], position(slot) - point, stored_.photons()[slot], weigh);
            }
            return sum.result();
        });
    }

    template <typename Accept, typename Weigh>
    [[nodiscard]] density_estimate<S, T> within(const vec3<T>& point, const density_options& options, Accept& accept,
                                                Weigh& weigh) const {
        const T reach = options.max_radius > 0 ? static_cast<T>(options.max_radius) : natural_radius(50);
        const T radius = std::max(reach * static_cast<T>(options.shrink), least_radius(reach));
        return over(point, square(radius), options.kernel, accept, weigh);
    }

    /// All photons within one radius. Seldom asked, hence with any kernel: a search compiled for each is long.
    template <typename Accept, typename Weigh>
    [[nodiscard]] density_estimate<S, T> over(const vec3<T>& point, T radius2, kernel_shape shape, Accept& accept,
                                              Weigh& weigh) const {
        detail::density_sum<S, T, any_kernel> sum{{shape}, radius2, unit()};
        stored_.tree().within(point, sum.radius2, [&](kd_slot i, T distance2) {
            if (accept(i)) { sum.add(distance2, position(i) - point, stored_.photons()[i], weigh); }
        });
        return sum.result();
    }

    detail::photon_store<S, T, Item> stored_{};
    double bunch_{1};
};

}  // namespace aglow
