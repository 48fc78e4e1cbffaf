// Spheres that keep coming, in trees of loose cubes; who searches never waits for who inserts.
//
// A sphere goes down the path of its centre to the first node with room, at the latest to the node as wide as the
// sphere, and never moves again. A node is a list of blocks of eight, published by one atomic store; a search descends
// only where the largest radius below a node can reach. Loose octrees: Ulrich 2000.
#pragma once

#include <atomic>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include <aglow/containers/loose_cube.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/containers/stable_array.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// An index of spheres, by number. Threads: one may insert while any number search; no search waits or tries again. A
/// search finds every sphere whose insertion happened before it, and of those inserted meanwhile any.
///
/// No bounds are asked for; the trees grow to where the spheres are. Scaling all by a power of two changes nothing.
template <std::floating_point T>
class loose_octree {
public:
    loose_octree() = default;

    /// Takes all spheres. Expects that nobody searches either one meanwhile; so does the assignment.
    loose_octree(loose_octree&& other) noexcept { swap(other); }
    loose_octree& operator=(loose_octree&& other) noexcept {
        loose_octree gone{std::move(other)};
        swap(gone);
        return *this;
    }
    ~loose_octree() = default;

    /// O(depth). Expects a finite centre, and a radius whose square is a normal number.
    void insert(const stored_sphere<T>& sphere, T radius) { append(home(sphere.centre, radius), sphere); }

    /// Takes a sphere into the list that every search looks at.
    void insert_outside(const stored_sphere<T>& sphere) { append(outside_, sphere); }

    /// Whether a centre is so far away that no cube can hold it: it waits outside for good.
    [[nodiscard]] static bool is_far(const vec3<T>& centre) { return max_abs(centre) >= farthest; }

    /// Adds to `found` what answers `question`, in no particular order.
    template <typename Question, bool D>
    void search(const Question& question, sphere_hits<T, D>& found) const {
        ask_list(outside_, question, found);
        const T reach = question.reach(largest_.load(std::memory_order_relaxed));
        for (unsigned near = everything.octants_near(question.point, reach); near != 0; near &= near - 1) {
            const root* const top = tops_[std::countr_zero(near)].load(std::memory_order_acquire);
            if (top) { descend({top->box, &top->inside}, question, found); }
        }
    }

    /// Calls `visitor(const stored_sphere<T>&)` for every sphere; for the writer.
    template <typename Visitor>
    void visit_all(Visitor&& visitor) const {
        visit_list(outside_, visitor);
        for (const auto& top : tops_) {
            if (top.load()) { visit_list(top.load()->inside, visitor); }
        }
        for (std::uint32_t i = 0; i < bricks_.size(); ++i) {
            for (const cell& octant : bricks_[i].octants) { visit_list(octant, visitor); }
        }
    }

    /// Bytes taken from the heap; for the writer.
    [[nodiscard]] std::size_t bytes() const { return links_.bytes() + bricks_.bytes() + roots_.bytes(); }

private:
    static constexpr unsigned lanes = 8;
    using block = sphere_block<T, lanes>;
    using word = std::atomic<std::uint32_t>;
    using cube = detail::loose_cube<T>;

    // A block and what hangs on it: `next` is the word of the block before this one (always full), `length` counts both
    // and all before.
    struct link : block {
        std::uint32_t next;
        std::uint32_t length;
    };

    // What is in a cube. `spheres`: (number of the newest block << 4 | how many of its lanes are in use), 0 if none.
    // `children`: the brick of its eight octants, 0 if none.
    struct cell {
        word spheres{0};
        word children{0};
    };

    // Eight octants; no sphere in or below any of them is larger than `largest`.
    struct brick {
        cell octants[8];
        std::atomic<T> largest{0};
    };

    // Where a tree begins, and the cube it covers. Roots that were outgrown stay for the readers that look at them.
    struct root {
        cube box;
        std::uint32_t number = 0;
        cell inside{};
    };

    template <typename Cell>
    struct place {
        cube box;
        Cell* inside;
    };

    static constexpr unsigned lane_bits = 4;
    static constexpr unsigned lane_mask = 15;
    // A node takes sixteen spheres before it hands on to its octants.
    static constexpr std::uint32_t blocks_before_octants = 2;
    // A sphere that would double the root more often than this waits outside, if there is room.
    static constexpr int patient_doublings = 12;
    static constexpr std::uint32_t blocks_outside = 8;
    static constexpr T farthest = std::numeric_limits<T>::max() / 32;
    static constexpr cube everything{vec3<T>{0}, std::numeric_limits<T>::max()};

    // ---- writing ----------------------------------------------------------------------------------------------------

    // The cell that takes a new sphere.
    [[nodiscard]] cell& home(const vec3<T>& centre, T radius) {
        const unsigned signs = everything.octant_of(centre);
        const root* top = tops_[signs].load(std::memory_order_relaxed);
        if (belongs_outside(top, centre, radius)) { return outside_; }
        if (!top) { top = plant(signs, centre, radius); }
        while (!top->box.holds(centre, radius)) { top = grow(signs, *top); }
        raise(largest_, radius);
        place<cell> at{top->box, &roots_[top->number].inside};
        while (full(*at.inside, blocks_before_octants) && at.box.half / 2 >= radius && at.box.divisible()) {
            brick& below = octants_of(*at.inside);
            raise(below.largest, radius);
            const unsigned i = at.box.octant_of(centre);
            at = {at.box.octant(i), &below.octants[i]};
        }
        return *at.inside;
    }

    static void raise(std::atomic<T>& largest, T radius) {
        if (largest.load(std::memory_order_relaxed) < radius) { largest.store(radius, std::memory_order_relaxed); }
    }

