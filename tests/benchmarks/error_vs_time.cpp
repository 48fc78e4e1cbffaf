#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include "benchmarks/synthetic_study.hpp"
#include "error_vs_time/gate.hpp"
#include "error_vs_time/json.hpp"
#include "error_vs_time/options.hpp"
#include "error_vs_time/plot.hpp"
#include "error_vs_time/png.hpp"
#include "error_vs_time/records.hpp"
#include "error_vs_time/report_page.hpp"
#include "error_vs_time/seeds.hpp"
#include "error_vs_time/summary.hpp"
#include "error_vs_time/tables.hpp"
#include "error_vs_time/work_left.hpp"
#include "support/catch.hpp"

using namespace error_vs_time;

namespace {

const metric& mape() { return metrics()[0]; }
const metric& relmse() { return metrics()[1]; }

std::size_t count(const std::string& text, const std::string& word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) { ++found; }
    return found;
}

}  // namespace

TEST_CASE("study: the path tracer's slope, its time to an error and the speed-up over it are those of the laws") {
    const study all = synthetic::study(0.02);
    const auto fit = slope(all, "box", "path", mape());
    REQUIRE(fit);
    CHECK(fit->slope == Approx(-0.5).margin(4 * fit->slope_error));
    CHECK(slope(all, "box", "path", relmse())->slope == Approx(2 * fit->slope));
    const double path_seconds = std::pow(0.20 / 0.09, 2);
    const double map_seconds = std::pow(0.08 / 0.09, 4);
    const time_to path = time_to_target(all, "box", "path", mape(), 0.09);
    CHECK(path.median.when == aglow::crossing::kind::at);
    CHECK(path.median.time == Approx(path_seconds).epsilon(0.04));
    REQUIRE(path.interval);
    CHECK(path.interval->contains(path_seconds));
    const auto ratio = speed_up_to_target(all, "box", "photon-map", mape(), 0.09);
    REQUIRE(ratio);
    CHECK(ratio->sign == '=');
    CHECK(ratio->estimate == Approx(path_seconds / map_seconds).epsilon(0.08));
    REQUIRE(ratio->interval);
    CHECK(ratio->interval->contains(path_seconds / map_seconds));
}

TEST_CASE("study: fewer than six seeds have no interval of 95 %, and tell their least and most as such") {
    for (const std::uint64_t seeds : {2u, 3u, 5u, 6u}) {
        CAPTURE(seeds);
        const study all = synthetic::study(0.05, 1, 1, 0, seeds);
        CHECK(seeds_in(all, "box") == seeds);
        const bool enough = seeds >= 6;
        const std::string range = "least to most of " + std::to_string(seeds) + " seeds";
        for (const table& t :
             {times_to_targets(all, "box", mape()), speed_ups(all, "box", mape()), steps(all, "box")}) {
            CHECK((t.caption.find("95 % bootstrap interval") != std::string::npos) == enough);
            CHECK((t.caption.find(range) != std::string::npos) == !enough);
        }
        CHECK((report_html(all).find("95 % bootstrap intervals") != std::string::npos) == enough);
        const time_to path = time_to_target(all, "box", "path", mape(), 0.09);
        const time_to map = time_to_target(all, "box", "photon-map", mape(), 0.09);
        const auto ratio = speed_up_to_target(all, "box", "photon-map", mape(), 0.09);
        REQUIRE((path.interval && map.interval && ratio && ratio->interval));
        if (enough) { continue; }
        const auto [least, most] = std::minmax_element(path.seconds.begin(), path.seconds.end());
        CHECK((path.interval->low == *least && path.interval->high == *most));
        CHECK(ratio->interval->low == path.interval->low / map.interval->high);
        CHECK(ratio->interval->high == path.interval->high / map.interval->low);
    }
    CHECK(report_html(synthetic::study(0.05, 1, 1, 0, 3)).find("a probability of 75 %") != std::string::npos);
}

