// A grid for one fixed radius, as progressive passes could use: cells as wide as the radius, a row of them side by side
// in a table of about as many places as points. Exact, and no point is met twice where rows share places.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <aglow/core/simd.hpp>
#include <aglow/core/simd_best.hpp>
#include <aglow/core/vec.hpp>

namespace rivals {

using aglow::vec3;

/// Points of a table that lie one after another.
struct grid_run {
    std::uint32_t first, last;
};

/// Points found, with room for sixteen more.
struct grid_found {
    std::vector<float> distances2;
    std::vector<std::uint32_t> indices;
    std::uint32_t count{0};

    void reserve(std::size_t room) {
        if (indices.size() >= room + aglow::simd::lanes) { return; }
        distances2.resize(2 * room + aglow::simd::lanes);
        indices.resize(distances2.size());
    }
};

/// Adds what is closer than `radius2` of one run.
struct scan_run_kernel {
    template <typename P>
    [[gnu::always_inline]] static inline std::uint32_t run(const float* const* at, const std::uint32_t* index,
                                                           const grid_run* runs, unsigned many,
                                                           const vec3<float>& point, float radius2, float* distances2,
                                                           std::uint32_t* indices) {
        std::uint32_t count = 0;
        for (unsigned r = 0; r < many; ++r) {
            for (std::uint32_t i = runs[r].first; i < runs[r].last; i += aglow::simd::lanes) {
                const P d =
                    P::length2(P::sub(P::load(at[0] + i), P::all(point.x)), P::sub(P::load(at[1] + i), P::all(point.y)),
                               P::sub(P::load(at[2] + i), P::all(point.z)));
                const std::uint32_t left = runs[r].last - i;
                const std::uint32_t mask = P::less(d, P::all(radius2)) & (left < 16 ? (1u << left) - 1 : 0xffffu);
                P::compress(distances2 + count, d, mask);
                P::compress(indices + count, index + i, mask);
                count += P::count(mask);
            }
        }
        return count;
    }
};

class hash_grid {
public:
    /// A grid that answers for `radius` and less.
    template <typename Items, typename Position>
    hash_grid(const Items& items, const Position& position, float radius) : per_cell_{0.999f / radius} {
        const auto count = static_cast<std::uint32_t>(items.size());
        mask_ = std::bit_ceil(std::max(count, 64u)) - 1;
        starts_.assign(mask_ + 2 + row, 0);
        std::vector<std::uint32_t> places(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            places[i] = place_of(position(items[i]));
            ++starts_[places[i]];
        }
        std::uint32_t before = 0;
        for (std::uint32_t& start : starts_) { before += std::exchange(start, before); }
        for (auto& numbers : at_) { numbers.resize(count + aglow::simd::lanes); }
        index_.resize(count + aglow::simd::lanes);
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::uint32_t to = starts_[places[i]]++;
            const vec3<float> p = position(items[i]);
            for (int a = 0; a < 3; ++a) { at_[static_cast<std::size_t>(a)][to] = p[a]; }
            index_[to] = i;
        }
        // Each start has moved on to the next one's.
        std::copy_backward(starts_.begin(), starts_.end() - 1, starts_.end());
        starts_.front() = 0;
    }

    /// Calls `visit(index, distance2)` for all strictly within `radius2`, which is at most that of the grid.
    template <typename Visit>
    void within(const vec3<float>& point, float radius2, grid_found& found, Visit&& visit) const {
        std::array<grid_run, 2 * rows> runs;
        const unsigned many = runs_around(point, runs);
        std::size_t most = 0;
        for (unsigned r = 0; r < many; ++r) { most += runs[r].last - runs[r].first; }
        found.reserve(most);
        const std::array<const float*, 3> at{at_[0].data(), at_[1].data(), at_[2].data()};
        found.count = aglow::simd::run_best<float, scan_run_kernel>(
            at.data(), index_.data(), runs.data(), many, point, radius2, found.distances2.data(), found.indices.data());
        for (std::uint32_t i = 0; i < found.count; ++i) { visit(found.indices[i], found.distances2[i]); }
    }

private:
    static constexpr std::uint32_t row = 3;
    static constexpr unsigned rows = 9;

    /// The cell of a number.
    [[nodiscard]] std::int32_t cell(float x) const { return static_cast<std::int32_t>(std::floor(x * per_cell_)); }
    [[nodiscard]] std::uint32_t row_of(std::int32_t y, std::int32_t z) const {
        std::uint32_t h = static_cast<std::uint32_t>(y) * 0x9e3779b1u ^ static_cast<std::uint32_t>(z) * 0x85ebca77u;
        h ^= h >> 15;
        return h * 0x2c1b3c6du;
    }
    [[nodiscard]] std::uint32_t place_of(const vec3<float>& p) const {
        return (row_of(cell(p.y), cell(p.z)) + static_cast<std::uint32_t>(cell(p.x))) & mask_;
    }

    /// The runs of points in three times nine cells; returns how many.
    unsigned runs_around(const vec3<float>& p, std::array<grid_run, 2 * rows>& runs) const {
        std::array<std::uint32_t, rows> places;
        const auto x = static_cast<std::uint32_t>(cell(p.x) - 1);
        for (int i = 0; i < 9; ++i) {
            places[static_cast<std::size_t>(i)] = (row_of(cell(p.y) + i % 3 - 1, cell(p.z) + i / 3 - 1) + x) & mask_;
        }
        unsigned many = 0;
        for (unsigned i = 0; i < rows; ++i) {
            // Places that an earlier row has shown are left out of this one.
            std::uint32_t from = places[i];
            std::uint32_t to = from + row;
            for (unsigned j = 0; j < i; ++j) { leave_out(places[j], from, to); }
            if (from >= to) { continue; }
            if (from > mask_) {
                from -= mask_ + 1;
                to -= mask_ + 1;
            }
            const std::uint32_t end = std::min(to, mask_ + 1);
            runs[many++] = {starts_[from], starts_[end]};
            if (to > end) { runs[many++] = {starts_[0], starts_[to - end]}; }
        }
        return many;
    }
    /// Takes the places of an earlier row out of [from, to): both are equally long, so that what is left is one piece.
    void leave_out(std::uint32_t earlier, std::uint32_t& from, std::uint32_t& to) const {
        const std::uint32_t ahead = (earlier - from) & mask_;
        const std::uint32_t behind = (from - earlier) & mask_;
        if (behind < row) { from = std::min(to, from + row - behind); }
        if (ahead < row) { to = std::min(to, from + ahead); }
    }

    /// A thousandth wider than the radius, for numbers are rounded; enough for some thousand cells a side.
    float per_cell_;
    std::uint32_t mask_;
    std::vector<std::uint32_t> starts_;
    std::array<std::vector<float>, 3> at_;
    std::vector<std::uint32_t> index_;
};

}  // namespace rivals
