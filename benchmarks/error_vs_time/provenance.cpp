#include "error_vs_time/provenance.hpp"

#include <ctime>
#include <fstream>
#include <iterator>

#include <aglow/core/version.hpp>

#include "error_vs_time/commit.hpp"
#include "error_vs_time/fingerprint.hpp"
#include "error_vs_time/seeds.hpp"

namespace error_vs_time {

namespace {

constexpr const char* when = "begun";
constexpr const char* command = "command";
constexpr const char* load = "load of the machine then";

/// What follows the colon in the first line of a file that begins so.
std::string first_line_of(const char* file, const std::string& start) {
    std::ifstream in{file};
    for (std::string line; std::getline(in, line);) {
        if (line.rfind(start, 0) == 0) { return line.substr(line.find(':') + 2); }
    }
    return "unknown";
}

std::string now() {
    const std::time_t seconds = std::time(nullptr);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", std::gmtime(&seconds));
    return text;
}

/// Mean number of running programs over the last minute, where the system tells.
std::string host_load() {
    std::string minute;
    std::ifstream{"/proc/loadavg"} >> minute;
    return minute.empty() ? "unknown" : minute;
}

/// Tells one build of this program from another: a commit does not, while it is being worked on.
std::string own_fingerprint() {
    std::ifstream own{"/proc/self/exe", std::ios::binary};
    fingerprint sum;
    for (std::istreambuf_iterator<char> at{own}, end; at != end; ++at) { sum.add(static_cast<unsigned char>(*at)); }
    return sum.digits();
}

/// "1001 … 1003; 90001 and 90002 for references that were made here"
std::string told_seeds(std::size_t count) {
    return std::to_string(first_seed) + " … " + std::to_string(first_seed + count - 1) + "; " +
           std::to_string(reference_seeds[0]) + " and " + std::to_string(reference_seeds[1]) +
           " for references that were made here";
}

std::string library() {
    return "aglow " + std::to_string(aglow::version.major) + '.' + std::to_string(aglow::version.minor) + '.' +
           std::to_string(aglow::version.patch);
}

}  // namespace

text_pairs provenance(const options& asked, const std::vector<std::string_view>& words) {
#ifdef __clang__
    const std::string compiler = __VERSION__;
#else
    const std::string compiler = std::string{"GCC "} + __VERSION__;
#endif
    const std::string side = std::to_string(asked.size);
    std::string line = "error_vs_time";
    for (const std::string_view word : words) { line += ' ' + std::string{word}; }
    return {{"library", library()},
            {"commit", commit},
            {"fingerprint of the program", own_fingerprint()},
            {"compiler", compiler},
            {"flags", AGLOW_COMPILED_WITH},
            {"processor", first_line_of("/proc/cpuinfo", "model name")},
            {"threads", "1; 2 or more for references that were made here"},
            {"seeds", told_seeds(asked.seeds)},
            {"size", side + " x " + side},
            {"samples of references made here", "2 x " + std::to_string(asked.reference_samples) + " a pixel"},
            {command, line},
            {when, now()},
            {load, host_load()}};
}

bool same_making(const text_pairs& a, const text_pairs& b) {
    const auto lasting = [](text_pairs pairs) {
        std::erase_if(
            pairs, [](const auto& pair) { return pair.first == when || pair.first == command || pair.first == load; });
        return pairs;
    };
    return lasting(a) == lasting(b);
}

}  // namespace error_vs_time