TEST_CASE("study: what lies beyond the ends of the curves is told as a limit") {
    const study all = synthetic::study();
    CHECK(time_to_target(all, "box", "path", mape(), 0.01).median.when == aglow::crossing::kind::never);
    CHECK(time_to_target(all, "box", "gather-cache", mape(), 0.05).median.when == aglow::crossing::kind::before);
    const auto at_least = speed_up_to_target(all, "box", "gather-cache", mape(), 0.09);
    REQUIRE(at_least);
    CHECK(at_least->sign == '>');
    CHECK(at_least->estimate == Approx(std::pow(0.20 / 0.09, 2) / 0.3).epsilon(0.1));
    CHECK(!at_least->interval);
    CHECK(!speed_up_to_target(all, "box", "path", mape(), 0.10));
    CHECK(!speed_up_to_target(all, "box", "not there", mape(), 0.10));
}

TEST_CASE("study: with two seeds of which one gets there, the median lies between that and the other's last run") {
    study two{.title = "two seeds", .baseline = "path"};
    const auto add = [&](std::uint64_t seed, double seconds, double error) {
        run_note r{.scene = "box", .method = "path", .seed = seed, .cpu_seconds = seconds};
        r.error.mape = error;
        two.runs.push_back(r);
    };
    add(1, 1, 0.2);
    add(1, 4, 0.1);
    add(2, 1, 0.4);
    add(2, 6, 0.2);
    const auto at_tenth = time_to_target(two, "box", "path", mape(), 0.1).median;
    CHECK(at_tenth.when == aglow::crossing::kind::never);
    CHECK(at_tenth.time == 5);
    const auto at_fifth = time_to_target(two, "box", "path", mape(), 0.2).median;
    CHECK(at_fifth.when == aglow::crossing::kind::before);
    CHECK(at_fifth.time == 3.5);
}

TEST_CASE("study: the baseline carried on beyond its last run follows its law, and is told as about") {
    const study all = synthetic::study(0.02);
    const double seconds = std::pow(0.20 / 0.01, 2);  // its last run takes 16
    const auto longer = carried_on(all, "box", mape(), 0.01);
    REQUIRE(longer);
    CHECK(*longer == Approx(seconds).epsilon(0.06));
    CHECK(!carried_on(all, "box", mape(), 0.09));
    const double cache_seconds = std::pow(0.02 / (0.01 - 0.004), 2);
    const auto ratio = speed_up_to_target(all, "box", "irradiance-cache", mape(), 0.01);
    // That cache's own floor lets it not get there, nor is anything claimed of it.
    CHECK((cache_seconds > 6.4 && !ratio));
    const auto gathered = speed_up_to_target(all, "box", "gather-cache", mape(), 0.01);
    REQUIRE(gathered);
    CHECK(gathered->sign == '>');
    CHECK(gathered->estimate == Approx(16).epsilon(0.1));
    REQUIRE(gathered->about);
    CHECK(*gathered->about == Approx(seconds).epsilon(0.1));  // one second for the gather cache
}

TEST_CASE("study: a baseline that falls slower than independent samples is not carried on as slowly") {
    study all = synthetic::study(0);
    for (run_note& r : all.runs) {
        if (r.method == "path") { r.error.mape = 0.2 * std::pow(r.cpu_seconds, -0.25); }
    }
    const double last = 16;
    CHECK(*carried_on(all, "box", mape(), 0.01) == Approx(last * std::pow(0.1 / 0.01, 2)).epsilon(0.1));
}

