// Pictures in files: OpenEXR with layers, and PNG for looking at. A file appears whole or not at all.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/picture.hpp"

namespace host {

/// A picture within a file; the one without a name is the file's own R, G and B.
struct layer {
    std::string name;
    picture image;
};

/// What the second of two independent pictures of the same is called, where a file holds both.
inline constexpr const char* second_half = "second";

/// Bits of a number in a file: a half has 11 significant ones, and half the size.
enum class precision { single, half };

/// Writes floats; every layer has the size of the first. Throws `std::runtime_error` that names the file; an older file
/// of that name is then untouched.
void write_exr(const std::filesystem::path& file, const std::vector<layer>& layers, precision kept = precision::single);

/// The layer `name` of a file, the nameless one by default. Throws `std::runtime_error` that names the file.
[[nodiscard]] picture read_exr(const std::filesystem::path& file, const std::string& name = {});

/// Whether this build writes PNG.
[[nodiscard]] bool has_png();

/// Writes 8 bits a channel, sRGB, after multiplying by `exposure`; what is above 1 is white. Throws
/// `std::runtime_error`.
void write_png(const std::filesystem::path& file, const picture& image, float exposure = 1);

/// Linear RGB of a PNG file, or of one in memory. Throws `std::runtime_error` that names the file, or `name`.
[[nodiscard]] picture read_png(const std::filesystem::path& file);
[[nodiscard]] picture read_png(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace host
