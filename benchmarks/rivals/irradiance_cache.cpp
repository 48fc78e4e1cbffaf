// rivals_irradiance_cache: whole lookups, from a place and its normal to blended irradiance, by our caches and by the
// textbooks' octree; and irradiance points, nearest first, with the test of normals.
//
// Walls of a unit room; reaches within a factor of two, six over each place. CPU seconds of one thread, medians of
// interleaved repeats. `random`: places anywhere; `coherent`: tiles of 128 neighbours. Before any time counts the
// answers of both indices are compared.
//
//     textbook   a record is weighed and added as the octree visits it
//     and ours   the textbooks' octree, and our blend of eight records at a time
//     growing    a cache that may grow
//     frozen     a cache that no longer does
//     in step    the same, asked about 1,024 places at a time
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <aglow/estimators/irradiance_cache.hpp>
#include <aglow/estimators/irradiance_points.hpp>

#include "common/command_line.hpp"
#include "kd_tree_sets.hpp"
#include "textbook_octree.hpp"

namespace {

using rivals::dice;
using rivals::point;
using rgb = aglow::vec3<float>;
using cache = aglow::irradiance_cache<rgb, float>;
using answer = aglow::irradiance_answer<rgb, float>;

constexpr std::string_view usage =
    "usage: rivals_irradiance_cache [options]\n"
    "\n"
    "Whole lookups of irradiance caches and of irradiance points beside those in the textbooks' octree.\n"
    "\n"
    "  --repeats N   turns whose median counts (5)\n"
    "  --smoke       only tries whether everything works\n"
    "  --help        this\n";

constexpr float scene_radius = 0.87f;

struct place {
    point position;
    point normal;
};
using places = std::vector<place>;

places on_walls(std::size_t count, std::uint64_t seed, bool coherent = false) {
    dice random{seed};
    std::vector<point> positions(count);
    for (point& p : positions) {
        p = random.in_cube();
        const std::uint64_t wall = random.below(6);
        p[static_cast<int>(wall / 2)] = static_cast<float>(wall % 2);
    }
    if (coherent) { rivals::sort_near(positions); }
    places made;
    for (const point& p : positions) {
        const int axis = p.x == 0 || p.x == 1 ? 0 : p.y == 0 || p.y == 1 ? 1 : 2;
        made.push_back({p, point{0}});
        made.back().normal[axis] = p[axis] == 0 ? 1.0f : -1.0f;
    }
    return made;
}

places tiles(std::size_t population, std::size_t count) {
    constexpr std::size_t tile = 128;
    const places all = on_walls(std::max(population, count), 2, true);
    dice random{3};
    places some;
    while (some.size() < count) {
        const std::size_t first = random.below(all.size() / tile) * tile;
        for (std::size_t i = first; i < first + tile; ++i) { some.push_back(all[i]); }
    }
    return some;
}

aglow::irradiance_cache_options options() {
    aglow::irradiance_cache_options o;
    o.reach.minimum_radius = 1e-6;  // so that a million of them need not overlap more than a thousand
    return o;
}

/// Light that bends as much as it takes for a record to reach `radius`.
aglow::irradiance_estimate<rgb, float> bent(const place& at, float radius) {
    aglow::irradiance_estimate<rgb, float> e;
    e.position = at.position;
    e.axes = aglow::frame<float>{at.normal};
    e.irradiance = rgb{1};
    const double reach = static_cast<double>(radius / scene_radius) / options().reach.accuracy;
    e.curvature.xx = e.curvature.yy =
        static_cast<float>(4 / (reach * reach * reach * reach)) / (scene_radius * scene_radius);
    e.gradients.translation.x = rgb{0.1f};
    e.relative_noise = 0.02f;
    e.rays = 400;
    return e;
}

/// The records of a frozen cache in the textbooks' octree.
class textbook {
public:
    explicit textbook(const cache::frozen& from) {
        for (std::uint32_t i = 0; i < from.size(); ++i) {
            tree_.insert({from[i], 0.1f}, from[i].position(), from[i].longest_radius());
        }
    }
    [[nodiscard]] answer lookup(const point& p, const point& normal) const {
        aglow::record_blend<rgb, float> blend{p, normal, limits_};
        visit(p, [&](const item& i) { (void)blend.add(i.record, i.bend); });
        return blend.answer();
    }
    /// The same by our blend.
    [[nodiscard]] answer lookup_eight(const point& p, const point& normal) const {
        aglow::record_blend<rgb, float> blend{p, normal, limits_};
        const item* near[64];
        std::size_t count = 0;
        const auto add_near = [&] {
            blend.add(
                count, [&](std::size_t i) -> const item& { return *near[i]; }, [](aglow::detail::verdict) {});
            count = 0;
        };
        visit(p, [&](const item& i) {
            near[count++] = &i;
            if (count == 64) { add_near(); }
        });
        add_near();
        return blend.answer();
    }
    [[nodiscard]] double checked(const places& questions) const {
        std::size_t sum = 0;
        for (const place& q : questions) {
            tree_.visit(q.position, [&](const item&) { ++sum; });
        }
        return static_cast<double>(sum) / static_cast<double>(questions.size());
    }
    [[nodiscard]] std::size_t bytes() const { return tree_.bytes(); }

private:
    struct item {
        cache::record record;
        float bend;
    };

