#include "error_vs_time/plot.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <aglow/core/numbers.hpp>

namespace error_vs_time {

const char* const plot_style = R"(
svg text { font: 12px system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; fill: #6a6a70; }
svg .title { font-size: 14px; font-weight: 600; fill: #1d1d1f; } svg .name { font-weight: 600; }
.grid { stroke: #ececef; } .axis { stroke: #8a8a90; } .target { stroke: #9a9aa0; stroke-dasharray: 2 4; }
.curve { fill: none; stroke: currentColor; stroke-width: 2; }
.band { fill: currentColor; opacity: .13; stroke: none; } circle { fill: currentColor; }
)";

namespace {

constexpr double width = 620;
constexpr double height = 420;
constexpr double left = 76;
constexpr double right = 150;  // room for the names of the series
constexpr double top = 34;
constexpr double bottom = 48;

/// A range of positive numbers laid out evenly by its logarithm.
struct log_axis {
    double low{std::numeric_limits<double>::max()};
    double high{0};
    double from{0};
    double to{1};

    void include(double value) {
        if (!(value > 0) || !aglow::is_finite(value)) { return; }
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void widen() {
        low /= 1.25;
        high *= 1.25;
    }
    [[nodiscard]] bool empty() const { return !(high > 0); }
    [[nodiscard]] bool holds(double value) const { return low <= value && value <= high; }
    [[nodiscard]] double at(double value) const {
        const double way = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
        return from + (to - from) * way;
    }
};

std::string px(double value) { return rounded(value, 5); }

std::string line(double x1, double y1, double x2, double y2, const char* kind) {
    return "<line class=\"" + std::string{kind} + "\" x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) +
           "\" y2=\"" + px(y2) + "\"/>\n";
}

std::string text(double x, double y, const char* anchor, const std::string& words, const std::string& more = {}) {
    return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
           escaped(words) + "</text>\n";
}

/// Calls `visit(value, labelled)` for 1, 2, 5 times the powers of ten on the axis. Labels thin out on long axes.
template <typename Visit>
void for_each_tick(const log_axis& axis, const Visit& visit) {
    const double decades = std::log10(axis.high / axis.low);
    for (int e = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10.0, e) <= axis.high; ++e) {
        for (const int step : {1, 2, 5}) {
            const double value = step * std::pow(10.0, e);
            if (axis.holds(value)) { visit(value, step == 1 || decades < 2.2); }
        }
    }
}

std::string axes(const plot& what, const log_axis& x, const log_axis& y) {
    std::string out;
    for_each_tick(x, [&](double value, bool labelled) {
        out += line(x.at(value), y.from, x.at(value), y.to, "grid");
        if (labelled) { out += text(x.at(value), y.from + 18, "middle", rounded(value)); }
    });
    for_each_tick(y, [&](double value, bool labelled) {
        out += line(x.from, y.at(value), x.to, y.at(value), "grid");
        if (labelled) { out += text(x.from - 7, y.at(value) + 4, "end", rounded(value)); }
    });
    out += line(x.from, y.from, x.to, y.from, "axis") + line(x.from, y.from, x.from, y.to, "axis");
    out += text((x.from + x.to) / 2, height - 8, "middle", what.x_label);
    out += text(16, (y.from + y.to) / 2, "middle", what.y_label,
                " transform=\"rotate(-90 16 " + px((y.from + y.to) / 2) + ")\"");
    return out + text(x.from, 20, "start", what.title, " class=\"title\"");
}

std::string targets(const plot& what, const log_axis& x, const log_axis& y) {
    std::string out;
    for (const double target : what.targets) {
        if (y.holds(target)) { out += line(x.from, y.at(target), x.to, y.at(target), "target"); }
    }
    return out;
}

std::string drawn(const plot_series& series, const log_axis& x, const log_axis& y) {
    std::string path;
    std::string band;
    std::string back;
    std::string dots;
    for (const plot_point& p : series.points) {
        if (!(p.x > 0 && p.y > 0)) { continue; }
        const std::string across = px(x.at(p.x));
        path += (path.empty() ? "M" : "L") + across + ' ' + px(y.at(p.y));
        band += (band.empty() ? "M" : "L") + across + ' ' + px(y.at(p.high));
        back = "L" + across + ' ' + px(y.at(p.low)) + back;
        dots += "<circle cx=\"" + across + "\" cy=\"" + px(y.at(p.y)) + "\" r=\"3\"><title>" + escaped(series.name) +
                ": " + rounded(p.y) + " after " + rounded(p.x) + " s</title></circle>";
    }
    if (path.empty()) { return {}; }
    return "<g style=\"color:" + series.colour + "\"><path class=\"band\" d=\"" + band + back +
           "Z\"/><path class=\"curve\" d=\"" + path + "\"/>" + dots + "</g>\n";
}

/// Names at the right ends of their curves, pushed apart where they would overlap.
std::string names(const plot& what, const log_axis& x, const log_axis& y) {
    struct label {
        double y;
        const plot_series* series;
    };
    std::vector<label> labels;
    for (const plot_series& s : what.series) {
        const auto last =
            std::find_if(s.points.rbegin(), s.points.rend(), [](const plot_point& p) { return p.x > 0 && p.y > 0; });
        if (last != s.points.rend()) { labels.push_back({y.at(last->y), &s}); }
    }
    std::stable_sort(labels.begin(), labels.end(), [](const label& a, const label& b) { return a.y < b.y; });
    constexpr double apart = 16;
    for (std::size_t i = 1; i < labels.size(); ++i) { labels[i].y = std::max(labels[i].y, labels[i - 1].y + apart); }
    double floor = y.from;
    for (auto l = labels.rbegin(); l != labels.rend(); ++l, floor -= apart) { l->y = std::min(l->y, floor); }
    std::string out;
    for (const label& l : labels) {
        out +=
            text(x.to + 8, l.y + 4, "start", l.series->name, " class=\"name\" style=\"fill:" + l.series->colour + "\"");
    }
    return out;
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            default: out += c;
        }
    }
    return out;
}

namespace {

/// Decimals without the zeros at their end.
std::string trimmed(std::string decimals) {
    if (decimals.find('.') == std::string::npos) { return decimals; }
    decimals.erase(decimals.find_last_not_of('0') + 1);
    if (decimals.back() == '.') { decimals.pop_back(); }
    return decimals;
}

}  // namespace

std::string rounded(double x, int significant) {
    if (!aglow::is_finite(x)) { return "–"; }
    if (x == 0) { return "0"; }
    char digits[64];
    const double size = std::abs(x);
    if (size < 1e-3 || size >= 1e6) {
        std::string out{
            digits,
            std::to_chars(digits, digits + sizeof digits, x, std::chars_format::scientific, significant - 1).ptr};
        return trimmed(out.substr(0, out.find('e'))) + 'e' + std::to_string(std::stoi(out.substr(out.find('e') + 1)));
    }
    const int before = static_cast<int>(std::floor(std::log10(size))) + 1;
    const int after = std::max(0, significant - before);
    std::string out{digits, std::to_chars(digits, digits + sizeof digits, x, std::chars_format::fixed, after).ptr};
    return after > 0 ? trimmed(out) : out;
}

std::string series_colour(std::size_t i) {
    static constexpr std::array colours{"#222222", "#0072b2", "#d55e00", "#009e73",
                                        "#cc79a7", "#b8860b", "#56b4e9", "#7a5195"};
    return colours[i % colours.size()];
}

std::string svg(const plot& what) {
    log_axis x{.from = left, .to = width - right};
    log_axis y{.from = height - bottom, .to = top};
    for (const plot_series& s : what.series) {
        for (const plot_point& p : s.points) {
            if (!(p.x > 0 && p.y > 0)) { continue; }
            x.include(p.x);
            for (const double value : {p.y, p.low, p.high}) { y.include(value); }
        }
    }
    if (x.empty() || y.empty()) { return "<p>" + escaped(what.title) + ": nothing to draw</p>\n"; }
    x.widen();
    y.widen();
    std::string out = "<svg class=\"plot\" viewBox=\"0 0 " + px(width) + ' ' + px(height) +
                      "\" role=\"img\" aria-label=\"" + escaped(what.title) + "\">\n";
    out += axes(what, x, y) + targets(what, x, y);
    for (const plot_series& s : what.series) { out += drawn(s, x, y); }
    return out + names(what, x, y) + "</svg>\n";
}

std::string svg_file(const plot& what) {
    const std::string start =
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width) + "\" height=\"" + px(height) + "\"";
    const std::string drawing = svg(what);
    if (drawing.rfind("<svg", 0) != 0) {
        return start + ">\n" + text(left, top, "start", what.title + ": nothing to draw") + "</svg>\n";
    }
    const std::size_t inside = drawing.find('\n') + 1;  // behind the opening tag
    return start + drawing.substr(4, inside - 4) + "<style>" + plot_style + "</style>\n" +
           "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" + drawing.substr(inside);
}

}  // namespace error_vs_time
