// How fast an octree of spheres takes records in and tells which of them cover a point, beside the textbook's pointer
// octree.
//
// All contenders take turns in one process; times are CPU time of one thread, medians over the turns. Answers are
// compared with brute force in the same run. The last columns are lookups on two threads at once, as a multiple of one
// thread's.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <aglow/containers/octree.hpp>

#include "common/command_line.hpp"
#include "kd_tree_sets.hpp"
#include "textbook_octree.hpp"

namespace {

using rivals::dice;
using rivals::point;

/// 64 bytes, as an irradiance record with gradients has.
struct record {
    point centre;
    float radius;
    float number;
    float light[11];
};
static_assert(sizeof(record) == 64);

using records = std::vector<record>;

constexpr std::string_view usage =
    "usage: rivals_octree [options]\n"
    "\n"
    "An octree of spheres beside the textbooks': inserting, and lookups in random and in coherent order.\n"
    "\n"
    "  --repeats N   turns whose median counts (5)\n"
    "  --csv FILE    writes the table as well\n"
    "  --smoke       only tries whether everything works\n"
    "  --help        this\n";

struct settings {
    bool smoke = false;
    std::size_t repeats = 5;
    std::string csv;
};

point on_walls(dice& random) {
    point p = random.in_cube();
    const std::uint64_t wall = random.below(6);
    p[static_cast<int>(wall / 2)] = static_cast<float>(wall % 2);
    return p;
}

// W: walls of a room, radii within a factor of four. S: the same walls, radii over three decades. V: all of the room.
// About six records cover a place.
record make(char set, dice& random, std::size_t count) {
    const float n = static_cast<float>(count);
    record r{};
    r.centre = set == 'V' ? random.in_cube() : on_walls(random);
    if (set == 'W') { r.radius = std::sqrt(36 / (3.1416f * n)) * std::exp2(2 * random.even() - 1.22f); }
    if (set == 'S') { r.radius = std::sqrt(36 / (3.1416f * n)) * 3.7f * std::pow(10.0f, -3 * random.even()); }
    if (set == 'V') { r.radius = std::cbrt(6 / (4.1888f * n)) * std::exp2(2 * random.even() - 1.45f); }
    return r;
}

records make_records(char set, std::size_t count) {
    dice random{2024};
    records all;
    for (std::size_t i = 0; i < count; ++i) {
        all.push_back(make(set, random, count));
        all.back().number = static_cast<float>(i);
    }
    return all;
}

std::vector<point> make_questions(char set, std::size_t population, std::size_t count, bool coherent) {
    dice random{7};
    std::vector<point> all(coherent ? std::max(population, count) : count);
    for (point& p : all) { p = set == 'V' ? random.in_cube() : on_walls(random); }
    if (!coherent) { return all; }
    rivals::sort_near(all);
    constexpr std::size_t tile = 128;
    std::vector<point> tiles;
    while (tiles.size() < count) {
        const std::size_t first = random.below(all.size() / tile) * tile;
        tiles.insert(tiles.end(), all.begin() + static_cast<std::ptrdiff_t>(first),
                     all.begin() + static_cast<std::ptrdiff_t>(first + tile));
    }
    return tiles;
}

bool covers(const record& r, const point& p) { return aglow::simd::distance2(r.centre, p) <= r.radius * r.radius; }

struct contender {
    virtual ~contender() = default;
    virtual const char* name() const = 0;
    virtual void build(const records& all) = 0;
    /// The sum over all questions of the light of the records that cover them, and how many were used.
    virtual double ask(std::span<const point> questions, std::size_t& used) const = 0;
    virtual std::vector<float> answer(const point& p) const = 0;
    virtual double bytes() const = 0;
};

struct textbook : contender {
    using tree = rivals::textbook_octree<record>;
    std::unique_ptr<tree> records_;

    const char* name() const override { return "textbook"; }
    void build(const records& all) override {
        records_ = std::make_unique<tree>(aglow::bounds<float>{point{0}, point{1}});
        for (const record& r : all) { records_->insert(r, r.centre, r.radius); }
    }
    double ask(std::span<const point> questions, std::size_t& used) const override {
        float sum = 0;
        for (const point& p : questions) {
            records_->visit(p, [&](const record& r) {
                if (!covers(r, p)) { return; }
                sum += r.number;
                ++used;
            });
        }
        return static_cast<double>(sum);
    }
    std::vector<float> answer(const point& p) const override {
        std::vector<float> found;
        records_->visit(p, [&](const record& r) {
            if (covers(r, p)) { found.push_back(r.number); }
        });
        std::sort(found.begin(), found.end());
        return found;
    }
    double bytes() const override { return static_cast<double>(records_->bytes()); }
};

struct growing : contender {
    std::unique_ptr<aglow::octree<record>> tree;

