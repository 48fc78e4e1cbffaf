// Discs that stay, and which of them may cover a point: one way down a tree, one short list.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

namespace aglow {

/// What lies within `radius` of `centre` and within `height` of the plane through it with unit `normal`.
template <std::floating_point T>
struct thick_disc {
    vec3<T> centre{};
    T radius{};
    vec3<T> normal{0, 0, 1};
    T height{};
};

/// An octree over the places where discs reach, each leaf with the list of all that touch it. Faster to ask than
/// `octree`, and never grows. Const and safe from many threads.
template <std::floating_point T>
class frozen_discs {
public:
    frozen_discs() = default;

    /// Expects finite numbers. The discs need not stay afterwards. O(n log n).
    explicit frozen_discs(std::span<const thick_disc<T>> discs) {
        if (discs.empty()) { return; }
        bounds<T> all;
        for (const thick_disc<T>& d : discs) {
            all.add(d.centre - d.radius);
            all.add(d.centre + d.radius);
        }
        const vec3<T> extent = all.extent();
        cube whole{all.centre(), std::max({extent.x, extent.y, extent.z}) * T(0.501)};
        middle_ = whole.middle;
        half_ = whole.half;
        std::vector<std::uint32_t> everything(discs.size());
        for (std::uint32_t i = 0; i < everything.size(); ++i) { everything[i] = i; }
        nodes_.resize(1);
        divide(0, whole, std::move(everything), discs, 0);
        lists_.shrink_to_fit();
        nodes_.shrink_to_fit();
    }

    /// The numbers, in rising order, of discs that may cover `point`: all that do, and few that do not.
    [[nodiscard]] std::span<const std::uint32_t> candidates(const vec3<T>& point) const {
        vec3<T> p = point - middle_;
        // NaN is outside.
        if (!(std::abs(p.x) <= half_ && std::abs(p.y) <= half_ && std::abs(p.z) <= half_) || nodes_.empty()) {
            return {};
        }
        T half = half_;
        node at = nodes_[0];
        while (at.count == inner) {
            half /= 2;
            const std::uint32_t octant = unsigned{p.x >= 0} | unsigned{p.y >= 0} << 1 | unsigned{p.z >= 0} << 2;
            p.x -= p.x >= 0 ? half : -half;
            p.y -= p.y >= 0 ? half : -half;
            p.z -= p.z >= 0 ? half : -half;
            at = nodes_[at.first + octant];
        }
        return {lists_.data() + at.first, at.count};
    }

    /// Bytes taken from the heap.
    [[nodiscard]] std::size_t bytes() const {
        return nodes_.capacity() * sizeof(node) + lists_.capacity() * sizeof(std::uint32_t);
    }

private:
    struct cube {
        vec3<T> middle;
        T half;
        [[nodiscard]] cube octant(std::uint32_t i) const {
            const T q = half / 2;
            return {middle + vec3<T>{i & 1u ? q : -q, i & 2u ? q : -q, i & 4u ? q : -q}, q};
        }
    };

    // Inner: eight children from `first`. Leaf: `count` numbers in the lists from `first`.
    struct node {
        std::uint32_t first{0};
        std::uint32_t count{0};
    };

    static constexpr std::uint32_t inner = 0xffffffffu;
    static constexpr std::size_t few = 20;
    static constexpr int deepest = 16;

    void divide(std::size_t self, const cube& c, std::vector<std::uint32_t> members,
                std::span<const thick_disc<T>> discs, int depth) {
        if (members.size() > few && depth < deepest) {
            std::vector<std::uint32_t> parts[8];
            std::size_t total = 0;
            for (std::uint32_t i = 0; i < 8; ++i) {
                parts[i] = touching(c.octant(i), members, discs);
                total += parts[i].size();
            }
            // Where most discs cover most octants, dividing multiplies lists without shortening them.
            if (total < 3 * members.size()) {
                members = {};
                const std::size_t first = nodes_.size();
                nodes_[self] = {static_cast<std::uint32_t>(first), inner};
                nodes_.resize(first + 8);
                for (std::uint32_t i = 0; i < 8; ++i) {
                    divide(first + i, c.octant(i), std::move(parts[i]), discs, depth + 1);
                }
                return;
            }
        }
        nodes_[self] = {static_cast<std::uint32_t>(lists_.size()), static_cast<std::uint32_t>(members.size())};
        lists_.insert(lists_.end(), members.begin(), members.end());
    }

    [[nodiscard]] static std::vector<std::uint32_t> touching(const cube& c, const std::vector<std::uint32_t>& members,
                                                             std::span<const thick_disc<T>> discs) {
        // The way down rounds differently from the way the cubes were made, by a few ulp of either.
        const T slack = (max_abs(c.middle) + c.half) * (8 * std::numeric_limits<T>::epsilon());
        std::vector<std::uint32_t> found;
        for (const std::uint32_t i : members) {
            const thick_disc<T>& d = discs[i];
            const vec3<T> way = c.middle - d.centre;
            const vec3<T> away = glm::max(glm::abs(way) - c.half, vec3<T>{0});
            const T halfway = c.half * (std::abs(d.normal.x) + std::abs(d.normal.y) + std::abs(d.normal.z));
            if (length2(away) <= square(d.radius + slack) &&
                std::abs(glm::dot(way, d.normal)) <= d.height + halfway + 2 * slack) {
                found.push_back(i);
            }
        }
        return found;
    }

    vec3<T> middle_{};
    T half_{};
    std::vector<node> nodes_;
    std::vector<std::uint32_t> lists_;
};

}  // namespace aglow
