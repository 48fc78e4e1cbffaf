#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <aglow/report/render_until.hpp>

#include "report/synthetic.hpp"
#include "support/catch.hpp"

using namespace aglow;
using synthetic::field;

namespace {

/// A renderer whose relative error is normal with deviation `floor` + `start` · work^-`exponent`.
struct renderer {
    double floor;
    double start;
    double exponent;
    std::uint64_t seed;
    field f{synthetic::damage::none};

    audited_picture<double> operator()(double work) {
        for (std::size_t i = 0; i < field::pixels; ++i) {
            const double deviation = floor + start * std::pow(work, -exponent);
            f.picture[i] = std::max(0.0, f.truth[i] * (1 + deviation * synthetic::normal_of(mix(seed, i))));
        }
        return {f.image(), f.guess};
    }

    /// The least work after which the true error is `target`.
    double oracle(double target) {
        double low = 1e-3;
        double high = 1e9;
        for (int i = 0; i < 24; ++i) {
            const double work = std::sqrt(low * high);
            (*this)(work);
            (f.mean_error() > target ? low : high) = work;
        }
        return high;
    }
};

render_until_options options(std::uint64_t seed) {
    render_until_options o{.first_work = 4, .most_work = 1e6};
    o.audit.target = 0.05;
    o.audit.seed = seed;
    return o;
}

/// How many of `count` samples hit what one in 3000 hits.
double rare_hits(random_sampler<double>& random, std::size_t count) {
    const double mean = static_cast<double>(count) / 3000;
    if (mean > 40) { return std::max(0.0, std::round(mean + std::sqrt(mean) * synthetic::normal(random))); }
    double hits = 0;
    for (double left = random.next_1d(); left > std::exp(-mean); left *= random.next_1d()) { ++hits; }
    return hits;
}

}  // namespace

TEST_CASE("render_until: no false certificate, and at most twice the work of somebody who knows the truth") {
    std::vector<double> ratios;
    int wrong = 0;
    for (std::uint64_t r = 0; r < 40; ++r) {
        renderer render{0, 1, 0.5, r};
        const until_result result = render_until(render, render.f.probe(), options(r));
        REQUIRE(result.status == until_status::reached);
        CHECK(result.certificate.status == audit_status::certified);
        render(result.work);
        wrong += render.f.mean_error() > 0.05 ? 1 : 0;
        ratios.push_back(result.work / render.oracle(0.05));
    }
    CHECK(wrong == 0);
    CHECK(mean_of(ratios).mean() <= 2);
}

TEST_CASE("render_until: an error that stays above the target is called unreachable, and never certified") {
    for (std::uint64_t r = 0; r < 20; ++r) {
        renderer render{0.1, 1, 0.5, r};
        const until_result result = render_until(render, render.f.probe(), options(r));
        CHECK(result.status == until_status::unreachable);
        CHECK(result.decay.floor_low > 0.05);
        CHECK(result.work < 1e5);
        CHECK(!is_finite(result.predicted_work));
    }
}

TEST_CASE("render_until: an error that stays just above the target, or just below, comes to an end too") {
    for (const double error : {0.96, 1.0, 1.04, 1.08}) {
        for (std::uint64_t r = 0; r < 2; ++r) {
            renderer render{0.05, 0, 0.5, r};
            (void)render(1);
            render = {0.05 * error * render.floor / render.f.mean_error(), 1, 0.5, r};
            render_until_options o = options(r);
            o.most_work = std::numeric_limits<double>::infinity();
            o.probe_work = 1e-4;
            const until_result result = render_until(render, render.f.probe(), o);
            render(result.work);
            CAPTURE(error, r, static_cast<int>(result.status), result.work, render.f.mean_error());
            CHECK((result.status == until_status::unreachable || render.f.mean_error() <= 0.05));
            CHECK((result.status == until_status::unreachable || result.status == until_status::reached));
            CHECK(result.work < 1e7);
        }
    }
}

TEST_CASE("render_until: when the work is up it says how far it came and how much is missing") {
    renderer render{0, 1, 0.5, 1};
    render_until_options o = options(1);
    o.most_work = 64;
    const until_result result = render_until(render, render.f.probe(), o);
    CHECK(result.status == until_status::out_of_work);
    CHECK(result.work == 64);
    CHECK(result.claims == 1);
    render(64);
    CHECK(result.certificate.mean_error_bound >= render.f.mean_error());
    CHECK(result.predicted_work > 0.5 * render.oracle(0.05));
    CHECK(result.predicted_work < 2 * render.oracle(0.05));
}

