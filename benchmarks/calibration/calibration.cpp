// Do the statements of an audit hold as often as they say? For scenes × integrators: hundreds of certificates, each
// from probes of its own, against the truth; and pictures that are wrong on purpose and must not be certified.
#include <charconv>
#include <concepts>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <aglow/report/quantiles.hpp>
#include <aglow/report/running_mean.hpp>

#include "case.hpp"
#include "common/command_line.hpp"
#include "stop_rule.hpp"
#include "whole_pictures.hpp"

using namespace calibration;

namespace {

/// How often what was stated was true.
struct tally {
    aglow::running_mean all, feature, hard, caustic, dark;  ///< coverage of the error bars, by kind of pixel
    aglow::running_mean sharpness;                          ///< mean bar over mean error
    aglow::running_mean bias, mean_error, quantile;         ///< coverage of the picture's statements
    std::vector<double> mean_bound, quantile_bound;         ///< over the truth
    aglow::running_mean samples;                            ///< of an audit
    aglow::running_mean slow;                               ///< whether noise seemed heavy-tailed to the end
    std::size_t falsely{0};
};

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

/// Audits as the effort says; by itself at a target near the true error: what a false certificate would take least
/// luck for.
aglow::audit_options audit_options(const known_scene& scene, double error) {
    const effort& how = scene.how();
    aglow::audit_options options{.noise = how.noise};
    if (how.bounded) { options.sample_bound = scene.sample_bound(); }
    options.class_probes = how.class_probes;
    options.budget = scene.budget(options.probes + 3 * options.class_probes);
    options.target = how.target > 0 ? how.target : 0.97 * error;
    return options;
}

tally calibrate(const known_scene& scene, const judged_picture& picture) {
    tally result;
    const true_errors truth = errors_of(scene, picture, aglow::audit_options{}.dark);
    aglow::audit_options options = audit_options(scene, truth.mean_relative);
    for (std::size_t i = 0; i < scene.how().certificates; ++i) {
        options.seed = i;
        const auto stated = aglow::audit(picture.audited(), scene.probe(), options, aglow::own_threads{});
        count_bars(scene, picture, truth, stated, result);
        result.bias.add(stated.energy_bias.low <= truth.bias && truth.bias <= stated.energy_bias.high ? 1 : 0);
        result.mean_error.add(truth.mean_relative <= stated.mean_error_bound ? 1 : 0);
        result.mean_bound.push_back(stated.mean_error_bound / truth.mean_relative);
        if (stated.quantile_bound) {
            result.quantile.add(truth.quantile95 <= *stated.quantile_bound ? 1 : 0);
            result.quantile_bound.push_back(*stated.quantile_bound / truth.quantile95);
        }
        result.samples.add(static_cast<double>(stated.samples));
        result.slow.add(stated.tail_index > 0.6 ? 1 : 0);
        const bool passed = stated.status == aglow::audit_status::certified;
        if (passed && options.target < truth.mean_relative) { ++result.falsely; }
    }
    return result;
}

/// How many of up to 100 audits of `picture` certify it.
std::size_t certified(const known_scene& scene, const judged_picture& picture, aglow::audit_options options,
                      std::size_t trials) {
    std::size_t passed = 0;
    for (std::size_t i = 0; i < trials; ++i) {
        options.seed = 5000 + i;
        const auto stated = aglow::audit(picture.audited(), scene.probe(), options, aglow::own_threads{});
        if (stated.status == aglow::audit_status::certified) { ++passed; }
    }
    return passed;
}

/// A picture, and how often it is certified: always if it is right, never if it is wrong on purpose.
void control(const known_scene& scene, const char* what, const judged_picture& picture, double target,
             double bias_target, bool should_pass) {
    aglow::audit_options options{.target = target, .probes = 1000, .sample_bound = scene.sample_bound()};
    options.budget = scene.budget(options.probes + 3 * options.class_probes);
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
    std::printf("%-16s %-17s %6s %6s %6s %6s %6s %7s | %6s %6s %6s %6s %6s %8s %5s %7s\n", "scene", "method", "all",
                "featur", "hard", "caust", "dark", "bar/err", "bias", "mean", "b/true", "q95", "b/true", "samples",
                "slow", "false");
}

void print(const known_scene& scene, const char* method, const tally& t) {
    const auto percent = [](const aglow::running_mean& m) { return m.count() == 0 ? 0.0 : 100 * m.mean(); };
    const auto typical = [](const std::vector<double>& v) { return v.empty() ? 0.0 : aglow::median(v); };
    std::printf(
        "%-16s %-17s %6.1f %6.1f %6.1f %6.1f %6.1f %7.2f | %6.1f %6.1f %6.2f %6.1f %6.2f %8.0f %5.1f %3zu/%zu\n",
        scene.name().c_str(), method, percent(t.all), percent(t.feature), percent(t.hard), percent(t.caustic),
        percent(t.dark), t.sharpness.mean(), percent(t.bias), percent(t.mean_error), typical(t.mean_bound),
        percent(t.quantile), typical(t.quantile_bound), t.samples.mean(), percent(t.slow), t.falsely,
        scene.how().certificates);
    std::fflush(stdout);
}

template <typename Known>
void print_trials(const Known& scene, const char* method, const stop_tally& t) {
    const auto at = [](const std::vector<double>& v, double q) { return v.empty() ? 0.0 : aglow::quantile(v, q); };
    std::printf(
        "until %-16s %-17s certified %3zu (%zu falsely), out of reach %zu, out of work %zu of %zu; work over the "
        "oracle's: median %.2f, 90 %% %.2f; the picture's alone: %.2f, %.2f; a probe's sample costs %.2f of the "
        "picture's\n",
        scene.name().c_str(), method, t.reached, t.falsely, t.unreachable, t.out_of_work, t.trials, at(t.work, 0.5),
        at(t.work, 0.9), at(t.picture_work, 0.5), at(t.picture_work, 0.9),
        t.price.each * aglow::square(static_cast<double>(scene.how().width)));
    std::fflush(stdout);
}

/// What is to be done, by the command line.
struct job {
    effort how{};
    std::vector<std::string> scenes{"cornell-diffuse", "point-light", "two-rooms", "cornell-glass"};
    bool coverage{true};
    bool controls{true};
    bool trials{true};
    std::size_t first{0};
    std::size_t last{std::size(methods)};
};

std::string usage() {
    return "usage: calibration [SCENE ...] [--smoke | --full] [--pixels=N] [--pool=N] [--certificates=N] [--method=N]\n"
           "       [--target=X] [--noise=X] [--class-probes=N] [--budget=N] [--bounded] [--width=N]\n"
           "       [--probes=guided|path] [--no-coverage] [--no-controls] [--no-trials] [--whole]\n"
           "Percentages of " +
           std::to_string(effort{}.certificates) +
           " certificates at nominal 95 %: error bars by kind of pixel; statements on the energy, the\n"
           "mean relative error and its 95 % quantile, and how far above the truth they are; false certificates, at\n"
           "a target just below the true error where none is told. Then pictures that are wrong on purpose, and\n"
           "pictures rendered until they are certified, beside an oracle that knows their error, with probes weighed\n"
           "against pictures of --width. These are small ones too, or with --whole of that width: then their truth\n"
           "is known at " +
           std::to_string(effort{}.truths) +
           " pixels drawn at random. Probes are the renderer's, guided where light comes over\n"
           "mirrors, or all plain paths.\n";
}

/// The text after "`name`=", where `argument` is that option.
std::optional<std::string_view> value_of(std::string_view argument, std::string_view name) {
    const bool is_it = argument.starts_with(name) && argument.substr(name.size()).starts_with('=');
    return is_it ? std::optional{argument.substr(name.size() + 1)} : std::nullopt;
}

/// Whether `argument` was `name` and a whole number, which is put into `value`; throws for one out of range.
template <std::unsigned_integral T>
bool take(std::string_view argument, std::string_view name, T& value, std::size_t least, std::size_t most) {
    const auto text = value_of(argument, name);
    if (text) { value = static_cast<T>(command_line::whole(name, *text, least, most)); }
    return text.has_value();
}

/// The same for a number above 0; where 1 is 100 %, none needs more than 100.
bool take(std::string_view argument, std::string_view name, double& value) {
    const auto text = value_of(argument, name);
    if (!text) { return false; }
    const auto [end, wrong] = std::from_chars(text->data(), text->data() + text->size(), value);
    if (wrong != std::errc{} || end != text->data() + text->size() || !(value > 0 && value <= 100)) {
        throw std::invalid_argument(std::string{name} + " wants a number above 0, up to 100, not \"" +
                                    std::string{*text} + '"');
    }
    return true;
}

bool take_number(std::string_view argument, job& what) {
    effort& e = what.how;
    if (take(argument, "--method", what.first, 0, std::size(methods) - 1)) {
        what.last = what.first + 1;
        return true;
    }
    constexpr std::size_t many = 1'000'000'000;
    return take(argument, "--pixels", e.pixels, 8, 4096) || take(argument, "--pool", e.pool, 256, many) ||
           take(argument, "--certificates", e.certificates, 1, many) || take(argument, "--target", e.target) ||
           take(argument, "--noise", e.noise) || take(argument, "--class-probes", e.class_probes, 0, many) ||
           take(argument, "--budget", e.budget, 0, many) || take(argument, "--width", e.width, 8, 16384);
}

bool take(std::string_view argument, job& what) {
    if (argument == "--no-coverage") {
        what.coverage = false;
    } else if (argument == "--no-controls") {
        what.controls = false;
    } else if (argument == "--no-trials") {
        what.trials = false;
    } else if (argument == "--probes=guided" || argument == "--probes=path") {
        what.how.probes = argument == "--probes=path" ? host::probe_kind::path : host::probe_kind::guided;
    } else if (argument == "--whole") {
        what.how.whole = true;
    } else if (argument == "--bounded") {
        what.how.bounded = true;
    } else {
        return take_number(argument, what);
    }
    return true;
}

/// What --smoke and --full stand for. Looked for before all else: what they set, an option before them may change too.
job preset(command_line::words asked) {
    bool smoke = false;
    bool full = false;
    while (asked.next()) {
        smoke = smoke || asked.is("--smoke");
        full = full || asked.is("--full");
    }
    if (smoke && full) { throw std::invalid_argument("--full and --smoke exclude each other"); }
    job what;
    if (smoke) {
        what.how = {.pixels = 24, .pool = 1024, .certificates = 3};
        what.scenes = {"cornell-diffuse"};
    }
    if (full) { what.how = {.pixels = 96, .pool = 65536, .certificates = 1000}; }
    return what;
}

job job_of(command_line::words& asked) {
    job what = preset(asked);
    std::vector<std::string> named;
    while (asked.next()) {
        if (asked.is("--smoke") || asked.is("--full")) { continue; }
        if (!asked.is_option()) {
            if (!host::scenes::find<float>(asked.word())) {
                throw std::invalid_argument("no scene called " + asked.word());
            }
            named.push_back(asked.word());
        } else if (!take(asked.word(), what)) {
            asked.refuse();
        }
    }
    if (!named.empty()) { what.scenes = named; }
    return what;
}

template <typename Known>
void try_to_stop(const Known& scene, const job& what) {
    for (std::size_t m = what.first; m < what.last; ++m) { print_trials(scene, methods[m], stop_trials(scene, m)); }
}

void work(const known_scene& scene, const job& what) {
    for (std::size_t m = what.first; m < what.last && what.coverage; ++m) {
        print(scene, methods[m], calibrate(scene, render(scene, m, 7)));
    }
    if (what.controls) { controls(scene); }
    if (what.trials && !what.how.whole) { try_to_stop(scene, what); }
}

int benchmark(const job& what) {
    if (what.coverage) { print_head(); }
    for (const std::string& name : what.scenes) {
        const auto scene = *host::scenes::find<float>(name);
        if (what.coverage || what.controls || !what.how.whole) { work(known_scene{scene, what.how}, what); }
        if (what.trials && what.how.whole) { try_to_stop(whole_scene{scene, what.how}, what); }
    }
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    return command_line::run(count, arguments, usage(),
                             [](command_line::words& asked) { return benchmark(job_of(asked)); });
}
