// Which of many boxes are near a point, looked up by the cell that the point lies in.
//
// An octree over boxes that stay. A box is listed in each leaf it meets; boxes that fill a whole cell are listed there,
// and the leaves below link up to that list.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// An index over boxes, by number. `const` calls are safe from many threads.
template <typename T>
class cell_directory {
public:
    cell_directory() = default;

    /// Over `boxes`; lists none that together are wider than a number can be. `meets(number, cell)` may sharpen a box:
    /// false if what is in it has nothing to do with that cell.
    template <typename Meets>
    cell_directory(const std::vector<bounds<T>>& boxes, const Meets& meets);

    /// Asks for the memory that `list_near` reads.
    void expect(const vec3<T>& point) const {
        if (all_.contains(point)) { simd::prefetch(&starts_[start_of(cell_of(point))]); }
    }
    /// Where the lists begin that together hold each box that contains `point` once, and maybe others; 0 for none. Asks
    /// for the memory of the first.
    [[nodiscard]] std::uint32_t list_near(const vec3<T>& point) const {
        const std::uint32_t list = all_.contains(point) ? list_at(cell_of(point)) : 0;
        simd::prefetch(lists_.data() + list);
        return list;
    }
    /// Calls `visitor(numbers, count)` for the lists from `list` on.
    template <typename Visitor>
    void visit_lists(std::uint32_t list, Visitor&& visitor) const {
        for (; list != 0; list = lists_[list]) { visitor(lists_.data() + list + 2, lists_[list + 1]); }
    }

    /// The longest list of a leaf: what a search has to look at where boxes crowd.
    [[nodiscard]] std::size_t longest() const { return longest_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const {
        return bricks_.capacity() * sizeof(brick) + (lists_.capacity() + starts_.capacity()) * sizeof(std::uint32_t);
    }

private:
    // Coordinates in units of the smallest cell, of which there are 2^depth along each side of the root.
    struct cell {
        std::uint32_t x, y, z;

        // Which octant it lies in, of its cell at the level whose bit that is.
        [[nodiscard]] unsigned octant(int bit) const {
            return (x >> bit & 1u) | (y >> bit & 1u) << 1 | (z >> bit & 1u) << 2;
        }
    };
    struct range {
        cell low, high;
    };
    // What is in each octant of a cell: another brick, or a list if `leaf` is set, or nothing if 0.
    using brick = std::array<std::uint32_t, 8>;

    static constexpr int depth = 20;
    // The power of two that is the most cells a length can have, so that a cell has a length.
    static constexpr int finest = std::numeric_limits<T>::max_exponent - 2;
    static constexpr std::uint32_t leaf = 0x80000000u;
    // A leaf with more boxes than this is divided, if that helps.
    static constexpr std::size_t enough = 10;
    // A way down through the bricks is more than a few bytes are worth: its turns are hard to foresee.
    static constexpr std::size_t starts_per_box = 16;

    template <typename Meets>
    class builder;

    [[nodiscard]] cell cell_of(const vec3<T>& p) const {
        const vec3<T> c = (p - all_.low) * cells_per_length_;
        return {coordinate(c.x), coordinate(c.y), coordinate(c.z)};
    }
    [[nodiscard]] static std::uint32_t coordinate(T x) {
        return static_cast<std::uint32_t>(std::min(static_cast<std::int32_t>(x), (1 << depth) - 1));
    }

    [[nodiscard]] std::uint32_t list_at(const cell& c) const {
        std::uint32_t at = starts_[start_of(c)];
        for (int bit = depth - start_levels_; at != 0 && (at & leaf) == 0;) { at = bricks_[at][c.octant(--bit)]; }
        return at & ~leaf;
    }
    [[nodiscard]] std::uint32_t start_of(const cell& c) const {
        const int bits = depth - start_levels_;
        return ((c.z >> bits << start_levels_ | c.y >> bits) << start_levels_) | c.x >> bits;
    }

    void halve_starts();

    bounds<T> all_{};
    T cells_per_length_ = 0;
    int start_levels_ = 0;
    std::size_t longest_ = 0;
    std::vector<brick> bricks_{};
    // Lists one after another: the list to go on with or 0, the number of boxes, and the boxes.
    std::vector<std::uint32_t> lists_{};
    // What a brick says, for each cell of a level a little down.
    std::vector<std::uint32_t> starts_{};
};

/// What a build needs besides its result.
template <typename T>
template <typename Meets>
class cell_directory<T>::builder {
public:
    using numbers = std::vector<std::uint32_t>;

    builder(cell_directory& made, const std::vector<bounds<T>>& boxes, const Meets& meets)
        : made_{made}, meets_{meets} {
        for (const bounds<T>& box : boxes) { ranges_.push_back({made.cell_of(box.low), made.cell_of(box.high)}); }
    }

