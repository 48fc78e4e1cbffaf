#include "render/options.hpp"

#include <charconv>
#include <cstdint>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>

#include <aglow/estimators/density.hpp>

#include "common/image_io.hpp"
#include "render/usage_error.hpp"

namespace host {
namespace {

const std::map<std::string, method> methods{{"path", method::path},
                                            {"irradiance-cache", method::irradiance_cache},
                                            {"photon-map", method::photon_map},
                                            {"final-gather", method::final_gather},
                                            {"gather-cache", method::gather_cache}};

const std::map<std::string, view> views{{"beauty", view::beauty},     {"direct", view::direct},
                                        {"indirect", view::indirect}, {"caustic", view::caustic},
                                        {"records", view::records},   {"photons", view::photons}};

template <typename Choice>
Choice chosen(const std::map<std::string, Choice>& choices, const std::string& option, const std::string& word) {
    const auto found = choices.find(word);
    if (found != choices.end()) { return found->second; }
    std::string known;
    for (const auto& [name, value] : choices) { known += (known.empty() ? "" : ", ") + name; }
    throw usage_error(option + " " + word + ": there is only " + known);
}

std::size_t pixels(const std::string& text, const std::string& number) {
    std::size_t n = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), n);
    if (error != std::errc{} || end != number.data() + number.size() || n < 1 || n > 32768) {
        throw usage_error("--size " + text + ": two numbers from 1 to 32768 are needed, such as 640x480");
    }
    return n;
}

/// Sets width and height from text like 640x480.
void read_size(const std::string& text, render_options& options) {
    const std::size_t cross = text.find('x');
    options.width = pixels(text, text.substr(0, cross));
    options.height = pixels(text, cross == std::string::npos ? "" : text.substr(cross + 1));
}

/// An error like 5% or 0.05 as a share.
double error_share(std::string text) {
    const bool percent = !text.empty() && text.back() == '%';
    if (percent) { text.pop_back(); }
    double x = 0;
    if (!CLI::detail::lexical_cast(text, x)) { x = 0; }
    x = percent ? x / 100 : x;
    if (!(x >= 1e-4 && x <= 1)) { throw usage_error("--until wants an error from 0.01% to 100%: 5% or 0.05"); }
    return x;
}

/// Refuses what is not a number from `low` to `high`, NaN too.
CLI::Validator between(double low, double high) {
    const auto refuse = [low, high](std::string& text) -> std::string {
        double x = 0;
        if (CLI::detail::lexical_cast(text, x) && x >= low && x <= high) { return {}; }
        std::ostringstream why;
        why << text << " is not a number from " << low << " to " << high;
        return why.str();
    };
    return {refuse, ""};
}

/// Refuses what is not a whole number from `low` to `high`, and drops leading zeros, by which CLI11 would read octal.
CLI::Validator whole(std::uint64_t low, std::uint64_t high) {
    const auto decimal = [low, high](std::string& text) -> std::string {
        std::uint64_t n = 0;
        const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), n);
        if (wrong == std::errc{} && end == text.data() + text.size() && n >= low && n <= high) {
            text = std::to_string(n);
            return {};
        }
        return text + " is not a whole number from " + std::to_string(low) + " to " + std::to_string(high);
    };
    return {decimal, ""};
}

/// The first line of what CLI11 complains of.
std::string one_line(std::string text) {
    const std::size_t end = text.find('\n');
    return end == std::string::npos ? text : text.substr(0, end);
}

