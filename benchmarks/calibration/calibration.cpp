// Do the statements of an audit hold as often as they say? For scenes × integrators: hundreds of certificates, each
// from probes of its own, against the truth; and pictures that are wrong on purpose and must not be certified.
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <aglow/report/running_mean.hpp>

#include "case.hpp"

using namespace calibration;

namespace {

/// How often what was stated was true.
struct tally {
    aglow::running_mean all, feature, hard, caustic, dark;  ///< coverage of the error bars, by kind of pixel
    aglow::running_mean sharpness;                          ///< mean bar over mean error
    aglow::running_mean bias, mean_error, quantile;         ///< coverage of the picture's statements
    std::size_t certified{0};
    std::size_t falsely{0};
};

struct true_errors {
    std::vector<double> absolute{};  ///< of the mean of the channels
    double bias{0};
    double mean_relative{0};
    double quantile95{0};
};

true_errors errors_of(const known_scene& scene, const judged_picture& picture, double dark) {
    true_errors result;
    const std::size_t count = scene.truth().size() / 3;
    double ours = 0;
    double theirs = 0;
    for (const float x : picture.values) { ours += static_cast<double>(x); }
    for (const float x : scene.truth()) { theirs += static_cast<double>(x); }
    const double delta = dark * ours / static_cast<double>(picture.values.size());
    result.bias = ours / theirs - 1;
    std::vector<double> relative;
    for (std::size_t i = 0; i < count; ++i) {
        double signed_error = 0;
        double pixel = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double truth = static_cast<double>(scene.truth()[3 * i + c]);
            const double error = static_cast<double>(picture.values[3 * i + c]) - truth;
            signed_error += error / 3;
            pixel += std::abs(error) / (truth + delta) / 3;
        }
        result.absolute.push_back(std::abs(signed_error));
        relative.push_back(pixel);
        result.mean_relative += pixel / static_cast<double>(count);
    }
    const auto at = relative.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(count) * 0.95);
    std::nth_element(relative.begin(), at, relative.end());
    result.quantile95 = *at;
    return result;
}

void count_bars(const known_scene& scene, const judged_picture& picture, const true_errors& truth,
                const aglow::audit_result& result, tally& into) {
    const std::vector<double> bars = aglow::error_bars(picture.audited(), result);
    aglow::running_mean width;
    aglow::running_mean error;
    const auto add = [](aglow::running_mean& to, bool held) { to.add(held ? 1 : 0); };
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const bool held = truth.absolute[i] <= bars[i];
        add(into.all, held);
        if (scene.feature()[i]) { add(into.feature, held); }
        if (picture.hard[i]) { add(into.hard, held); }
        if (scene.caustic()[i]) { add(into.caustic, held); }
        if (picture.classes[i] == judged_picture::dark_class) { add(into.dark, held); }
        width.add(bars[i]);
        error.add(truth.absolute[i]);
    }
    into.sharpness.add(width.mean() / error.mean());
}

tally calibrate(const known_scene& scene, const judged_picture& picture) {
    tally result;
    const auto probe = [&](std::size_t pixel, std::uint64_t seed, std::size_t) { return scene.look(pixel, seed); };
    aglow::audit_options options{.probes = 400, .sample_bound = scene.sample_bound()};
    // What the pool can give, and an eighth more for the look that deals it out.
    options.budget = 9 * options.probes * aglow::probe_batches * scene.samples_per_look() / 8;
    const true_errors truth = errors_of(scene, picture, options.dark);
    // A target near the true error: what a false certificate would take least luck for.
    options.target = 0.97 * truth.mean_relative;
    for (std::size_t i = 0; i < scene.how().certificates; ++i) {
        options.seed = i;
        const auto stated = aglow::audit(picture.audited(), probe, options, aglow::own_threads{});
        count_bars(scene, picture, truth, stated, result);
        result.bias.add(stated.energy_bias.low <= truth.bias && truth.bias <= stated.energy_bias.high ? 1 : 0);
        result.mean_error.add(truth.mean_relative <= stated.mean_error_bound ? 1 : 0);
        if (stated.quantile_bound) { result.quantile.add(truth.quantile95 <= *stated.quantile_bound ? 1 : 0); }
        if (stated.status == aglow::audit_status::certified) { ++result.falsely; }
    }
    return result;
}

