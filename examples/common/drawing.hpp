// Marks over a picture: places that the camera sees, rings around them, words under it, panels side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <aglow/concepts/spectrum.hpp>
#include <aglow/core/numbers.hpp>
#include <aglow/core/vec.hpp>

#include "common/camera.hpp"
#include "common/picture.hpp"

namespace host {

/// Whether nothing of `scene` hides `place` from the camera.
template <typename World>
[[nodiscard]] bool is_seen(const World& scene, const camera<float>& view, const vec3<float>& place) {
    return !scene.occluded(view.origin, place + (view.origin - place) * 1e-3f);
}

/// Calls `paint(pixel, i)` for each of `count` places `place(i)` that the camera sees.
template <typename World, typename Place, typename Paint>
void for_each_seen(const World& scene, const camera<float>& view, picture& image, std::size_t count, Place&& place,
                   Paint&& paint) {
    for (std::size_t i = 0; i < count; ++i) {
        const vec3<float> p = place(i);
        const auto film = view.film_point(p, image.width, image.height);
        if (!film || !is_seen(scene, view, p)) { continue; }
        paint(image.at(static_cast<std::size_t>(film->x), static_cast<std::size_t>(film->y)), i);
    }
}

/// Adds a dot of each photon's colour, of brightness `bright`, where the camera sees it.
template <typename World, typename Map>
void add_photons(picture& image, const World& scene, const camera<float>& view, const Map& map, float bright = 0.2f) {
    for_each_seen(
        scene, view, image, map.size(), [&](std::size_t i) { return map.position(i); },
        [&](vec3<float>& pixel, std::size_t i) {
            const vec3<float> power = map.photons()[i].power;
            if (!aglow::is_black(power)) { pixel += power * (bright / aglow::max_component(power)); }
        });
}

/// Paints a dot where each record of a cache was computed.
template <typename World, typename Cache>
void paint_records(picture& image, const World& scene, const camera<float>& view, const Cache& cache,
                   const vec3<float>& colour = {1, 0.35f, 0.05f}) {
    for_each_seen(
        scene, view, image, cache.size(),
        [&](std::size_t i) { return cache[static_cast<std::uint32_t>(i)].position(); },
        [&](vec3<float>& pixel, std::size_t) { pixel = colour; });
}

/// Draws the border of a record's reach, `share` of its size, as the ellipse that it is on the record's plane.
template <typename World, typename Record>
void paint_reach(picture& image, const World& scene, const camera<float>& view, const Record& record, float share,
                 const vec3<float>& colour) {
    const auto axes = record.axes();
    constexpr std::size_t steps = 256;
    const auto border = [&](std::size_t i) {
        const float turn = 2 * aglow::pi<float> * static_cast<float>(i) / steps;
        const vec3<float> d{std::cos(turn), std::sin(turn), 0};
        return record.position() + axes.to_world(d) * (share * record.radius() / std::sqrt(record.distance2(d)));
    };
    if (!is_seen(scene, view, record.position())) { return; }
    for_each_seen(scene, view, image, steps, border, [&](vec3<float>& pixel, std::size_t) { pixel = colour; });
}

/// Five columns of seven dots, the lowest bit on top; blank for what has no form here.
[[nodiscard]] inline std::array<std::uint8_t, 5> letter_form(char letter) {
    constexpr std::string_view known = "0123456789abcdefghijklmnopqrstuvwxyzMSE.,-+/=";
    constexpr std::array<std::array<std::uint8_t, 5>, known.size()> forms{{
        {62, 81, 73, 69, 62},  {0, 66, 127, 64, 0},   {66, 97, 81, 73, 70},  {33, 65, 69, 75, 49},
        {24, 20, 18, 127, 16}, {39, 69, 69, 69, 57},  {60, 74, 73, 73, 48},  {1, 113, 9, 5, 3},
        {54, 73, 73, 73, 54},  {6, 73, 73, 41, 30},   {32, 84, 84, 84, 120}, {127, 72, 68, 68, 56},
        {56, 68, 68, 68, 32},  {56, 68, 68, 72, 127}, {56, 84, 84, 84, 24},  {8, 126, 9, 1, 2},
        {12, 82, 82, 82, 62},  {127, 8, 4, 4, 120},   {0, 68, 125, 64, 0},   {32, 64, 68, 61, 0},
        {127, 16, 40, 68, 0},  {0, 65, 127, 64, 0},   {124, 4, 24, 4, 120},  {124, 8, 4, 4, 120},
        {56, 68, 68, 68, 56},  {124, 20, 20, 20, 8},  {8, 20, 20, 24, 124},  {124, 8, 4, 4, 8},
        {72, 84, 84, 84, 32},  {4, 63, 68, 64, 32},   {60, 64, 64, 32, 124}, {28, 32, 64, 32, 28},
        {60, 64, 48, 64, 60},  {68, 40, 16, 40, 68},  {12, 80, 80, 80, 60},  {68, 100, 84, 76, 68},
        {127, 2, 12, 2, 127},  {70, 73, 73, 73, 49},  {127, 73, 73, 73, 65}, {0, 96, 96, 0, 0},
        {0, 80, 48, 0, 0},     {8, 8, 8, 8, 8},       {8, 8, 62, 8, 8},      {32, 16, 8, 4, 2},
        {20, 20, 20, 20, 20},
    }};
    const std::size_t i = known.find(letter);
    return i < known.size() ? forms[i] : std::array<std::uint8_t, 5>{};
}

/// Writes `words` from `column`, `row` (their upper left corner); what does not fit is cut off.
inline void write_words(picture& image, std::string_view words, std::size_t column, std::size_t row) {
    for (const char letter : words) {
        for (const std::uint8_t dots : letter_form(letter)) {
            for (std::size_t y = 0; y < 7 && column < image.width && row + y < image.height; ++y) {
                if (dots >> y & 1) { image.at(column, row + y) = vec3<float>{0.85f}; }
            }
            ++column;
        }
        ++column;
    }
}

/// `image` with `words` on a dark strip below it.
[[nodiscard]] inline picture captioned(const picture& image, std::string_view words) {
    picture result{image.width, image.height + 15};
    std::copy(image.pixels.begin(), image.pixels.end(), result.pixels.begin());
    write_words(result, words, 4, image.height + 4);
    return result;
}

/// Pictures side by side, tops level, a narrow gap between them.
[[nodiscard]] inline picture side_by_side(std::span<const picture> parts, std::size_t gap = 4) {
    picture result;
    for (const picture& p : parts) {
        result.width += p.width + (result.width > 0 ? gap : 0);
        result.height = std::max(result.height, p.height);
    }
    result = picture{result.width, result.height};
    std::size_t left = 0;
    for (const picture& p : parts) {
        for (std::size_t y = 0; y < p.height; ++y) {
            for (std::size_t x = 0; x < p.width; ++x) { result.at(left + x, y) = p.at(x, y); }
        }
        left += p.width + gap;
    }
    return result;
}

}  // namespace host
