// Pictures rendered until they are certified, beside an oracle that knows their error: how often is a certificate
// false, and what does it cost not to know?
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <aglow/report/render_until.hpp>

#include "case.hpp"

namespace calibration {

/// One picture at ever more samples a pixel (or passes), up to `most`, and its true error. Rendered as it is asked for.
template <typename Known, typename Expose>
class growing_picture {
public:
    growing_picture(const Known& scene, const Expose& expose, std::uint32_t most)
        : scene_{scene}, expose_{expose}, most_{most}, film_{scene.how().pixels, scene.how().pixels} {}

    /// The picture when at least `work` is done; the last one if none is.
    [[nodiscard]] std::size_t at(double work) {
        return first([&](std::size_t i) { return works_[i] >= work; });
    }
    /// The first picture with an error of at most `error`; the last one if none has.
    [[nodiscard]] std::size_t within(double error) {
        return first([&](std::size_t i) { return errors_[i] <= error; });
    }

    [[nodiscard]] double work(std::size_t i) const { return works_[i]; }
    [[nodiscard]] double error(std::size_t i) const { return errors_[i]; }
    [[nodiscard]] aglow::audited_picture<float> picture(std::size_t i) const { return pictures_[i].audited(); }

private:
    template <typename Test>
    std::size_t first(const Test& test) {
        for (std::size_t i = 0;; ++i) {
            if (i == works_.size()) {
                if (film_.samples() >= most_) { return i - 1; }
                grow();
            }
            if (test(i)) { return i; }
        }
    }

    void grow() {
        const std::uint32_t next = std::max(film_.samples() + 1, film_.samples() + film_.samples() / 16);
        expose_(film_, std::min(most_, next) - film_.samples());
        works_.push_back(film_.samples());
        pictures_.push_back(picture_of(film_));
        errors_.push_back(scene_.mean_error(pictures_.back()));
    }

    const Known& scene_;
    const Expose& expose_;
    std::uint32_t most_;
    aglow::film<rgb> film_;
    std::vector<double> works_{};
    std::vector<double> errors_{};
    std::vector<judged_picture> pictures_{};
};

/// What probes cost, in samples of every pixel of a picture of the width that the effort names: that is larger than the
/// small ones that are judged here.
struct probe_price {
    double each{0};   ///< of a sample
    double guide{0};  ///< before the first
};

template <typename Known>
[[nodiscard]] probe_price price_of(const Known& scene, std::size_t method) {
    const double all = picture_cost(scene, method) * aglow::square(static_cast<double>(scene.how().width));
    return {scene.probe_cost() / all, scene.guide_cost() / all};
}

/// What became of the trials of one method.
struct stop_tally {
    probe_price price{};
    std::size_t trials{0};
    std::size_t reached{0};
    std::size_t unreachable{0};
    std::size_t out_of_work{0};
    std::size_t falsely{0};
    std::vector<double> work{};          ///< picture and probes where it was reached, over the work of the oracle
    std::vector<double> picture_work{};  ///< the same of the picture alone
};

/// One trial: the target is the error of the picture when the oracle's work is done, and the rule may do 8 times that.
template <typename Known, typename Growing>
void try_to_stop(const Known& scene, Growing& growing, double target, std::uint64_t seed, stop_tally& into) {
    const double oracle = growing.work(growing.within(target));
    std::size_t now = 0;
    const auto advance = [&](double work) {
        now = growing.at(work);
        return growing.picture(now);
    };
    aglow::render_until_options options{.first_work = 1, .most_work = 8 * oracle, .probe_work = into.price.each};
    options.audit = {.target = target, .seed = seed};
    const auto end = aglow::render_until(advance, scene.probe(), options, aglow::own_threads{});
    ++into.trials;
    into.unreachable += end.status == aglow::until_status::unreachable ? 1 : 0;
    into.out_of_work += end.status == aglow::until_status::out_of_work ? 1 : 0;
    if (end.status != aglow::until_status::reached) { return; }
    ++into.reached;
    into.falsely += growing.error(now) > target ? 1 : 0;
    const double probes = into.price.guide + into.price.each * static_cast<double>(end.probe_samples);
    into.work.push_back((growing.work(now) + probes) / oracle);
    into.picture_work.push_back(growing.work(now) / oracle);
}

/// The target that the effort names, or those where an oracle needs 4 to 32 samples a pixel, spread evenly; on four
/// pictures of `method`.
template <typename Known>
[[nodiscard]] stop_tally stop_trials(const Known& scene, std::size_t method) {
    stop_tally result{.price = price_of(scene, method)};
    constexpr std::size_t pictures = 4;
    const std::size_t trials = std::max<std::size_t>(1, scene.how().certificates / pictures);
    for (std::size_t p = 0; p < pictures; ++p) {
        with_method(scene, scene.scene(), method, 11 + p, mistake::none, [&](const auto& expose) {
            growing_picture growing{scene, expose, 256};
            for (std::size_t i = 0; i < trials; ++i) {
                const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(trials);
                const double named = scene.how().target;
                const double target = named > 0 ? named : growing.error(growing.at(4 * std::pow(8.0, share)));
                try_to_stop(scene, growing, target, aglow::mix(p, i), result);
            }
        });
    }
    return result;
}

}  // namespace calibration
