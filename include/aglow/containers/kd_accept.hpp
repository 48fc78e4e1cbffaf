// What a search of a kd-tree may find: the caller's word, asked about slots.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

#include <aglow/containers/kd_search.hpp>
#include <aglow/containers/kd_select.hpp>
#include <aglow/core/simd.hpp>

namespace aglow {

/// The place of an item in a tree's own order, in [0, size()). Slots of near items are near each other.
using kd_slot = std::uint32_t;

/// Accepts every item.
struct kd_accept_all {
    template <typename... Slot>
    constexpr bool operator()(Slot...) const {
        return true;
    }
};

/// Accepts every item, and while the search still selects asks the memory for the payload of what it has found so far.
/// For who reads all of that payload, where queries come in no order and each would wait for it.
template <typename Item>
class kd_accept_fetching : public kd_accept_all {
public:
    /// Expects the payload of every slot.
    explicit kd_accept_fetching(std::span<const Item> payload) : payload_{payload.data()} {}

    bool operator()(std::size_t, kd_slot slot) const { return (*this)(slot); }
    bool operator()(kd_slot slot) const {
        const Item& item = payload_[slot];
        simd::prefetch(&item);
        simd::prefetch(reinterpret_cast<const char*>(&item + 1) - 1);
        return true;
    }

private:
    const Item* payload_;
};

/// Says what counts by looking at the payload, `accept(i, slot)` of search i, and while a batch is at one search asks
/// the memory for what the next will look at: else searches in no order wait for their payload longer than for their
/// tree. Of payload that memory near by holds, nothing is asked for.
template <typename Item, typename Accept>
class kd_accept_ahead {
public:
    /// Expects the payload of every slot.
    kd_accept_ahead(std::span<const Item> payload, const Accept& accept) : payload_{payload}, accept_{accept} {}

    bool operator()(std::size_t i, kd_slot slot) const { return accept_(i, slot); }

    /// Hears that a search may soon ask about slots from `first` to before `last`.
    void expect(kd_slot first, kd_slot last) const {
        if (payload_.size_bytes() <= simd::near_memory) { return; }
        const auto line = [&](kd_slot i) { return reinterpret_cast<const char*>(payload_.data() + i); };
        for (const char* at = line(first); at < line(last); at += 64) { simd::prefetch(at); }
    }

private:
    std::span<const Item> payload_;
    Accept accept_;
};

/// Something that says whether the item of a slot may be found: `accept(slot)`. It is asked only about items within
/// the radius, maybe more than once for one search; what it refuses counts neither towards k nor towards the radius.
template <typename F>
concept KdAccept = std::predicate<F&, kd_slot>;

namespace detail {

template <typename Accept>
inline constexpr bool kd_accepts_all = std::is_base_of_v<kd_accept_all, std::remove_cvref_t<Accept>>;

template <typename T, typename Accept>
[[gnu::noinline]] void refuse(void* caller, kd_candidates<T>& found, std::uint32_t first) {
    Accept& accept = *static_cast<Accept*>(caller);
    std::uint32_t kept = first;
    for (std::uint32_t i = first; i < found.count; ++i) {
        found.distances2[kept] = found.distances2[i];
        found.slots[kept] = found.slots[i];
        kept += accept(found.slots[i]) ? 1u : 0u;
    }
    found.count = kept;
}
/// As `refuse`, where nothing is.
template <typename T, typename Accept>
[[gnu::noinline]] void announce(void* caller, kd_candidates<T>& found, std::uint32_t first) {
    Accept& accept = *static_cast<Accept*>(caller);
    for (std::uint32_t i = first; i < found.count; ++i) { accept(found.slots[i]); }
}
template <typename Accept>
[[gnu::noinline]] bool accepts(void* caller, std::uint32_t slot) {
    return (*static_cast<Accept*>(caller))(slot);
}

/// `accept` as the search takes it. The search leaves it where it is.
template <typename T, typename Accept>
kd_filter<T> filter_of(Accept& accept) {
    void* caller = const_cast<void*>(static_cast<const void*>(std::addressof(accept)));
    if constexpr (std::is_same_v<std::remove_cv_t<Accept>, kd_accept_all>) {
        return {};
    } else if constexpr (kd_accepts_all<Accept>) {
        return {caller, &announce<T, Accept>, nullptr};
    } else {
        return {caller, &refuse<T, Accept>, &accepts<Accept>};
    }
}

/// Tells who accepts, if he would hear it, what the leaves hold that a search has listed.
template <typename T, typename Accept>
void announce_leaves(const kd_storage<T>& tree, const kd_probe<T>& probe, Accept& accept) {
    if constexpr (requires { accept.expect(kd_slot{}, kd_slot{}); }) {
        if (probe.level > 0) { return; }  // none are
        for (std::uint32_t i = probe.next[0]; i < probe.count[0]; ++i) {
            const kd_slot first = probe.open[0][i] * kd_leaf_size;
            accept.expect(first, std::min(first + kd_leaf_size, static_cast<kd_slot>(tree.size)));
        }
    }
}

}  // namespace detail

}  // namespace aglow
