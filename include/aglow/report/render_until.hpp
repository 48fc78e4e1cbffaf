// Work on until an audit certifies the error that was asked for, or until it is clear that it never will.
//
// One set of probes looks at every picture on the way; it grows and gets sharper where that saves more rendering than
// it costs. What the probes see of the light stays true whatever picture they are held against, so nothing is looked at
// twice. The probability to be wrong, α, is shared out over the claims: the union bound over them asks for no
// independence. Other looks claim nothing and pay none of it, though they choose by the same probes when to claim: that
// all together stay below α is measured (benchmarks/calibration), not proved.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include <aglow/core/callback.hpp>
#include <aglow/core/random.hpp>
#include <aglow/report/audit.hpp>
#include <aglow/report/until_result.hpp>
#include <aglow/report/until_rule.hpp>

namespace aglow {

namespace detail {

inline void require_until(const render_until_options& options) {
    const auto require = [](bool holds, const char* what) {
        if (!holds) { throw std::invalid_argument(what); }
    };
    require(options.first_work > 0 && is_finite(options.first_work), "first_work: not positive");
    require(options.most_work >= options.first_work, "most_work: below first_work");
    require(options.least_growth > 1, "least_growth: not above 1");
    require(options.most_growth >= options.least_growth, "most_growth: below least_growth");
    require(options.least_noise > 0, "least_noise: not positive");
    require(options.most_noise >= options.least_noise, "most_noise: below least_noise");
    require(options.scout_probes >= 30, "scout_probes: fewer than 30");
    require(options.most_probes >= claim_outlook::least_probes, "most_probes: fewer than 300");
    require(options.probe_work >= 0 && is_finite(options.probe_work), "probe_work: negative or not finite");
}

template <std::floating_point T>
[[nodiscard]] until_result end_of(const until_rule<T>& rule, until_status status, double work,
                                  const audit_result& certificate) {
    return {
        .status = status,
        .certificate = certificate,
        .decay = rule.decay(),
        .work = work,
        .predicted_work = status == until_status::reached || rule.checks().empty() ? work : rule.predicted_work(work),
        .claims = rule.claims(),
        .probe_samples = rule.samples(),
        .checks = rule.checks()};
}

}  // namespace detail

/// Renders on until the mean relative error is certified to be at most `options.audit.target`. `advance(work)` brings
/// the picture to that total work and returns it as an `audited_picture`, valid until the next call; `probe` as for
/// `audit`. The same for any threads of `run`. Throws `std::invalid_argument` for options out of range.
template <typename Advance, Probe P, Executor E = in_sequence>
[[nodiscard]] until_result render_until(Advance&& advance, const P& probe, const render_until_options& options,
                                        const E& run = {}) {
    detail::require_until(options);
    using picture_type = std::remove_cvref_t<decltype(advance(options.first_work))>;
    detail::until_rule<typename picture_type::scalar> rule{options};
    audit_result certificate{};
    const auto end = [&](until_status status, double work) { return detail::end_of(rule, status, work, certificate); };
    for (double work = options.first_work;; work = rule.next_work(work)) {
        const auto picture = advance(work);
        require_auditable(picture, options.audit);
        if (count_broken_pixels(picture.image) > 0) {
            certificate = detail::refuse_broken(picture, options.audit);
            return end(until_status::broken, work);
        }
        // A claim is on the mean alone: it needs no probes for the error bars of classes.
        const picture_type plain{.image = picture.image, .guess = picture.guess};
        rule.look(plain, probe, work, run);
        const bool out_of_work = work >= options.most_work;
        if (out_of_work) { rule.look_at_last(plain, probe, work, run); }
        do {
            if (out_of_work || rule.worth_a_claim(work)) { certificate = rule.claim(); }
        } while (certificate.status != audit_status::certified && !out_of_work &&
                 rule.improve(plain, probe, work, run));
        const bool reached = certificate.status == audit_status::certified;
        const double predicted = reached ? work : rule.predicted_work(work);
        const bool going_on = !options.progress || options.progress({rule.checks().back(), predicted});
        if (reached) { return end(until_status::reached, work); }
        if (rule.is_broken()) { return end(until_status::broken, work); }
        if (!going_on) { return end(until_status::cancelled, work); }
        if (rule.gives_up(plain, probe, work, run)) {
            certificate = rule.claim();  // says why
            const bool after_all = certificate.status == audit_status::certified;
            return end(after_all          ? until_status::reached
                       : rule.is_broken() ? until_status::broken
                                          : until_status::unreachable,
                       work);
        }
        if (out_of_work || rule.is_out_of_claims()) { return end(until_status::out_of_work, work); }
    }
}

}  // namespace aglow
