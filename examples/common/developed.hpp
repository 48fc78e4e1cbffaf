// What a film holds, as pictures.
#pragma once

#include <cstddef>

#include <aglow/algorithms/film.hpp>

#include "common/picture.hpp"

namespace host {

/// `of(column, row)` of every pixel of a film.
template <typename Of>
[[nodiscard]] picture picture_of(const aglow::film<aglow::vec3<float>>& film, const Of& of) {
    picture image{film.width(), film.height()};
    for (std::size_t y = 0; y < image.height; ++y) {
        for (std::size_t x = 0; x < image.width; ++x) { image.at(x, y) = of(x, y); }
    }
    return image;
}

/// The light of a film.
[[nodiscard]] inline picture developed(const aglow::film<aglow::vec3<float>>& film) {
    return picture_of(film, [&](std::size_t x, std::size_t y) { return film.radiance(x, y); });
}

/// The errors that its integrator told, in all bands.
[[nodiscard]] inline picture developed_errors(const aglow::film<aglow::vec3<float>>& film) {
    return picture_of(film, [&](std::size_t x, std::size_t y) { return aglow::vec3<float>{film.error(x, y)}; });
}

}  // namespace host
