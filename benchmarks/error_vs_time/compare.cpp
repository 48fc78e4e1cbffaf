// Compares two reports of error_vs_time: exit status 1 where the second is significantly worse.
#include <algorithm>
#include <charconv>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "error_vs_time/gate.hpp"
#include "error_vs_time/records.hpp"

namespace {

error_vs_time::study read(const std::string& file) {
    std::ifstream in{file, std::ios::binary};
    if (!in) { throw std::runtime_error(file + ": cannot be read"); }
    try {
        return error_vs_time::read_report(std::string{std::istreambuf_iterator<char>{in}, {}});
    } catch (const std::exception& error) { throw std::runtime_error(file + ": " + error.what()); }
}

constexpr std::string_view usage =
    "usage: compare_reports BEFORE.json AFTER.json [--smallest PERCENT]\n"
    "\n"
    "Compares the errors and the CPU seconds of two reports of error_vs_time, run by run of the same seed: each step "
    "of each\n"
    "method, and all steps of a method together. A difference is significant where a paired t-test of the logarithms,\n"
    "corrected for the number of tests (Holm), finds it at 5 % or less.\n"
    "\n"
    "Exit status: 0 where nothing is worse, 1 where something is significantly worse by more than PERCENT (5; more "
    "where\n"
    "other programs ran beside), or where a step, a seed or a whole pixel got lost or a step's settings are others, 2 "
    "where\n"
    "the reports cannot be compared: other sizes, other references, nothing in common.\n";

/// Prints the lines, each with `mark` before it.
void print(const char* mark, const std::vector<std::string>& lines) {
    for (const std::string& line : lines) { std::cout << mark << line << '\n'; }
}

/// "5" or "5%" as a share.
double percentage(std::string text) {
    if (!text.empty() && text.back() == '%') { text.pop_back(); }
    double number = -1;
    const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (wrong != std::errc{} || end != text.data() + text.size() || !(number >= 0 && number <= 1e6)) {
        throw std::runtime_error("--smallest wants a percentage, such as 5");
    }
    return number / 100;
}

int compare(const error_vs_time::study& before, const error_vs_time::study& after,
            const error_vs_time::gate_options& options) {
    const auto other = error_vs_time::other_scenes(before, after);
    if (!other.empty()) { throw std::runtime_error(other.front()); }
    const auto found = error_vs_time::differences(before, after, options);
    if (found.empty()) { throw std::runtime_error("the reports share no scene, method and step with two equal seeds"); }
    const auto lost = error_vs_time::losses(before, after);
    print("unlike  ", error_vs_time::unlike(before, after));
    print("LOST    ", lost);
    std::cout << error_vs_time::told(found);
    const auto significant = std::count_if(found.begin(), found.end(), [](const auto& d) { return d.significant; });
    std::cout << significant << " of " << found.size() << " differences are significant\n";
    return lost.empty() && !error_vs_time::worse(found, options) ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
    if (count == 2 && (std::string_view{arguments[1]} == "--help" || std::string_view{arguments[1]} == "-h")) {
        std::cout << usage;
        return 0;
    }
    const bool with_smallest = count == 5 && std::string_view{arguments[3]} == "--smallest";
    if (count != 3 && !with_smallest) {
        std::cerr << usage;
        return 2;
    }
    try {
        error_vs_time::gate_options options;
        if (with_smallest) { options.smallest = percentage(arguments[4]); }
        return compare(read(arguments[1]), read(arguments[2]), options);
    } catch (const std::exception& error) {
        std::cerr << "compare_reports: " << error.what() << '\n';
        return 2;
    }
}