    const char* name() const override { return "octree"; }
    void build(const records& all) override {
        tree = std::make_unique<aglow::octree<record>>();
        for (const record& r : all) { tree->insert(r, r.centre, r.radius); }
    }
    double ask(std::span<const point> questions, std::size_t& used) const override {
        float sum = 0;
        for (const point& p : questions) {
            tree->visit_covering(p, [&](const record& r) {
                sum += r.number;
                ++used;
            });
        }
        return static_cast<double>(sum);
    }
    std::vector<float> answer(const point& p) const override {
        std::vector<float> found;
        tree->visit_covering(p, [&](const record& r) { found.push_back(r.number); });
        return found;
    }
    double bytes() const override { return static_cast<double>(tree->bytes()); }
};

struct settled : growing {
    const char* name() const override { return "settled"; }
    void build(const records& all) override {
        growing::build(all);
        tree->settle();
    }
};

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// Nanoseconds for each of `count` when `task` does them all.
template <typename Task>
double nanoseconds(std::size_t count, const Task& task) {
    const double start = cpu_seconds();
    task();
    return (cpu_seconds() - start) * 1e9 / static_cast<double>(count);
}

// Lookups per CPU second of two threads at once, each with all questions, as a multiple of one thread's.
double two_threads(const contender& who, std::span<const point> questions, double alone) {
    double each[2] = {};
    {
        std::vector<std::jthread> crew;
        for (double& mine : each) {
            crew.emplace_back([&] {
                std::size_t used = 0;
                mine = nanoseconds(questions.size(), [&] { who.ask(questions, used); });
            });
        }
    }
    return 2 * alone / std::max(each[0], each[1]);
}

struct row {
    std::vector<double> insert, random, coherent, together;
    double bytes = 0;
    double used = 0;
};

void check(const contender& who, const records& all, std::span<const point> questions) {
    for (const point& p : questions) {
        std::vector<float> expected;
        for (const record& r : all) {
            if (covers(r, p)) { expected.push_back(r.number); }
        }
        if (who.answer(p) != expected) {
            throw std::runtime_error(std::string{who.name()} + ": not what brute force finds");
        }
    }
}

void compare(char set, std::size_t count, const settings& how, std::ostream& csv) {
    const records all = make_records(set, count);
    const std::size_t asked = how.smoke ? 2'000 : 100'000;
    const auto random = make_questions(set, count, asked, false);
    const auto coherent = make_questions(set, count, asked, true);
    std::vector<std::unique_ptr<contender>> contenders;
    contenders.push_back(std::make_unique<textbook>());
    contenders.push_back(std::make_unique<growing>());
    contenders.push_back(std::make_unique<settled>());
    std::vector<row> rows(contenders.size());
    for (std::size_t turn = 0; turn < how.repeats; ++turn) {
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            contender& who = *contenders[i];
            row& r = rows[i];
            std::size_t used = 0;
            if (turn < 3 || count <= 100'000) {
                r.insert.push_back(nanoseconds(count, [&] { who.build(all); }));
            }
            if (turn == 0) {
                check(who, all, std::span{random}.first(how.smoke ? 50 : 30'000'000 / (count + 100'000)));
            }
            r.random.push_back(nanoseconds(asked, [&] { who.ask(random, used); }));
            r.used = static_cast<double>(used) / static_cast<double>(asked);
            r.coherent.push_back(nanoseconds(coherent.size(), [&] { who.ask(coherent, used); }));
            r.together.push_back(two_threads(who, random, r.random.back()));
            r.bytes = who.bytes() / static_cast<double>(count);
        }
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto against = [&](auto times) { return median(rows[0].*times) / median(rows[i].*times); };
        std::printf(
            "%c %8zu  %-9s insert %6.0f ns %5.2fx   random %6.0f ns %5.2fx   coherent %6.0f ns %5.2fx   %6.1f bytes   "
            "%4.1f used   2 threads %4.2fx\n",
            set, count, contenders[i]->name(), median(rows[i].insert), against(&row::insert), median(rows[i].random),
            against(&row::random), median(rows[i].coherent), against(&row::coherent), rows[i].bytes, rows[i].used,
            median(rows[i].together));
        csv << set << ',' << count << ',' << contenders[i]->name() << ',' << median(rows[i].insert) << ','
            << median(rows[i].random) << ',' << median(rows[i].coherent) << ',' << rows[i].bytes << ',' << rows[i].used
            << ',' << median(rows[i].together) << '\n';
    }
    std::fflush(stdout);
}

settings read_settings(command_line::words& asked) {
    settings how;
    while (asked.next()) {
        if (asked.is("--smoke")) {
            how.smoke = true;
            how.repeats = 1;
        } else if (asked.is("--csv")) {
            how.csv = asked.value();
        } else if (asked.is("--repeats")) {
            how.repeats = asked.number(1, 1000);
        } else {
            asked.refuse();
        }
    }
    return how;
}

void run(const settings& how) {
    std::ofstream csv;
    if (!how.csv.empty()) { csv.open(how.csv); }
    csv << "set,records,who,insert_ns,random_ns,coherent_ns,bytes,used,two_threads\n";
    const std::vector<std::size_t> counts =
        how.smoke ? std::vector<std::size_t>{1'000} : std::vector<std::size_t>{1'000, 10'000, 100'000, 1'000'000};
    for (const char set : {'W', 'S', 'V'}) {
        for (const std::size_t count : counts) { compare(set, count, how, csv); }
    }
    if (!how.csv.empty() && !csv.flush()) { throw std::runtime_error(how.csv + ": cannot be written"); }
}

}  // namespace

int main(int count, char** arguments) {
    return command_line::run(count, arguments, usage, [](command_line::words& asked) {
        run(read_settings(asked));
        return 0;
    });
}
