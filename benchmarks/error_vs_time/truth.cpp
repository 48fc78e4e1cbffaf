#include "error_vs_time/truth.hpp"

#include <array>
#include <bit>
#include <optional>

#include "common/image_io.hpp"
#include "common/progress.hpp"
#include "error_vs_time/fingerprint.hpp"
#include "error_vs_time/make_run.hpp"

namespace error_vs_time {

namespace {

struct halves {
    host::picture first;
    host::picture second;
};

/// A picture file's two halves, where it has the size; the same twice where it has no second one.
std::optional<halves> read(const std::filesystem::path& file, std::size_t size, bool two) {
    if (!std::filesystem::exists(file)) { return std::nullopt; }
    halves found{.first = host::read_exr(file), .second = {}};
    if (found.first.width != size || found.first.height != size) { return std::nullopt; }
    found.second = two ? host::read_exr(file, host::second_half) : found.first;
    return found;
}

std::filesystem::path project_file(const std::string& scene) {
    return std::filesystem::path{AGLOW_REFERENCES} / (scene + ".exr");
}

/// Noise of the references that an independent renderer made in one piece, as the table beside them tells it.
double outside_noise(const std::string& scene) {
    return scene == "cornell-diffuse" ? 1.6e-5 : scene == "cornell-glass" ? 2.1e-5 : 0;
}

halves made(const host::scene_description<float>& scene, std::size_t size, std::uint32_t samples) {
    host::progress bar{"reference of " + scene.name + ", 2 x " + std::to_string(samples) + " samples per pixel"};
    const reference_halves values = path_traced(scene, samples, size, [&](double share) {
        bar.show(share);
        return true;
    });
    return {picture_of(values.first, size), picture_of(values.second, size)};
}

/// Tells scenes of one name, path tracers and seeds apart, by a small picture of theirs.
std::string making(const host::scene_description<float>& scene) {
    const reference_halves small = path_traced(scene, 16, 32);
    fingerprint sum;
    for (const auto* half : {&small.first, &small.second}) {
        for (const float x : *half) {
            for (const unsigned char byte : std::bit_cast<std::array<unsigned char, sizeof x>>(x)) { sum.add(byte); }
        }
    }
    return sum.digits();
}

void tell_noise(truth& known) {
    const aglow::image_error noise = known.compare(known.first);
    known.note.reference = "own path tracer, two halves";
    known.note.reference_pictures = 2;
    known.note.reference_relmse = noise.reference_relmse;
    known.note.reference_mape = noise.reference_mape;
}

}  // namespace

std::vector<float> truth::mean() const {
    std::vector<float> m(first.size());
    for (std::size_t i = 0; i < m.size(); ++i) { m[i] = 0.5f * first[i] + 0.5f * second[i]; }
    return m;
}

aglow::image_error truth::compare(const std::vector<float>& image) const {
    const auto view = [&](const std::vector<float>& values) {
        return aglow::image_view<float>{values, note.width, note.height, 3};
    };
    return aglow::compare(view(image), view(first), view(second));
}

std::vector<float> values_of(const host::picture& image) {
    std::vector<float> values;
    values.reserve(3 * image.pixels.size());
    for (const auto& p : image.pixels) { values.insert(values.end(), {p.x, p.y, p.z}); }
    return values;
}

host::picture picture_of(const std::vector<float>& values, std::size_t size) {
    host::picture image{size, size};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    }
    return image;
}

std::filesystem::path kept_file(const host::scene_description<float>& scene, std::size_t size, std::uint32_t samples,
                                const std::filesystem::path& folder) {
    return folder / (scene.name + "-reference-" + std::to_string(size) + "-2x" + std::to_string(samples) + '-' +
                     making(scene) + ".exr");
}

bool must_be_made(const host::scene_description<float>& scene, std::size_t size, const std::filesystem::path& kept) {
    return !read(project_file(scene.name), size, false) && !read(kept, size, false);
}

truth truth_of(const host::scene_description<float>& scene, std::size_t size, std::uint32_t samples,
               const std::filesystem::path& kept) {
    const double outside = outside_noise(scene.name);
    truth known{.note = {.name = scene.name, .description = scene.about, .width = size, .height = size}};
    std::optional<halves> found = read(project_file(scene.name), size, outside == 0);
    const bool own = !found || outside == 0;
    if (!found) { found = read(kept, size, true); }
    if (!found) {
        found = made(scene, size, samples);
        host::write_exr(kept, {{"", found->first}, {host::second_half, found->second}});
    }
    known.first = values_of(found->first);
    known.second = values_of(found->second);
    if (own) {
        tell_noise(known);
    } else {
        known.note.reference = "an independent path tracer's picture";
        known.note.reference_relmse = outside;
    }
    return known;
}

}  // namespace error_vs_time
