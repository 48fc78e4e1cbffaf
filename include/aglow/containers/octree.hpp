// Items with a sphere of influence that keep coming, and which of them cover a point; who reads never waits for who
// writes.
//
// What has come lately is in the trees of a loose_octree; what the owner lets settle is packed for faster searches.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <aglow/containers/loose_octree.hpp>
#include <aglow/containers/packed_spheres.hpp>
#include <aglow/containers/sphere_search.hpp>
#include <aglow/containers/stable_array.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// What became of an item that was handed to an octree.
enum class octree_status {
    inserted,
    /// The radius is NaN, infinite, negative, zero, or so extreme that its square is no normal number.
    bad_radius,
    /// A coordinate of the centre is NaN or infinite.
    bad_centre
};

/// An insertion's outcome: true if the item went in, and then its number, counted from 0 in the order of insertion.
struct octree_insertion {
    octree_status status;
    std::uint32_t index;

    explicit operator bool() const { return status == octree_status::inserted; }
};

/// How many insertions an octree refused, by reason.
struct octree_refusals {
    std::size_t radius = 0;
    std::size_t centre = 0;
};

/// What can be shown an item, alone or with its number.
template <typename Visitor, typename Item>
concept ItemVisitor = std::invocable<Visitor&, const Item&> || std::invocable<Visitor&, const Item&, std::uint32_t>;

/// Items with a sphere of influence each. Tells whose sphere covers a point, and whose centre is near one.
///
/// Threads: one may insert while any number search; no search waits or tries again. A search finds every item whose
/// insertion happened before it, and of those inserted meanwhile any. Several writers take turns by a lock of their
/// own.
///
/// Order: a search shows its finds in the order of their insertion, whatever the index looks like inside.
///
/// Space: no bounds are asked for; the trees grow to where the items are. Scaling all input by a power of two changes
/// nothing. Distances are those of `simd::distance2`, to the bit.
///
/// Memory and speed: an item never moves and costs some 25 to 35 bytes beside its own (float). Insertion is fast;
/// searches are four to eight times faster for what has been through `settle`.
template <typename Item, std::floating_point T = float>
class octree {
public:
    octree() = default;

    /// Takes all items. Expects that nobody searches either octree meanwhile; so does the assignment.
    octree(octree&& other) noexcept { swap(other); }
    octree& operator=(octree&& other) noexcept {
        octree gone{std::move(other)};
        swap(gone);
        return *this;
    }
    ~octree() = default;

    /// Stores `item` with its sphere of influence; a bad sphere is refused, counted, and changes nothing. `radius` is
    /// the largest the item will ever have: it may shrink later (`visit_covering` with `radius_of`), never grow.
    /// O(depth). Throws `std::length_error` after 2^31 items.
    octree_insertion insert(Item item, const vec3<T>& centre, T radius) {
        if (!usable_radius(radius)) { return ++refused_.radius, octree_insertion{octree_status::bad_radius, 0}; }
        if (!is_finite(centre.x) || !is_finite(centre.y) || !is_finite(centre.z)) {
            return ++refused_.centre, octree_insertion{octree_status::bad_centre, 0};
        }
        const std::uint32_t index = items_.append(std::move(item));
        latest_.insert({centre, limit2_of(radius), index}, radius);
        published_.store(index + 1, std::memory_order_release);
        return {octree_status::inserted, index};
    }

    /// Calls `visitor(const Item&)`, or `visitor(const Item&, number)`, for each item whose sphere, as inserted, covers
    /// `point`: distance <= radius. A visitor that returns bool ends the visit by false.
    template <typename Visitor>
        requires ItemVisitor<Visitor, Item>
    void visit_covering(const vec3<T>& point, Visitor&& visitor) const {
        sphere_hits<T> found;
        search(covering_question<T>{point}, found);
        found.show(items_, visitor);
    }

    /// As above for spheres that have shrunk: `radius_of(const Item&)` tells an item's present radius, at most the one
    /// at insertion. If items shrink while others search, let both sides use `std::atomic_ref` on the item's radius.
    template <typename RadiusOf, typename Visitor>
        requires std::invocable<RadiusOf&, const Item&> && ItemVisitor<Visitor, Item>
    void visit_covering(const vec3<T>& point, RadiusOf&& radius_of, Visitor&& visitor) const {
        sphere_hits<T, true> found;
        search(covering_question<T>{point}, found);
        found.keep_if([&](std::uint32_t i, T distance2) { return distance2 <= square<T>(radius_of(items_[i])); });
        found.show(items_, visitor);
    }

