// How much faster is our kd-tree than those in use? All contenders answer the same questions in one process, in turn;
// CPU time, medians; every answer of a sample is compared with brute force.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <aglow/containers/kd_tree.hpp>

#include "common/command_line.hpp"
#include "kd_tree_contender.hpp"
#include "kd_tree_threads.hpp"

namespace rivals {
namespace {

constexpr std::string_view usage =
    "usage: rivals [options]\n"
    "\n"
    "The kd-tree beside those of nanoflann, FLANN and CGAL: building, nearest photons and photons within a radius.\n"
    "\n"
    "  --sets LETTERS   sets of photons (ABRCD)\n"
    "  --count N        photons of each (1000000)\n"
    "  --queries N      questions (20000)\n"
    "  --repeats N      turns whose median counts (5)\n"
    "  --only PARTS     of build,random,coherent\n"
    "  --csv FILE       writes the table as well, for rivals_plot\n"
    "  --append         adds its rows to those that FILE has: a long contest can be held in parts\n"
    "  --smoke          only tries whether everything works\n"
    "  --help           this\n";

struct settings {
    std::size_t count = 1'000'000;
    std::size_t queries = 20'000;
    std::size_t repeats = 5;
    std::string sets = "ABRCD";
    std::string csv;
    std::string only = "build,random,coherent";
    bool append = false;

    [[nodiscard]] bool wants(const std::string& part) const { return only.find(part) != std::string::npos; }
};

/// One question in one order on one set: what each contender took for it.
struct row {
    char set;
    std::string what;
    std::string order;
    std::map<std::string, double> seconds;
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

class contest {
public:
    explicit contest(settings what) : settings_{std::move(what)} {
        add_aglow(all_);
#ifdef RIVALS_AVX2
        if (__builtin_cpu_supports("avx2")) { add_aglow_avx2(all_); }
#endif
#ifdef RIVALS_SSE
        add_aglow_sse(all_);
#endif
#ifdef RIVALS_NANOFLANN
        add_nanoflann(all_);
#endif
#ifdef RIVALS_FLANN
        add_flann(all_);
#endif
#ifdef RIVALS_CGAL
        add_cgal(all_);
#endif
    }

    /// Whether every checked answer was right.
    bool run() {
        for (const char set : settings_.sets) { run(set); }
        if (!settings_.csv.empty()) { write_csv(); }
        std::printf("\n%zu answers compared with brute force, %zu wrong (checksum %g)\n", checked_, wrong_, sum_);
        return wrong_ == 0;
    }

private:
    void run(char set) {
        const std::vector<point> places = points_of(set, settings_.count, 1);
        std::vector<photon> photons(places.size());
        dice random{3};
        for (std::size_t i = 0; i < photons.size(); ++i) {
            photons[i] = {places[i], {random.in_cube(), random.in_cube()}};
        }
        std::printf("\nset %c, %zu photons\n", set, photons.size());
        build(set, photons);
        constexpr std::size_t checks = 4;
        for (const bool coherent : {false, true}) {
            if (!settings_.wants(coherent ? "coherent" : "random")) { continue; }
            const auto queries = questions(set, 1'000'000, settings_.queries, coherent);
            const std::string order = coherent ? "coherent" : "random";
            for (const std::size_t k : {std::size_t{1}, std::size_t{8}, std::size_t{50}, std::size_t{200}}) {
                if (k > photons.size()) { continue; }
                for (std::size_t i = 0; i < checks; ++i) { check_nearest(photons, queries[i * 7 % queries.size()], k); }
                measure({set, "k=" + std::to_string(k), order, {}}, queries.size(),
                        [&](contender& c) { return c.nearest(queries, k); });
            }
            measure({set, "k=50 + estimate", order, {}}, queries.size(),
                    [&](contender& c) { return c.estimate(queries, std::min<std::size_t>(50, photons.size())); });
            for (const std::size_t hits : {std::size_t{50}, std::size_t{200}}) {
                const float radius2 = radius_for(queries, std::min(hits, photons.size()));
                for (std::size_t i = 0; i < checks; ++i) {
                    check_within(photons, queries[i * 7 % queries.size()], radius2);
                }
                measure({set, "radius for " + std::to_string(hits), order, {}}, queries.size(),
                        [&](contender& c) { return c.within(queries, radius2); });
            }
        }
    }

