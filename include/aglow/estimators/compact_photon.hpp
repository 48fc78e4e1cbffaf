// A photon in sixteen bytes, its place included: for maps of many photons, and for keeping and sending them.
//
// Each part is read back at the centre of its cell or rounded by chance, so that no mean is shifted.
#pragma once

#include <concepts>
#include <cstdint>

#include <aglow/core/octahedral.hpp>
#include <aglow/core/packed_place.hpp>
#include <aglow/core/shared_exponent.hpp>
#include <aglow/estimators/photon.hpp>

namespace aglow {

/// Power in four bytes.
template <typename S>
struct packed_power;

/// Gray is exact.
template <>
struct packed_power<float> {
    float power{0};
    packed_power() = default;
    packed_power(float p, std::uint64_t) : power{p} {}
    [[nodiscard]] float value() const { return power; }
};
template <>
struct packed_power<vec3<float>> : shared_exponent {
    using shared_exponent::shared_exponent;
};

/// A spectrum whose power fits into four bytes: gray or RGB, in float.
template <typename S>
concept CompactSpectrum = Spectrum<S> && requires(const S& power) {
    requires sizeof(packed_power<S>) == 4;
    { packed_power<S>{power, std::uint64_t{}}.value() } -> std::same_as<S>;
};

/// A photon and its place among the `place_cells` of its map. Places are within half a cell, 2.4e-7 of the box;
/// directions within 0.0168 rad; power within 1/127 of its largest band, and right in the mean.
template <CompactSpectrum S>
class compact_photon {
public:
    compact_photon() = default;

    /// `word` names the photon: another one is rounded by another chance.
    template <std::floating_point T>
    compact_photon(const landed_photon<S, T>& p, const S& power, const place_cells<T>& cells, std::uint64_t word)
        : cell_{cells.cell(p.position)},
          power_{power, mix(word, 0x636f6d70616374u)},
          wi_{above(p.what.wi.template direction<T>(), p.what.normal.template direction<T>())},
          normal_{p.what.normal.template direction<T>()} {}

    [[nodiscard]] S flux() const { return power_.value(); }
    template <typename T>
    [[nodiscard]] vec3<T> towards() const {
        return wi_.template direction<T>();
    }
    template <typename T>
    [[nodiscard]] vec3<T> facing() const {
        return normal_.template direction<T>();
    }
    template <typename T>
    [[nodiscard]] vec3<T> position(const place_cells<T>& cells) const {
        return cells.centre(cell_);
    }

    template <typename T>
    [[nodiscard]] bool arrived_on(const vec3<T>& n) const {
        return glm::dot(wi_.template along<T>(), n) > 0;
    }
    template <typename T>
    [[nodiscard]] bool faces(const vec3<T>& n, T cosine) const {
        // Of squares, so that there is no root to take.
        const vec3<T> along = normal_.template along<T>();
        const T d = glm::dot(along, n);
        const T least2 = square(cosine) * length2(along);
        return cosine > 0 ? d > 0 && d * d >= least2 : d >= 0 || d * d <= least2;
    }

private:
    /// What came from above `n` still does when it is rounded: else grazing photons would be lost to their surface.
    template <typename T>
    [[nodiscard]] static coarse_octahedral above(const vec3<T>& wi, const vec3<T>& n) {
        coarse_octahedral packed{wi};
        if (!(glm::dot(wi, n) > 0)) { return packed; }
        for (T up = T(1) / 128; up < 1 && !(glm::dot(packed.along<T>(), n) > 0); up *= 2) {
            packed = coarse_octahedral{wi + n * up};
        }
        return packed;
    }

    std::uint64_t cell_{0};
    packed_power<S> power_{};
    coarse_octahedral wi_{};
    coarse_octahedral normal_{};
};

}  // namespace aglow
