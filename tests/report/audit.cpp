#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <thread>
#include <vector>

#include <glm/vec3.hpp>

#include <aglow/report/audit.hpp>
#include <aglow/report/statement.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;
using synthetic::damage;
using synthetic::field;

namespace {

/// An audit whose target is the picture's true error: the hardest case for a bound.
audit_options at_the_edge(const field& f, std::uint64_t seed) {
    return {.target = std::max(0.01, f.mean_error()), .seed = seed};
}

/// How many of `rounds` audits end as `status`.
template <typename P>
int count(int rounds, const field& f, const P& probe, audit_options options, audit_status status) {
    int found = 0;
    for (int r = 0; r < rounds; ++r) {
        options.seed = static_cast<std::uint64_t>(r);
        found += audit(f.image(), probe, options).status == status ? 1 : 0;
    }
    return found;
}

/// Whether one of the reasons begins with `words`.
bool says(const audit_result& a, const char* words) {
    return std::any_of(a.reasons.begin(), a.reasons.end(), [&](const auto& r) { return r.find(words) == 0; });
}

}  // namespace

TEST_CASE("audit: every statement holds as often as it says, on six kinds of damage") {
    constexpr int rounds = 120;
    const auto kind =
        GENERATE(damage::noise, damage::too_bright, damage::outliers, damage::edges, damage::waves, damage::dark);
    const field f{kind, 5};
    const std::vector<double> errors = f.errors();
    const double q95 = quantile(errors, 0.95);
    const double clipped = mean_of(detail::clipped(errors)).mean();
    int mean_held = 0, bias_held = 0, quantile_held = 0, clipped_held = 0;
    std::vector<double> sharpness;
    for (std::uint64_t r = 0; r < rounds; ++r) {
        const audit_result a = audit(f.image(), f.probe(), at_the_edge(f, r));
        mean_held += a.mean_error_bound >= f.mean_error() ? 1 : 0;
        bias_held += a.energy_bias.contains(f.energy_bias()) ? 1 : 0;
        quantile_held += a.quantile_bound.value() >= q95 ? 1 : 0;
        clipped_held += a.clipped_error_bound >= clipped ? 1 : 0;
        sharpness.push_back(a.mean_error_bound / f.mean_error());
    }
    CAPTURE(static_cast<int>(kind), f.mean_error(), median(sharpness));
    const double least = synthetic::least_coverage(rounds) * rounds;
    CHECK(mean_held >= least);
    CHECK(bias_held >= least);
    CHECK(quantile_held >= least);
    CHECK(clipped_held >= least);
    CHECK(median(sharpness) < (kind == damage::edges ? 1.6 : 1.35));
}

TEST_CASE("audit: error bars hold for 93 to 97.5 % of the pixels and at least 92 % of each class") {
    constexpr int rounds = 60;
    const auto kind = GENERATE(damage::noise, damage::outliers, damage::waves, damage::edges);
    const field f{kind, 9};
    running_mean all, rim;
    for (std::uint64_t r = 0; r < rounds; ++r) {
        const audit_result a = audit(f.all(), f.probe(), at_the_edge(f, r));
        const std::vector<double> bars = error_bars(f.all(), a);
        running_mean in, in_rim;
        for (std::size_t i = 0; i < field::pixels; ++i) {
            const double held = std::abs(f.picture[i] - f.truth[i]) <= bars[i] ? 1 : 0;
            in.add(held);
            if (f.classes[i] == 1) { in_rim.add(held); }
        }
        all.add(in.mean());
        rim.add(in_rim.mean());
    }
    CAPTURE(static_cast<int>(kind), all.mean(), rim.mean());
    CHECK(all.mean() >= 0.93);
    CHECK(all.mean() <= (kind == damage::edges ? 0.99 : 0.975));
    CHECK(rim.mean() >= 0.92);
}

TEST_CASE("audit: guesses that know where the errors are make the bound sharper") {
    const field f{damage::edges, 2};
    running_mean with, without;
    for (std::uint64_t r = 0; r < 30; ++r) {
        with.add(audit(audited_picture<double>{f.image(), f.guess}, f.probe(), at_the_edge(f, r)).mean_error_bound);
        without.add(audit(f.image(), f.probe(), at_the_edge(f, r)).mean_error_bound);
    }
    CHECK(with.mean() > f.mean_error());
    CHECK(with.mean() - f.mean_error() < 0.7 * (without.mean() - f.mean_error()));
}