    template <typename Visitor>
    void visit(const point& p, const Visitor& visitor) const {
        tree_.visit(p, [&](const item& i) {
            if (aglow::distance2(p, i.record.position()) < aglow::square(i.record.longest_radius())) { visitor(i); }
        });
    }

    rivals::textbook_octree<item> tree_{aglow::bounds<float>{point{0}, point{1}}};
    aglow::detail::lookup_limits<float> limits_{options().lookup, options().reach.metric};
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

/// Nanoseconds for one of `questions`, of which `task` adds up some number over each.
template <typename Task>
double time_of(const places& questions, const Task& task) {
    const double start = cpu_seconds();
    const float sum = task(questions);
    const double seconds = cpu_seconds() - start;
    if (!(sum < 1e30f)) { throw std::runtime_error("an answer is no number"); }
    return seconds * 1e9 / static_cast<double>(questions.size());
}

/// Asks `one(place)` about each.
template <typename One>
auto each(One one) {
    return [one](const places& questions) {
        float sum = 0;
        for (const place& q : questions) { sum += one(q); }
        return sum;
    };
}

float ask_in_step(const cache::frozen& from, const places& questions) {
    float sum = 0;
    std::vector<answer> answers(1024);
    for (std::size_t i = 0; i < questions.size(); i += answers.size()) {
        const auto some = std::span{questions}.subspan(i, std::min(answers.size(), questions.size() - i));
        from.lookup_each(some, std::span{answers});
        for (std::size_t k = 0; k < some.size(); ++k) { sum += answers[k].irradiance.x; }
    }
    return sum;
}

struct times {
    std::vector<double> random, coherent;
};

struct questions {
    places random, coherent;

