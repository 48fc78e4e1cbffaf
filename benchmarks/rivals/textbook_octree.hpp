// The octree of the textbooks, as a baseline: nodes on the heap, split at the centre, a list of records in each; a
// record is in every node that its box overlaps on the level where nodes are about as large as it (Ward 1988, pbrt-v2).
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/vec.hpp>

namespace rivals {

/// Finds records whose box overlaps the leaf of a point; the visitor tests the sphere. The bounds are fixed at the
/// start.
template <typename Record, typename T = float>
class textbook_octree {
public:
    using point = aglow::vec3<T>;
    using box = aglow::bounds<T>;

    explicit textbook_octree(const box& bounds, int max_depth = 21) : bounds_{bounds}, max_depth_{max_depth} {}

    void insert(const Record& record, const point& centre, T radius) {
        records_.push_back(std::make_unique<Record>(record));
        const box reach{centre - radius, centre + radius};
        insert(root_, bounds_, records_.back().get(), reach, aglow::length2(reach.extent()), 0);
    }

    /// Calls `visitor(const Record&)` for every record in the nodes around `p`.
    template <typename Visitor>
    void visit(const point& p, Visitor&& visitor) const {
        const node* at = &root_;
        box cube = bounds_;
        while (at) {
            for (const Record* record : at->records) { visitor(*record); }
            const point middle = cube.centre();
            const unsigned i = unsigned{p.x > middle.x} | unsigned{p.y > middle.y} << 1 | unsigned{p.z > middle.z} << 2;
            cube = octant(cube, middle, i);
            at = at->children[i].get();
        }
    }

    /// Bytes on the heap, counted as the allocator rounds them.
    [[nodiscard]] std::size_t bytes() const {
        return records_.size() * (block(sizeof(Record)) + sizeof(void*)) + bytes(root_) - sizeof(node);
    }

private:
    struct node {
        std::array<std::unique_ptr<node>, 8> children;
        std::vector<const Record*> records;
    };

    static std::size_t block(std::size_t size) { return size == 0 ? 0 : (size + 8 + 15) / 16 * 16; }

    static std::size_t bytes(const node& at) {
        std::size_t sum = block(sizeof(node)) + block(at.records.capacity() * sizeof(void*));
        for (const auto& child : at.children) { sum += child ? bytes(*child) : 0; }
        return sum;
    }

    static box octant(const box& cube, const point& middle, unsigned i) {
        return {{i & 1u ? middle.x : cube.low.x, i & 2u ? middle.y : cube.low.y, i & 4u ? middle.z : cube.low.z},
                {i & 1u ? cube.high.x : middle.x, i & 2u ? cube.high.y : middle.y, i & 4u ? cube.high.z : middle.z}};
    }

    static bool overlap(const box& a, const box& b) {
        return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
               a.low.z <= b.high.z && b.low.z <= a.high.z;
    }

    void insert(node& at, const box& cube, const Record* record, const box& reach, T diagonal2, int depth) {
        if (depth == max_depth_ || aglow::length2(cube.extent()) < diagonal2) {
            at.records.push_back(record);
            return;
        }
        const point middle = cube.centre();
        for (unsigned i = 0; i < 8; ++i) {
            const box below = octant(cube, middle, i);
            if (!overlap(below, reach)) { continue; }
            if (!at.children[i]) { at.children[i] = std::make_unique<node>(); }
            insert(*at.children[i], below, record, reach, diagonal2, depth + 1);
        }
    }

    box bounds_;
    int max_depth_;
    node root_{};
    std::vector<std::unique_ptr<Record>> records_{};
};

}  // namespace rivals
