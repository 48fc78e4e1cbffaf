// What the looks at a picture on its way have seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <aglow/report/decay.hpp>
#include <aglow/report/until_result.hpp>

namespace aglow::detail {

/// All looks in order; of several at one picture, by ever better probes, the last counts.
class until_history {
public:
    void add(const until_check& check) {
        if (all_.empty() || all_.back().work < check.work) {
            ++pictures_;
        } else {
            counting_.pop_back();
        }
        all_.push_back(check);
        const double deviation = std::max(check.error_deviation, 1e-9 * std::abs(check.error));
        counting_.push_back({check.work, check.error, deviation});
    }

    /// Of the last look.
    void set_bound(double bound) { all_.back().bound = bound; }

    /// Expects one look.
    [[nodiscard]] const until_check& last() const { return all_.back(); }
    [[nodiscard]] const std::vector<until_check>& all() const { return all_; }
    [[nodiscard]] std::size_t pictures() const { return pictures_; }
    [[nodiscard]] decay_fit decay() const { return fit_decay(counting_); }

private:
    std::vector<until_check> all_{};
    std::vector<measured_error> counting_{};
    std::size_t pictures_{0};
};

}  // namespace aglow::detail