TEST_CASE("study: every step is told beside the baseline's time to the same error, measured or carried on") {
    const study all = synthetic::study(0.02);
    for (const std::size_t budget : {0u, 6u}) {
        const double t = 0.1 * std::pow(2.0, static_cast<double>(budget));
        const double path_seconds = std::pow(0.20 / (0.004 + 0.02 / std::sqrt(t)), 2);
        const auto equal = at_equal_error(all, "box", "irradiance-cache", budget, relmse());
        REQUIRE(equal);
        CHECK(equal->sign == (path_seconds > 16 ? '~' : '='));
        CHECK(equal->baseline_seconds == Approx(path_seconds).epsilon(0.08));
        CHECK(equal->ratio.low <= path_seconds / t);
        CHECK(equal->ratio.high >= path_seconds / t);
    }
    CHECK(!at_equal_error(all, "box", "path", 0, relmse()));
    const table every = steps(all, "box");
    CHECK(every.rows.size() == 7 * synthetic::laws().size());
    for (const auto& row : every.rows) { CHECK(row.size() == every.head.size()); }
}

TEST_CASE("curve: pure variance has a flat efficiency, and a floor a falling one") {
    const study all = synthetic::study();
    const auto path = curve(all, "box", "path", relmse());
    const auto cache = curve(all, "box", "irradiance-cache", relmse());
    REQUIRE(path.size() == 7);
    CHECK(path.front().efficiency == Approx(path.back().efficiency).epsilon(0.15));
    CHECK(cache.front().efficiency > 1.6 * cache.back().efficiency);
    CHECK(path[3].error_low < path[3].error);
    CHECK(path[3].error < path[3].error_high);
}