/// How many of up to 100 audits of `picture` certify it.
std::size_t certified(const known_scene& scene, const judged_picture& picture, aglow::audit_options options,
                      std::size_t trials) {
    const auto probe = [&](std::size_t pixel, std::uint64_t seed, std::size_t) { return scene.look(pixel, seed); };
    std::size_t passed = 0;
    for (std::size_t i = 0; i < trials; ++i) {
        options.seed = 5000 + i;
        const auto stated = aglow::audit(picture.audited(), probe, options, aglow::own_threads{});
        if (stated.status == aglow::audit_status::certified) { ++passed; }
    }
    return passed;
}

/// A picture, and how often it is certified: always if it is right, never if it is wrong on purpose.
void control(const known_scene& scene, const char* what, const judged_picture& picture, double target,
             double bias_target, bool should_pass) {
    aglow::audit_options options{.target = target, .probes = 1000, .sample_bound = scene.sample_bound()};
    options.budget = 9 * options.probes * aglow::probe_batches * scene.samples_per_look() / 8;
    if (bias_target > 0) { options.bias_target = bias_target; }
    const std::size_t trials = std::min<std::size_t>(scene.how().certificates, 100);
    const std::size_t passed = certified(scene, picture, options, trials);
    std::printf("control %-52s certified %3zu of %zu, %s\n", what, passed, trials,
                should_pass ? (passed * 10 >= trials * 9 ? "as it should" : "TOO SELDOM")
                            : (passed * 100 <= trials ? "as it should not be" : "TOO OFTEN"));
    std::fflush(stdout);
}

/// The same method, right and with a mistake, at a target a little below the error of the wrong picture.
void control_mistake(const known_scene& scene, const char* what, std::size_t method, mistake wrong) {
    const judged_picture bad = render(scene, method, 7, wrong);
    const double dark = aglow::audit_options{}.dark;
    const double bad_error = errors_of(scene, bad, dark).mean_relative;
    const double good_error = errors_of(scene, render(scene, method, 7), dark).mean_relative;
    char words[96];
    std::snprintf(words, sizeof words, "%s: error %.1f %%, without %.1f %%", what, 100 * bad_error, 100 * good_error);
    control(scene, words, bad, 0.97 * bad_error, 0, false);
}

/// A second lamp, without size and with about one per cent of the light, that the picture does not know of.
void control_missing_lamp(const known_scene& scene) {
    auto description = *host::scenes::find<float>(scene.name());
    description.name += " and a small lamp";
    description.lamps.push_back({{100, 480, 100}, {700, 700, 700}});
    const known_scene lit{description, scene.how()};
    const judged_picture dim = render(lit, scene.scene(), 3, 7);
    const judged_picture whole = render(lit, 3, 7);
    char words[96];
    const double bias = errors_of(lit, dim, aglow::audit_options{}.dark).bias;
    std::snprintf(words, sizeof words, "a lamp missing: energy %+.2f %%, asked for 0.5 %%", 100 * bias);
    control(lit, words, dim, 0.1, 0.005, false);
    std::snprintf(words, sizeof words, "the same with its lamp: energy %+.2f %%",
                  100 * errors_of(lit, whole, aglow::audit_options{}.dark).bias);
    control(lit, words, whole, 0.1, 0.015, true);
}

