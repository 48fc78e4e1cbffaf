// How the lead over the best rival goes with the number of photons: a picture of what `rivals --csv` wrote.
#include <algorithm>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/command_line.hpp"
#include "error_vs_time/plot.hpp"

namespace {

constexpr std::string_view usage =
    "usage: rivals_plot RIVALS.csv RATIO.svg [SET] [ORDER]\n"
    "\n"
    "How the lead over the best rival goes with the number of photons, from the table that rivals --csv wrote: of a "
    "set\n"
    "of photons (B), for questions in random or coherent order (random).\n";

/// Seconds of ours and of the best of the others; 0 where nobody was asked.
struct pair_of_times {
    double ours{0};
    double best{0};
};

/// By question, then by number of photons.
using table = std::map<std::string, std::map<double, pair_of_times>>;

/// The fields of a line; what stands in quotes may hold commas.
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

table read(const std::string& name, const std::string& set, const std::string& order) {
    std::ifstream file{name};
    if (!file) { throw std::runtime_error("cannot read " + name); }
    table all;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        const std::vector<std::string> f = fields_of(line);
        if (f.size() != 6) { throw std::runtime_error("not six fields: " + line); }
        if (f[0] != set || (f[3] != order && f[2] != "build")) { continue; }
        pair_of_times& times = all[f[2]][std::stod(f[1])];
        const double seconds = std::stod(f[5]);
        if (f[4] == "aglow") { times.ours = seconds; }
        if (!f[4].starts_with("aglow")) { times.best = times.best > 0 ? std::min(times.best, seconds) : seconds; }
    }
    return all;
}

error_vs_time::plot picture_of(const table& all, const std::string& set, const std::string& order) {
    error_vs_time::plot picture{.title = "kd-tree: set " + set + ", single queries in " + order + " order",
                                .x_label = "photons",
                                .y_label = "times as fast as the fastest of the others"};
    for (const char* question : {"k=1", "k=8", "k=50", "k=200", "radius for 50", "build"}) {
        const auto found = all.find(question);
        if (found == all.end()) { continue; }
        error_vs_time::plot_series line{question, error_vs_time::series_colour(picture.series.size()), {}};
        for (const auto& [count, times] : found->second) {
            if (!(times.ours > 0 && times.best > 0)) { continue; }
            const double ratio = times.best / times.ours;
            line.points.push_back({count, ratio, ratio, ratio});
        }
        picture.series.push_back(line);
    }
    return picture;
}

int run(command_line::words& asked) {
    std::vector<std::string> given;
    while (asked.next()) {
        if (asked.is_option() || given.size() == 4) { asked.refuse(); }
        given.push_back(asked.word());
    }
    if (given.size() < 2) { throw std::invalid_argument("wants a table and the name of a picture; see --help"); }
    const std::string set = given.size() > 2 ? given[2] : "B";
    const std::string order = given.size() > 3 ? given[3] : "random";
    std::ofstream file{given[1]};
    file << error_vs_time::svg_file(picture_of(read(given[0], set, order), set, order));
    if (!file.flush()) { throw std::runtime_error("cannot write " + given[1]); }
    return 0;
}

}  // namespace

int main(int count, char** arguments) { return command_line::run(count, arguments, usage, run); }
