// Ctrl-C as a wish to come to an end: the first is noted, the second ends the program at once.
#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <exception>
#include <functional>
#include <string_view>
#include <utility>

#include <unistd.h>

namespace host {

/// Listens for Ctrl-C from when it is made. Where the caller's shell said that it be ignored, it stays so.
class interruption {
public:
    interruption() {
        if (std::signal(SIGINT, &interruption::note) == SIG_IGN) { std::signal(SIGINT, SIG_IGN); }
    }

    /// Whether it came. From any thread.
    [[nodiscard]] static bool came() { return came_.load(std::memory_order_relaxed); }

private:
    static_assert(std::atomic<bool>::is_always_lock_free, "or a signal handler must not touch it");

    static void note(int) {
        came_.store(true, std::memory_order_relaxed);
        std::signal(SIGINT, SIG_DFL);
        constexpr std::string_view words = "\nending with what is there; Ctrl-C again ends at once\n";
        if (write(STDERR_FILENO, words.data(), words.size()) < 0) { return; }
    }

    static inline std::atomic<bool> came_{false};
};

/// Thrown out of work that was ended early, and of which there is no part to keep.
struct interrupted : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "interrupted"; }
};

/// An executor that runs tasks on `run` until `ended()`, asked from any thread, is true, and then throws `interrupted`;
/// of itself it ends by an interruption.
template <typename Run>
class interruptible {
public:
    /// Keeps a reference.
    explicit interruptible(const Run& run, std::function<bool()> ended = &interruption::came)
        : run_{run}, ended_{std::move(ended)} {}

    template <typename Task>
    void operator()(std::size_t count, Task&& task) const {
        run_(count, [&](std::size_t i) {
            if (ended_()) { throw interrupted{}; }
            task(i);
        });
    }

private:
    const Run& run_;
    std::function<bool()> ended_;
};

}  // namespace host