    // What a brick should say of the cell that begins at `corner` and is 2^bits wide: the boxes `in` it, and the list
    // `up`.
    [[nodiscard]] std::uint32_t fill(const cell& corner, int bits, numbers in, std::uint32_t up) {
        if (in.empty() && up == 0) { return 0; }
        if (in.size() <= enough || bits == 0) { return add_leaf(corner, bits, in, up); }
        const auto partial =
            std::partition(in.begin(), in.end(), [&](std::uint32_t i) { return fills(i, corner, bits); });
        const auto partials = static_cast<std::size_t>(in.end() - partial);
        std::array<numbers, 8> below;
        std::size_t sum = 0, used = 0;
        for (unsigned octant = 0; octant < 8; ++octant) {
            const cell low = child(corner, bits - 1, octant);
            std::copy_if(partial, in.end(), std::back_inserter(below[octant]),
                         [&](std::uint32_t i) { return overlaps(i, low, bits - 1); });
            sum += below[octant].size();
            used += !below[octant].empty();
        }
        if (partials <= enough / 2 || 10 * sum > 6 * partials * used) { return add_leaf(corner, bits, in, up); }
        in.resize(in.size() - partials);
        const std::uint32_t link = in.empty() ? up : add_list(in, up);
        return divide(corner, bits - 1, below, link);
    }

private:
    [[nodiscard]] std::uint32_t divide(const cell& corner, int bits, std::array<numbers, 8>& below, std::uint32_t up) {
        const auto made = static_cast<std::uint32_t>(made_.bricks_.size());
        made_.bricks_.emplace_back();
        for (unsigned octant = 0; octant < 8; ++octant) {
            const std::uint32_t said = fill(child(corner, bits, octant), bits, std::move(below[octant]), up);
            made_.bricks_[made][octant] = said;
        }
        return made;
    }

    [[nodiscard]] std::uint32_t add_leaf(const cell& corner, int bits, numbers& in, std::uint32_t up) {
        const bounds<T> box = box_of(corner, bits);
        std::erase_if(in, [&](std::uint32_t i) { return !meets_(i, box); });
        if (in.empty()) { return up == 0 ? 0 : up | leaf; }
        made_.longest_ = std::max(made_.longest_, in.size());
        return add_list(in, up) | leaf;
    }

    [[nodiscard]] std::uint32_t add_list(const numbers& in, std::uint32_t up) {
        const auto at = static_cast<std::uint32_t>(made_.lists_.size());
        made_.lists_.push_back(up);
        made_.lists_.push_back(static_cast<std::uint32_t>(in.size()));
        made_.lists_.insert(made_.lists_.end(), in.begin(), in.end());
        return at;
    }

    // The points of a cell, and half a smallest cell around for the rounding of coordinates.
    [[nodiscard]] bounds<T> box_of(const cell& c, int bits) const {
        const T length = 1 / made_.cells_per_length_;
        const vec3<T> low = made_.all_.low + (vec3<T>{c.x, c.y, c.z} - T(0.5)) * length;
        return {low, low + T((1u << bits) + 1) * length};
    }
    [[nodiscard]] static cell child(const cell& c, int bits, unsigned octant) {
        const std::uint32_t half = 1u << bits;
        return {c.x + (octant & 1u ? half : 0u), c.y + (octant & 2u ? half : 0u), c.z + (octant & 4u ? half : 0u)};
    }
    [[nodiscard]] bool fills(std::uint32_t i, const cell& c, int bits) const {
        const std::uint32_t last = (1u << bits) - 1;
        const range& r = ranges_[i];
        return r.low.x <= c.x && r.low.y <= c.y && r.low.z <= c.z && r.high.x >= c.x + last && r.high.y >= c.y + last &&
               r.high.z >= c.z + last;
    }
    [[nodiscard]] bool overlaps(std::uint32_t i, const cell& c, int bits) const {
        const std::uint32_t last = (1u << bits) - 1;
        const range& r = ranges_[i];
        return r.low.x <= c.x + last && r.low.y <= c.y + last && r.low.z <= c.z + last && r.high.x >= c.x &&
               r.high.y >= c.y && r.high.z >= c.z;
    }

    cell_directory& made_;
    const Meets& meets_;
    std::vector<range> ranges_{};
};

template <typename T>
template <typename Meets>
cell_directory<T>::cell_directory(const std::vector<bounds<T>>& boxes, const Meets& meets) {
    bounds<T> all;
    for (const bounds<T>& b : boxes) { all.add(b); }
    if (all.empty()) { return; }
    // Boxes that are all one point, as tiny spheres far from the origin are, lie in a cell of any size.
    const T widest = std::max(max_abs(all.extent()), std::numeric_limits<T>::min());
    if (!(widest < std::numeric_limits<T>::max())) { return; }
    all_ = all;
    cells_per_length_ = std::ldexp(T(1), std::min(depth - 1 - std::ilogb(widest), finest));
    std::vector<std::uint32_t> numbers(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) { numbers[i] = static_cast<std::uint32_t>(i); }
    bricks_.emplace_back();  // brick 0 and list 0 mean none
    lists_.push_back(0);
    starts_.push_back(builder<Meets>{*this, boxes, meets}.fill({0, 0, 0}, depth, std::move(numbers), 0));
    bricks_.shrink_to_fit();
    lists_.shrink_to_fit();
    const auto is_brick = [](std::uint32_t start) { return start != 0 && (start & leaf) == 0; };
    while (8 * starts_.size() <= starts_per_box * boxes.size() &&
           std::any_of(starts_.begin(), starts_.end(), is_brick)) {
        halve_starts();
    }
}

// Says what the bricks say one level further down.
template <typename T>
void cell_directory<T>::halve_starts() {
    const int next = start_levels_ + 1;
    std::vector<std::uint32_t> finer(std::size_t{1} << 3 * next);
    for (std::uint32_t i = 0; i < finer.size(); ++i) {
        const std::uint32_t side = (1u << next) - 1;
        const cell c{i & side, i >> next & side, i >> 2 * next};
        const std::uint32_t above =
            starts_[start_of({c.x << (depth - next), c.y << (depth - next), c.z << (depth - next)})];
        finer[i] = above == 0 || (above & leaf) != 0 ? above : bricks_[above][c.octant(0)];
    }
    starts_.swap(finer);
    start_levels_ = next;
}

}  // namespace aglow
