// What including the library costs: user seconds of the compiler, the least of some runs.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/command_line.hpp"

namespace {

constexpr std::string_view usage =
    "usage: compile_time [RUNS]\n"
    "\n"
    "User seconds of the compiler for the whole library and for the smallest program, the least of so many runs (5).\n";

double user_seconds() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    return static_cast<double>(used.ru_utime.tv_sec) + 1e-6 * static_cast<double>(used.ru_utime.tv_usec);
}

double least(const std::string& command, std::size_t runs) {
    double best = 1e9;
    for (std::size_t i = 0; i < runs; ++i) {
        const double before = user_seconds();
        if (std::system(command.c_str()) != 0) { std::exit(1); }
        best = std::min(best, user_seconds() - before);
    }
    return best;
}

int run(command_line::words& asked) {
    std::size_t runs = 5;
    while (asked.next()) {
        if (asked.is_option()) { asked.refuse(); }
        runs = command_line::whole("RUNS", asked.word(), 1, 1000);
    }
    const auto folder = std::filesystem::temp_directory_path();
    const auto write = [&](const char* name, const char* text) {
        std::ofstream{folder / name} << text;
        return (folder / name).string();
    };
    const std::string nothing = write("aglow_nothing.cpp", "");
    const std::string whole = write("aglow_whole.cpp", "#include <aglow/aglow.hpp>\n");
    const std::string compile = AGLOW_COMPILER " -std=c++20 -I" AGLOW_ROOT "/include -c -o /dev/null ";
    std::printf("nothing at -O0          %.2f s\n", least(compile + "-O0 " + nothing, runs));
    std::printf("aglow.hpp at -O0        %.2f s, to stay below 1\n", least(compile + "-O0 " + whole, runs));
    std::printf("minimal.cpp at -O2      %.2f s\n", least(compile + "-O2 " AGLOW_ROOT "/examples/minimal.cpp", runs));
    return 0;
}

}  // namespace

int main(int count, char** arguments) { return command_line::run(count, arguments, usage, run); }
