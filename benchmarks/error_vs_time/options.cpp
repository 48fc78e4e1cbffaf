#include "error_vs_time/options.hpp"

#include <algorithm>
#include <charconv>
#include <functional>
#include <stdexcept>

#include "common/command_line.hpp"
#include "error_vs_time/seeds.hpp"

namespace error_vs_time {

const std::string_view usage =
    "usage: error_vs_time [options]\n"
    "\n"
    "Renders scenes by all methods at rising budgets, on one thread, and compares each picture with a reference.\n"
    "\n"
    "  --output DIR     where results go (build/error_vs_time)\n"
    "  --scene NAME     a scene to measure; may be given again (cornell-diffuse, cornell-glass)\n"
    "  --size N         pictures of N x N pixels (256); where no reference of that size is kept, one is made first\n"
    "  --seeds N        pictures for each budget, 2 to 1000 (3)\n"
    "  --relmse E,...   errors whose time is told (8e-3,1.9e-3,1.2e-3,4.5e-4,1.3e-4)\n"
    "  --full           larger budgets, 8 seeds and three more scenes: hours instead of minutes\n"
    "  --smoke          only tries whether everything works: the first budgets at 16 x 16 pixels\n"
    "  --help           this\n"
    "\n"
    "DIR gets report.html (to look at), report.md, runs.csv (one line a picture), report.json (for compare_reports),\n"
    "the curves of each scene as SVG, and the last pictures as EXR in pictures/. Stopped in the middle, the same "
    "command\n"
    "goes on where it was; steps of the same build, machine, size and seeds in DIR are not rendered again.\n";

namespace {

std::vector<double> errors(std::string_view option, std::string_view text) {
    std::vector<double> found;
    for (const char *at = text.data(), *last = at + text.size();;) {
        double error = 0;
        const auto [end, wrong] = std::from_chars(at, last, error);
        if (wrong != std::errc{} || !(error > 0 && error < 1e3) || (end != last && *end != ',')) {
            throw std::invalid_argument(std::string{option} + " wants positive numbers with commas between, not \"" +
                                        std::string{text} + '"');
        }
        found.push_back(error);
        if (end == last) { break; }
        at = end + 1;
    }
    std::sort(found.begin(), found.end(), std::greater{});
    return found;
}

void add_once(std::vector<std::string>& names, std::string_view name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) { names.emplace_back(name); }
}

/// What --full and --smoke stand for, where nothing else was said.
void fill_in(options& result, bool scenes_named, bool size_named, bool seeds_named) {
    if (result.full && result.smoke) { throw std::invalid_argument("--full and --smoke exclude each other"); }
    if (result.full) {
        if (!seeds_named) { result.seeds = 8; }
        for (const char* more : {"glossy-floor", "point-light", "sky-room"}) {
            if (!scenes_named) { result.scenes.emplace_back(more); }
        }
    }
    if (result.smoke) {
        if (!scenes_named) { result.scenes = {"cornell-diffuse"}; }
        if (!size_named) { result.size = 16; }
        if (!seeds_named) { result.seeds = 2; }
        result.reference_samples = 16;
    }
}

}  // namespace

options parse(std::span<const std::string_view> words) {
    options result;
    std::vector<std::string> named;
    bool size_named = false;
    bool seeds_named = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string_view word = words[i];
        const auto value = [&] {
            if (i + 1 >= words.size()) { throw std::invalid_argument(std::string{word} + " wants a value"); }
            return words[++i];
        };
        if (word == "--help" || word == "-h") {
            result.help = true;
        } else if (word == "--output" || word == "-o") {
            result.output = value();
        } else if (word == "--scene") {
            add_once(named, value());
        } else if (word == "--size") {
            result.size = command_line::whole(word, value(), 8, 4096);
            size_named = true;
        } else if (word == "--seeds") {
            result.seeds = command_line::whole(word, value(), 2, most_seeds);
            seeds_named = true;
        } else if (word == "--relmse") {
            result.relmse_targets = errors(word, value());
        } else if (word == "--full") {
            result.full = true;
        } else if (word == "--smoke") {
            result.smoke = true;
        } else {
            throw std::invalid_argument("no option " + std::string{word} + "; --help tells of those there are");
        }
    }
    if (!named.empty()) { result.scenes = named; }
    fill_in(result, !named.empty(), size_named, seeds_named);
    return result;
}

}  // namespace error_vs_time
