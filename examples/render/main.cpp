// Renders a built-in scene or a model file from the command line.

#include <cstdio>
#include <exception>
#include <fstream>
#include <new>

#include "common/counted_scene.hpp"
#include "common/interruption.hpp"
#include "common/scenes/registry.hpp"
#include "render/options.hpp"
#include "render/scenes.hpp"
#include "render/usage_error.hpp"

namespace {

namespace fs = std::filesystem;

void list_scenes() {
    for (const auto& s : host::scenes::all<float>()) { std::printf("%-20s %s\n", s.name.c_str(), s.about.c_str()); }
}

/// Better now than after an hour.
void expect_writable(const fs::path& file) {
    const fs::path probe = file.string() + ".part";
    const bool good = std::ofstream{probe, std::ios::app}.good();
    std::error_code ignored;
    fs::remove(probe, ignored);
    if (!good || fs::is_directory(file)) { throw host::usage_error("cannot write " + file.string()); }
}

bool is_diffuse(const host::scene_description<float>& s) {
    for (const auto& m : s.materials) {
        if (aglow::any(host::lobes_of(m), ~aglow::lobe_set::diffuse_reflection)) { return false; }
    }
    return true;
}

host::render_result render(const host::render_options& options) {
    const auto built_in = host::scenes::find<float>(options.scene);
    if (built_in) {
        return is_diffuse(*built_in) ? render_diffuse(*built_in, options) : render_any(*built_in, options);
    }
    if (!fs::exists(options.scene)) {
        throw host::usage_error(options.scene + ": neither a file nor a scene of --list");
    }
    return render_model(options);
}

void write(const host::render_options& options, const host::render_result& result) {
    fs::path png = options.output;
    if (options.output.extension() == ".exr") {
        host::write_exr(options.output, result.layers,
                        options.reference ? host::precision::half : host::precision::single);
        std::printf("%s\n", options.output.c_str());
        png.replace_extension(".png");
        if (!host::has_png()) { return; }
    }
    host::write_png(png, result.layers.front().image, options.exposure);
    std::printf("%s\n", png.c_str());
    if (!result.heat) { return; }
    const fs::path heat = png.parent_path() / (png.stem().string() + "-error.png");
    host::write_png(heat, *result.heat);
    std::printf("%s\n", heat.c_str());
}

int run(int count, const char* const* words) {
    const auto options = host::read_options(count, words);
    if (!options) { return 0; }
    if (options->list) {
        list_scenes();
        return 0;
    }
    expect_writable(options->output);
    const host::interruption listening;
    host::render_result result = render(*options);
    result.notes.insert(result.notes.begin(), options->unused.begin(), options->unused.end());
    result.add_fact("rays", host::ray_count::all_nearest());
    result.add_fact("shadow rays", host::ray_count::all_shadow());
    result.add_bytes("memory at most", host::peak_memory());
    write(*options, result);
    host::print_table(result);
    return host::interruption::came() ? 130 : 0;  // as shells say it of a program that Ctrl-C ended
}

}  // namespace

int main(int count, char** words) {
    try {
        return run(count, words);
    } catch (const host::usage_error& e) {
        std::fprintf(stderr, "render: %s\n", e.what());
        return 2;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "render: not enough memory; a smaller --size or fewer photons need less\n");
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "render: %s\n", e.what());
        return 1;
    }
}
