// How far the work is: a bar with the remaining time on a terminal, plain lines elsewhere.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>

#include <unistd.h>

namespace host {

/// "12 s", "3 min 05 s", "2 h 07 min".
[[nodiscard]] inline std::string spoken(double seconds) {
    char text[48];
    const long s = static_cast<long>(std::max(0.0, seconds) + 0.5);
    if (s < 60) {
        std::snprintf(text, sizeof text, "%ld s", s);
    } else if (s < 3600) {
        std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
    } else {
        std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s / 60 % 60);
    }
    return text;
}

/// One phase of work. `show` may be called from many threads; it draws at most ten times a second on a terminal.
/// Elsewhere it prints a line at a tenth of the work, two seconds apart at least. Writes to standard error, so that
/// results on standard output stay clean.
class progress {
public:
    explicit progress(std::string what, std::FILE* out = stderr)
        : what_{std::move(what)}, out_{out}, terminal_{isatty(fileno(out)) == 1} {}
    progress(const progress&) = delete;
    progress& operator=(const progress&) = delete;
    ~progress() { finish(); }

    /// `share` of the whole, in [0, 1], is done.
    void show(double share) {
        const std::unique_lock lock{guard_, std::try_to_lock};
        if (!lock.owns_lock() || finished_) { return; }
        if (terminal_) {
            draw_bar(share);
        } else {
            print_line(share);
        }
    }

    /// Closes the bar; called by the destructor too.
    void finish() {
        const std::scoped_lock lock{guard_};
        if (finished_) { return; }
        finished_ = true;
        std::fprintf(out_, "%s%s: %s%s\n", terminal_ ? "\r" : "", what_.c_str(), spoken(elapsed()).c_str(),
                     terminal_ ? "\033[K" : "");
        std::fflush(out_);
    }

    [[nodiscard]] double elapsed() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    void draw_bar(double share) {
        const double now = elapsed();
        if (now - drawn_ < 0.1) { return; }
        drawn_ = now;
        constexpr int width = 40;
        const int full = static_cast<int>(std::clamp(share, 0.0, 1.0) * width);
        const std::string bar =
            std::string(static_cast<std::size_t>(full), '#') + std::string(static_cast<std::size_t>(width - full), '.');
        std::fprintf(out_, "\r%s [%s] %3.0f %%  %s left\033[K", what_.c_str(), bar.c_str(), share * 100,
                     left(share).c_str());
        std::fflush(out_);
    }
    void print_line(double share) {
        const int tenth = static_cast<int>(share * 10);
        const double now = elapsed();
        if (tenth <= tenth_ || share >= 1 || now - drawn_ < 2) { return; }
        tenth_ = tenth;
        drawn_ = now;
        std::fprintf(out_, "%s: %d %%, %s left\n", what_.c_str(), tenth * 10, left(share).c_str());
        std::fflush(out_);
    }
    [[nodiscard]] std::string left(double share) const {
        return share > 0 ? spoken(elapsed() * (1 - share) / share) : std::string{"?"};
    }

    std::string what_;
    std::FILE* out_;
    bool terminal_;
    std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
    double drawn_{0};
    int tenth_{0};
    bool finished_{false};
    std::mutex guard_{};
};

}  // namespace host
