#include "render/scenes.hpp"
#include "render/usage_error.hpp"

namespace host {

render_result render_model(const render_options& options) {
    throw usage_error(options.scene +
                      ": built without Embree and assimp, so only the scenes of --list can be rendered");
}

}  // namespace host
