// Photons that landed, and the irradiance that they make: density estimation on a kd-tree.
//
// Jensen 1996; counting rules that make the estimate unbiased where the density is even: García Hernández et al. 2012.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/packed_place.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/estimators/density.hpp>
#include <aglow/estimators/density_sum.hpp>
#include <aglow/estimators/photon.hpp>

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
    explicit photon_map(std::span<const landed_photon<S, T>> photons, T scale = 1, const Run& run = {}) {
        choose_unit(photons, scale);
        const band_of<S> factor = band_of<S>(scale) * (1 / unit_);
        std::vector<std::uint32_t> sound;
        sound.reserve(photons.size());
        for (std::size_t i = 0; i < photons.size(); ++i) {
            if (is_radiance(S(photons[i].what.power * factor))) { sound.push_back(static_cast<std::uint32_t>(i)); }
        }
        if constexpr (packs) {
            index_packed(photons, sound, factor, run);
        } else {
            tree_ = kd_tree<T>{sound, [&](std::uint32_t i) { return photons[i].position; }, run};
            photons_ = std::vector<Item>(tree_.size());
            for_each_block(run, photons_.size(), at_once, [&](std::size_t, std::size_t first, std::size_t last) {
                for (std::size_t slot = first; slot < last; ++slot) {
                    photons_[slot] = photons[sound[tree_.order()[slot]]].what;
                    photons_[slot].power = photons_[slot].power * factor;
                }
            });
        }
        dropped_ = photons.size() - tree_.size();
        tree_.forget_order();
        measure();
    }

    /// The photons of another map, kept in another way; where they lie in that map decides how they are rounded.
    template <typename Other, Executor Run = in_sequence>
        requires(!std::same_as<Other, Item>)
    explicit photon_map(const photon_map<S, T, Other>& other, const Run& run = {})
        : photon_map{landed_from(other), T(1), run} {}

    [[nodiscard]] std::size_t size() const { return photons_.size(); }
    [[nodiscard]] bool empty() const { return photons_.empty(); }
    /// Photons refused for bad numbers.
    [[nodiscard]] std::size_t dropped() const { return dropped_; }
    /// Tight box of all photons.
    [[nodiscard]] const bounds<T>& box() const { return box_; }
    /// Photons in the map's own order, near ones near each other, and where they lie.
    [[nodiscard]] std::span<const Item> photons() const { return photons_; }
    /// What the powers of `photons()` are counted in, W: 1, or a power of two where they would be too faint to be
    /// normal numbers.
    [[nodiscard]] band_of<S> unit() const { return unit_; }
    [[nodiscard]] vec3<T> position(std::size_t i) const { return tree_.position(static_cast<kd_slot>(i)); }
    /// Bytes in all.
    [[nodiscard]] std::size_t memory() const { return tree_.memory() + photons_.capacity() * sizeof(Item); }

    /// Tells the map how many photons come together, where single paths bring many: what may be where none came.
    void come_in_bunches(double photons) { bunch_ = std::max(1.0, photons); }

    /// Irradiance at `point` in W/m², from photons that arrived on the side that unit `normal` points out of; black
    /// where none are near. k nearest within the largest radius: with all k found, the k-1 inner ones over the disc of
    /// the k-th; with fewer, all over the largest disc. Together they are unbiased where the density is even. Where k
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
        auto e = sum(point, options, accept, weigh);
        // Nobody came, and yet with 95 % confidence up to three were to be expected (the rule of three): photons, or
        // bunches of them, where they come by few paths.
        if (e.count == 0 && e.radius > 0) {
            e.error = 3 / pi<band_of<S>> * brightest_ * unit_ * band_of<S>(bunch_) * band_of<S>(1 / square(e.radius));
        }
        return e;
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
        const T even = std::sqrt(area_ * static_cast<T>(count) / (pi<T> * static_cast<T>(size())));
        return std::max(4 * even, least_radius_);
    }