void add_picture(CLI::App& app, render_options& o, std::string& size) {
    app.add_option("SCENE", o.scene, "a built-in scene (see --list) or a model file (OBJ, glTF 2, PLY)")->type_name("");
    app.add_flag("--list", o.list, "list the built-in scenes");
    const auto add = [&app](const char* name, auto& into, const char* type, const char* what) {
        return app.add_option(name, into, what)->type_name(type)->group("The picture");
    };
    add("-o,--output", o.output, "FILE", "the picture: .exr (a .png comes beside it) or .png [SCENE.exr]");
    add("--size", size, "WxH", "width x height in pixels [256x256]");
    add("--spp", o.samples, "N", "samples per pixel [16]")->transform(whole(1, 1 << 24));
    add("--time", o.seconds, "SECONDS", "as many samples as fit into so many seconds, preparation included")
        ->check(between(0.01, 1e7));
    add("--seed", o.seed, "N", "another seed, other noise [0]")
        ->transform(whole(0, std::numeric_limits<std::uint64_t>::max()));
    add("--threads", o.threads, "N", "threads; the picture does not depend on them [all cores]")
        ->transform(whole(1, 1024));
    add("--exposure", o.exposure, "FACTOR", "of the PNG [1]")->check(between(1e-6, 1e6));
}

