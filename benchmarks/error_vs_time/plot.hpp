// A log-log plot as inline SVG.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace error_vs_time {

struct plot_point {
    double x{0};
    double y{0};
    double low{0};  ///< the band around y
    double high{0};
};

struct plot_series {
    std::string name{};
    std::string colour{};
    std::vector<plot_point> points{};
};

struct plot {
    std::string title{};
    std::string x_label{};
    std::string y_label{};
    std::vector<plot_series> series{};
    std::vector<double> targets{};  ///< horizontal lines, where they lie within the data
};

/// The plot as an `<svg>` element; points that have no logarithm are left out. A text instead where nothing is left.
[[nodiscard]] std::string svg(const plot& what);

/// The plot as a file of its own, which browsers and README pages show without help.
[[nodiscard]] std::string svg_file(const plot& what);

/// What a page that holds plots says about their looks (CSS).
extern const char* const plot_style;

/// A colour for the i-th series that people with colour-blindness tell apart (Okabe & Ito 2008).
[[nodiscard]] std::string series_colour(std::size_t i);

/// `text` with what HTML and SVG would take for markup replaced.
[[nodiscard]] std::string escaped(std::string_view text);

/// `x` with so many significant digits, without an exponent between 0.0001 and 1,000,000.
[[nodiscard]] std::string rounded(double x, int significant = 3);

}  // namespace error_vs_time