void controls(const known_scene& scene) {
    const judged_picture good = render(scene, 3, 77);
    judged_picture exact = good;
    exact.values = scene.truth();
    control(scene, "the truth itself", exact, 0.05, 0, true);
    judged_picture dim = exact;
    for (float& x : dim.values) { x *= 0.9f; }
    control(scene, "a tenth of the light removed", dim, 0.05, 0, false);
    judged_picture slightly = exact;
    for (float& x : slightly.values) { x *= 0.97f; }
    control(scene, "3 % of the light removed, bias asked", slightly, 0.1, 0.005, false);
    judged_picture broken = exact;
    broken.values[broken.values.size() / 2] = std::numeric_limits<float>::quiet_NaN();
    control(scene, "one pixel is NaN", broken, 0.05, 0, false);
    control_mistake(scene, "photon map, radius x 3", 0, mistake::wide_radius);
    control_mistake(scene, "final gather, photons of one bounce", 1, mistake::no_depth);
    control_mistake(scene, "irradiance cache, a = 1", 2, mistake::coarse_cache);
    control_missing_lamp(scene);
}

void print_head() {
    std::printf("%-16s %-17s %6s %6s %6s %6s %6s %7s | %6s %6s %6s %7s\n", "scene", "method", "all", "featur", "hard",
                "caust", "dark", "bar/err", "bias", "mean", "q95", "false");
}

void print(const known_scene& scene, const char* method, const tally& t) {
    const auto percent = [](const aglow::running_mean& m) { return m.count() == 0 ? 0.0 : 100 * m.mean(); };
    std::printf("%-16s %-17s %6.1f %6.1f %6.1f %6.1f %6.1f %7.2f | %6.1f %6.1f %6.1f %3zu/%zu\n", scene.name().c_str(),
                method, percent(t.all), percent(t.feature), percent(t.hard), percent(t.caustic), percent(t.dark),
                t.sharpness.mean(), percent(t.bias), percent(t.mean_error), percent(t.quantile), t.falsely,
                scene.how().certificates);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    effort e;
    bool chosen = false;
    bool with_controls = true;
    std::vector<std::string> scenes{"cornell-diffuse", "point-light", "two-rooms", "cornell-glass"};
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--smoke") == 0) {
            e = {.pixels = 24, .truth = 256, .pool = 256, .batches = 16, .certificates = 3};
            scenes = {"cornell-diffuse"};
        } else if (std::strcmp(argv[i], "--full") == 0) {
            e = {.pixels = 96, .truth = 65536, .pool = 16384, .batches = 64, .certificates = 1000};
        } else if (std::strncmp(argv[i], "--pixels=", 9) == 0) {
            e.pixels = std::stoul(argv[i] + 9);
        } else if (std::strncmp(argv[i], "--truth=", 8) == 0) {
            e.truth = static_cast<std::uint32_t>(std::stoul(argv[i] + 8));
        } else if (std::strncmp(argv[i], "--pool=", 7) == 0) {
            e.pool = static_cast<std::uint32_t>(std::stoul(argv[i] + 7));
        } else if (std::strcmp(argv[i], "--no-controls") == 0) {
            with_controls = false;
        } else if (std::strncmp(argv[i], "--", 2) != 0) {
            if (!chosen) { scenes.clear(); }
            chosen = true;
            scenes.emplace_back(argv[i]);
        } else {
            std::printf(
                "usage: calibration [SCENE ...] [--smoke | --full] [--pixels=N] [--truth=N] [--pool=N] "
                "[--no-controls]\n"
                "Percentages of %zu certificates at nominal 95 %%: error bars by kind of pixel; statements on the\n"
                "energy, the mean relative error and its 95 %% quantile; false certificates at a target just below\n"
                "the true error.\n",
                e.certificates);
            return std::strcmp(argv[i], "--help") == 0 ? 0 : 2;
        }
    }
    print_head();
    for (const std::string& name : scenes) {
        if (!host::scenes::find<float>(name)) {
            std::fprintf(stderr, "calibration: no scene called %s\n", name.c_str());
            return 2;
        }
        const known_scene scene{*host::scenes::find<float>(name), e};
        for (std::size_t m = 0; m < std::size(methods); ++m) {
            print(scene, methods[m], calibrate(scene, render(scene, m, 7)));
        }
        if (with_controls) { controls(scene); }
    }
}
