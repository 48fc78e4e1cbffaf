#include "common/counted_scene.hpp"
#include "render/renderer.hpp"
#include "render/scenes.hpp"

namespace host {

render_result render_any(const scene_description<float>& scene, const render_options& options) {
    const counted_scene<host::scene<float>> traced{scene};
    return renderer{traced, traced.lights(), traced.view(), options}.render();
}

}  // namespace host
