// How the lead over the best rival goes with the number of photons: a picture of what `rivals --csv` wrote.
//
//     rivals_plot rivals.csv ratio.svg [set, B] [order, random]
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "error_vs_time/plot.hpp"

namespace {

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
    if (!file) { throw std::runtime_error("rivals_plot: cannot read " + name); }
    table all;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        const std::vector<std::string> f = fields_of(line);
        if (f.size() != 6) { throw std::runtime_error("rivals_plot: not six fields: " + line); }
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

}  // namespace

int main(int count, char** words) {
    if (count < 3) {
        std::fprintf(stderr, "rivals_plot rivals.csv ratio.svg [set] [order]\n");
        return 2;
    }
    try {
        const std::string set = count > 3 ? words[3] : "B";
        const std::string order = count > 4 ? words[4] : "random";
        std::ofstream{words[2]} << error_vs_time::svg_file(picture_of(read(words[1], set, order), set, order));
    } catch (const std::exception& trouble) {
        std::fprintf(stderr, "%s\n", trouble.what());
        return 2;
    }
}
