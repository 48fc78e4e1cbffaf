#include <aglow/core/parallel.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/archetypes.hpp"
#include "support/catch.hpp"

namespace {

using aglow::in_sequence;
using aglow::own_threads;

/// How often each of `count` tasks is run.
template <typename Run>
std::vector<int> runs(const Run& run, std::size_t count) {
    std::vector<std::atomic<int>> times(count);
    run(count, [&](std::size_t i) { ++times[i]; });
    return {times.begin(), times.end()};
}

/// The words of what `run` throws when some tasks do; empty if nothing.
template <typename Run>
std::string thrown(const Run& run, std::size_t count, const std::set<std::size_t>& bad) {
    try {
        run(count, [&](std::size_t i) {
            if (bad.contains(i)) { throw std::runtime_error(std::to_string(i)); }
        });
    } catch (const std::runtime_error& error) { return error.what(); }
    return "";
}

struct block {
    std::size_t first;
    std::size_t last;
};

/// The blocks by their index, as any executor runs them.
template <typename Run>
std::vector<block> blocks_of(const Run& run, std::size_t count, std::size_t size, std::size_t expected) {
    std::vector<block> blocks(expected, {1, 0});
    aglow::for_each_block(run, count, size, [&](std::size_t i, std::size_t first, std::size_t last) {
        blocks.at(i) = {first, last};
    });
    return blocks;
}

}  // namespace

TEST_CASE("parallel: every task is run once, on any number of threads") {
    for (const std::size_t count : {0u, 1u, 2u, 3u, 7u, 1000u}) {
        const std::vector<int> once(count, 1);
        INFO(count << " tasks");
        CHECK(runs(in_sequence{}, count) == once);
        CHECK(runs(archetypes::executor{}, count) == once);
        CHECK(runs(own_threads{}, count) == once);
        for (const unsigned threads : {0u, 1u, 2u, 3u, 8u}) { CHECK(runs(own_threads{threads}, count) == once); }
    }
}

TEST_CASE("parallel: the number of threads is at least one and by default the machine's") {
    CHECK(own_threads{0}.count() == 1);
    CHECK(own_threads{5}.count() == 5);
    CHECK(own_threads{}.count() >= 1);
    CHECK(own_threads{}.count() == std::max(1u, std::thread::hardware_concurrency()));
}

TEST_CASE("parallel: the caller's thread works too, and in sequence it is the only one") {
    const auto home = std::this_thread::get_id();
    in_sequence{}(10, [&](std::size_t) { CHECK(std::this_thread::get_id() == home); });
    // Two tasks on two threads that wait for each other: both threads must be at work.
    std::atomic<int> arrived{0};
    std::array<std::thread::id, 2> workers;
    own_threads{2}(2, [&](std::size_t i) {
        workers[i] = std::this_thread::get_id();
        ++arrived;
        while (arrived < 2) { std::this_thread::yield(); }
    });
    CHECK(workers[0] != workers[1]);
    CHECK((workers[0] == home || workers[1] == home));
}

TEST_CASE("parallel: the exception of the lowest task comes out, and the others are still run") {
    for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        CHECK(thrown(own_threads{threads}, 100, {}) == "");
        CHECK(thrown(own_threads{threads}, 100, {99}) == "99");
        CHECK(thrown(own_threads{threads}, 100, {40, 41, 42, 90}) == "40");
        CHECK(thrown(own_threads{threads}, 1, {0}) == "0");
    }
    CHECK(thrown(in_sequence{}, 100, {40, 41}) == "40");
    std::atomic<int> done{0};
    try {
        own_threads{3}(100, [&](std::size_t i) {
            if (i == 10) { throw std::runtime_error("10"); }
            ++done;
        });
    } catch (const std::runtime_error&) {}
    CHECK(done == 99);
}

TEST_CASE("parallel: tasks may themselves run tasks") {
    std::atomic<int> done{0};
    own_threads{3}(4, [&](std::size_t) { own_threads{2}(5, [&](std::size_t) { ++done; }); });
    CHECK(done == 20);
}

TEST_CASE("parallel: blocks cover the items in order, do not overlap, and do not depend on the threads") {
    for (const std::size_t count : {0u, 1u, 9u, 10u, 11u, 1000u}) {
        for (const std::size_t size : {1u, 3u, 10u, 2000u}) {
            const std::size_t expected = (count + size - 1) / size;
            for (const unsigned threads : {1u, 2u, 3u, 8u}) {
                const auto blocks = blocks_of(own_threads{threads}, count, size, expected);
                std::size_t next = 0;
                for (const block& b : blocks) {
                    REQUIRE(b.first == next);
                    REQUIRE((b.last > b.first && b.last - b.first <= size));
                    next = b.last;
                }
                REQUIRE(next == count);
            }
        }
    }
}

