// A model file (OBJ, glTF 2, PLY) as triangles, materials and lights.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/camera.hpp"
#include "common/material.hpp"
#include "common/picture.hpp"

namespace host {

/// What a file holds, in its own unit of length.
struct model {
    /// Triangles whose corners turn left on the side that their normals are on.
    struct mesh {
        std::vector<vec3<float>> corners{};
        std::vector<std::array<std::uint32_t, 3>> triangles{};
        std::size_t material{0};
        /// Of each corner: the shading normal, and, empty where the file has none, its colour and place in the
        /// material's texture.
        std::vector<vec3<float>> normals{};
        std::vector<vec3<float>> colours{};
        std::vector<vec2<float>> places{};
    };
    struct lamp {
        vec3<float> position{};
        vec3<float> intensity{};
    };

    std::vector<host::material<float>> materials{};
    /// Of each material, what its diffuse part is multiplied by over the surface; an empty picture for none.
    std::vector<picture> textures{};
    std::vector<mesh> meshes{};
    std::vector<lamp> lamps{};
    /// The file's first camera; empty where it has none.
    std::optional<host::camera<float>> camera{};
    /// What was left out, one clause each, for people.
    std::vector<std::string> notes{};
};

/// Reads a model file. Throws `std::runtime_error` that names the file where it cannot be read or holds no triangle.
[[nodiscard]] model read_model(const std::filesystem::path& file);

}  // namespace host
