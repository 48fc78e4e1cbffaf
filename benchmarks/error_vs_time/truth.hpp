// What pictures are measured against.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <aglow/report/image_error.hpp>
#include <aglow/report/image_view.hpp>

#include "common/picture.hpp"
#include "common/scene.hpp"
#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// A scene's true picture, in two halves of independent noise where such are known; RGB, row by row from the top.
struct truth {
    std::vector<float> first{};
    std::vector<float> second{};
    scene_note note{};

    [[nodiscard]] std::vector<float> mean() const;
    [[nodiscard]] aglow::image_error compare(const std::vector<float>& image) const;
};

/// The file in `folder` for a reference of two times `samples` paths a pixel. Its name tells all that it is made of, so
/// that none of another making is taken for it.
[[nodiscard]] std::filesystem::path kept_file(const host::scene_description<float>& scene, std::size_t size,
                                              std::uint32_t samples, const std::filesystem::path& folder);

/// The reference of a scene, `size` pixels square: the project's own file of that size, or one that was left at `kept`,
/// or a new one of two times `samples` paths a pixel, which is left there.
[[nodiscard]] truth truth_of(const host::scene_description<float>& scene, std::size_t size, std::uint32_t samples,
                             const std::filesystem::path& kept);

/// Whether `truth_of` would have to render it.
[[nodiscard]] bool must_be_made(const host::scene_description<float>& scene, std::size_t size,
                                const std::filesystem::path& kept);

[[nodiscard]] std::vector<float> values_of(const host::picture& image);
[[nodiscard]] host::picture picture_of(const std::vector<float>& values, std::size_t size);

}  // namespace error_vs_time
