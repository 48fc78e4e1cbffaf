// What the kd-trees are asked: five clouds of photons, and questions in random and in coherent order.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <aglow/core/bounds.hpp>
#include <aglow/core/vec.hpp>

namespace rivals {

using point = aglow::vec3<float>;

/// The names of the sets, and what they are.
inline constexpr std::array<std::pair<char, const char*>, 5> sets{{
    {'A', "even in a cube"},
    {'B', "on six walls, and a caustic: four fifths on walls along the axes, one fifth within 0.01 of a spot"},
    {'R', "as B, rotated"},
    {'C', "even in one plane"},
    {'D', "a thousand places, repeated"},
}};

/// Numbers that are the same on every machine.
class dice {
public:
    explicit dice(std::uint64_t seed) : bits_{seed} {}
    std::uint64_t below(std::uint64_t n) { return bits_() % n; }
    float even() { return static_cast<float>(bits_() >> 40) * 0x1p-24f; }
    float bell() {
        const double radius = std::sqrt(-2 * std::log(1 - static_cast<double>(bits_() >> 11) * 0x1p-53));
        return static_cast<float>(radius * std::cos(6.283185307179586 * static_cast<double>(even())));
    }
    point in_cube() { return {even(), even(), even()}; }

private:
    std::mt19937_64 bits_;
};

inline point in_box(dice& random) {
    if (random.below(5) == 0) {
        const point spread{random.bell(), random.bell(), std::abs(random.bell())};
        return point{0.5f, 0.5f, 0} + spread * 0.01f;
    }
    point p = random.in_cube();
    const std::uint64_t wall = random.below(6);
    p[static_cast<int>(wall / 2)] = static_cast<float>(wall % 2);
    return p;
}

inline point rotated(point p) {
    return {0.36f * p.x + 0.48f * p.y - 0.8f * p.z, -0.8f * p.x + 0.6f * p.y, 0.48f * p.x + 0.64f * p.y + 0.6f * p.z};
}

/// `count` points of a set; the same seed gives the same points.
inline std::vector<point> points_of(char set, std::size_t count, std::uint64_t seed) {
    dice random{seed};
    dice places{17};
    std::vector<point> stock(1000);
    for (point& p : stock) { p = places.in_cube(); }
    std::vector<point> points(count);
    for (point& p : points) {
        switch (set) {
            case 'B': p = in_box(random); break;
            case 'R': p = rotated(in_box(random)); break;
            case 'C': p = {random.even(), random.even(), 0.5f}; break;
            case 'D': p = stock[random.below(stock.size())]; break;
            default: p = random.in_cube();
        }
    }
    return points;
}

/// Every third bit of the result is one of the low 21 bits of `x`.
inline std::uint64_t spread_bits(std::uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffff;
    x = (x | x << 16) & 0x1f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/// Sorted along a Morton curve.
inline void sort_near(std::vector<point>& points) {
    aglow::bounds<float> box;
    for (const point& p : points) { box.add(p); }
    const float scale = 2097151.0f / aglow::max_abs(box.extent());
    const auto cell = [&](float x, float low) { return spread_bits(static_cast<std::uint64_t>((x - low) * scale)); };
    const auto key = [&](const point& p) {
        return cell(p.x, box.low.x) | cell(p.y, box.low.y) << 1 | cell(p.z, box.low.z) << 2;
    };
    std::sort(points.begin(), points.end(), [&](const point& a, const point& b) { return key(a) < key(b); });
}

/// Questions from the same distribution as the set: in random order, or in tiles of 128 neighbours.
inline std::vector<point> questions(char set, std::size_t population, std::size_t count, bool coherent) {
    std::vector<point> all = points_of(set, std::max(population, count), 4711);
    if (!coherent) {
        all.resize(count);
        return all;
    }
    sort_near(all);
    dice random{5};
    constexpr std::size_t tile = 128;
    std::vector<point> tiles;
    while (tiles.size() < count) {
        const std::size_t first = random.below(all.size() / tile) * tile;
        for (std::size_t i = first; i < first + tile; ++i) { tiles.push_back(all[i]); }
    }
    return tiles;
}

}  // namespace rivals
