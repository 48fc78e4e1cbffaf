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
    aglow::audit_options options{.probes = 400};
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

/// A picture that is wrong on purpose: how often it is certified all the same.
void control(const known_scene& scene, const char* what, const judged_picture& wrong, double target, double bias_target,
             bool should_pass) {
    const auto probe = [&](std::size_t pixel, std::uint64_t seed, std::size_t) { return scene.look(pixel, seed); };
    std::size_t passed = 0;
    const std::size_t trials = std::min<std::size_t>(scene.how().certificates, 100);
    for (std::size_t i = 0; i < trials; ++i) {
        aglow::audit_options options{.target = target, .probes = 1000, .seed = 5000 + i};
        if (bias_target > 0) { options.bias_target = bias_target; }
        const auto stated = aglow::audit(wrong.audited(), probe, options, aglow::own_threads{});
        if (stated.status == aglow::audit_status::certified) { ++passed; }
    }
    std::printf("control %-40s certified %zu of %zu, %s\n", what, passed, trials,
                should_pass ? (passed * 10 >= trials * 9 ? "as it should" : "TOO SELDOM")
                            : (passed * 20 <= trials ? "as it should not be" : "TOO OFTEN"));
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
    std::vector<std::string> scenes{"cornell-diffuse", "point-light", "two-rooms", "cornell-glass"};
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--smoke") == 0) {
            e = {.pixels = 24, .truth = 256, .pool = 256, .batches = 16, .certificates = 3};
            scenes = {"cornell-diffuse"};
        } else if (std::strcmp(argv[i], "--full") == 0) {
            e = {.pixels = 96, .truth = 65536, .pool = 16384, .batches = 64, .certificates = 1000};
        } else if (std::strncmp(argv[i], "--", 2) != 0) {
            if (i == 1) { scenes.clear(); }
            scenes.emplace_back(argv[i]);
        } else {
            std::printf(
                "usage: calibration [SCENE ...] [--smoke | --full]\n"
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
        const known_scene scene{name, e};
        for (std::size_t m = 0; m < std::size(methods); ++m) {
            print(scene, methods[m], calibrate(scene, render(scene, m, 7)));
        }
        controls(scene);
    }
}