    void build(char set, const std::vector<photon>& photons) {
        row builds{set, "build", "", {}};
        std::map<std::string, std::vector<double>> seconds;
        const std::size_t rounds = settings_.wants("build") ? (settings_.repeats + 1) / 2 : 1;
        for (std::size_t i = 0; i < rounds; ++i) {
            for (auto& c : all_) {
                if (c->borrows()) { continue; }
                const double start = cpu_seconds();
                c->build(photons);
                seconds[c->name()].push_back(cpu_seconds() - start);
            }
            const auto own = [&](const char* name, const auto& executor) {
                seconds[name].push_back(critical_seconds(executor, [&] {
                    const aglow::kd_tree<float> tree{photons, &photon::position, executor};
                    sum_ += static_cast<double>(tree.size());
                }));
            };
            own("aglow, index only", timed_threads{1});
            own("aglow, index only, 2 threads", timed_threads{2});
        }
        if (!settings_.wants("build")) { return; }
        for (auto& [name, values] : seconds) { builds.seconds[name] = median(values); }
        report(builds, 1);
        std::printf("  bytes a photon:");
        for (auto& c : all_) { std::printf("  %s %.1f", c->name().c_str(), c->bytes_per_photon()); }
        std::printf("\n");
    }

    /// Squared radius that holds `hits` photons in the mean over the queries.
    float radius_for(const std::vector<point>& queries, std::size_t hits) {
        std::vector<float> distances2;
        std::size_t asked = 0;
        for (std::size_t i = 0; i < queries.size(); i += queries.size() / 200 + 1, ++asked) {
            const std::size_t most = std::min(settings_.count, hits * 30);
            for (const answer& a : all_.front()->list_nearest(queries[i], most)) { distances2.push_back(a.distance2); }
        }
        const auto middle =
            distances2.begin() + static_cast<std::ptrdiff_t>(std::min(asked * hits, distances2.size() - 1));
        std::nth_element(distances2.begin(), middle, distances2.end());
        return std::max(*middle, 1e-8f);
    }

    void measure(row what, std::size_t queries, const std::function<double(contender&)>& ask) {
        std::map<std::string, std::vector<double>> seconds;
        for (std::size_t i = 0; i < settings_.repeats; ++i) {
            for (auto& c : all_) {
                if (what.order == "random" && c->name() == "aglow, hinted") { continue; }
                const double start = cpu_seconds();
                sum_ += ask(*c);
                seconds[c->name()].push_back(cpu_seconds() - start);
            }
        }
        for (auto& [name, values] : seconds) { what.seconds[name] = median(values) / static_cast<double>(queries); }
        report(what, 1e3);
    }

    /// One line: our times, the best rival, and how many times ours that is.
    void report(const row& what, double scale) {
        double best = 0;
        std::string who = "nobody";
        for (auto& [name, seconds] : what.seconds) {
            if (name.starts_with("aglow") || (best > 0 && seconds >= best)) { continue; }
            best = seconds;
            who = name;
        }
        std::printf("  %-16s %-9s", what.what.c_str(), what.order.c_str());
        for (auto& [name, seconds] : what.seconds) {
            if (!name.starts_with("aglow")) { continue; }
            std::printf(" %s %.3f (%.1fx)", name.c_str() + (name.size() > 7 ? 7 : 0), 1e3 * scale * seconds,
                        best / seconds);
        }
        std::printf("  %s %.3f", who.c_str(), 1e3 * scale * best);
        std::printf("  %s\n", scale > 1 ? "us" : "ms");
        std::fflush(stdout);
        rows_.push_back(what);
    }

