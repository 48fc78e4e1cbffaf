#include "error_vs_time/table.hpp"

#include "error_vs_time/plot.hpp"

namespace error_vs_time {

namespace {

std::string html_row(const std::vector<std::string>& cells, const std::string& tag, std::size_t words) {
    std::string out = "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i) {
        out += '<' + tag + (i < words ? " class=\"words\">" : ">") + escaped(cells[i]) + "</" + tag + '>';
    }
    return out + "</tr>\n";
}

std::string markdown_row(const std::vector<std::string>& cells) {
    std::string out = "|";
    for (const std::string& cell : cells) {
        out += ' ';
        for (const char c : cell) {
            out += c == '|' ? std::string{"\\|"} : c == '\n' ? std::string{" "} : std::string{c};
        }
        out += " |";
    }
    return out + '\n';
}

}  // namespace

std::string html(const table& what) {
    if (what.rows.empty()) { return {}; }
    std::string out = "<div class=\"scroll\"><table><caption>" + escaped(what.caption) + "</caption>\n<thead>" +
                      html_row(what.head, "th", what.words) + "</thead>\n<tbody>\n";
    for (const auto& row : what.rows) { out += html_row(row, "td", what.words); }
    return out + "</tbody></table></div>\n";
}

std::string markdown(const table& what) {
    if (what.rows.empty()) { return {}; }
    std::string out = "**" + what.caption + "**\n\n" + markdown_row(what.head) + '|';
    for (std::size_t i = 0; i < what.head.size(); ++i) { out += i < what.words ? "---|" : "--:|"; }
    out += '\n';
    for (const auto& row : what.rows) { out += markdown_row(row); }
    return out + '\n';
}

}  // namespace error_vs_time