    /// Calls `visitor`, as `visit_covering` does, for each item whose centre lies within `distance` of `point`, borders
    /// included; for none if `distance` is negative or NaN.
    template <typename Visitor>
        requires ItemVisitor<Visitor, Item>
    void visit_within(const vec3<T>& point, T distance, Visitor&& visitor) const {
        if (!(distance >= 0)) { return; }
        sphere_hits<T> found;
        search(within_question<T>{point, distance}, found);
        found.show(items_, visitor);
    }

    /// Packs what has come so far for faster searches and less memory; answers, order and addresses stay. O(n log n),
    /// in sequence. Worth it when items come no more. Expects that nobody searches meanwhile.
    void settle() {
        settle([](const Item&) { return std::numeric_limits<T>::max(); });
    }

    /// The same, and takes over the present radii, `radius_of(const Item&)`, where they have shrunk.
    template <typename RadiusOf>
        requires std::invocable<RadiusOf&, const Item&>
    void settle(RadiusOf&& radius_of) { pack(radius_of, std::numeric_limits<std::size_t>::max()); }

    /// The same for what has come lately: packs it by itself, together with packs that are not much larger, so that
    /// there are never more packs than the logarithm of the items. Worth it each time that items have grown by a small
    /// part; then an item is packed O(log n) times in all.
    template <typename RadiusOf>
        requires std::invocable<RadiusOf&, const Item&>
    void settle_latest(RadiusOf&& radius_of) { pack(radius_of, 8); }

    /// How many items are in; from any thread.
    [[nodiscard]] std::uint32_t size() const { return published_.load(std::memory_order_acquire); }
    [[nodiscard]] bool empty() const { return size() == 0; }

    /// The item of number `index`. Expects `index < size()`.
    [[nodiscard]] const Item& operator[](std::uint32_t index) const { return items_[index]; }

    /// The same, to be changed; while others search, only through `std::atomic_ref` of what their visitors read
    /// likewise.
    [[nodiscard]] Item& operator[](std::uint32_t index) { return items_[index]; }

    /// What was refused so far; for the writer.
    [[nodiscard]] const octree_refusals& refused() const { return refused_; }

    /// Bytes taken from the heap, items included; for the writer.
    [[nodiscard]] std::size_t bytes() const {
        std::size_t sum = items_.bytes() + latest_.bytes() + settled_.capacity() * sizeof(packed_spheres<T>);
        for (const packed_spheres<T>& pack : settled_) { sum += pack.bytes(); }
        return sum;
    }

private:
    [[nodiscard]] static bool usable_radius(T radius) {
        return is_finite(radius) && radius > 0 && is_finite(radius * radius) &&
               radius * radius >= std::numeric_limits<T>::min();
    }

    // Packs what is in the trees with the latest packs, as long as these are at most `ratio` times as large.
    template <typename RadiusOf>
    void pack(RadiusOf& radius_of, std::size_t ratio) {
        std::vector<stored_sphere<T>> spheres;
        loose_octree<T> rest;
        const auto take = [&](stored_sphere<T> sphere) {
            if (loose_octree<T>::is_far(sphere.centre)) { return rest.insert_outside(sphere); }
            const T radius = radius_of(items_[sphere.item]);
            if (usable_radius(radius)) { sphere.limit2 = std::min(sphere.limit2, limit2_of(radius)); }
            spheres.push_back(sphere);
        };
        latest_.visit_all(take);
        latest_ = std::move(rest);
        while (!settled_.empty() && settled_.back().size() / ratio <= spheres.size()) {
            settled_.back().visit_all(take);
            settled_.pop_back();
        }
        if (!spheres.empty()) { settled_.emplace_back(std::move(spheres)); }
    }

    template <typename Question, bool D>
    void search(const Question& question, sphere_hits<T, D>& found) const {
        for (const packed_spheres<T>& pack : settled_) { pack.search(question, found); }
        latest_.search(question, found);
    }

    void swap(octree& other) noexcept {
        std::swap(items_, other.items_);
        std::swap(settled_, other.settled_);
        std::swap(latest_, other.latest_);
        published_.store(other.published_.exchange(published_.load()));
        std::swap(refused_, other.refused_);
    }

    stable_array<Item> items_{};
    // Each much larger than the next; the latest spheres are in the trees.
    std::vector<packed_spheres<T>> settled_{};
    loose_octree<T> latest_{};
    std::atomic<std::uint32_t> published_{0};
    octree_refusals refused_{};
};

}  // namespace aglow
