// The spheres near a few points that lie together, picked out once for all of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <aglow/core/bounds.hpp>
#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// Spheres side by side, few enough to be asked one by one whether they cover a point.
template <typename T>
struct near_spheres {
    static constexpr std::size_t room = 128;

    std::array<T, room + simd::lanes> x, y, z, limit2;
    std::array<std::uint32_t, room + simd::lanes> item;
    std::size_t count = 0;
    bool complete = true;  ///< false where there was no room for all
};

/// What was found for up to `Points` points that lie together, one after another; more may be read behind.
template <typename T, std::size_t Points>
struct near_finds {
    std::array<std::uint32_t, Points * near_spheres<T>::room + simd::lanes> items;
    std::array<std::uint32_t, Points> ends;
    std::uint32_t begin = 0;
    std::size_t told = 0;

    void start() { begin = 0, told = 0; }
    /// The next point's.
    [[nodiscard]] std::span<const std::uint32_t> next() {
        const std::span<const std::uint32_t> some{&items[begin], ends[told] - begin};
        begin = ends[told++];
        return some;
    }
};

namespace detail {

/// Adds to `near`, by place as of `ask_blocks`, the spheres in `blocks[numbers[i]]`, for i below `count`, that may
/// cover a point in `box`. None is missed: a point in the box is at least as far away in every step of the rounding.
struct pick_near {
    template <typename Pack, typename Block, typename T>
    [[gnu::always_inline]] static void run(const Block* blocks, const std::uint32_t* numbers, std::uint32_t count,
                                           const bounds<T>& box, near_spheres<T>& near) {
        const Pack low[3] = {Pack::all(box.low.x), Pack::all(box.low.y), Pack::all(box.low.z)};
        const Pack high[3] = {Pack::all(box.high.x), Pack::all(box.high.y), Pack::all(box.high.z)};
        const Pack zero = Pack::all(0);
        std::size_t n = near.count;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Block& b = blocks[numbers[i]];
            const Pack x = Pack::load(b.x), y = Pack::load(b.y), z = Pack::load(b.z), limit2 = Pack::load(b.limit2);
            const Pack distances2 = Pack::length2(off(x, low[0], high[0], zero), off(y, low[1], high[1], zero),
                                                  off(z, low[2], high[2], zero));
            const std::uint32_t mask = Pack::less(distances2, limit2);
            if (mask == 0) { continue; }
            if (n + simd::lanes > near.room) {
                near.complete = false;
                return;
            }
            Pack::compress(&near.x[n], x, mask);
            Pack::compress(&near.y[n], y, mask);
            Pack::compress(&near.z[n], z, mask);
            Pack::compress(&near.limit2[n], limit2, mask);
            Pack::compress_numbers(&near.item[n], numbers[i] * simd::lanes, mask);
            n += Pack::count(mask);
        }
        near.count = n;
    }

private:
    template <typename Pack>
    [[gnu::always_inline]] static Pack off(const Pack& x, const Pack& low, const Pack& high, const Pack& zero) {
        return Pack::max(Pack::max(Pack::sub(low, x), Pack::sub(x, high)), zero);
    }
};

/// Writes the items that cover each of `count` points one after another to `found`, and where they end to `ends`.
struct ask_near {
    template <typename Pack, typename T>
    [[gnu::always_inline]] static void run(near_spheres<T>& near, const vec3<T>* points, std::size_t count,
                                           std::uint32_t* found, std::uint32_t* ends) {
        std::fill_n(&near.limit2[near.count], simd::lanes, T(0));
        std::uint32_t end = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const Pack x = Pack::all(points[i].x), y = Pack::all(points[i].y), z = Pack::all(points[i].z);
            for (std::size_t k = 0; k < near.count; k += simd::lanes) {
                const Pack distances2 =
                    Pack::length2(Pack::sub(Pack::load(&near.x[k]), x), Pack::sub(Pack::load(&near.y[k]), y),
                                  Pack::sub(Pack::load(&near.z[k]), z));
                const std::uint32_t mask = Pack::less(distances2, Pack::load(&near.limit2[k]));
                Pack::compress(found + end, &near.item[k], mask);
                end += Pack::count(mask);
            }
            ends[i] = end;
        }
    }
};

}  // namespace detail

}  // namespace aglow
