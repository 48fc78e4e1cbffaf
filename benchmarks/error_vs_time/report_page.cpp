#include "error_vs_time/report_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <aglow/report/image_error.hpp>
#include <aglow/report/statement.hpp>

#include "error_vs_time/plot.hpp"
#include "error_vs_time/png.hpp"
#include "error_vs_time/summary.hpp"
#include "error_vs_time/tables.hpp"

namespace error_vs_time {

namespace {

constexpr const char* style = R"(
:root { --ink: #1d1d1f; --soft: #6a6a70; --line: #dcdce0; --paper: #ffffff; --shade: #f5f5f7; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1320px; padding: 24px 28px 80px; background: var(--paper); color: var(--ink);
       font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { font-size: 28px; margin: 8px 0 4px; } h2 { font-size: 22px; margin: 44px 0 6px; } h3 { font-size: 16px; margin: 26px 0 8px; }
p { margin: 4px 0 12px; max-width: 80ch; } .soft { color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(480px, 100%), 1fr)); gap: 16px; }
svg.plot { width: 100%; height: auto; background: var(--paper); border: 1px solid var(--line); border-radius: 6px; }
.scroll { overflow-x: auto; margin: 14px 0 22px; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 13.5px; min-width: 480px; }
caption { text-align: left; font-weight: 600; padding: 4px 0 6px; }
th, td { padding: 4px 14px 4px 0; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 600; border-bottom: 1px solid #b5b5ba; }
th.words, td.words { text-align: left; } tbody tr:hover { background: var(--shade); }
.compare { display: flex; flex-wrap: wrap; gap: 10px 18px; align-items: center; margin: 6px 0 10px; }
.compare select, .compare label { font: inherit; }
.stage { position: relative; width: min(100%, 768px); border: 1px solid var(--line); user-select: none; touch-action: none;
         cursor: ew-resize; line-height: 0; }
.stage img { width: 100%; image-rendering: pixelated; display: block; }
.stage .over { position: absolute; inset: 0; clip-path: inset(0 calc(100% - var(--cut)) 0 0); }
.stage::after { content: ""; position: absolute; top: 0; bottom: 0; left: calc(var(--cut) - 1px); width: 2px; background: #fff;
                box-shadow: 0 0 3px #000; pointer-events: none; }
.warning { border-left: 3px solid #d55e00; padding-left: 10px; }
.strip { display: grid; align-items: end; grid-template-columns: repeat(auto-fill, minmax(190px, 1fr)); gap: 10px; margin: 16px 0; }
figure { margin: 0; } figure img { width: 100%; image-rendering: pixelated; display: block; }
figcaption { font-size: 12.5px; color: var(--soft); padding: 3px 0 5px; }
pre { white-space: pre-wrap; background: var(--shade); padding: 10px 14px; border-radius: 6px; font-size: 13px; margin: 6px 0 14px; }
details { margin: 6px 0; } summary { cursor: pointer; color: var(--soft); }
nav a { margin-right: 16px; color: #0059a3; }
)";

constexpr const char* script = R"(
for (const box of document.querySelectorAll('.viewer')) {
  const [left, right] = box.querySelectorAll('select');
  const errors = box.querySelector('input[type=checkbox]');
  const stage = box.querySelector('.stage');
  const [under, over] = stage.querySelectorAll('img');
  const source = name => {
    const figure = box.querySelector('figure[data-index="' + name + '"]');
    const images = figure.querySelectorAll('img');
    return images[errors.checked && images.length > 1 ? 1 : 0].src;
  };
  const show = () => { over.src = source(left.value); under.src = source(right.value); };
  const cut = event => {
    const frame = stage.getBoundingClientRect();
    const way = Math.min(1, Math.max(0, (event.clientX - frame.left) / frame.width));
    stage.style.setProperty('--cut', 100 * way + '%');
  };
  left.onchange = right.onchange = errors.onchange = show;
  stage.onpointermove = cut;
  stage.onpointerdown = event => { stage.setPointerCapture(event.pointerId); cut(event); };
  show();
}
)";

plot curves(const study& all, const std::string& scene, const metric& what) {
    plot result{.title = scene + ": " + what.name, .x_label = "CPU seconds", .y_label = what.name};
    result.targets = targets_of(all, what);
    const std::vector<std::string> methods = methods_of(all);
    for (std::size_t i = 0; i < methods.size(); ++i) {
        plot_series series{.name = methods[i], .colour = series_colour(i)};
        for (const aglow::convergence_row& r : curve(all, scene, methods[i], what)) {
            series.points.push_back({r.seconds, r.error, r.error_low, r.error_high});
        }
        result.series.push_back(std::move(series));
    }
    return result;
}

std::string plots(const study& all, const std::string& scene) {
    return "<div class=\"plots\">" + svg(curves(all, scene, metrics()[0])) + svg(curves(all, scene, metrics()[1])) +
           "</div>\n<p class=\"soft\">Curves are medians over seeds, bands reach from the 5 % to the 95 % quantile of "
           "the seeds. Dotted lines are the targets of the tables. On logarithmic axes independent samples fall as "
           "MAPE ~ t<sup>−½</sup> and relMSE ~ t<sup>−1</sup>.</p>\n";
}

std::string figure(const picture_note& p, std::size_t index) {
    std::string out = "<figure data-index=\"" + std::to_string(index) + "\"><figcaption>" + escaped(p.method) +
                      (p.caption.empty() ? "" : ": " + escaped(p.caption)) + "</figcaption><img alt=\"" +
                      escaped(p.method) + "\" src=\"" + png_uri(p.rgb, p.width, p.height) + "\">";
    if (!p.error_rgb.empty()) {
        out +=
            "<img alt=\"error of " + escaped(p.method) + "\" src=\"" + png_uri(p.error_rgb, p.width, p.height) + "\">";
    }
    return out + "</figure>\n";
}

std::string choice(const std::vector<const picture_note*>& pictures, std::size_t chosen) {
    std::string out = "<select>";
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        out += "<option value=\"" + std::to_string(i) + (i == chosen ? "\" selected>" : "\">") +
               escaped(pictures[i]->method) + "</option>";
    }
    return out + "</select>";
}

std::string viewer(const study& all, const std::string& scene) {
    std::vector<const picture_note*> pictures;
    for (const picture_note& p : all.pictures) {
        if (p.scene == scene) { pictures.push_back(&p); }
    }
    if (pictures.empty()) { return {}; }
    std::string out =
        "<h3>Pictures</h3><div class=\"viewer\"><div class=\"compare\"><label>left " + choice(pictures, 0) +
        "</label><label>right " + choice(pictures, pictures.size() > 1 ? 1 : 0) +
        "</label><label><input type=\"checkbox\"> relative error in false colour (black 0, pale yellow 20 % and "
        "more)</label></div><div class=\"stage\" style=\"--cut:50%\"><img alt=\"right\"><img class=\"over\" "
        "alt=\"left\"></div>\n<div class=\"strip\">";
    for (std::size_t i = 0; i < pictures.size(); ++i) { out += figure(*pictures[i], i); }
    return out + "</div></div>\n";
}

std::string audits(const study& all, const std::string& scene) {
    std::string out = html(certificates(all, scene));
    if (out.empty()) { return {}; }
    out += "<details><summary>the statements in full</summary>";
    for (const audit_note& a : all.audits) {
        if (a.scene == scene) { out += "<pre>" + escaped(a.method + "\n" + a.statement) + "</pre>"; }
    }
    return "<h3>Certificates</h3>" + out + "</details>\n";
}

/// The least error that a run of the scene has; infinite without runs.
double lowest(const study& all, const std::string& scene, double aglow::image_error::*value) {
    double least = std::numeric_limits<double>::infinity();
    for (const run_note& r : all.runs) {
        if (r.scene == scene && r.error.*value > 0) { least = std::min(least, r.error.*value); }
    }
    return least;
}

/// Says where the reference's noise is more than a fifth of the lowest error measured against it.
std::string warning(const study& all, const scene_note& scene) {
    std::string out;
    const auto check = [&](const char* name, double noise, double least) {
        if (!(noise > 0.2 * least)) { return; }
        out += "<p class=\"warning\">The reference's noise is more than a fifth of the lowest " + std::string{name} +
               " here, " + rounded(least) + ": what is near that is partly the reference's.</p>\n";
    };
    if (scene.reference_pictures < 2) {
        check("relMSE", scene.reference_relmse, lowest(all, scene.name, &aglow::image_error::relmse));
    }
    check("MAPE", scene.reference_mape, lowest(all, scene.name, &aglow::image_error::mape));
    return out;
}

std::string about(const study& all, const scene_note& scene) {
    std::string out = "<h2 id=\"" + escaped(scene.name) + "\">" + escaped(scene.name) + "</h2>\n<p>" +
                      escaped(scene.description) + "; " + std::to_string(scene.width) + "×" +
                      std::to_string(scene.height) +
                      " pixels. <span class=\"soft\">Reference: " + escaped(scene.reference) + "; its own noise is " +
                      rounded(scene.reference_relmse) + " as relMSE";
    if (scene.reference_mape > 0) { out += " and " + aglow::percent(scene.reference_mape) + " as MAPE"; }
    out += scene.reference_pictures < 2 ? ", and is part of all errors here"
                                        : ", and is no part of relMSE, RMSE and bias²: its halves cancel there";
    return out + ".</span></p>\n" + warning(all, scene);
}

/// What stands in the tables' brackets, and how far it is to be trusted.
std::string about_intervals(std::size_t seeds) {
    if (seeds >= seeds_for_95) {
        return "Intervals are 95 % bootstrap intervals over seeds; below about 20 seeds they hold less.";
    }
    if (seeds < 2) { return {}; }
    const double held = 1 - std::pow(2.0, 1 - static_cast<double>(seeds));
    return "In brackets are the least and the most of " + std::to_string(seeds) +
           " seeds, between which the median of a time lies with a probability of " + rounded(100 * held) +
           " %: 95 % take " + std::to_string(seeds_for_95) + " seeds or more.";
}

std::string reading(const study& all, const std::string& scene) {
    return "<p class=\"soft\">Times are interpolated between a seed's neighbouring runs, on logarithmic axes; &lt; and "
           "&gt; "
           "are limits, where a method was there from its first run or not by its last. ≈ carries " +
           escaped(all.baseline) +
           " on beyond its last run, as fast as its errors fell or as those of independent samples do, whichever is "
           "faster. " +
           about_intervals(seeds_in(all, scene)) + "</p>\n";
}

std::string section(const study& all, const scene_note& scene) {
    const std::string& name = scene.name;
    std::string out = about(all, scene) + plots(all, name) + "<h3>Time to an error</h3>" + reading(all, name);
    for (const metric& what : metrics()) {
        if (targets_of(all, what).empty()) { continue; }
        out += html(times_to_targets(all, name, what)) + html(speed_ups(all, name, what));
    }
    out += html(steps(all, name)) + audits(all, name) + viewer(all, name) + "<h3>Errors</h3>" +
           html(final_errors(all, name)) + html(slopes(all, name));
    out += html(efficiencies(all, name)) + html(bias_and_variance(all, name));
    return out + "<h3>Where the time goes</h3>" + html(phase_times(all, name)) + html(work_done(all, name));
}

table provenance(const study& all) {
    table result{.caption = "How this was made", .head = {"what", "value"}, .words = 2};
    for (const auto& [name, value] : all.provenance) { result.rows.push_back({name, value}); }
    return result;
}

table definitions() {
    table result{
        .caption = "What the errors mean (I picture, R reference)", .head = {"error", "definition"}, .words = 2};
    for (const metric& what : metrics()) { result.rows.push_back({what.name, what.formula}); }
    return result;
}

}  // namespace

std::string report_html(const study& all) {
    std::string out =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<title>" +
        escaped(all.title) + "</title>\n<style>" + style + plot_style + "</style></head>\n<body>\n<h1>" +
        escaped(all.title) + "</h1>\n<p class=\"soft\">Speed-ups are over “" + escaped(all.baseline) + "”. Version " +
        std::to_string(schema_version) + " of the report.</p>\n<nav>";
    for (const scene_note& s : all.scenes) {
        out += "<a href=\"#" + escaped(s.name) + "\">" + escaped(s.name) + "</a>";
    }
    out += "<a href=\"#made\">how it was made</a></nav>\n";
    for (const scene_note& s : all.scenes) { out += section(all, s); }
    out += "<h2 id=\"made\">How it was made</h2>\n" + html(provenance(all)) + html(definitions());
    return out + "<script>" + script + "</script>\n</body></html>\n";
}

std::string report_svg(const study& all, const std::string& scene, const metric& what) {
    return svg_file(curves(all, scene, what));
}

std::string report_markdown(const study& all) {
    std::string out = "# " + all.title + "\n\n";
    for (const scene_note& s : all.scenes) {
        out += "## " + s.name + "\n\n";
        for (const metric& what : metrics()) {
            if (targets_of(all, what).empty()) { continue; }
            out += markdown(times_to_targets(all, s.name, what)) + markdown(speed_ups(all, s.name, what));
        }
        out += markdown(steps(all, s.name)) + markdown(final_errors(all, s.name)) + markdown(certificates(all, s.name));
    }
    return out + markdown(provenance(all));
}

}  // namespace error_vs_time