TEST_CASE("json: what is written is read back, and what is no JSON is refused") {
    const json value = json::object{{"text", "a \"quoted\"\nline\\ \x01 é"},
                                    {"number", 0.1},
                                    {"list", json::list{1, true, json{}, -2.5e-300}},
                                    {"none", json::list{}},
                                    {"broken", std::nan("")}};
    const json again = parse_json(value.dump());
    CHECK(again.dump() == value.dump());
    CHECK(again["text"].text() == value["text"].text());
    CHECK(again["number"].number() == 0.1);
    CHECK(again["list"].elements()[3].number() == -2.5e-300);
    CHECK(again["broken"].number(7) == 7);
    for (const char* wrong :
         {"", "{", "[1,]", "{\"a\" 1}", "nul", "\"open", "1 2", "\"\\x\"", "{\"a\":1,}", "\"\\u12"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(parse_json(wrong), std::runtime_error);
    }
    CHECK_THROWS_AS(parse_json(std::string(100'000, '[')), std::runtime_error);
}

TEST_CASE("report.json: a study comes back as it was, seeds of 64 bits included") {
    study all = synthetic::study();
    all.runs[3].seed = 0xfedcba9876543210u;
    const std::string text = report_json(all);
    const study again = read_report(text);
    CHECK(report_json(again) == text);
    CHECK(again.runs.size() == all.runs.size());
    CHECK(again.runs[3].seed == all.runs[3].seed);
    CHECK(again.runs[5].error.relmse == all.runs[5].error.relmse);
    CHECK(again.parts[2].parts.variance == all.parts[2].parts.variance);
    CHECK(again.audits[1].budget == 6);
    CHECK(again.audits[1].bound == all.audits[1].bound);
    CHECK(again.relmse_targets == all.relmse_targets);
    CHECK(again.scenes[0].reference_pictures == all.scenes[0].reference_pictures);
    CHECK_THROWS_WITH(read_report("{}"), "not a report of error_vs_time");
    std::string later = text;
    later.replace(later.find("\"version\": 1"), 12, "\"version\": 9");
    CHECK_THROWS_WITH(read_report(later), "a report of version 9, not 1");
}

TEST_CASE("report.json: what is unknown is not read back as nothing") {
    study all = synthetic::study();
    constexpr double endless = std::numeric_limits<double>::infinity();
    all.audits[0].bound = all.audits[0].bias_high = endless;
    all.audits[0].bias_low = -endless;
    all.runs[0].error.mape = endless;
    const study again = read_report(report_json(all));
    CHECK(again.audits[0].bound == endless);
    CHECK(again.audits[0].bias_low == -endless);
    CHECK(again.audits[0].bias_high == endless);
    CHECK(again.runs[0].error.mape == endless);
}

TEST_CASE("runs.csv: one line a run, as many fields in each as in its head") {
    const study all = synthetic::study();
    std::istringstream lines{runs_csv(all)};
    std::string head;
    std::getline(lines, head);
    const auto commas = std::count(head.begin(), head.end(), ',');
    CHECK(head.find("scene,method,budget,settings,seed,cpu_seconds") == 0);
    CHECK(head.find("count records") != std::string::npos);
    std::size_t runs = 0;
    for (std::string line; std::getline(lines, line); ++runs) {
        // The settings hold a comma within quotes.
        CHECK(std::count(line.begin(), line.end(), ',') == commas + 1);
        CHECK(line.find("\"\"stratified\"\"") != std::string::npos);
    }
    CHECK(runs == all.runs.size());
}

TEST_CASE("png: the file has the checksums of the standard, and base64 its test vectors") {
    const std::vector<std::uint8_t> pixel{255, 0, 0};
    const std::vector<std::uint8_t> file = png(pixel, 1, 1);
    // 8 bytes of signature; IHDR 25; IDAT 12 + 2 + 5 + 4 + 4; IEND 12, which always ends in the checksum ae426082.
    REQUIRE(file.size() == 8 + 25 + 27 + 12);
    CHECK(std::vector<std::uint8_t>(file.end() - 4, file.end()) == std::vector<std::uint8_t>{0xae, 0x42, 0x60, 0x82});
    CHECK(std::vector<std::uint8_t>(file.begin() + 29, file.begin() + 33) ==
          std::vector<std::uint8_t>{0x90, 0x77, 0x53, 0xde});  // of a 1 x 1 RGB header
    const auto of = [](std::string_view text) {
        return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    };
    CHECK(of("") == "");
    CHECK(of("f") == "Zg==");
    CHECK(of("fo") == "Zm8=");
    CHECK(of("foobar") == "Zm9vYmFy");
    CHECK_THROWS_AS(png(pixel, 2, 1), std::invalid_argument);
    CHECK(png(std::vector<std::uint8_t>(3 * 300 * 300), 300, 300).size() > 270'000);
}

TEST_CASE("shown: broken light is magenta, light is sRGB, and error runs from black to pale yellow") {
    const float nan = std::nanf("");
    const auto colours = shown(std::vector<float>{0, 0.2140411f, 1, nan, 0, 0});
    CHECK(colours == std::vector<std::uint8_t>{0, 127, 255, 255, 0, 255});
    const std::vector<float> reference{1, 1, 1, 1, 1, 1};
    const auto errors = shown_error(std::vector<float>{1, 1, 1, 2, 2, 2}, reference, 0.02);
    CHECK(errors[0] == 0);
    CHECK(errors[3] > 250);
    CHECK(errors[4] == 255);
}

TEST_CASE("rounded: three digits, no exponent where people would not write one") {
    CHECK(rounded(0) == "0");
    CHECK(rounded(12.345) == "12.3");
    CHECK(rounded(0.00123456) == "0.00123");
    CHECK(rounded(1234.6) == "1235");
    CHECK(rounded(100) == "100");
    CHECK(rounded(-2.50) == "-2.5");
    CHECK(rounded(0.000279) == "2.79e-4");
    CHECK(rounded(1.23456e-7) == "1.23e-7");
    CHECK(rounded(-1.5e-12) == "-1.5e-12");
    CHECK(rounded(1.5e7) == "1.5e7");
    CHECK(rounded(std::nan("")) == "–");
}

TEST_CASE("report.html: self-contained, every method drawn in both plots of both scenes, names escaped") {
    const study all = synthetic::study();
    const std::string page = report_html(all);
    CHECK(count(page, "<svg") == 4);
    CHECK(count(page, "class=\"curve\"") == 4 * synthetic::laws().size());
    CHECK(count(page, "<svg") == count(page, "</svg>"));
    CHECK(count(page, "<table") == count(page, "</table>"));
    CHECK(count(page, "<div") == count(page, "</div>"));
    CHECK(page.find("glass &amp; mirror") != std::string::npos);
    CHECK(page.find("&lt;synthetic&gt;") != std::string::npos);
    CHECK(page.find("http://") == std::string::npos);
    CHECK(page.find("https://") == std::string::npos);
    CHECK(page.find("data:image/png;base64,") != std::string::npos);
    CHECK(page.find("nan") == std::string::npos);
    if (const char* file = std::getenv("AGLOW_REPORT_HTML")) { std::ofstream{file} << page; }
}

TEST_CASE("a scene's curves: an SVG file that needs no page around it, with every method drawn") {
    const study all = synthetic::study();
    const std::string file = report_svg(all, all.scenes.front().name, metrics()[1]);
    CHECK(file.rfind("<svg xmlns=\"http://www.w3.org/2000/svg\"", 0) == 0);
    CHECK(count(file, "<svg") == 1);
    CHECK(count(file, "class=\"curve\"") == synthetic::laws().size());
    CHECK(file.find(".curve {") != std::string::npos);
    CHECK(report_svg({.title = "nothing"}, "box", metrics()[1]).find("nothing to draw") != std::string::npos);
}

TEST_CASE("report.html: a reference whose noise is more than a fifth of the lowest error is said to be so") {
    study all = synthetic::study();
    const auto warnings = [&](double relmse_noise, double mape_noise, std::size_t pictures) {
        for (scene_note& s : all.scenes) {
            s.reference_relmse = relmse_noise;
            s.reference_mape = mape_noise;
            s.reference_pictures = pictures;
        }
        return count(report_html(all), "class=\"warning\"");
    };
    double least = 1;
    for (const run_note& r : all.runs) { least = std::min(least, r.error.relmse); }
    CHECK(warnings(0.15 * least, 0, 1) == 0);
    CHECK(warnings(0.5 * least, 0, 1) == 2);
    CHECK(warnings(0.5 * least, 0, 2) == 0);  // two halves: that noise is no part of relMSE
    CHECK(warnings(0.5 * least, 0.01, 2) == 2);
}

TEST_CASE("report.html: an empty study is a page too") {
    const std::string page = report_html({.title = "nothing"});
    CHECK(page.find("</html>") != std::string::npos);
    study one{.title = "one run", .baseline = "path"};
    one.scenes.push_back({.name = "box"});
    one.runs.push_back({.scene = "box", .method = "path", .cpu_seconds = 1});
    CHECK(report_html(one).find("nothing to draw") != std::string::npos);
    CHECK(report_markdown(one).find("path") != std::string::npos);
}

TEST_CASE("report.md: times and certificates are tables of equal width") {
    std::istringstream lines{report_markdown(synthetic::study())};
    std::size_t rows = 0;
    std::ptrdiff_t bars = 0;
    for (std::string line; std::getline(lines, line);) {
        const auto here = line.empty() || line[0] != '|' ? 0 : std::count(line.begin(), line.end(), '|');
        if (here > 0 && bars > 0) { CHECK(here == bars); }
        bars = here;
        rows += here > 0 ? 1 : 0;
    }
    CHECK(rows > 30);
}

TEST_CASE("gate: Holm's correction by hand") {
    CHECK(holm_adjusted(std::vector<double>{0.01, 0.04, 0.03, 0.005}) ==
          std::vector<double>{3 * 0.01, 2 * 0.03, 2 * 0.03, 4 * 0.005});
    CHECK(holm_adjusted(std::vector<double>{0.9, 0.8}) == std::vector<double>{1, 1});
    CHECK(holm_adjusted({}).empty());
}

TEST_CASE("gate: the same method measured again is not called worse, but for one comparison in twenty") {
    int wrong = 0;
    for (std::uint64_t r = 0; r < 40; ++r) {
        const auto found = differences(synthetic::study(0.05, 1, 1, 2 * r), synthetic::study(0.05, 1, 1, 2 * r + 1));
        const bool any = std::any_of(found.begin(), found.end(), [](const difference& d) { return d.significant; });
        wrong += any ? 1 : 0;
    }
    CHECK(wrong <= 6);  // 2 expected; more than 6 has a chance below 1 %
}

TEST_CASE("gate: ten per cent slower and ten per cent wronger are found, and named") {
    const study before = synthetic::study(0.02, 1, 1, 1);
    const auto slower = differences(before, synthetic::study(0.02, 1.1, 1, 2));
    const auto wronger = differences(before, synthetic::study(0.02, 1, 1.1, 2));
    const auto better = differences(before, synthetic::study(0.02, 0.9, 0.9, 2));
    CHECK(slower.size() == 2 * 4 * (7 + 1) * 3);
    CHECK(worse(slower));
    CHECK(worse(wronger));
    CHECK(!worse(better));
    for (const difference& d : slower) {
        if (d.significant) { CHECK(d.quantity == "CPU seconds"); }
        if (d.quantity == "CPU seconds") { CHECK(d.ratio == Approx(1.1).epsilon(0.04)); }
    }
    CHECK(told(wronger).find("WORSE   ") == 0);
    CHECK(differences(before, before).front().p_value == 1);
    CHECK(differences(before, study{}).empty());
}

TEST_CASE("gate: three seeds are enough to find a tenth more time or error in all steps of a method together") {
    const study before = synthetic::study(0.02, 1, 1, 1, 3);
    for (const study& after : {synthetic::study(0.02, 1.1, 1, 2, 3), synthetic::study(0.02, 1, 1.1, 2, 3)}) {
        const auto found = differences(before, after);
        CHECK(worse(found));
        const auto said = told(found);
        CHECK(count(said, "WORSE") >= 2 * synthetic::laws().size());
        CHECK(said.find("all steps") != std::string::npos);
    }
    CHECK(!worse(differences(before, synthetic::study(0.02, 1, 1, 2, 3))));
}

TEST_CASE("gate: what got lost is named, and what else is not alike") {
    const study before = synthetic::study();
    CHECK(losses(before, before).empty());
    CHECK(unlike(before, before).empty());
    study after = before;
    after.runs[9].error.broken = 5;
    const std::string lost_scene = after.runs.back().scene;
    std::erase_if(after.runs, [&](const run_note& r) {
        return r.scene == lost_scene || (r.method == "photon-map" && r.budget == 6);
    });
    after.provenance[0].second = "another";
    const auto lost = losses(before, after);
    REQUIRE(lost.size() == 1 + 8);
    CHECK(std::find(lost.begin(), lost.end(), "box, path, step 2, seed 1: 5 broken pixels, 0 before") != lost.end());
    CHECK(std::find(lost.begin(), lost.end(), "box, photon-map, step 7, seed 0: not in the second report") !=
          lost.end());
    CHECK(unlike(before, after) ==
          std::vector<std::string>{"compiler: none before, now another", lost_scene + ": not in the second report"});
    CHECK(unlike(after, before).back() == lost_scene + ": not in the first report");
}

TEST_CASE("gate: steps of other settings are not compared but named, nor pictures of other sizes or references") {
    const study before = synthetic::study();
    CHECK(other_scenes(before, before).empty());
    study after = before;
    for (run_note& r : after.runs) {
        if (r.scene == "box" && r.method == "gather-cache" && r.budget == 2) {
            r.settings = "half of that";
            r.error.relmse *= 3;
        }
    }
    for (const difference& d : differences(before, after)) { CHECK(d.ratio == 1); }
    const auto lost = losses(before, after);
    REQUIRE(lost.size() == 1);
    CHECK(lost[0] == "box, gather-cache, step 3: 16 samples, \"stratified\" before, now half of that");
    study smaller = before;
    smaller.scenes[0].width = 32;
    CHECK(other_scenes(before, smaller) == std::vector<std::string>{"box: pictures of 64x64 before, now of 32x64"});
    study judged = before;
    judged.scenes[1].reference_relmse *= 2;
    CHECK(other_scenes(before, judged).size() == 1);
}

TEST_CASE("seeds: no picture can have a reference's, however many there are") {
    using words = std::vector<std::string_view>;
    const std::string most = std::to_string(most_seeds);
    const std::string more = std::to_string(most_seeds + 1);
    CHECK(parse(words{"--seeds", most}).seeds == most_seeds);
    CHECK_THROWS_AS(parse(words{"--seeds", more}), std::invalid_argument);
    const auto apart = [](std::uint64_t seed) { return seed < first_seed || seed >= first_seed + most_seeds; };
    CHECK(std::all_of(std::begin(kept_reference_seeds), std::end(kept_reference_seeds), apart));
    CHECK(std::all_of(std::begin(reference_seeds), std::end(reference_seeds), apart));
}

TEST_CASE("options: what is asked for is taken, wrong words are named") {
    using words = std::vector<std::string_view>;
    CHECK(parse(words{}).size == 256);
    const options some = parse(
        words{"--scene", "a", "--seeds", "4", "--scene", "b", "--scene", "a", "--relmse", "1e-4,1e-2", "-o", "x"});
    CHECK(some.scenes == std::vector<std::string>{"a", "b"});
    CHECK(some.seeds == 4);
    CHECK(some.relmse_targets == std::vector<double>{1e-2, 1e-4});
    CHECK(some.output == "x");
    CHECK(parse(words{"--seeds", "3", "--full"}).seeds == 3);
    CHECK(parse(words{"--full"}).seeds == 8);
    CHECK(parse(words{"--full"}).scenes.size() == 5);
    CHECK(parse(words{"--scene", "a", "--smoke"}).scenes == std::vector<std::string>{"a"});
    CHECK(parse(words{"--smoke", "--help"}).help);
    for (const words& wrong : {words{"--size"}, words{"--size", "256x256"}, words{"--size", "-8"}, words{"--size", "0"},
                               words{"--seeds", "1"}, words{"--relmse", "1e-3,"}, words{"--relmse", "-1"},
                               words{"--full", "--smoke"}, words{"--speed"}}) {
        CAPTURE(wrong.front());
        CHECK_THROWS_AS(parse(wrong), std::invalid_argument);
    }
    CHECK_THROWS_WITH(parse(words{"--size", "3x"}), "--size wants a whole number from 8 to 4096, not \"3x\"");
}

TEST_CASE("work left: what is spared takes no time, and the rest as long as what was done for its cost") {
    work_left left;
    left.expect(10);
    left.expect(30);
    CHECK(!left.known());
    left.spared(10);
    left.did(6, 3);
    CHECK(left.known());
    CHECK(left.seconds() == Approx(12));
    left.did(24, 12);
    CHECK(left.seconds() == 0);
}

#ifdef AGLOW_CHROMIUM

TEST_CASE("report.html: a real browser draws it, and its script puts two pictures side by side") {
    const auto folder = std::filesystem::temp_directory_path() / "aglow_report_html";
    std::filesystem::create_directories(folder);
    std::ofstream{folder / "report.html"} << report_html(synthetic::study(0.05, 1, 1, 0, 3));
    const std::string command =
        std::string{AGLOW_CHROMIUM} +
        " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run"
        " --disable-background-networking --disable-component-update --disable-sync --user-data-dir=" +
        (folder / "profile").string() + " --dump-dom file://" + (folder / "report.html").string() + " > " +
        (folder / "dom.html").string() + " 2> " + (folder / "log").string();
    REQUIRE(std::system(command.c_str()) == 0);
    std::ifstream in{folder / "dom.html"};
    const std::string page{std::istreambuf_iterator<char>{in}, {}};
    CHECK(count(page, "<img alt=\"right\" src=\"data:image/png;base64,") == 2);
    CHECK(count(page, "<img class=\"over\" alt=\"left\" src=\"data:image/png;base64,") == 2);
    CHECK(count(page, "class=\"curve\"") == 4 * synthetic::laws().size());
    std::filesystem::remove_all(folder);
}

#endif
