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

namespace host {

/// What a file holds, in its own unit of length. Textures are not read: a material has one colour.
struct model {
    struct mesh {
        std::vector<vec3<float>> corners{};
        std::vector<std::array<std::uint32_t, 3>> triangles{};
        std::size_t material{0};
    };
    struct lamp {
        vec3<float> position{};
        vec3<float> intensity{};
    };

    std::vector<host::material<float>> materials{};
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
