#include "render/report.hpp"

#include <algorithm>
#include <cstdio>

#include <sys/resource.h>

namespace host {

std::string render_result::grouped(std::uint64_t n) {
    std::string text = std::to_string(n);
    for (std::size_t at = text.size(); at > 3; at -= 3) { text.insert(at - 3, ","); }
    return text;
}

void render_result::add_bytes(std::string name, std::uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f MB", static_cast<double>(bytes) / 1e6);
    facts.push_back({std::move(name), text});
}

void print_table(const render_result& result) {
    double total = 0;
    for (const auto& p : result.phases) { total += p.seconds; }
    std::printf("\n%-24s %14s\n", "phase", "seconds");
    for (const auto& p : result.phases) { std::printf("%-24s %14.2f\n", p.name.c_str(), p.seconds); }
    std::printf("%-24s %14.2f\n\n", "in all", total);
    for (const auto& f : result.facts) { std::printf("%-24s %14s\n", f.name.c_str(), f.value.c_str()); }
    for (const std::string& note : result.notes) { std::printf("%s\n", note.c_str()); }
}

std::uint64_t peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace host
