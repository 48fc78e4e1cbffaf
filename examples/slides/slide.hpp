// What every slide needs: where to put it and how large, a film that is exposed for as long as wanted, and its file.
//
// Called as `slide_x FOLDER [--tiny]`; the folder must be there. --tiny makes a thumbnail in a moment.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <aglow/algorithms/film.hpp>
#include <aglow/core/parallel.hpp>

#include "common/camera.hpp"
#include "common/developed.hpp"
#include "common/drawing.hpp"
#include "common/image_io.hpp"

namespace host {

/// Seconds since it was made.
class stopwatch {
public:
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(clock::now() - start_).count(); }

private:
    using clock = std::chrono::steady_clock;
    clock::time_point start_{clock::now()};
};

/// The frame around every slide.
class slide {
public:
    slide(std::filesystem::path folder, bool tiny) : folder_{std::move(folder)}, tiny_{tiny} {}

    [[nodiscard]] bool tiny() const { return tiny_; }
    [[nodiscard]] std::size_t side() const { return tiny_ ? 64 : 256; }
    [[nodiscard]] const aglow::own_threads& run() const { return run_; }

    /// The ray through a point of the slide's film.
    [[nodiscard]] auto eye(const camera<float>& view) const {
        return [view, n = side()](const vec2<float>& film) { return view.through(film, n, n); };
    }

    /// A picture of `samples` samples a pixel.
    template <typename Integrator>
    [[nodiscard]] picture expose(const camera<float>& view, const Integrator& integrator, std::uint32_t samples) const {
        aglow::film<vec3<float>> film{side(), side()};
        film.expose(eye(view), integrator, {.samples = samples}, run_);
        return developed(film);
    }

    /// A picture of as many samples as fit until `clock` shows `seconds`, one at the least; how many is put in `taken`.
    template <typename Integrator>
    [[nodiscard]] picture expose_until(const camera<float>& view, const Integrator& integrator, const stopwatch& clock,
                                       double seconds, std::uint32_t& taken) const {
        aglow::film<vec3<float>> film{side(), side()};
        double each = 0;
        do {
            const stopwatch one;
            film.expose(eye(view), integrator, {.samples = 1}, run_);
            each = one.seconds();
        } while (clock.seconds() + each < seconds);
        taken = film.samples();
        return developed(film);
    }

    /// The built-in reference of a scene, at the size of the slide.
    [[nodiscard]] picture reference(const std::string& scene) const {
        const picture whole = read_exr(std::string{AGLOW_REFERENCES} + "/" + scene + ".exr");
        const std::size_t n = whole.width / side();
        picture result{side(), side()};
        for (std::size_t y = 0; y < whole.height; ++y) {
            for (std::size_t x = 0; x < whole.width; ++x) {
                result.at(x / n, y / n) += whole.at(x, y) * (1 / static_cast<float>(n * n));
            }
        }
        return result;
    }

    /// Writes FOLDER/name.png and name.exr.
    void save(const std::string& name, const std::vector<picture>& parts) const {
        const picture all = side_by_side(parts);
        write_exr(folder_ / (name + ".exr"), {{"", all}});
        if (has_png()) { write_png(folder_ / (name + ".png"), all); }
    }

private:
    std::filesystem::path folder_;
    bool tiny_;
    aglow::own_threads run_{};
};

/// `format` filled in, as printf does.
template <typename... Values>
[[nodiscard]] std::string text(const char* format, Values... values) {
    char line[160];
    std::snprintf(line, sizeof line, format, values...);
    return line;
}

/// The `main` of a slide: reads the arguments, says in one line what went wrong.
template <typename Draw>
int show_slide(int count, char** words, Draw&& draw) {
    const std::vector<std::string_view> asked(words + 1, words + count);
    const bool help = std::any_of(asked.begin(), asked.end(), [](auto w) { return w == "--help" || w == "-h"; });
    const bool tiny = asked.size() == 2 && asked[1] == "--tiny";
    if (help || asked.empty() || asked[0].starts_with('-') || (asked.size() > 1 && !tiny)) {
        std::fprintf(help ? stdout : stderr, "usage: %s FOLDER [--tiny]\n", words[0]);
        return help ? 0 : 2;
    }
    if (!std::filesystem::is_directory(words[1])) {  // better now than after minutes
        std::fprintf(stderr, "%s: %s is no folder\n", words[0], words[1]);
        return 2;
    }
    try {
        draw(slide{words[1], tiny});
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s: %s\n", words[0], e.what());
        return 2;
    }
    return 0;
}

}  // namespace host