    void check_nearest(const std::vector<photon>& photons, const point& query, std::size_t k) {
        std::vector<answer> truth = all_distances(photons, query);
        std::nth_element(truth.begin(), truth.begin() + static_cast<std::ptrdiff_t>(k - 1), truth.end(), nearer);
        truth.resize(k);
        std::sort(truth.begin(), truth.end(), nearer);
        for (auto& c : all_) { compare(*c, truth, c->list_nearest(query, k)); }
    }
    void check_within(const std::vector<photon>& photons, const point& query, float radius2) {
        std::vector<answer> truth = all_distances(photons, query);
        const auto inside = [&](float r2) {
            return std::count_if(truth.begin(), truth.end(), [&](const answer& a) { return a.distance2 < r2; });
        };
        const auto least = inside(radius2 * (1 - 1e-5f));
        const auto most = inside(radius2 * (1 + 1e-5f));
        std::erase_if(truth, [&](const answer& a) { return !(a.distance2 < radius2); });
        std::sort(truth.begin(), truth.end(), nearer);
        for (auto& c : all_) {
            const std::vector<answer> found = c->list_within(query, radius2);
            if (c->is_ours()) {
                compare(*c, truth, found);
                continue;
            }
            // Others round in their own way what is nearly as far as the radius.
            const auto size = static_cast<std::ptrdiff_t>(found.size());
            note(*c, least <= size && size <= most);
        }
    }

    static std::vector<answer> all_distances(const std::vector<photon>& photons, const point& query) {
        std::vector<answer> all(photons.size());
        for (std::uint32_t i = 0; i < all.size(); ++i) {
            all[i] = {aglow::simd::distance2(photons[i].position, query), i};
        }
        return all;
    }
    static bool nearer(const answer& a, const answer& b) {
        return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.index < b.index);
    }

    /// Ours must find the very items; of others, whose ties and last bits are their own, the distances count.
    void compare(const contender& c, const std::vector<answer>& truth, std::vector<answer> found) {
        std::sort(found.begin(), found.end(), nearer);
        bool same = found.size() == truth.size();
        for (std::size_t i = 0; same && i < found.size(); ++i) {
            const float allowed = c.is_ours() ? 0 : 1e-5f * truth[i].distance2 + 1e-13f;
            same = std::abs(found[i].distance2 - truth[i].distance2) <= allowed;
            same = same && (!c.is_ours() || found[i].index == truth[i].index);
        }
        note(c, same);
    }
    void note(const contender& c, bool right) {
        ++checked_;
        if (right) { return; }
        ++wrong_;
        std::printf("  wrong: %s\n", c.name().c_str());
    }

    void write_csv() const {
        std::FILE* file = std::fopen(settings_.csv.c_str(), settings_.append ? "a" : "w");
        if (file == nullptr) { throw std::runtime_error("cannot write " + settings_.csv); }
        if (std::ftell(file) == 0) { std::fprintf(file, "set,count,question,order,contender,seconds\n"); }
        for (const row& r : rows_) {
            for (auto& [name, seconds] : r.seconds) {
                std::fprintf(file, "%c,%zu,%s,%s,\"%s\",%.4g\n", r.set, settings_.count, r.what.c_str(),
                             r.order.c_str(), name.c_str(), seconds);
            }
        }
        std::fclose(file);
    }

    settings settings_;
    contenders all_;
    std::vector<row> rows_;
    std::size_t checked_{0};
    std::size_t wrong_{0};
    double sum_{0};
};

settings parse(command_line::words& asked) {
    constexpr std::size_t most = 100'000'000;
    settings s;
    while (asked.next()) {
        if (asked.is("--smoke")) {
            s.count = 3000;
            s.queries = 256;
            s.repeats = 1;
        } else if (asked.is("--append")) {
            s.append = true;
        } else if (asked.is("--count")) {
            s.count = asked.number(1, most);
        } else if (asked.is("--queries")) {
            s.queries = asked.number(1, most);
        } else if (asked.is("--repeats")) {
            s.repeats = asked.number(1, 1000);
        } else if (asked.is("--sets")) {
            s.sets = asked.value();
        } else if (asked.is("--csv")) {
            s.csv = asked.value();
        } else if (asked.is("--only")) {
            s.only = asked.value();
        } else {
            asked.refuse();
        }
    }
    return s;
}

}  // namespace
}  // namespace rivals

int main(int count, char** arguments) {
    return command_line::run(count, arguments, rivals::usage, [](command_line::words& asked) {
        return rivals::contest{rivals::parse(asked)}.run() ? 0 : 1;
    });
}