private:
    static constexpr std::size_t at_once = 8192;  ///< photons of one task
    struct nothing {};
    /// Whether items are rounded to the cells of a box.
    static constexpr bool packs =
        std::constructible_from<Item, const landed_photon<S, T>&, const S&, const place_cells<T>&, std::uint64_t>;

    /// Packs the photons into the cells of their box, in their own order, and indexes what came of them.
    template <typename Run>
    void index_packed(std::span<const landed_photon<S, T>> photons, std::vector<std::uint32_t>& sound,
                      band_of<S> factor, const Run& run) {
        std::erase_if(sound, [&](std::uint32_t i) { return !is_finite(length2(photons[i].position * T(0x1p-64))); });
        bounds<T> box;
        for (const std::uint32_t i : sound) { box.add(photons[i].position); }
        cells_ = place_cells<T>{box};
        std::vector<Item> packed(sound.size());
        for_each_block(run, sound.size(), at_once, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const landed_photon<S, T>& p = photons[sound[i]];
                packed[i] = Item{p, S(p.what.power * factor), cells_, sound[i]};
            }
        });
        tree_ = kd_tree<T>{packed, [&](const Item& p) { return p.position(cells_); }, run};
        photons_ = std::vector<Item>(tree_.size());
        for_each_block(run, photons_.size(), at_once, [&](std::size_t, std::size_t first, std::size_t last) {
            for (std::size_t slot = first; slot < last; ++slot) { photons_[slot] = packed[tree_.order()[slot]]; }
        });
    }

    template <typename Other>
    static std::vector<landed_photon<S, T>> landed_from(const photon_map<S, T, Other>& other) {
        std::vector<landed_photon<S, T>> all;
        all.reserve(other.size());
        for (std::size_t i = 0; i < other.size(); ++i) {
            const Other& p = other.photons()[i];
            all.push_back({other.position(i),
                           {p.flux() * other.unit(), packed_direction<std::int16_t>{p.template towards<T>()},
                            packed_direction<std::int16_t>{p.template facing<T>()}}});
        }
        return all;
    }

    void choose_unit(std::span<const landed_photon<S, T>> photons, T scale) {
        band_of<S> top = 0;
        for (const landed_photon<S, T>& p : photons) {
            if (is_radiance(p.what.power)) { top = std::max(top, max_component(p.what.power)); }
        }
        const band_of<S> faint = std::numeric_limits<band_of<S>>::min() * band_of<S>(0x1p40);
        if (top * band_of<S>(scale) < faint) { unit_ = band_of<S>(0x1p-64); }
    }

    void measure() {
        box_ = tree_.box();
        const vec3<T> e = box_.extent();
        area_ = 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
        const T far = empty() ? T(0) : std::max(max_abs(box_.low), max_abs(box_.high));
        least_radius_ = position_error(far);
        if constexpr (packs) { least_radius_ = std::max(least_radius_, 4 * cells_.error()); }
        for (const Item& p : photons_) { brightest_ = std::max(brightest_, max_component(p.flux())); }
    }

    /// The least radius that positions can tell, for a search as far as `reach`.
    [[nodiscard]] T least_radius(T reach) const { return std::max(least_radius_, position_error(reach)); }

    /// Side, plane and normal: what makes a photon one of this surface. Refused ones never count.
    [[nodiscard]] bool accepts(kd_slot i, const vec3<T>& point, const vec3<T>& normal,
                               const density_options& options) const {
        const Item& p = photons_[i];
        const vec3<T> away = tree_.position(i) - point;
        const T height = std::abs(glm::dot(away, normal)) - least_radius_;
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
        const std::uint32_t count = std::max(2u, options.count);
        const T reach = options.max_radius > 0 ? static_cast<T>(options.max_radius) : natural_radius(count);
        const auto found = tree_.nearest(point, count, scratch, {.radius2 = square(reach)}, accept);
        const T radius2 = found.radius2 * square(static_cast<T>(options.shrink));
        const T least2 = square(least_radius(reach));
        if (radius2 < least2) { return over(point, least2, options.kernel, accept, weigh); }
        return with_kernel(options.kernel, [&](auto kernel) {
            detail::density_sum<S, T, decltype(kernel)> sum{kernel, radius2, unit_};
            for (std::size_t i = 0; i < found.size(); ++i) {
                const kd_slot slot = found.slots[i];
                sum.add(found.distances2[i], tree_.position(slot) - point, photons_[slot], weigh);
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
        detail::density_sum<S, T, any_kernel> sum{{shape}, radius2, unit_};
        tree_.within(point, sum.radius2, [&](kd_slot i, T distance2) {
            if (accept(i)) { sum.add(distance2, tree_.position(i) - point, photons_[i], weigh); }
        });
        return sum.result();
    }

    kd_tree<T> tree_{};
    std::vector<Item> photons_{};
    [[no_unique_address]] std::conditional_t<packs, place_cells<T>, nothing> cells_{};
    bounds<T> box_{};
    T area_{0};
    T least_radius_{0};
    band_of<S> unit_{1};
    band_of<S> brightest_{0};  ///< the largest power of a photon
    std::size_t dropped_{0};
    double bunch_{1};
};

}  // namespace aglow