    [[nodiscard]] bool belongs_outside(const root* top, const vec3<T>& centre, T radius) const {
        if (is_far(centre)) { return true; }
        if (!top || full(outside_, blocks_outside)) { return false; }
        return (max_abs(centre - top->box.middle) + radius) / top->box.half > T(1 << patient_doublings);
    }

    // The first root.
    const root* plant(unsigned signs, const vec3<T>& centre, T radius) {
        return publish(signs, roots_.append(cube::around_sphere(centre, radius)));
    }

    // A root twice as wide around the present one, which becomes an octant of it.
    const root* grow(unsigned signs, const root& old) {
        const cube wider = old.box.doubled();
        const std::uint32_t number = bricks_.append();
        brick& below = bricks_[number];
        copy(old.inside, below.octants[wider.octant_of(old.box.middle)]);
        below.largest.store(largest_.load(std::memory_order_relaxed), std::memory_order_relaxed);
        const std::uint32_t made = roots_.append(wider);
        roots_[made].inside.children.store(number + 1, std::memory_order_release);
        return publish(signs, made);
    }

    const root* publish(unsigned signs, std::uint32_t number) {
        roots_[number].number = number;
        tops_[signs].store(&roots_[number], std::memory_order_release);
        return &roots_[number];
    }

    static void copy(const cell& from, cell& to) {
        to.spheres.store(from.spheres.load(std::memory_order_relaxed), std::memory_order_relaxed);
        to.children.store(from.children.load(std::memory_order_relaxed), std::memory_order_relaxed);
    }

    [[nodiscard]] brick& octants_of(cell& parent) {
        const std::uint32_t known = parent.children.load(std::memory_order_relaxed);
        if (known != 0) { return bricks_[known - 1]; }
        const std::uint32_t number = bricks_.append();
        parent.children.store(number + 1, std::memory_order_release);
        return bricks_[number];
    }

    [[nodiscard]] bool full(const cell& at, std::uint32_t blocks) const {
        const std::uint32_t newest = at.spheres.load(std::memory_order_relaxed);
        return (newest & lane_mask) == lanes && links_[newest >> lane_bits].length >= blocks;
    }

    void append(cell& at, const stored_sphere<T>& sphere) {
        std::uint32_t newest = at.spheres.load(std::memory_order_relaxed);
        if (newest == 0 || (newest & lane_mask) == lanes) { newest = add_block(newest); }
        links_[newest >> lane_bits].set(newest & lane_mask, sphere);
        at.spheres.store(newest + 1, std::memory_order_release);
    }

    // The word of a new empty block that follows `before`.
    [[nodiscard]] std::uint32_t add_block(std::uint32_t before) {
        const std::uint32_t length = before == 0 ? 1 : links_[before >> lane_bits].length + 1;
        if (links_.size() >> (32 - lane_bits) != 0) { throw std::length_error("aglow::octree: too many items"); }
        const std::uint32_t number = links_.append();
        links_[number].next = before;
        links_[number].length = length;
        return number << lane_bits;
    }

    // ---- reading ----------------------------------------------------------------------------------------------------

    template <typename Visitor>
    void visit_list(const cell& at, Visitor&& visitor) const {
        for (std::uint32_t newest = at.spheres.load(); newest != 0; newest = links_[newest >> lane_bits].next) {
            for (std::uint32_t i = 0; i < (newest & lane_mask); ++i) { visitor(links_[newest >> lane_bits].at(i)); }
        }
    }

    template <typename Question, bool D>
    void ask_list(const cell& at, const Question& question, sphere_hits<T, D>& found) const {
        std::uint32_t newest = at.spheres.load(std::memory_order_acquire);
        while (newest != 0) {
            const link& here = links_[newest >> lane_bits];
            found.reserve(lanes);
            ask(here, newest & lane_mask, question, found);
            newest = here.next;
        }
    }

    // Depth first on a small stack of its own; a tree too deep for it goes on in a call of this function.
    template <typename Question, bool D>
    void descend(const place<const cell>& from, const Question& question, sphere_hits<T, D>& found) const {
        constexpr std::size_t room = 64;
        place<const cell> waiting[room];
        std::size_t count = 0;
        waiting[count++] = from;
        while (count != 0) {
            const place<const cell> at = waiting[--count];
            ask_list(*at.inside, question, found);
            const std::uint32_t children = at.inside->children.load(std::memory_order_acquire);
            if (children == 0) { continue; }
            const brick& below = bricks_[children - 1];
            const T reach = question.reach(below.largest.load(std::memory_order_relaxed));
            for (unsigned near = at.box.octants_near(question.point, reach); near != 0; near &= near - 1) {
                const auto i = static_cast<unsigned>(std::countr_zero(near));
                const place<const cell> child{at.box.octant(i), &below.octants[i]};
                if (count < room) {
                    waiting[count++] = child;
                } else {
                    descend(child, question, found);
                }
            }
        }
    }

    void swap(loose_octree& other) noexcept {
        std::swap(links_, other.links_);
        std::swap(bricks_, other.bricks_);
        std::swap(roots_, other.roots_);
        cell kept;
        copy(outside_, kept);
        copy(other.outside_, outside_);
        copy(kept, other.outside_);
        for (unsigned i = 0; i < 8; ++i) { tops_[i].store(other.tops_[i].exchange(tops_[i].load())); }
        largest_.store(other.largest_.exchange(largest_.load()));
    }

    stable_array<link> links_{};
    stable_array<brick> bricks_{};
    stable_array<root> roots_{};
    // One tree for each combination of signs, so that a cube need never grow across zero.
    std::atomic<const root*> tops_[8] = {};
    // Spheres much larger than their root, or much farther than it should grow for them.
    cell outside_{};
    // No sphere in the trees is larger.
    std::atomic<T> largest_{0};
};

}  // namespace aglow
