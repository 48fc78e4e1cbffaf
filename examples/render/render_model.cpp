#include <utility>

#include "common/counted_scene.hpp"
#include "common/model_scene.hpp"
#include "render/renderer.hpp"
#include "render/scenes.hpp"
#include "render/usage_error.hpp"

namespace host {
namespace {

model read(const render_options& options) {
    try {
        return read_model(options.scene);
    } catch (const std::runtime_error& e) { throw usage_error(e.what()); }
}

}  // namespace

render_result render_model(const render_options& options) {
    const model from_file = read(options);
    const counted_scene<model_scene> scene{from_file};
    render_result result = renderer{scene, scene.lights(), scene.view(), options}.render();
    result.notes.insert(result.notes.end(), from_file.notes.begin(), from_file.notes.end());
    return result;
}

}  // namespace host