void add_method(CLI::App& app, render_options& o, std::string& how) {
    const auto add = [&app](const char* name, auto& into, const char* type, const std::string& what) {
        return app.add_option(name, into, what)->type_name(type)->group("How it is made");
    };
    add("--method", how, "NAME", "path, irradiance-cache, photon-map, final-gather or gather-cache [gather-cache]");
    add("--caustic-photons", o.caustic_photons, "N", "wanted over mirrors and glass [200000]")
        ->transform(whole(0, 4'000'000'000));
    add("--indirect-photons", o.indirect_photons, "N", "wanted after a matte bounce [100000; photon-map 200000]")
        ->transform(whole(0, 4'000'000'000));
    add("--direct-photons", o.direct_photons, "N", "wanted straight from the lights [20000; photon-map 0]")
        ->transform(whole(0, 4'000'000'000));
    add("--estimate", o.photons_per_estimate, "N",
        "photons per estimate [" + std::to_string(aglow::density_options{}.count) + "]")
        ->transform(whole(2, 100000));
    add("--gather-rays", o.gather_rays, "N", "rays of each cache record [350] or final gather [64]")
        ->transform(whole(1, 1 << 20));
    add("--accuracy", o.accuracy, "X", "of the irradiance cache: smaller is finer")->check(between(1e-4, 10.0));
}

void add_questions(CLI::App& app, render_options& o, std::string& show, std::string& until) {
    const char* group = "What it is made of, and how wrong it is";
    app.add_option("--view", show, "beauty, direct, indirect, caustic, records or photons [beauty]")
        ->type_name("NAME")
        ->group(group);
    app.add_flag("--layers", o.layers, "also direct, indirect and caustic light, as layers of the EXR")->group(group);
    app.add_flag("--error", o.error, "audit the picture: error bars as a layer, and as a heat map beside it")
        ->group(group);
    app.add_option(
           "--error-samples", o.error_samples,
           "most samples of that audit: few make bars and bounds wider, never wrong [as many as the probes' noise "
           "calls for]")
        ->type_name("N")
        ->transform(whole(10'000, 4'000'000'000))
        ->group(group);
    app.add_option(
           "--until", until,
           "render on until an audit certifies this mean relative error, such as 5%; photons, gather rays and accuracy "
           "follow it where they are not given")
        ->type_name("ERROR")
        ->group(group);
    app.add_flag("--reference", o.reference,
                 "two pictures by path tracing, --spp samples each, of independent noise: the EXR's own and its layer "
                 "`second`, in half floats")
        ->group(group);
}

/// What contradicts itself.
void expect_consistent(const CLI::App& app, const render_options& o) {
    if (o.reference &&
        (app.count("--method") + app.count("--view") + app.count("--until") > 0 || o.layers || o.error)) {
        throw usage_error(
            "--reference makes one kind of picture: --method, --view, --layers, --until, --error do not go with it");
    }
    if (o.show != view::beauty && (o.error || o.until > 0)) {
        throw usage_error("--error and --until are about the whole picture: --view " +
                          app["--view"]->as<std::string>() + " does not go with them");
    }
    if (o.output.extension() != ".exr" && o.output.extension() != ".png") {
        throw usage_error("--output " + o.output.string() + ": the name must end in .exr or .png");
    }
    if (o.output.extension() == ".png" && !has_png()) {
        throw usage_error("--output " + o.output.string() + ": built without libpng, only .exr can be written");
    }
    if (o.output.extension() == ".png" && (o.layers || o.reference)) {
        throw usage_error("--output " + o.output.string() +
                          ": layers, and the second half of a reference, need a file that ends in .exr");
    }
}

/// What was said and changes nothing.
std::vector<std::string> unused(const CLI::App& app, const render_options& o) {
    std::vector<std::string> notes;
    const auto look = [&](const char* option, bool used, const std::string& why) {
        if (!used && app.count(option) > 0) { notes.push_back(option + std::string{" is not used: "} + why); }
    };
    const bool caches = o.how == method::irradiance_cache || o.how == method::gather_cache;
    const bool traces = !o.reference && o.how != method::path;  // photons, if only beside mirrors
    const bool stores = traces && o.how != method::irradiance_cache;
    const std::string by = o.reference ? "a reference" : "--method " + name_of(o.how);
    look("--caustic-photons", traces, by + " has no photons");
    look("--indirect-photons", stores, by + " has none of these photons");
    look("--direct-photons", stores, by + " has none of these photons");
    look("--estimate", traces, by + " has no photons");
    look("--gather-rays", !o.reference && (caches || o.how == method::final_gather), by + " does not gather");
    look("--accuracy", !o.reference && caches, by + " has no irradiance cache");
    look("--spp", o.until == 0 && o.seconds == 0, o.until > 0 ? "--until decides" : "--time decides");
    look("--error-samples", o.error, "--error is not asked for");
    look("--layers", o.show == view::beauty, "--view shows one of them alone");
    return notes;
}

}  // namespace

std::string name_of(method how) {
    for (const auto& [name, value] : methods) {
        if (value == how) { return name; }
    }
    return {};
}

std::optional<render_options> read_options(int count, const char* const* words) {
    render_options o;
    std::string how = "gather-cache";
    std::string show = "beauty";
    std::string size;
    std::string until;
    CLI::App app{"Renders a picture of a built-in scene or of a model file.", "render"};
    app.footer(
        R"(Without options: the classical combination at 256x256, 16 samples a pixel, into SCENE.exr and SCENE.png.

  render cornell-glass --spp 64 --output glass.exr
  render cornell-diffuse --method path --time 10
  render cornell-diffuse --until 5% --error
  render model.glb --size 640x480 --exposure 2

Ctrl-C ends the pass that is under way, and what is there is written; a second one ends at once.

Status 0: a picture was written. 1: it failed on the way. 2: the wish makes no sense, or the file cannot be read.
130: interrupted, and what was there was written.)");
    app.option_defaults()->take_last();  // a script's options come first, and its caller's win
    add_picture(app, o, size);
    add_method(app, o, how);
    add_questions(app, o, show, until);
    try {
        app.parse(count, words);
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return std::nullopt;
    } catch (const CLI::ParseError& e) { throw usage_error(one_line(e.what())); }
    if (o.list) { return o; }
    if (o.scene.empty()) { throw usage_error("no scene is named; --list shows the built-in ones, --help the options"); }
    o.how = chosen(methods, "--method", how);
    o.show = chosen(views, "--view", show);
    // By their count: an empty word, a shell's unset variable, is a wrong wish.
    if (app.count("--size") > 0) { read_size(size, o); }
    if (app.count("--until") > 0) { o.until = error_share(until); }
    if (app.count("--output") == 0) { o.output = std::filesystem::path{o.scene}.stem().string() + ".exr"; }
    expect_consistent(app, o);
    o.unused = unused(app, o);
    return o;
}

}  // namespace host