TEST_CASE("audit: a right picture is certified") {
    const field f{damage::none};
    CHECK(count(50, f, f.probe(), {.target = 0.02, .bias_target = 0.005}, audit_status::certified) == 50);
}

TEST_CASE("audit: a black picture of a black scene is certified, its energy too, and of a lit one it is not") {
    const std::vector<float> values(64 * 64, 0.0f);
    const audited_picture<float> black{.image = {values, 64, 64}};
    const auto unlit = [](std::size_t, std::uint64_t) { return 0.0; };
    const audit_result right = audit(black, unlit, {.bias_target = 0.01});
    CHECK(right.status == audit_status::certified);
    CHECK(right.energy_bias.low == 0);
    CHECK(right.energy_bias.high == 0);
    CHECK(error_bars(black, right)[0] == 0);
    // Every other pixel is lit, by samples that differ a lot.
    const auto lit = [](std::size_t pixel, std::uint64_t seed) {
        return pixel % 2 == 0 && unit_interval<double>(mix(seed, 5)) < 0.2 ? 5.0 : 0.0;
    };
    const audit_result wrong = audit(black, lit, {.bias_target = 0.01});
    CHECK(wrong.status == audit_status::not_certified);
    CHECK(wrong.mean_error == Approx(0.5).margin(0.1));
    CHECK(wrong.energy_bias.estimate == -1);
    CHECK(wrong.samples < 100'000'000);
}

TEST_CASE("audit: a picture 5 % too bright is never certified for 4 %, and found out for 3.5 %") {
    const field f{damage::too_bright};
    CHECK(count(50, f, f.probe(), {.target = 0.04}, audit_status::certified) == 0);
    CHECK(count(50, f, f.probe(), {.target = 0.035, .noise = 0.35}, audit_status::not_certified) == 50);
}

TEST_CASE("audit: one small light removed, one per cent of the energy, is found by the bias") {
    field f{damage::none};
    double mean = 0;
    for (const double x : f.truth) { mean += x / field::pixels; }
    std::size_t lit = 0;
    for (std::size_t i = 0; i < field::pixels; ++i) { lit += i % field::side > 50 && f.truth[i] > 0.5 ? 1 : 0; }
    for (std::size_t i = 0; i < field::pixels; ++i) {
        if (i % field::side > 50 && f.truth[i] > 0.5) {
            f.picture[i] -= 0.01 * mean * field::pixels / static_cast<double>(lit);
        }
    }
    REQUIRE(f.energy_bias() == Approx(-0.01));
    const audit_options options{.target = 0.02, .bias_target = 0.005};
    CHECK(count(50, f, f.probe(), options, audit_status::certified) == 0);
    CHECK(count(50, f, f.probe(), options, audit_status::not_certified) >= 45);
}

TEST_CASE("audit: one NaN pixel is enough to refuse, and no probe is spent") {
    field f{damage::none};
    f.picture[1234] = std::numeric_limits<double>::quiet_NaN();
    const audit_result a = audit(f.image(), f.probe());
    CHECK(a.status == audit_status::not_certified);
    CHECK(a.broken_pixels == 1);
    CHECK(a.samples == 0);
    CHECK(a.mean_error_bound == std::numeric_limits<double>::infinity());
    CHECK(a.energy_bias.high == std::numeric_limits<double>::infinity());
    REQUIRE(a.reasons.size() == 1);
}

