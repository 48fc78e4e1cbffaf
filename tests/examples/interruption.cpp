#include "common/interruption.hpp"

#include <atomic>
#include <csignal>
#include <cstddef>

#include <aglow/core/parallel.hpp>

#include "support/catch.hpp"

TEST_CASE(
    "interruption: the first signal is noted, ends what cannot be kept in part, and leaves the next to the system") {
    const auto before = std::signal(SIGINT, SIG_DFL);
    const aglow::own_threads two{2};
    const host::interruptible run{two};
    {
        const host::interruption listening;
        std::atomic<int> done{0};
        run(10, [&](std::size_t) { ++done; });
        CHECK(done == 10);
        CHECK_FALSE(host::interruption::came());
        std::raise(SIGINT);
        CHECK(host::interruption::came());
        CHECK_THROWS_AS(run(10, [&](std::size_t) { ++done; }), host::interrupted);
        CHECK(done == 10);
    }
    CHECK(std::signal(SIGINT, SIG_IGN) == SIG_DFL);
    // What a shell told a program in the background.
    const host::interruption deaf;
    CHECK(std::signal(SIGINT, before) == SIG_IGN);
}

TEST_CASE("interruption: work that a host ends for its own reasons ends like an interrupted one") {
    const aglow::own_threads two{2};
    std::atomic<int> done{0};
    const host::interruptible run{two, [&] { return done >= 5; }};
    CHECK_THROWS_AS(run(1000, [&](std::size_t) { ++done; }), host::interrupted);
    CHECK((done == 5 || done == 6));  // both threads may have asked before the fifth was done
}
