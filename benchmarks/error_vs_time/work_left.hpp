// How long a study still takes, from how long its parts took so far.
#pragma once

#include <chrono>
#include <cstddef>

namespace error_vs_time {

/// Adds up work by its expected cost, in any unit: what is taken over from an earlier study counts as neither done nor
/// left.
class work_left {
public:
    using clock = std::chrono::steady_clock;

    void expect(double cost) { left_ += cost; }

    /// A part that was expected took this many seconds.
    void did(double cost, double seconds) {
        left_ -= cost;
        done_ += cost;
        seconds_ += seconds;
    }
    /// A part that was expected need not be done.
    void spared(double cost) { left_ -= cost; }

    /// Nothing before the first part is done.
    [[nodiscard]] double seconds() const { return done_ > 0 && left_ > 0 ? seconds_ / done_ * left_ : 0; }
    [[nodiscard]] bool known() const { return done_ > 0; }

private:
    double left_{0};
    double done_{0};
    double seconds_{0};
};

}  // namespace error_vs_time
