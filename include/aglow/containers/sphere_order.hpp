// Spheres in an order to pack them in: groups of like size, and neighbours side by side in each.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow::detail {

/// The diagonal of the box around the centres.
template <typename T>
[[nodiscard]] T extent_of(const std::vector<stored_sphere<T>>& spheres) {
    bounds<T> all;
    for (const stored_sphere<T>& s : spheres) { all.add(s.centre); }
    return all.diagonal();
}

/// About how many blocks of sixteen a search meets, were the centres spread over a square of half that diagonal.
template <typename T>
[[nodiscard]] T blocks_met(std::span<stored_sphere<T>> spheres, T size) {
    const T side = size / 2 * std::sqrt(T(simd::lanes) / T(spheres.size()));
    if (!(side > 0)) { return T(spheres.size()); }
    return square(1 + 2 * spheres.back().radius() / side);
}

/// Makes one of the last two groups if a search then meets no more blocks of sixteen; false if not.
template <typename T>
bool join_last(std::vector<std::span<stored_sphere<T>>>& groups, T size) {
    const std::span<stored_sphere<T>> large = groups.back();
    const std::span<stored_sphere<T>> small = groups[groups.size() - 2];
    const std::span<stored_sphere<T>> both{small.data(), small.size() + large.size()};
    if (blocks_met(both, size) > blocks_met(small, size) + blocks_met(large, size)) { return false; }
    groups.pop_back();
    groups.back() = both;
    return true;
}

/// The spheres in groups of like size, small ones first. Two groups are one where a search then meets fewer blocks.
template <typename T>
[[nodiscard]] std::vector<std::span<stored_sphere<T>>> by_size(std::vector<stored_sphere<T>>& spheres) {
    std::vector<std::span<stored_sphere<T>>> groups;
    std::sort(spheres.begin(), spheres.end(), [](const stored_sphere<T>& a, const stored_sphere<T>& b) {
        return a.limit2 < b.limit2 || (a.limit2 == b.limit2 && a.item < b.item);
    });
    const T size = extent_of(spheres);
    for (std::size_t first = 0; first < spheres.size();) {
        std::size_t last = first;
        const int octave = std::ilogb(spheres[first].limit2);
        while (last < spheres.size() && std::ilogb(spheres[last].limit2) == octave) { ++last; }
        groups.emplace_back(spheres.data() + first, last - first);
        while (groups.size() > 1 && join_last(groups, size)) {}
        first = last;
    }
    return groups;
}

/// The axis along which a box of that extent is longest.
template <typename T>
[[nodiscard]] int longest(const vec3<T>& e) {
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

/// Orders spheres so that sixteen, 256, 4096 … in a row are neighbours: halves along the longest side, at such
/// counts.
template <typename T>
void arrange(std::span<stored_sphere<T>> spheres) {
    if (spheres.size() <= simd::lanes) { return; }
    std::size_t unit = simd::lanes;
    while (unit * simd::lanes <= spheres.size() / 2) { unit *= simd::lanes; }
    const std::size_t half = (spheres.size() / 2 + unit / 2) / unit * unit;
    bounds<T> box;
    for (const stored_sphere<T>& s : spheres) { box.add(s.centre); }
    const int axis = longest(box.extent());
    std::nth_element(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(half), spheres.end(),
                     [axis](const stored_sphere<T>& a, const stored_sphere<T>& b) {
                         return a.centre[axis] < b.centre[axis] ||
                                (a.centre[axis] == b.centre[axis] && a.item < b.item);
                     });
    arrange(spheres.first(half));
    arrange(spheres.subspan(half));
}

}  // namespace aglow::detail