TEST_CASE("render_until: noise that seems heavy-tailed until probes are sharp does not hide a picture that is good") {
    // A twentieth of the light comes with few samples: a relative variance of 8, of which small probes see nothing or
    // far too much. Looked at no harder for it, it costs some eight times as much.
    running_mean cost;
    for (std::uint64_t r = 0; r < 10; ++r) {
        renderer render{0, 0.1, 0.5, r};
        const auto probe = [&](std::size_t pixel, std::uint64_t seed, std::size_t count) {
            random_sampler<double> random{mix(seed)};
            const double common = 0.95 * synthetic::exponential_mean(random, count);
            return render.f.truth[pixel] *
                   (common + 0.05 * 3000 * rare_hits(random, count) / static_cast<double>(count));
        };
        render_until_options o = options(r);
        o.most_work = 1e5;
        o.probe_work = 2e-5;
        const until_result result = render_until(render, probe, o);
        CHECK(result.status == until_status::reached);
        cost.add(std::log(result.work + o.probe_work * static_cast<double>(result.probe_samples)));
    }
    CAPTURE(std::exp(cost.mean()), cost.standard_error());
    CHECK(std::exp(cost.mean()) < 400);
}

TEST_CASE("render_until: rare bright samples of the probes are not taken for an error of the picture that stays") {
    for (std::uint64_t r = 0; r < 4; ++r) {
        renderer render{0, 0.25, 0.5, r};
        const auto spikes = [&](std::size_t pixel, std::uint64_t seed) {
            return render.f.truth[pixel] * (unit_interval<double>(mix(seed)) < 0.01 ? 50.5 : 0.5);
        };
        render_until_options o = options(r);
        o.first_work = 1;
        o.probe_work = 1e-4;
        CHECK(render_until(render, spikes, o).status == until_status::reached);
    }
}

TEST_CASE("render_until: where the probes' noise has no variance the work ends, though nothing bounds it") {
    for (const double tail : {1.2, 1.6}) {
        for (std::uint64_t r = 0; r < 3; ++r) {
            renderer render{0, 0.25, 0.5, r};
            const auto endless = [&](std::size_t pixel, std::uint64_t seed) {  // Pareto's law, of mean 1
                const double u = 1 - unit_interval<double>(mix(seed));
                return render.f.truth[pixel] * std::pow(u, -1 / tail) * (tail - 1) / tail;
            };
            render_until_options o = options(r);
            o.first_work = 1;
            o.most_work = std::numeric_limits<double>::infinity();
            o.probe_work = 1e-4;
            const until_result result = render_until(render, endless, o);
            CAPTURE(tail, r);
            CHECK((result.status == until_status::unreachable || result.status == until_status::reached));
            CHECK((tail > 1.5 || result.status == until_status::unreachable));
            CHECK(result.work < 1e7);
            CHECK(result.probe_samples < 1'000'000'000);
        }
    }
}

TEST_CASE("render_until: a picture too bright for good, which no claim can be made of, comes to an end") {
    renderer render{0, 0.1, 0.5, 1};
    const auto too_bright = [&](double work) {
        const auto picture = render(work);
        for (double& x : render.f.picture) { x *= 1.03; }
        return picture;
    };
    render_until_options o = options(1);
    o.most_work = std::numeric_limits<double>::infinity();
    o.audit.bias_target = 0.01;
    const until_result result = render_until(too_bright, render.f.probe(), o);
    CHECK(result.status == until_status::out_of_work);
    CHECK(result.claims > 10);
    CHECK(result.claims < 70);
    CHECK(is_finite(result.certificate.energy_bias.low));
}

TEST_CASE("render_until: the caller can stop it, and hears how much is left") {
    renderer render{0, 1, 0.5, 1};
    render_until_options o = options(1);
    std::vector<double> predicted;
    o.progress = [&](const until_progress& p) {
        predicted.push_back(p.predicted_work);
        return predicted.size() < 3;
    };
    CHECK(render_until(render, render.f.probe(), o).status == until_status::cancelled);
    REQUIRE(predicted.size() == 3);
    CHECK(predicted[2] > 100);
    CHECK(predicted[2] < 1500);
}

TEST_CASE("render_until: a broken pixel ends it at once") {
    renderer render{0, 1, 0.5, 1};
    const auto broken = [&](double work) {
        const auto picture = render(work);
        render.f.picture[3] = std::numeric_limits<double>::infinity();
        return picture;
    };
    const until_result result = render_until(broken, render.f.probe(), options(1));
    CHECK(result.status == until_status::broken);
    CHECK(result.certificate.broken_pixels == 1);
}

TEST_CASE("render_until: looks come at growing work, and claims get ever less of the miss probability") {
    renderer render{0.02, 1, 0.5, 3};
    const until_result result = render_until(render, render.f.probe(), options(3));
    REQUIRE(result.status == until_status::reached);
    for (std::size_t i = 1; i < result.checks.size(); ++i) {
        const double growth = result.checks[i].work / result.checks[i - 1].work;
        CHECK(growth >= 1);
        CHECK(growth <= 2.0001);
    }
    // Which claim is told was chosen by the data: it is as sure as all together, though its bound is that of its share.
    const audit_result& claim = result.certificate;
    CHECK(claim.confidence == 0.95);
    const double reach = (claim.mean_error_bound - claim.mean_error) / claim.mean_error_deviation;
    CHECK(reach * std::sqrt(static_cast<double>(claim.probes)) >
          normal_quantile(1 - 0.05 * share_of_miss(result.claims)));
}

TEST_CASE("render_until: probes whose noise never falls, or has no mean, come to an end and certify nothing") {
    renderer render{0, 0.1, 0.5, 1};
    const auto stubborn = [&](std::size_t pixel, std::uint64_t seed, std::size_t) {
        return render.f.truth[pixel] * (1 + 0.5 * synthetic::normal_of(seed));
    };
    const auto endless = [&](std::size_t pixel, std::uint64_t seed, std::size_t count) {
        random_sampler<double> random{seed};
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) { sum += 1 / std::max(1e-12, random.next_1d()); }
        return render.f.truth[pixel] * sum / static_cast<double>(count) / 10;
    };
    render_until_options o = options(1);
    o.most_work = 64;
    CHECK(render_until(render, stubborn, o).status != until_status::reached);
    const until_result result = render_until(render, endless, o);
    CHECK(result.status != until_status::reached);
    CHECK(result.probe_samples < 100'000'000);
}

