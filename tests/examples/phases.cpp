#include "render/phases.hpp"

#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "render/passes.hpp"
#include "support/catch.hpp"

namespace {

using phase = aglow::preparation_phase;

/// A stopwatch that the test turns, and a file for the bars to go to.
struct stage {
    double now{0};
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> out{std::tmpfile(), &std::fclose};
    [[nodiscard]] host::time_budget budget(double seconds) const {
        return {seconds, [this] { return now; }};
    }
};

}  // namespace

TEST_CASE("phases: without a limit all goes on, and every phase's seconds are its own") {
    stage s;
    const auto budget = s.budget(0);
    host::phase_watch watch{budget, s.out.get()};
    const auto spend = [&](phase p, double seconds) {
        CHECK(watch({p, 0}));
        s.now += seconds;
        CHECK(watch({p, 0.5}));
        CHECK(watch({p, 1}));
    };
    spend(phase::photons, 3);
    spend(phase::irradiance, 50);
    spend(phase::records, 700);
    host::render_result result;
    watch.finish(result);
    REQUIRE(result.phases.size() == 3);
    CHECK(result.phases[0].name == "photons");
    CHECK(result.phases[0].seconds == 3);
    CHECK(result.phases[1].seconds == 50);
    CHECK(result.phases[2].seconds == 700);
    CHECK(result.notes.empty());
    CHECK_FALSE(budget.is_over());
}

TEST_CASE(
    "phases: what would eat the picture's time is cut short, once in the notes, and the next phase has its turn") {
    stage s;
    const auto budget = s.budget(100);
    host::phase_watch watch{budget, s.out.get()};
    CHECK(watch({phase::photons, 0}));
    s.now = 20;
    CHECK(watch({phase::photons, 0.3}));
    s.now = 30;
    CHECK_FALSE(watch({phase::photons, 0.4}));
    CHECK_FALSE(watch({phase::photons, 0.42}));
    CHECK(watch({phase::irradiance, 0}));
    s.now = 33;
    CHECK(watch({phase::irradiance, 1}));
    CHECK(watch({phase::records, 0}));
    s.now = 80;
    CHECK_FALSE(watch({phase::records, 0.6}));
    // Nothing is cut short that is done.
    CHECK(watch({phase::records, 1}));
    host::render_result result;
    watch.finish(result);
    REQUIRE(result.notes.size() == 2);
    CHECK(result.notes[0] == "photons: cut short after 40 %, to leave time for the picture");
    CHECK(result.notes[1] == "irradiance cache: cut short after 60 %, to leave time for the picture");
}

TEST_CASE("phases: four tenths of the time at least are the picture's") {
    stage s;
    const auto budget = s.budget(10);
    for (const phase p : {phase::photons, phase::irradiance, phase::places, phase::records}) {
        s.now = 0;
        CHECK(budget.allows(p));
        s.now = 6.01;
        CHECK_FALSE(budget.allows(p));
    }
    s.now = 9.9;
    CHECK_FALSE(budget.is_over());
    s.now = 10;
    CHECK(budget.is_over());
}

TEST_CASE("phases: what is told to end is over, lets no phase go on, and says that it was interrupted") {
    stage s;
    bool ended = false;
    const host::time_budget budget{0, [&] { return s.now; }, [&] { return ended; }};
    host::phase_watch watch{budget, s.out.get()};
    CHECK(watch({phase::photons, 0.2}));
    CHECK_FALSE(budget.is_over());
    ended = true;
    CHECK(budget.is_over());
    CHECK_FALSE(watch({phase::photons, 0.3}));
    CHECK_FALSE(watch({phase::irradiance, 0}));
    host::render_result result;
    watch.finish(result);
    REQUIRE(result.notes.size() == 2);
    CHECK(result.notes[0] == "photons: cut short after 30 %, interrupted");
}

TEST_CASE("passes: samples double until a pass takes five seconds, or what is left") {
    const double ever = std::numeric_limits<double>::infinity();
    CHECK(host::samples_of_pass(0, 0, ever) == 4);
    CHECK(host::samples_of_pass(0, 0, 100) == 1);
    CHECK(host::samples_of_pass(4, 0.1, ever) == 4);
    CHECK(host::samples_of_pass(4, 0, ever) == 4);
    CHECK(host::samples_of_pass(100, 50, ever) == 10);
    CHECK(host::samples_of_pass(100, 50, 2) == 4);
    CHECK(host::samples_of_pass(100, 2000, ever) == 1);
    CHECK(host::samples_of_pass(100, 50, -1) == 1);
}
