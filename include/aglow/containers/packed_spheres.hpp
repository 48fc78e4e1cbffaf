// Spheres that stay, packed for the question which of them cover a point.
//
// A tree of boxes around spheres, sixteen wide: blocks of sixteen neighbours, nodes of sixteen blocks or nodes, all
// full. Spheres of very different size go into trees of their own. Packed R-trees: Kamel & Faloutsos 1993.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <aglow/containers/cell_directory.hpp>
#include <aglow/containers/near_spheres.hpp>
#include <aglow/containers/packed_boxes.hpp>
#include <aglow/containers/sphere_order.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// An index over spheres that no longer change. `const` calls are safe from many threads; building is in sequence,
/// O(n log n). Costs some 22 bytes a sphere (float).
template <typename T>
class packed_spheres {
public:
    packed_spheres() = default;
    /// Expects finite centres, the differences of which are finite, and a `limit2` above 0; spheres that lie farther
    /// apart may not be found.
    explicit packed_spheres(std::vector<stored_sphere<T>> spheres) : size_{spheres.size()} {
        std::vector<bounds<T>> boxes;
        for (const std::span<stored_sphere<T>> alike : detail::by_size(spheres)) {
            roots_.push_back(plant(alike, boxes));
        }
        blocks_.shrink_to_fit();
        items_.shrink_to_fit();
        nodes_.shrink_to_fit();
        directory_ =
            cell_directory<T>{boxes, [&](std::uint32_t i, const bounds<T>& cell) { return meets(blocks_[i], cell); }};
    }

    /// Adds to `found` what answers `question`, in no particular order.
    template <typename Question, bool D>
    void search(const Question& question, sphere_hits<T, D>& found) const {
        search_trees(question, found);
    }

    template <bool D>
    void search(const covering_question<T>& question, sphere_hits<T, D>& found) const {
        search(question, is_listed() ? directory_.list_near(question.point) : 0, found);
    }

    /// Calls `found(i, items)` with the spheres that cover `point_at(i)`, for i below `count`, in order. Goes on with
    /// several points in step and asks for memory ahead, which pays where the index does not fit into the caches; and
    /// looks through the index once for points in a row that lie together.
    template <typename PointAt, typename Found>
    void search_each(std::size_t count, const PointAt& point_at, Found&& found) const {
        std::array<vec3<T>, in_step> points;
        for (std::size_t first = 0; first < count; first += in_step) {
            const std::size_t some = std::min(in_step, count - first);
            for (std::size_t i = 0; i < some; ++i) {
                const auto& p = point_at(first + i);
                points[i].x = p.x, points[i].y = p.y, points[i].z = p.z;
            }
            search_some({points.data(), some},
                        [&](std::size_t i, std::span<const std::uint32_t> items) { found(first + i, items); });
        }
    }

    /// Calls `visitor(const stored_sphere<T>&)` for every sphere.
    template <typename Visitor>
    void visit_all(Visitor&& visitor) const {
        for (std::uint32_t place = 0; place < blocks_.size() * lanes; ++place) {
            const block& b = blocks_[place / lanes];
            const std::uint32_t i = place % lanes;
            if (b.limit2[i] > 0) { visitor(sphere{b.centre(i), b.limit2[i], item_at(place)}); }
        }
    }

    /// Which items these are, by place: neighbours follow each other, and a few places are `none`. From now on a find
    /// is a place: for an owner who lays out his items likewise.
    [[nodiscard]] std::vector<std::uint32_t> hand_out_items() { return std::exchange(items_, {}); }
    static constexpr std::uint32_t none = 0xffffffffu;

    [[nodiscard]] std::size_t size() const { return size_; }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const {
        return blocks_.capacity() * sizeof(block) + items_.capacity() * sizeof(std::uint32_t) +
               nodes_.capacity() * sizeof(node) + roots_.capacity() * sizeof(std::uint32_t) + directory_.bytes();
    }

private:
    static constexpr unsigned lanes = simd::lanes;
    static constexpr std::size_t in_step = 32;
    // From so many points of one cell on it pays to look for the spheres near all of them first.
    static constexpr std::size_t together = 3;
    // Where a cell lists more blocks than this, the trees are faster.
    static constexpr std::size_t crowded = 96;
    using sphere = stored_sphere<T>;
    struct alignas(64) block : sphere_lanes<T, lanes> {};

