// An array that only grows at its end and never moves what it holds, so readers need no lock.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace aglow {

/// An append-only array in chunks, each a sixteenth of all before it: addresses stay, at most 1/16 lies idle.
/// One writer may append while many read elements whose index reached them through a release/acquire pair of the
/// owner's. Elements are not counted for the reader here: the owner publishes what is ready.
template <typename X>
class stable_array {
public:
    stable_array() = default;
    stable_array(const stable_array&) = delete;
    stable_array& operator=(const stable_array&) = delete;

    /// Takes all elements. Expects that nobody reads either array meanwhile.
    stable_array(stable_array&& other) noexcept { swap(other); }
    stable_array& operator=(stable_array&& other) noexcept {
        stable_array gone{std::move(other)};
        swap(gone);
        return *this;
    }

    ~stable_array() {
        std::size_t left = size_;
        for (std::size_t i = 0; i < chunks_.size() && at(i); ++i) {
            const std::size_t here = std::min(left, chunk_length(i));
            std::destroy_n(at(i), here);
            left -= here;
            std::allocator<X>{}.deallocate(at(i), chunk_length(i));
        }
    }

    /// Appends an element made from `args`; returns its index. Throws `std::length_error` after 2^32 - 2^12 elements.
    template <typename... Args>
    std::uint32_t append(Args&&... args) {
        if (size_ >= limit) { throw std::length_error("aglow::stable_array: too many elements"); }
        const place where = locate(size_);
        if (!at(where.chunk)) { add_chunk(where.chunk); }
        make(at(where.chunk) + where.offset, std::forward<Args>(args)...);
        return size_++;
    }

    [[nodiscard]] const X& operator[](std::uint32_t index) const {
        const place where = locate(index);
        return at(where.chunk)[where.offset];
    }
    [[nodiscard]] X& operator[](std::uint32_t index) {
        const place where = locate(index);
        return at(where.chunk)[where.offset];
    }

    /// Number of elements; for the writer.
    [[nodiscard]] std::uint32_t size() const { return size_; }

    /// Bytes taken from the heap; for the writer.
    [[nodiscard]] std::size_t bytes() const {
        std::size_t elements = 0;
        for (std::size_t i = 0; i < chunks_.size() && at(i); ++i) { elements += chunk_length(i); }
        return elements * sizeof(X);
    }

private:
    // Chunks come in generations of sixteen equal ones; those of generation g hold 2^(first_bits + g) elements.
    static constexpr int first_bits = 2;
    static constexpr std::uint32_t offset_of_first = 16u << first_bits;
    static constexpr std::uint32_t limit = 0u - 4096u;
    static constexpr std::size_t generations = 32 - (first_bits + 4);

    struct place {
        std::size_t chunk;
        std::size_t offset;
    };

    [[nodiscard]] static place locate(std::uint32_t index) {
        const std::uint32_t shifted = index + offset_of_first;
        const auto generation = static_cast<std::uint32_t>(std::bit_width(shifted) - (first_bits + 5));
        const std::uint32_t bits = first_bits + generation;
        return {generation * 16u + ((shifted >> bits) & 15u), shifted & ((1u << bits) - 1u)};
    }

    [[nodiscard]] static std::size_t chunk_length(std::size_t chunk) {
        return std::size_t{1} << (first_bits + chunk / 16);
    }

    [[nodiscard]] X* at(std::size_t chunk) const { return chunks_[chunk].load(std::memory_order_relaxed); }

    template <typename... Args>
    static void make(X* where, Args&&... args) {
        if constexpr (std::is_constructible_v<X, Args...>) {
            std::construct_at(where, std::forward<Args>(args)...);
        } else {
            ::new (static_cast<void*>(where)) X{std::forward<Args>(args)...};
        }
    }

    void add_chunk(std::size_t chunk) {
        chunks_[chunk].store(std::allocator<X>{}.allocate(chunk_length(chunk)), std::memory_order_relaxed);
    }

    void swap(stable_array& other) noexcept {
        for (std::size_t i = 0; i < chunks_.size(); ++i) {
            X* const mine = at(i);
            chunks_[i].store(other.at(i), std::memory_order_relaxed);
            other.chunks_[i].store(mine, std::memory_order_relaxed);
        }
        std::swap(size_, other.size_);
    }

    std::array<std::atomic<X*>, generations * 16> chunks_{};
    std::uint32_t size_ = 0;
};

}  // namespace aglow
