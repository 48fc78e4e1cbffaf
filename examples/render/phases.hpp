// The phases before a picture: a bar for each, and an end to what would eat the picture's time.
#pragma once

#include <cstdio>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <aglow/algorithms/preparation.hpp>

#include "common/phase_name.hpp"
#include "common/progress.hpp"
#include "render/report.hpp"

namespace host {

/// The seconds of a whole job, and whether it was told to come to an end before.
class time_budget {
public:
    /// `seconds` in all, 0 for as many as it takes; `spent` tells how many have passed since the job began, `ended`
    /// whether it is to go on no longer.
    time_budget(
        double seconds, std::function<double()> spent, std::function<bool()> ended = [] { return false; })
        : seconds_{seconds}, spent_{std::move(spent)}, ended_{std::move(ended)} {}

    [[nodiscard]] bool limited() const { return seconds_ > 0; }
    [[nodiscard]] double seconds() const { return seconds_; }
    [[nodiscard]] double spent() const { return spent_(); }
    /// Infinite without a limit, negative past it.
    [[nodiscard]] double left() const {
        return limited() ? seconds_ - spent() : std::numeric_limits<double>::infinity();
    }
    [[nodiscard]] bool ended() const { return ended_(); }
    [[nodiscard]] bool is_over() const { return ended() || (limited() && spent() >= seconds_); }

    /// Whether a phase may go on. Four tenths at least are the picture's, and each phase leaves something to the next.
    [[nodiscard]] bool allows(aglow::preparation_phase phase) const {
        return !ended() && (!limited() || spent() < seconds_ * end_of(phase));
    }

private:
    static double end_of(aglow::preparation_phase phase) {
        switch (phase) {
            case aglow::preparation_phase::photons: return 0.25;
            case aglow::preparation_phase::irradiance: return 0.35;
            case aglow::preparation_phase::places: return 0.4;
            case aglow::preparation_phase::records: break;
        }
        return 0.6;
    }

    double seconds_;
    std::function<double()> spent_;
    std::function<bool()> ended_;
};

/// Listens to an integrator's preparation: draws bars, notes the seconds of each phase, and cuts phases short that
/// take more than their share of the time.
class phase_watch {
public:
    explicit phase_watch(const time_budget& budget, std::FILE* out = stderr)
        : budget_{budget}, out_{out}, begun_{budget.spent()} {}

    bool operator()(const aglow::preparation& now) {
        if (!bar_ || now.phase != phase_) { open(now.phase); }
        bar_->show(now.share);
        if (now.share >= 1 || budget_.allows(now.phase)) { return true; }
        if (notes_.empty() || cut_ != now.phase) { note(now); }
        return false;
    }

    /// Ends the last phase, and moves what was noted to `result`.
    void finish(render_result& result) {
        close();
        for (auto& p : phases_) { result.phases.push_back(std::move(p)); }
        for (auto& n : notes_) { result.notes.push_back(std::move(n)); }
    }

private:
    void open(aglow::preparation_phase phase) {
        close();
        phase_ = phase;
        bar_.emplace(name_of(phase), out_);
    }
    void close() {
        if (!bar_) { return; }
        bar_.reset();
        const double now = budget_.spent();
        phases_.push_back({name_of(phase_), now - begun_});
        begun_ = now;
    }
    void note(const aglow::preparation& now) {
        cut_ = now.phase;
        char cut[80];
        std::snprintf(cut, sizeof cut, ": cut short after %.0f %%, %s", 100 * now.share,
                      budget_.ended() ? "interrupted" : "to leave time for the picture");
        notes_.push_back(name_of(now.phase) + cut);
    }

    const time_budget& budget_;
    std::FILE* out_;
    double begun_;
    aglow::preparation_phase phase_{};
    aglow::preparation_phase cut_{};
    std::optional<progress> bar_{};
    std::vector<render_result::phase> phases_{};
    std::vector<std::string> notes_{};
};

}  // namespace host
