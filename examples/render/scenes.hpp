// Each kind of scene is rendered in a file of its own, so that they compile side by side.
#pragma once

#include "common/scene.hpp"
#include "render/options.hpp"
#include "render/report.hpp"

namespace host {

/// A built-in scene whose materials are all Lambert's: the code for all others is left out.
[[nodiscard]] render_result render_diffuse(const scene_description<float>& scene, const render_options& options);

/// Any built-in scene.
[[nodiscard]] render_result render_any(const scene_description<float>& scene, const render_options& options);

/// A model file. Throws `usage_error` where it cannot be read, or where this build reads none.
[[nodiscard]] render_result render_model(const render_options& options);

}  // namespace host