    // The boxes of sixteen children, blocks or nodes, from number `first` on.
    struct alignas(64) node {
        detail::packed_boxes<T> boxes;
        std::uint32_t first;
        std::uint16_t used;  // a bit for each child there is
        bool of_blocks;
    };

    // ---- search -----------------------------------------------------------------------------------------------------

    // Whether the lists of the directory are short enough to be asked for what covers a point.
    [[nodiscard]] bool is_listed() const { return directory_.longest() <= crowded; }

    // `list` as the directory says, where it is asked.
    template <bool D>
    void search(const covering_question<T>& question, std::uint32_t list, sphere_hits<T, D>& found) const {
        if (!is_listed()) { return search_trees(question, found); }
        directory_.visit_lists(
            list, [&](const std::uint32_t* numbers, std::uint32_t count) { ask(numbers, count, question, found); });
    }

    template <typename Question, bool D>
    void ask(const std::uint32_t* numbers, std::uint32_t count, const Question& question,
             sphere_hits<T, D>& found) const {
        const std::size_t known = found.size();
        simd::run_best<T, ask_blocks>(blocks_.data(), numbers, count, question, found);
        if (!items_.empty()) {
            found.rename(known, [this](std::uint32_t place) { return items_[place]; });
        }
    }
    [[nodiscard]] std::uint32_t item_at(std::uint32_t place) const { return items_.empty() ? place : items_[place]; }

    template <typename Found>
    [[gnu::always_inline]] void search_some(std::span<const vec3<T>> points, const Found& found) const {
        std::array<std::uint32_t, in_step> lists{};
        if (is_listed()) { find_lists(points, lists); }
        near_finds<T, in_step> shared;
        bool is_shared = false;
        for (std::size_t i = 0, last = 0; i < points.size(); ++i) {
            if (i == last) {
                while (last < points.size() && lists[last] == lists[i]) { ++last; }
                is_shared =
                    is_listed() && last - i >= together && search_near(lists[i], points.subspan(i, last - i), shared);
            }
            sphere_hits<T> hits;
            if (!is_shared) { search(covering_question<T>{points[i]}, lists[i], hits); }
            found(i, is_shared ? shared.next() : hits.items());
        }
    }

    // Searches for points that share a list; false where too many spheres are near.
    [[nodiscard]] bool search_near(std::uint32_t list, std::span<const vec3<T>> points,
                                   near_finds<T, in_step>& found) const {
        bounds<T> box;
        for (const vec3<T>& p : points) { box.add(p); }
        near_spheres<T> near;
        directory_.visit_lists(list, [&](const std::uint32_t* numbers, std::uint32_t count) {
            simd::run_best<T, detail::pick_near>(blocks_.data(), numbers, count, box, near);
        });
        if (!near.complete) { return false; }
        if (!items_.empty()) {
            for (std::size_t i = 0; i < near.count; ++i) { near.item[i] = items_[near.item[i]]; }
        }
        simd::run_best<T, detail::ask_near>(near, points.data(), points.size(), found.items.data(), found.ends.data());
        found.start();
        return true;
    }

