// How a map keeps its photons: in the order of a tree over where they lie, packed or whole, bad numbers left out.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/containers/kd_tree.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/packed_place.hpp>
#include <aglow/core/parallel.hpp>
#include <aglow/core/ray.hpp>
#include <aglow/estimators/photon.hpp>

namespace aglow::detail {

/// Photons of spectrum `S`, an `Item` each, and what an estimate has to know of them all. Immutable once made.
template <Spectrum S, std::floating_point T, PhotonItem<S, T> Item>
class photon_store {
public:
    photon_store() = default;

    /// See `photon_map`.
    template <Executor Run>
    photon_store(std::span<const landed_photon<S, T>> photons, T scale, const Run& run) {
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

    [[nodiscard]] const kd_tree<T>& tree() const { return tree_; }
    [[nodiscard]] const std::vector<Item>& photons() const { return photons_; }
    [[nodiscard]] const bounds<T>& box() const { return box_; }
    /// Of the faces of the box.
    [[nodiscard]] T area() const { return area_; }
    /// The least radius that positions can tell.
    [[nodiscard]] T least_radius() const { return least_radius_; }
    /// What powers are counted in.
    [[nodiscard]] band_of<S> unit() const { return unit_; }
    /// The largest power of a photon.
    [[nodiscard]] band_of<S> brightest() const { return brightest_; }
    [[nodiscard]] std::size_t dropped() const { return dropped_; }

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
        std::erase_if(sound, [&](std::uint32_t i) { return !detail::is_usable(photons[i].position); });
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
        const T far = photons_.empty() ? T(0) : std::max(max_abs(box_.low), max_abs(box_.high));
        least_radius_ = position_error(far);
        if constexpr (packs) { least_radius_ = std::max(least_radius_, 4 * cells_.error()); }
        for (const Item& p : photons_) { brightest_ = std::max(brightest_, max_component(p.flux())); }
    }

    kd_tree<T> tree_{};
    std::vector<Item> photons_{};
    [[no_unique_address]] std::conditional_t<packs, place_cells<T>, nothing> cells_{};
    bounds<T> box_{};
    T area_{0};
    T least_radius_{0};
    band_of<S> unit_{1};
    band_of<S> brightest_{0};
    std::size_t dropped_{0};
};

/// The photons of a map, whole and in watts.
template <typename Map, typename S = typename Map::spectrum, typename T = typename Map::scalar>
[[nodiscard]] std::vector<landed_photon<S, T>> landed_from(const Map& map) {
    std::vector<landed_photon<S, T>> all;
    all.reserve(map.size());
    for (std::size_t i = 0; i < map.size(); ++i) {
        const auto& p = map.photons()[i];
        all.push_back({map.position(i),
                       {p.flux() * map.unit(), packed_direction<std::int16_t>{p.template towards<T>()},
                        packed_direction<std::int16_t>{p.template facing<T>()}}});
    }
    return all;
}

}  // namespace aglow::detail
