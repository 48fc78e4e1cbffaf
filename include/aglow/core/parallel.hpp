// The one seam through which work is spread over threads; the threads are the host's to choose.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace aglow {

/// Something that runs `task(i)` once for every i in [0, count), in any order and on any threads, and returns when all
/// are done. A host plugs in its own pool with one lambda:
/// `[](std::size_t count, auto&& task) { tbb::parallel_for(std::size_t{0}, count, task); }`.
template <typename E>
concept Executor = requires(const E& run, void (*task)(std::size_t)) {
    run(std::size_t{}, task);
};

/// Runs every task in turn on the calling thread.
struct in_sequence {
    template <std::invocable<std::size_t> Task>
    void operator()(std::size_t count, Task&& task) const {
        for (std::size_t i = 0; i < count; ++i) { task(i); }
    }
};

/// Runs tasks on `count` threads that live as long as the call; the caller's own thread is one of them.
/// Rethrows the exception of the lowest task that threw.
class own_threads {
public:
    /// As many threads as the machine has cores.
    own_threads() : own_threads(std::max(1u, std::thread::hardware_concurrency())) {}
    explicit own_threads(unsigned count) : count_{std::max(1u, count)} {}

    [[nodiscard]] unsigned count() const { return count_; }

    template <std::invocable<std::size_t> Task>
    void operator()(std::size_t tasks, Task&& task) const {
        if (count_ == 1 || tasks < 2) { return in_sequence{}(tasks, task); }
        shared state{.tasks = tasks};
        {
            std::vector<std::jthread> crew;
            const std::size_t helpers = std::min<std::size_t>(count_, tasks) - 1;
            for (std::size_t i = 0; i < helpers; ++i) {
                crew.emplace_back([&] { work(state, task); });
            }
            work(state, task);
        }
        if (state.failure) { std::rethrow_exception(state.failure); }
    }

private:
    struct shared {
        std::size_t tasks;
        std::atomic<std::size_t> next{0};
        std::mutex guard{};
        std::size_t failed{static_cast<std::size_t>(-1)};
        std::exception_ptr failure{};
    };

    template <typename Task>
    static void work(shared& state, Task& task) {
        for (std::size_t i = state.next++; i < state.tasks; i = state.next++) {
            try {
                task(i);
            } catch (...) {
                const std::scoped_lock lock{state.guard};
                if (i < state.failed) {
                    state.failed = i;
                    state.failure = std::current_exception();
                }
            }
        }
    }

    unsigned count_;
};

/// A step through a ring of `count` places that meets each once, the first few of them far from one another: place
/// i step mod count, about the golden ratio apart. What is cut short in this order is thin, not half.
[[nodiscard]] constexpr std::size_t spread_step(std::size_t count) {
    std::size_t step = std::max<std::size_t>(1, count * 377 / 610);
    while (std::gcd(step, count) > 1) { ++step; }
    return step;
}

/// Splits [0, count) into blocks of `block` items and runs `body(block_index, first, last)` for each. The blocks do not
/// depend on the number of threads, so what is joined in block order is the same for any number. Expects `block` > 0.
template <Executor E, typename Body>
void for_each_block(const E& run, std::size_t count, std::size_t block, Body&& body) {
    const std::size_t blocks = count / block + (count % block != 0 ? 1 : 0);
    run(blocks, [&](std::size_t i) { body(i, i * block, i * block + std::min(block, count - i * block)); });
}

/// Hands what tasks make, in parallel, to one taker in the order of their numbers, each as soon as all before it are
/// taken: what has to be done in turn is done while others still work.
template <typename Made, typename Take>
class in_turn {
public:
    in_turn(std::size_t count, Take& take) : waiting_(count), take_{take} {}

    /// Whoever brings what is next takes it, and all that waits behind it; others put theirs down and go on.
    void bring(std::size_t i, Made made) {
        std::unique_lock lock{guard_};
        waiting_[i].emplace(std::move(made));
        if (taken_) { return; }
        taken_ = true;  // stays so where `take` throws: nothing goes past what was lost
        while (next_ < waiting_.size() && waiting_[next_]) {
            const std::size_t now = next_++;
            Made one = std::move(*waiting_[now]);
            waiting_[now].reset();
            lock.unlock();
            take_(now, std::move(one));
            lock.lock();
        }
        taken_ = false;
    }

private:
    std::mutex guard_{};
    std::vector<std::optional<Made>> waiting_;
    std::size_t next_{0};
    bool taken_{false};  ///< whether some thread takes
    Take& take_;
};

/// Runs `make(i)` for every i in [0, count) in parallel, and `take(i, made)` for what came of it in order of i, one at
/// a time, on any of the threads: the same for any number of them. `take` must not touch what `make` reads.
template <Executor E, typename Make, typename Take>
void make_and_take(const E& run, std::size_t count, Make&& make, Take&& take) {
    in_turn<std::invoke_result_t<Make&, std::size_t>, Take> row{count, take};
    run(count, [&](std::size_t i) { row.bring(i, make(i)); });
}

}  // namespace aglow