TEST_CASE("render_until: a picture without any error, looked at without noise, is certified at once") {
    renderer render{0, 0, 0.5, 1};
    for (double& x : render.f.truth) { x = 1; }
    const auto exact = [](std::size_t, std::uint64_t) { return 1.0; };
    const until_result result = render_until(render, exact, options(1));
    CHECK(result.status == until_status::reached);
    CHECK(result.work == 4);
    CHECK(result.certificate.mean_error_bound == 0);
}

TEST_CASE("render_until: a picture of one pixel that rare samples make is not given up") {
    // One sample in 40 is 40 times as bright: a small lamp in a pixel that shows all of a room.
    const auto sample = [](std::uint64_t seed) { return unit_interval<double>(mix(seed)) < 1.0 / 40 ? 40.0 : 0.025; };
    const auto mean_of_samples = [&](std::uint64_t seed, std::size_t count) {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) { sum += sample(mix(seed, i)); }
        return sum / static_cast<double>(count);
    };
    const auto probe = [&](std::size_t, std::uint64_t seed, std::size_t count) { return mean_of_samples(seed, count); };
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        double pixel = 0;
        const auto advance = [&](double work) {
            pixel = mean_of_samples(mix(seed, 77), static_cast<std::size_t>(work));
            return audited_picture<double>{.image = {{&pixel, 1}, 1, 1, 1}};
        };
        render_until_options o = options(seed);
        o.audit.target = 0.3;
        const until_result result = render_until(advance, probe, o);
        CAPTURE(seed, result.work);
        CHECK(result.status == until_status::reached);
    }
}

TEST_CASE("render_until: wrong settings are refused by name") {
    renderer render{0, 1, 0.5, 1};
    render_until_options o = options(1);
    o.first_work = 0;
    CHECK(synthetic::refuses("first_work", [&] { (void)render_until(render, render.f.probe(), o); }));
    o = options(1);
    o.most_growth = 1;
    CHECK(synthetic::refuses("most_growth", [&] { (void)render_until(render, render.f.probe(), o); }));
    o = options(1);
    o.probe_work = -1;
    CHECK(synthetic::refuses("probe_work", [&] { (void)render_until(render, render.f.probe(), o); }));
}