    // Finds the lists of points and asks for the blocks in them.
    void find_lists(std::span<const vec3<T>> points, std::array<std::uint32_t, in_step>& lists) const {
        const bool far = blocks_.size() * sizeof(block) > simd::near_memory;
        if (far) {
            for (const vec3<T>& p : points) { directory_.expect(p); }
        }
        for (std::size_t i = 0; i < points.size(); ++i) { lists[i] = directory_.list_near(points[i]); }
        if (!far) { return; }
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (i > 0 && lists[i] == lists[i - 1]) { continue; }
            directory_.visit_lists(lists[i], [&](const std::uint32_t* numbers, std::uint32_t boxes) {
                for (std::uint32_t k = 0; k < boxes; ++k) { simd::prefetch_all(blocks_[numbers[k]]); }
            });
        }
    }

    template <typename Question, bool D>
    void search_trees(const Question& question, sphere_hits<T, D>& found) const {
        for (const std::uint32_t root : roots_) { search_tree(root, question, found); }
    }

    template <typename Question, bool D>
    void search_tree(std::uint32_t root, const Question& question, sphere_hits<T, D>& found) const {
        std::array<std::uint32_t, 8 * lanes> waiting;  // at most 15 of every level, and the last sixteen
        const bounds<T> asked = question.box();
        std::size_t count = 0;
        waiting[count++] = root;
        while (count != 0) {
            const node& at = nodes_[waiting[--count]];
            std::uint32_t near = at.boxes.near(asked) & at.used;
            if (at.of_blocks) {
                std::uint32_t numbers[lanes];
                std::uint32_t some = 0;
                for (; near != 0; near &= near - 1) { numbers[some++] = at.first + first_lane(near); }
                ask(&numbers[0], some, question, found);
            } else {
                for (; near != 0; near &= near - 1) { waiting[count++] = at.first + first_lane(near); }
            }
        }
    }

    [[nodiscard]] static std::uint32_t first_lane(std::uint32_t mask) {
        return static_cast<std::uint32_t>(std::countr_zero(mask));
    }

    // ---- build ------------------------------------------------------------------------------------------------------

    // Builds the tree over `alike`; returns its root.
    [[nodiscard]] std::uint32_t plant(std::span<sphere> alike, std::vector<bounds<T>>& all_boxes) {
        detail::arrange(alike);
        const auto first_block = static_cast<std::uint32_t>(blocks_.size());
        std::vector<bounds<T>> boxes;
        for (std::size_t i = 0; i < alike.size(); i += lanes) {
            boxes.push_back(add_block(alike.subspan(i, std::min<std::size_t>(lanes, alike.size() - i))));
        }
        all_boxes.insert(all_boxes.end(), boxes.begin(), boxes.end());
        std::uint32_t first = first_block;
        for (bool of_blocks = true;; of_blocks = false) {
            const auto next = static_cast<std::uint32_t>(nodes_.size());
            boxes = add_level(boxes, first, of_blocks);
            if (boxes.size() == 1) { return next; }
            first = next;
        }
    }

    // Whether a sphere of `b` reaches into `cell`.
    [[nodiscard]] static bool meets(const block& b, const bounds<T>& cell) {
        for (unsigned i = 0; i < lanes; ++i) {
            const vec3<T> nearest = glm::min(glm::max(b.centre(i), cell.low), cell.high);
            if (distance2(b.centre(i), nearest) <= b.limit2[i] * search_margin<T>) { return true; }
        }
        return false;
    }

    // Appends a block; returns the box around its spheres.
    bounds<T> add_block(std::span<const sphere> spheres) {
        block& made = blocks_.emplace_back();
        bounds<T> box;
        for (std::uint32_t i = 0; i < spheres.size(); ++i) {
            made.set(i, spheres[i].centre, spheres[i].limit2);
            items_.push_back(spheres[i].item);
            const T reach = spheres[i].radius() * search_margin<T>;
            box.add(spheres[i].centre - reach);
            box.add(spheres[i].centre + reach);
        }
        for (auto i = static_cast<std::uint32_t>(spheres.size()); i < lanes; ++i) {
            made.clear(i);
            items_.push_back(none);
        }
        return box;
    }

    // Appends the nodes over children with these boxes; returns the boxes of the nodes.
    std::vector<bounds<T>> add_level(const std::vector<bounds<T>>& children, std::uint32_t first, bool of_blocks) {
        std::vector<bounds<T>> boxes;
        for (std::size_t i = 0; i < children.size(); i += lanes) {
            const std::span some = std::span{children}.subspan(i, std::min<std::size_t>(lanes, children.size() - i));
            boxes.push_back(add_node(some));
            nodes_.back().first = first + static_cast<std::uint32_t>(i);
            nodes_.back().of_blocks = of_blocks;
        }
        return boxes;
    }

    bounds<T> add_node(std::span<const bounds<T>> children) {
        bounds<T> all;
        for (const bounds<T>& child : children) { all.add(child); }
        node& made = nodes_.emplace_back();
        made.boxes.pack(children, all);
        made.used = static_cast<std::uint16_t>((1u << children.size()) - 1u);
        return all;
    }

    std::size_t size_ = 0;
    std::vector<block> blocks_{};
    std::vector<std::uint32_t> items_{};  // by place; empty if places are all there is to find
    std::vector<node> nodes_{};
    std::vector<std::uint32_t> roots_{};
    cell_directory<T> directory_{};
};

}  // namespace aglow