TEST_CASE("parallel: a block larger than all items, up to the largest there is, is one block") {
    const auto blocks = blocks_of(in_sequence{}, 10, std::numeric_limits<std::size_t>::max(), 1);
    CHECK(blocks[0].first == 0);
    CHECK(blocks[0].last == 10);
}

TEST_CASE("parallel: sums by block, joined in block order, are the same bits for any number of threads") {
    const auto sum = [](const auto& run) {
        std::vector<float> parts(100);
        aglow::for_each_block(run, 10'000, 100, [&](std::size_t i, std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k) { parts[i] += 1 / static_cast<float>(k + 1); }
        });
        float all = 0;
        for (const float part : parts) { all += part; }
        return all;
    };
    const float reference = sum(in_sequence{});
    for (const unsigned threads : {1u, 2u, 3u, 8u}) { CHECK(sum(own_threads{threads}) == reference); }
    CHECK(sum(archetypes::executor{}) == reference);
}

TEST_CASE("parallel: steps of spread_step meet every place once, and the first few lie far apart") {
    for (std::size_t count = 1; count <= 400; ++count) {
        const std::size_t step = aglow::spread_step(count);
        std::vector<char> met(count, 0);
        for (std::size_t i = 0; i < count; ++i) { ++met[i * step % count]; }
        CAPTURE(count, step);
        CHECK(std::all_of(met.begin(), met.end(), [](char times) { return times == 1; }));
        if (count < 100) { continue; }
        // Of the first eight none is nearer to another than a third of even spacing, the ring closed; in large rings.
        for (std::size_t i = 0; i < 8; ++i) {
            for (std::size_t j = 0; j < i; ++j) {
                const std::size_t across = (i - j) * step % count;
                CHECK(std::min(across, count - across) * 24 >= count);
            }
        }
    }
}

TEST_CASE("parallel: what threads make is taken in its order, one at a time, whatever order it is made in") {
    const auto backwards = [](std::size_t count, auto&& task) {
        while (count-- > 0) { task(count); }
    };
    const auto taken = [](const auto& run, std::size_t count) {
        std::vector<std::size_t> order;
        std::atomic<int> inside{0};
        bool alone = true;
        const auto make = [](std::size_t i) { return std::vector<std::size_t>{i, i * i}; };
        aglow::make_and_take(run, count, make, [&](std::size_t i, const std::vector<std::size_t>& made) {
            alone = alone && ++inside == 1;
            if (made == make(i)) { order.push_back(i); }
            --inside;
        });
        CHECK(alone);
        return order;
    };
    for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
        std::vector<std::size_t> all(count);
        for (std::size_t i = 0; i < count; ++i) { all[i] = i; }
        CHECK(taken(in_sequence{}, count) == all);
        CHECK(taken(backwards, count) == all);
        for (const unsigned threads : {2u, 3u, 8u}) { CHECK(taken(own_threads{threads}, count) == all); }
    }
}

TEST_CASE("parallel: the first is taken while other threads still make the second") {
    std::atomic<bool> first_taken{false};
    const auto make = [&](std::size_t i) {
        using clock = std::chrono::steady_clock;
        const auto patience = clock::now() + std::chrono::seconds{20};
        while (i == 1 && !first_taken && clock::now() < patience) { std::this_thread::yield(); }
        return first_taken.load();
    };
    bool met = false;
    aglow::make_and_take(own_threads{2}, 2, make, [&](std::size_t i, bool saw_it_taken) {
        first_taken = true;
        met = i == 1 && saw_it_taken;
    });
    CHECK(met);
}

TEST_CASE("parallel: where taking throws, nothing behind is taken and the exception comes out") {
    for (const unsigned threads : {1u, 2u, 8u}) {
        std::vector<std::size_t> order;
        const auto take = [&](std::size_t i, std::size_t) {
            if (i == 5) { throw std::runtime_error("five"); }
            order.push_back(i);
        };
        const auto make = [](std::size_t i) { return i; };
        CHECK_THROWS_WITH(aglow::make_and_take(own_threads{threads}, 100, make, take), "five");
        CHECK(order == std::vector<std::size_t>{0, 1, 2, 3, 4});
    }
}
