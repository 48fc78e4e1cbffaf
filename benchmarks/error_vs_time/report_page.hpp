// A study as a page for people: self-contained HTML, and a short text of it in Markdown.
#pragma once

#include <string>

#include "error_vs_time/study.hpp"

namespace error_vs_time {

/// The whole report as one HTML file that asks nothing of a network.
[[nodiscard]] std::string report_html(const study& all);

/// A scene's curves of one error over CPU seconds, as an SVG file.
[[nodiscard]] std::string report_svg(const study& all, const std::string& scene, const metric& what);

/// Times to an error, speed-ups and certificates as Markdown tables.
[[nodiscard]] std::string report_markdown(const study& all);

}  // namespace error_vs_time
