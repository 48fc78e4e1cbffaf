// What can be said with confidence about the error of a finished picture, whoever made it and however.
//
// A few hundred random pixels are looked at again by an unbiased estimator, the probe. Nothing is assumed of the
// picture: it may be biased in any way. What the probe cannot see is not certified; the caller names it and it stays in
// the statement.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <aglow/core/parallel.hpp>
#include <aglow/report/audit_result.hpp>
#include <aglow/report/audit_sample.hpp>
#include <aglow/report/confidence.hpp>
#include <aglow/report/image_view.hpp>
#include <aglow/report/probe.hpp>

namespace aglow {

namespace detail {

[[nodiscard]] inline std::vector<double> clipped(std::span<const double> values) {
    std::vector<double> all(values.begin(), values.end());
    for (double& x : all) { x = std::min(x, 1.0); }
    return all;
}

/// Σ(B−I)/ΣI by the difference estimator: what the probes say of B−I against the picture's known mean. The miss
/// probability is taken one fifth smaller than asked for: with as few probes, intervals of skewed gaps hold about a
/// point too seldom. `unmet` is added on either side.
[[nodiscard]] inline interval energy_bias(std::span<const double> gaps, double mean, double confidence, double unmet) {
    const interval gap = cautious_interval(gaps, 1 - 0.8 * (1 - confidence));
    const auto relative = [&](double d) {
        if (d == 0) { return 0.0; }  // a black picture of a black scene among them
        return d < mean ? d / (mean - d) : std::numeric_limits<double>::infinity();
    };
    return {relative(gap.estimate), relative(gap.low - unmet), relative(gap.high + unmet)};
}

inline void add_reason(audit_result& result, bool holds, const char* words) {
    if (holds) { result.reasons.emplace_back(words); }
}

/// Whether broken answers of the probes' host cost more light than a tenth of the target, which decides nothing.
[[nodiscard]] inline bool has_lost_light(const audit_result& result) { return result.lost_share > 0.1 * result.target; }

/// Whether what the probes themselves answered is broken, so that no more of them would help.
[[nodiscard]] inline bool has_broken_probes(const audit_result& result) {
    return result.broken_samples > 0 || has_lost_light(result);
}

/// Signs that the probes themselves cannot be trusted.
inline void find_doubts(audit_result& result, bool heavy_tailed) {
    add_reason(result, result.broken_samples > 0, "a probe returned infinity or NaN");
    add_reason(result, has_lost_light(result),
               "the host's scene or lights gave broken answers, and probes lost light by them");
    add_reason(result, heavy_tailed, "heavy tails: the probes' noise does not fall as that of a finite variance");
    add_reason(result, result.largest_share > 0.2,
               "heavy tails: a single probe makes up more than a fifth of the error");
}

/// What seems heavy-tailed, or too wide a bound, may only be few samples: where more of them help, that comes first.
inline void blame_budget(audit_result& result) {
    if (result.status != audit_status::inconclusive || result.samples_called_for == 0 || has_broken_probes(result)) {
        return;
    }
    result.reasons.insert(result.reasons.begin(),
                          "the budget of samples is too small: the probes' noise calls for about " +
                              std::to_string(result.samples_called_for));
}

inline void judge(audit_result& result, const audit_options& options, bool heavy_tailed) {
    find_doubts(result, heavy_tailed);
    const bool doubtful = !result.reasons.empty();
    const double bound = options.distribution_free ? result.clipped_error_bound : result.mean_error_bound;
    const bool small = bound <= options.target;
    const bool large = result.mean_error_floor > options.target;
    const double limit = options.bias_target.value_or(std::numeric_limits<double>::infinity());
    const bool neutral = -limit <= result.energy_bias.low && result.energy_bias.high <= limit;
    const bool biased = result.energy_bias.low > limit || result.energy_bias.high < -limit;
    add_reason(result, large, "the mean relative error is above the target");
    add_reason(result, biased, "the energy bias is beyond its target");
    add_reason(result, !large && !small, "the bound on the mean relative error is above the target");
    add_reason(result, !biased && !neutral, "the interval of the energy bias reaches beyond its target");
    result.status = doubtful           ? audit_status::inconclusive
                    : large || biased  ? audit_status::not_certified
                    : small && neutral ? audit_status::certified
                                       : audit_status::inconclusive;
    blame_budget(result);
}

template <std::floating_point T>
[[nodiscard]] audit_result refuse_broken(const audited_picture<T>& picture, const audit_options& options) {
    audit_result result{.status = audit_status::not_certified, .target = options.target};
    result.confidence = options.confidence;
    result.broken_pixels = count_broken_pixels(picture.image);
    result.unseen = options.unseen;
    result.reasons.emplace_back("pixels of the picture are infinite or NaN");
    return result;
}

/// All statements of a set of probes that were drawn uniformly, and of the extra ones of rare classes.
template <std::floating_point T>
void state(audit_result& result, const audit_sample<T>& sample, const audit_options& options) {
    const std::vector<double> errors = sample.mean_errors();
    const std::vector<double> plain = sample.plain_errors();
    const running_mean all = mean_of(errors);
    result.mean_error = all.mean();
    result.mean_error_deviation = all.deviation();
    result.likely_error = sample.likely().error;
    const bool bounded = !sample.heavy_tailed();
    result.unmet_error = bounded ? sample.unmet_error(options.confidence) : 0;
    result.mean_error_bound = skewed_upper_bound(errors, options.confidence) + result.unmet_error;
    const running_mean least = mean_of(sample.least_errors());
    const double t = student_t_quantile(options.confidence, static_cast<double>(least.count() - 1));
    result.mean_error_floor = least.mean() - t * least.standard_error();
    // Where rare samples were not met, what looks like the picture's error may be all theirs.
    result.mean_error_floor = bounded ? result.mean_error_floor - result.unmet_error : 0;
    result.clipped_error_bound = betting_upper_bound(clipped(plain), options.confidence);
    result.quantile_bound = quantile_upper_bound(plain, options.quantile, options.confidence);
    result.energy_bias = energy_bias(sample.gaps(), sample.mean(), options.confidence,
                                     bounded ? sample.unmet_gap(options.confidence) : 0);
    result.scales = sample.scales(options.confidence);
    result.tail_index = sample.tail_index();
    const double sum = static_cast<double>(errors.size()) * std::max(options.target, mean_of(plain).mean());
    for (const double e : errors) { result.largest_share = std::max(result.largest_share, std::abs(e) / sum); }
}

/// All that probes say which were drawn.
template <std::floating_point T>
[[nodiscard]] audit_result judged(const audit_sample<T>& sample, const audit_options& options) {
    audit_result result{.target = options.target, .confidence = options.confidence, .quantile = options.quantile};
    result.unseen = options.unseen;
    result.distribution_free = options.distribution_free;
    result.dark_floor = sample.dark_floor();
    result.probes = sample.probes();
    result.samples_per_probe = sample.samples_per_probe();
    result.samples = sample.samples();
    result.samples_called_for = sample.called_for();
    result.broken_samples = sample.broken();
    result.lost_share = sample.lost_share();
    state(result, sample, options);
    judge(result, options, sample.heavy_tailed());
    return result;
}

}  // namespace detail

/// Statements about the error of `picture`, each at `options.confidence` by itself. `probe` estimates a pixel without
/// bias (see `Probe`); it is called about `options.probes` times the samples needed for the target, on the threads of
/// `run`, and the result is bitwise the same for any of them. Throws `std::invalid_argument` for options out of range
/// or spans that do not fit the picture.
template <std::floating_point T, Probe P, Executor E = in_sequence>
[[nodiscard]] audit_result audit(const audited_picture<T>& picture, const P& probe, const audit_options& options = {},
                                 const E& run = {}) {
    require_auditable(picture, options);
    if (count_broken_pixels(picture.image) > 0) { return detail::refuse_broken(picture, options); }
    detail::audit_sample<T> sample{options};
    sample.draw(detail::audit_ground<T>{picture, options}, probe, run);
    return detail::judged(sample, options);
}

/// Audits a plain picture, without guesses and classes.
template <std::floating_point T, Probe P, Executor E = in_sequence>
[[nodiscard]] audit_result audit(const image_view<T>& image, const P& probe, const audit_options& options = {},
                                 const E& run = {}) {
    return audit(audited_picture<T>{.image = image}, probe, options, run);
}

}  // namespace aglow