    template <typename Task>
    void ask(times& t, const Task& task) const {
        t.random.push_back(time_of(random, task));
        t.coherent.push_back(time_of(coherent, task));
    }
};

void compare(std::size_t count, std::size_t asked, std::size_t repeats) {
    cache growing{scene_radius, options()};
    const auto radius = static_cast<float>(std::sqrt(36 / (3.1416 * static_cast<double>(count))));
    dice random_reach{5};
    double start = cpu_seconds();
    for (const place& p : on_walls(count, 1)) {
        (void)growing.insert(bent(p, radius * std::exp2(random_reach.even() - 0.6f)));
    }
    const double insertion = (cpu_seconds() - start) * 1e9 / static_cast<double>(count);
    const cache::frozen frozen = growing.freeze();
    const textbook book{frozen};
    const questions about{on_walls(asked, 2), tiles(count, asked)};
    for (std::size_t i = 0; i < std::min<std::size_t>(asked, 5000); ++i) {
        const place& at = about.random[i];
        const answer a = frozen.lookup(at.position, at.normal), b = book.lookup(at.position, at.normal);
        if (a.records != b.records || std::abs(a.weight - b.weight) > 1e-4f) {
            throw std::runtime_error("the two indices do not find the same records");
        }
    }
    aglow::lookup_counters counters;
    for (const place& q : about.random) { (void)frozen.lookup(q.position, q.normal, counters); }
    const auto of = [](const auto& from) {
        return [&from](const place& q) { return from.lookup(q.position, q.normal).irradiance.x; };
    };
    const auto eight = [&](const place& q) { return book.lookup_eight(q.position, q.normal).irradiance.x; };
    times each_one[5];
    for (std::size_t turn = 0; turn < repeats; ++turn) {
        about.ask(each_one[0], each(of(book)));
        about.ask(each_one[1], each(eight));
        about.ask(each_one[2], each(of(growing)));
        about.ask(each_one[3], each(of(frozen)));
        about.ask(each_one[4], [&](const places& some) { return ask_in_step(frozen, some); });
    }
    const auto n = static_cast<double>(count);
    const char* names[] = {"textbook", "and ours", "growing", "frozen", "in step"};
    const std::size_t bytes[] = {book.bytes(), book.bytes(), growing.bytes(), frozen.bytes(), frozen.bytes()};
    const double random = median(each_one[0].random), coherent = median(each_one[0].coherent);
    for (int i = 0; i < 5; ++i) {
        const double one = median(each_one[i].random), near = median(each_one[i].coherent);
        std::printf("records %8zu  %-9s random %6.0f ns %5.2fx   coherent %6.0f ns %5.2fx   %6.1f bytes\n", count,
                    names[i], one, random / one, near, coherent / near, static_cast<double>(bytes[i]) / n);
    }
    std::printf("records %8zu  %.1f used of %.1f that the textbook checks; insertion %.0f ns, neighbours clamped\n",
                count, static_cast<double>(counters.used) / static_cast<double>(counters.lookups),
                book.checked(about.random), insertion);
    std::fflush(stdout);
}

void read_points(std::size_t count, std::size_t asked, std::size_t repeats) {
    std::vector<aglow::irradiance_point<rgb, float>> points;
    for (const place& p : on_walls(count, 1)) {
        points.push_back({.position = p.position, .normal = p.normal, .irradiance = rgb{1}});
    }
    const aglow::irradiance_points<rgb, float> map{points};
    const questions about{on_walls(asked, 2), tiles(count, asked)};
    times lit, dark;
    const auto read = [&](const place& q, float side) {
        const auto found = map.nearest(q.position, q.normal * side);
        return found ? found->value.x : 0.0f;
    };
    const auto in_front = [&](const place& q) { return read(q, 1); };
    const auto behind = [&](const place& q) { return read(q, -1); };
    for (std::size_t turn = 0; turn < repeats; ++turn) {
        about.ask(lit, each(in_front));
        dark.random.push_back(time_of(about.random, each(behind)));
    }
    std::printf(
        "points  %8zu  nearest   random %6.0f ns         coherent %6.0f ns         %6.1f bytes   none fits %6.0f ns\n",
        count, median(lit.random), median(lit.coherent), static_cast<double>(map.memory()) / static_cast<double>(count),
        median(dark.random));
    std::fflush(stdout);
}

int run(command_line::words& asked) {
    bool smoke = false;
    std::size_t repeats = 5;
    while (asked.next()) {
        if (asked.is("--smoke")) {
            smoke = true;
            repeats = 1;
        } else if (asked.is("--repeats")) {
            repeats = asked.number(1, 1000);
        } else {
            asked.refuse();
        }
    }
    const std::size_t lookups = smoke ? 2'000 : 65'536;
    for (const std::size_t n : {1'000u, 10'000u, 100'000u, 1'000'000u}) {
        if (!smoke || n == 1'000) { compare(n, lookups, repeats); }
    }
    for (const std::size_t n : {1'000u, 125'000u, 1'250'000u}) {
        if (!smoke || n == 1'000) { read_points(n, lookups, repeats); }
    }
    return 0;
}

}  // namespace

int main(int count, char** arguments) { return command_line::run(count, arguments, usage, run); }