TEST_CASE("audit: noise of infinite variance and noise of rare spikes never pass, and are called by their name") {
    const field f{damage::none};
    const auto power_law = [&](std::size_t pixel, std::uint64_t seed) {
        random_sampler<double> random{seed};
        return f.truth[pixel] * 0.3 / 1.3 * std::pow(1 - random.next_1d(), -1 / 1.3);
    };
    const auto spikes = [&](std::size_t pixel, std::uint64_t seed) {
        random_sampler<double> random{seed};
        return f.truth[pixel] * (random.next_1d() < 1e-4 ? 5000.5 : 0.5);
    };
    CHECK(count(20, f, power_law, {.budget = 200'000}, audit_status::inconclusive) == 20);
    CHECK(count(20, f, spikes, {.budget = 200'000}, audit_status::certified) == 0);
    const audit_result a = audit(f.image(), power_law, {.target = 0.2, .patience = 4});
    CHECK(a.tail_index > 0.6);
    CHECK(a.reasons.front().find("heavy tails") == 0);
}

TEST_CASE(
    "audit: a budget that is too small is blamed before the probes, and the budget that is called for is enough") {
    const field f{damage::none};
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const audit_options few{.target = 0.02, .budget = 10'000, .seed = seed};
        const audit_result a = audit(f.image(), f.probe(), few);
        CHECK(a.status == audit_status::inconclusive);
        REQUIRE_FALSE(a.reasons.empty());
        CHECK(a.reasons.front().find("the budget of samples is too small") == 0);
        // By algebra: relative variance 1 over half the target squared, for each of 400 probes, and an eighth more;
        // a tenth of the pixels are dark and call for none.
        const double called_for = static_cast<double>(a.samples_called_for) / (400 * 1.125 / square(0.01));
        CHECK((called_for > 0.4 && called_for < 1.2));
        audit_options enough = few;
        enough.budget = 2 * a.samples_called_for;
        const audit_result again = audit(f.image(), f.probe(), enough);
        CHECK(again.status == audit_status::certified);
        CHECK(again.reasons.empty());
        CHECK(again.samples_called_for == 0);
    }
    // What more samples would not mend is not blamed on them.
    field bright{damage::too_bright};
    const audit_result wrong = audit(bright.image(), bright.probe(), {.target = 0.01, .budget = 1'000'000});
    CHECK(wrong.status == audit_status::not_certified);
    CHECK_FALSE(says(wrong, "the budget"));
}

TEST_CASE("audit: a bound on samples tells rare bright ones from an infinite variance, and widens what is said") {
    const field f{damage::noise};
    // One sample in 400 is 200 times as bright: no probe of a few hundred samples looks like a finite variance.
    const auto spikes = [&](std::size_t pixel, std::uint64_t seed) {
        random_sampler<double> random{seed};
        return f.truth[pixel] * (random.next_1d() < 0.0025 ? 200.5 : 0.5);
    };
    const audit_options impatient{.target = 0.3, .budget = 200'000, .patience = 1};
    CHECK(count(10, f, spikes, impatient, audit_status::inconclusive) == 10);
    const audit_result doubted = audit(f.image(), spikes, impatient);
    CHECK(says(doubted, "heavy tails"));
    audit_options bounded = impatient;
    bounded.sample_bound = 200.5;
    const audit_result a = audit(f.image(), spikes, bounded);
    CHECK(a.unmet_error > 0);
    CHECK(a.mean_error_bound > a.unmet_error + f.mean_error());
    for (const std::string& reason : a.reasons) { CHECK(reason.find("heavy tails: the probes' noise") != 0); }
    // With patience the same probe is seen for what it is.
    const audit_result patient = audit(f.image(), spikes, {.target = 0.3});
    CHECK(patient.status == audit_status::certified);
    CHECK(patient.unmet_error == 0);
}

TEST_CASE(
    "audit: with a bound on its samples, a probe of rare spikes states what is true, and certifies nothing false") {
    constexpr int rounds = 100;
    field f{damage::none};
    // The picture lacks all that comes in rare samples.
    for (std::size_t i = 0; i < field::pixels; ++i) { f.picture[i] = 0.9 * f.truth[i]; }
    const auto spikes = [&](std::size_t pixel, std::uint64_t seed) {
        random_sampler<double> random{seed};
        return f.truth[pixel] * (0.9 + (random.next_1d() < 1e-3 ? 100.0 : 0.0));
    };
    int mean_held = 0, bias_held = 0, certified = 0;
    for (std::uint64_t r = 0; r < rounds; ++r) {
        const audit_result a =
            audit(f.image(), spikes,
                  {.target = 0.97 * f.mean_error(), .budget = 100'000, .sample_bound = 101, .patience = 1, .seed = r});
        mean_held += a.mean_error_bound >= f.mean_error() ? 1 : 0;
        bias_held += a.energy_bias.contains(f.energy_bias()) ? 1 : 0;
        certified += a.status == audit_status::certified ? 1 : 0;
    }
    CHECK(mean_held >= rounds * synthetic::least_coverage(rounds));
    CHECK(bias_held >= rounds * synthetic::least_coverage(rounds));
    CHECK(certified <= rounds * (1 - synthetic::least_coverage(rounds)));
}

TEST_CASE("audit: noise of a finite variance is not called heavy, however different the pixels") {
    const field f{damage::noise};
    const auto uneven = [&](std::size_t pixel, std::uint64_t seed) {
        const double width = std::exp(0.5 * synthetic::normal_of(pixel));
        return f.truth[pixel] * (1 - width - width * std::log(1 - random_sampler<double>{seed}.next_1d()));
    };
    for (std::uint64_t r = 0; r < 10; ++r) {
        const audit_result a = audit(f.image(), uneven, {.seed = r, .unseen = {{"caustics of the point light", 0.02}}});
        CHECK(a.tail_index < 0.58);
        CHECK(a.status == audit_status::certified);
        CHECK(a.unseen.front().what == "caustics of the point light");
    }
}

TEST_CASE("audit: fireflies in two of a thousand pixels are not missed") {
    field f{damage::noise};
    for (std::size_t i = 0; i < field::pixels; i += 500) { f.picture[i] = 15 * f.truth[i] + 0.2; }
    REQUIRE(f.mean_error() > 0.06);
    CHECK(count(50, f, f.probe(), {.target = 0.055}, audit_status::certified) == 0);
    int held = 0;
    for (std::uint64_t r = 0; r < 100; ++r) {
        held += audit(f.image(), f.probe(), at_the_edge(f, r)).mean_error_bound >= f.mean_error() ? 1 : 0;
    }
    CHECK(held >= 100 * synthetic::least_coverage(100));
}

TEST_CASE("audit: a leak that few probes meet is not beyond the distribution-free bound, nor certified by it") {
    field f{damage::none};
    for (std::size_t i = 0; i < 12; ++i) { f.picture[40 * field::side + 10 + i % 4 + field::side * (i / 4)] *= 9; }
    const double clipped = mean_of(detail::clipped(f.errors())).mean();
    REQUIRE(f.mean_error() > 0.02);
    int held = 0;
    for (std::uint64_t r = 0; r < 50; ++r) {
        held += audit(f.image(), f.probe(), {.target = 0.01, .seed = r}).clipped_error_bound >= clipped ? 1 : 0;
    }
    CHECK(held == 50);
    CHECK(count(50, f, f.probe(), {.target = 0.01, .distribution_free = true}, audit_status::certified) == 0);
}

TEST_CASE("standing out: a flat picture has nothing, an edge neither, and one bright pixel only itself") {
    std::vector<double> values(25, 2.0);
    const image_view<double> image{values, 5, 5, 1};
    for (const double x : standing_out(image, 0.04)) { CHECK(x == 0); }
    for (std::size_t i = 0; i < 25; i += 5) { values[i] = values[i + 1] = 9; }
    for (const double x : standing_out(image, 0.04)) { CHECK(x == 0); }
    for (double& x : values) { x = 2; }
    values[12] = 22;
    const std::vector<double> found = standing_out(image, 0.04);
    CHECK(found[12] == Approx(20 / 2.04));
    CHECK(std::count(found.begin(), found.end(), 0.0) == 24);
    CHECK(standing_out(image_view<double>{std::span{values}.first(1), 1, 1, 1}, 0.04).front() == 0);
}

TEST_CASE("audit: broken probe samples are counted and nothing is certified on them") {
    const field f{damage::none};
    const auto broken = [&](std::size_t pixel, std::uint64_t seed) {
        return seed % 1000 == 0 ? std::numeric_limits<double>::quiet_NaN() : f.truth[pixel];
    };
    const audit_result a = audit(f.image(), broken);
    CHECK(a.broken_samples > 0);
    CHECK(a.status == audit_status::inconclusive);
    CHECK(is_finite(a.mean_error_bound));
}

TEST_CASE("audit: one thread and eight say the same, bit for bit") {
    const field f{damage::edges};
    const audit_result one = audit(f.all(), f.probe(), {});
    for (const unsigned threads : {2u, 3u, 8u}) {
        const audit_result many = audit(f.all(), f.probe(), {}, own_threads{threads});
        CHECK(many.mean_error_bound == one.mean_error_bound);
        CHECK(many.energy_bias.low == one.energy_bias.low);
        CHECK(many.quantile_bound == one.quantile_bound);
        CHECK(many.samples == one.samples);
        REQUIRE(many.scales.size() == one.scales.size());
        for (std::size_t i = 0; i < one.scales.size(); ++i) { CHECK(many.scales[i].scale == one.scales[i].scale); }
    }
}

TEST_CASE("audit: a picture scaled by a power of two gets the same statements, bit for bit") {
    const field f{damage::outliers};
    field scaled = f;
    for (auto* values : {&scaled.picture, &scaled.truth, &scaled.guess}) {
        for (double& x : *values) { x *= 0x1p40; }
    }
    const audit_result a = audit(f.all(), f.probe());
    const audit_result b = audit(scaled.all(), scaled.probe());
    CHECK(a.mean_error_bound == b.mean_error_bound);
    CHECK(a.energy_bias.high == b.energy_bias.high);
    CHECK(a.scales.front().scale == b.scales.front().scale);
    CHECK(a.dark_floor * 0x1p40 == b.dark_floor);
}

TEST_CASE("audit: colours count channel by channel, from any type with an index") {
    const field f{damage::none};
    std::vector<float> picture;
    for (const double x : f.truth) {
        picture.push_back(static_cast<float>(x));
        picture.push_back(static_cast<float>(0.5 * x));
        picture.push_back(static_cast<float>(0.1 * x * 1.3));
    }
    const auto colour = [&](std::size_t pixel, std::uint64_t) {
        return glm::vec3{static_cast<float>(f.truth[pixel])} * glm::vec3{1, 0.5f, 0.1f};
    };
    const auto list = [&](std::size_t pixel, std::uint64_t) {
        const double x = f.truth[pixel];
        return std::array<double, 3>{x, 0.5 * x, 0.1 * x};
    };
    const image_view<float> image{picture, field::side, field::side, 3};
    const audit_result a = audit(image, colour);
    CHECK(a.mean_error == Approx(audit(image, list).mean_error).epsilon(1e-5));
    CHECK(a.mean_error < 0.1);
    CHECK(a.mean_error > 0.06);
    CHECK(a.energy_bias.contains(0.03 / 1.6));
    CHECK(a.energy_bias.high - a.energy_bias.low < 0.3 * 0.03 / 1.6);
    // One audit looks at few pixels; what many of them say in the mean is the bias itself.
    running_mean bias;
    for (std::uint64_t seed = 0; seed < 25; ++seed) {
        bias.add(audit(image, colour, {.seed = seed}).energy_bias.estimate);
    }
    CHECK(bias.mean() == Approx(0.03 / 1.6).epsilon(0.05));
}

TEST_CASE("audit: a budget is kept, and costs sharpness only") {
    const field f{damage::noise};
    const audit_result rich = audit(f.image(), f.probe(), {.target = 0.04});
    const audit_result poor = audit(f.image(), f.probe(), {.target = 0.04, .budget = 40'000});
    CHECK(rich.samples > 200'000);
    CHECK(poor.samples <= 40'000);
    CHECK(poor.mean_error_bound > rich.mean_error_bound);
    // What cannot do is made do with the least.
    for (const std::size_t nearly_none : {0u, 100u, 255u, 256u, 1000u}) {
        const audit_result least = audit(f.image(), f.probe(), {.target = 0.04, .budget = nearly_none});
        CHECK(least.samples <= 256 + 8 * 200);
        CHECK(least.status == audit_status::inconclusive);
    }
}

TEST_CASE("audit: pixels that are too dark are not taken for better ones by the noise of few samples") {
    // A tenth of the pixels have a fifth of their light: |B-U| / (U + dark) of a noisy U is below that of I.
    field f{damage::none};
    for (std::size_t i = 0; i < field::pixels; i += 10) { f.picture[i] *= 0.2; }
    const double truth = quantile(f.errors(), 0.95);
    constexpr int rounds = 200;
    int held = 0;
    for (std::uint64_t seed = 0; seed < rounds; ++seed) {
        const audit_result a = audit(f.image(), f.probe(), {.target = 0.05, .budget = 10'000, .seed = seed});
        REQUIRE(a.quantile_bound);
        held += *a.quantile_bound >= truth ? 1 : 0;
    }
    CHECK(held >= rounds * synthetic::least_coverage(rounds));
}

TEST_CASE("audit: a short budget is kept with rare classes too, and spent on fewer probes that see better") {
    const field f{damage::noise};
    const audit_result rich = audit(f.all(), f.probe(), {.target = 0.04});
    const audit_result poor = audit(f.all(), f.probe(), {.target = 0.04, .budget = 40'000});
    const audit_result short_of_little = audit(f.all(), f.probe(), {.target = 0.04, .budget = rich.samples * 9 / 10});
    CHECK(poor.samples <= 40'000);
    CHECK(short_of_little.samples <= rich.samples * 9 / 10);
    CHECK(poor.probes >= 200);
    CHECK(poor.probes < short_of_little.probes);
    CHECK(short_of_little.probes < rich.probes);
    for (const class_scale& scale : poor.scales) { CHECK(scale.scores >= 60); }
    // The same samples on 400 probes see twice the noise.
    CHECK(poor.samples_per_probe > 40'000 / rich.probes);
}

TEST_CASE("audit: the floor under the mean error holds as often as it says, and good pictures are not called bad") {
    for (const damage kind : {damage::noise, damage::edges, damage::dark}) {
        const synthetic::field field{kind, 7};
        const double truth = field.mean_error();
        int above = 0;
        int refused = 0;
        for (std::uint64_t seed = 0; seed < 100; ++seed) {
            const audit_result stated = audit(field.all(), field.probe(), {.target = 1.05 * truth, .seed = seed});
            above += stated.mean_error_floor > truth;
            refused += stated.status == audit_status::not_certified;
        }
        CAPTURE(static_cast<int>(kind));
        CHECK(above <= 10);  // of 100 at 5 %, once in 90 tests
        CHECK(refused <= 5);
    }
}

TEST_CASE("audit: where a class has no bar, every pixel's is infinite, in a black picture too") {
    const std::vector<double> black(16, 0.0);
    const std::vector<std::uint32_t> classes(16, 1);
    const audited_picture<double> picture{.image = {black, 4, 4, 1}, .guess = black, .classes = classes};
    for (const double bar : error_bars(picture, audit_result{})) {
        CHECK(bar == std::numeric_limits<double>::infinity());
    }
    audit_result endless;
    endless.scales = {{1, std::numeric_limits<double>::infinity(), 10, false}};
    for (const double bar : error_bars(picture, endless)) { CHECK(bar == std::numeric_limits<double>::infinity()); }
}

TEST_CASE("audit: noise beyond what was planned is not taken for the picture's error") {
    const field f{damage::none};
    // One sample in 400 is 200 times as bright, and the budget meets few of them.
    const auto spikes = [&](std::size_t pixel, std::uint64_t seed) {
        random_sampler<double> random{seed};
        return f.truth[pixel] * (random.next_1d() < 0.0025 ? 200.5 : 0.5);
    };
    constexpr int rounds = 50;
    int held = 0;
    for (std::uint64_t r = 0; r < rounds; ++r) {
        const audit_result plain = audit(f.image(), f.probe(), {.target = 0.02, .budget = 20'000, .seed = r});
        CHECK(plain.mean_error > 0.02);
        held += plain.mean_error_floor <= 0.02 ? 1 : 0;
        const audit_result rare = audit(f.image(), spikes, {.target = 0.02, .budget = 100'000, .seed = r});
        CHECK(rare.mean_error > 0.5);
        CHECK(rare.mean_error_floor == 0);
        CHECK(rare.status == audit_status::inconclusive);
    }
    CHECK(held >= rounds * synthetic::least_coverage(rounds));
}

TEST_CASE(
    "audit sample: probes that grew and were sharpened still tell the error of whatever picture they are held "
    "against") {
    // Drawn for one picture, grown on a second whose guesses fear errors elsewhere, and read against a third.
    const field first{damage::edges, 1};
    field second{damage::dark, 2};
    const field third{damage::noise, 3};
    running_mean seen;
    running_mean samples;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        detail::audit_sample<double> sample{{.target = 0.05, .probes = 200, .noise = 0.7, .seed = seed}};
        const audited_picture<double> before{first.image(), first.guess};
        const audited_picture<double> after{second.image(), second.guess};
        sample.draw(detail::audit_ground<double>{before, {}}, first.probe(), in_sequence{});
        const double drawn = static_cast<double>(sample.samples_per_probe());
        sample.sharpen(detail::audit_ground<double>{after, {}}, 4, first.probe(), in_sequence{});
        CHECK(static_cast<double>(sample.samples_per_probe()) == Approx(4 * drawn).epsilon(0.01));
        sample.grow(detail::audit_ground<double>{after, {}}, 300, first.probe(), in_sequence{});
        CHECK(sample.probes() == 500);
        sample.read({third.image(), third.guess});
        seen.add(sample.likely().error / third.mean_error());
        samples.add(static_cast<double>(sample.samples()) / (4 * drawn * 500));
    }
    CAPTURE(seen.mean(), seen.standard_error());
    CHECK(std::abs(seen.mean() - 1) < 0.02 + 3 * seen.standard_error());
    CHECK(seen.standard_error() < 0.02);
    CHECK(samples.mean() == Approx(1.15).epsilon(0.1));  // an eighth more, for the looks that deal them out
}

TEST_CASE("audit: wrong settings are refused by name") {
    const field f{damage::none};
    CHECK(synthetic::refuses("target", [&] { (void)audit(f.image(), f.probe(), {.target = 0}); }));
    CHECK(synthetic::refuses("probes", [&] { (void)audit(f.image(), f.probe(), {.probes = 10}); }));
    CHECK(synthetic::refuses("confidence", [&] { (void)audit(f.image(), f.probe(), {.confidence = 1}); }));
    audited_picture<double> wrong = f.all();
    wrong.guess = wrong.guess.first(5);
    CHECK(synthetic::refuses("guess", [&] { (void)audit(wrong, f.probe()); }));
}

TEST_CASE("statement: a bound of clipped errors is said to be one, and is the one that is told") {
    const field f{damage::none};
    audit_result result = audit(f.image(), f.probe(), {.target = 0.05, .distribution_free = true});
    CHECK(result.distribution_free);
    result.clipped_error_bound = 0.04;
    result.mean_error_bound = 0.11;
    const std::string text = statement(result);
    CHECK(text.find(": mean relative error, errors above 100 % counted as 100 %, within 5 %") != std::string::npos);
    CHECK(text.find("the mean relative error, errors above 100 % counted as 100 %, is at most 4 %") !=
          std::string::npos);
    CHECK(text.find("11 %") == std::string::npos);
}

TEST_CASE("statement: says the status, the bound, why, and what was not seen") {
    const field f{damage::too_bright};
    const audit_options options{.target = 0.02, .unseen = {{"caustics of the point light", 0.03}}};
    const std::string text = statement(audit(f.image(), f.probe(), options));
    CHECK(text.find("not certified: mean relative error within 2 %") == 0);
    CHECK(text.find("because the mean relative error is above the target") != std::string::npos);
    CHECK(text.find("with 95 % confidence, the energy is off by 4.") != std::string::npos);
    CHECK(text.find("with 95 % confidence, 95 % of the pixels are off by at most ") != std::string::npos);
    CHECK(text.find("caustics of the point light, 3 % of the light") != std::string::npos);
    CHECK(percent(0.0412849) == "4.13 %");
    CHECK(percent_sure(0.95) == "95 %");
    CHECK(percent_sure(0.99) == "99 %");
    CHECK(percent_sure(0.99956) == "99.956 %");
    CHECK(percent_sure(1 - 1e-6) == "99.9999 %");
    CHECK(percent_sure(1) == "100 %");
    CHECK(percent(std::numeric_limits<double>::infinity()) == "unknown");
}
