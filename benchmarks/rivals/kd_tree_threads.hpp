// CPU time, and that of the slowest thread: what a build would take on a machine with nothing else to do.
#pragma once

#include <time.h>

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

namespace rivals {

/// CPU seconds of the calling thread.
inline double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// An executor that adds up, over its calls, the CPU time of the thread that had most to do. Tasks are dealt to the
/// thread that has used the least, so that what else the machine does has no say.
class timed_threads {
public:
    explicit timed_threads(unsigned count) : count_{count} {}

    template <std::invocable<std::size_t> Task>
    void operator()(std::size_t tasks, Task&& task) const {
        const double start = cpu_seconds();
        std::vector<double> used(count_, 0.0);
        for (std::size_t i = 0; i < tasks; ++i) {
            double& least = *std::min_element(used.begin(), used.end());
            const double before = cpu_seconds();
            task(i);
            least += cpu_seconds() - before;
        }
        *saved_ += cpu_seconds() - start - *std::max_element(used.begin(), used.end());
    }

    /// Seconds that the threads beside the busiest took off the whole.
    [[nodiscard]] double saved() const { return *saved_; }

private:
    unsigned count_;
    std::shared_ptr<double> saved_ = std::make_shared<double>(0.0);
};

/// Seconds of the critical path of `work`, which runs its tasks on `threads`.
template <std::invocable Work>
double critical_seconds(const timed_threads& threads, Work&& work) {
    const double start = cpu_seconds();
    const double saved = threads.saved();
    work();
    return cpu_seconds() - start - (threads.saved() - saved);
}

}  // namespace rivals
