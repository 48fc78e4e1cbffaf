// What a matte scene pays for all that the library could do besides: time and code beside a twin written by hand.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/command_line.hpp"
#include "room.hpp"

namespace {

double seconds(float (*trace)(std::uint64_t), std::uint64_t count, float& seen) {
    const std::clock_t before = std::clock();
    seen = trace(count);
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

/// Bytes of code in an object file, by the system's `size`.
long code_bytes(const std::string& object) {
    std::FILE* size = popen(("size '" + object + "' | tail -n 1").c_str(), "r");
    long bytes = 0;
    if (!size || std::fscanf(size, "%ld", &bytes) != 1) { bytes = 0; }
    if (size) { pclose(size); }
    return bytes;
}

constexpr std::string_view usage =
    "usage: left_out [PAIRS] [LIBRARY.o TWIN.o] [--gate]\n"
    "The time that the library takes on a matte scene over that of a twin written by hand, median of PAIRS (41)\n"
    "side by side, and the same of their code where the objects are named. With --gate it fails where the code is\n"
    "above 1.02; the time is for people to look at.\n";

struct question {
    std::size_t pairs{41};
    std::vector<std::string> objects{};
    bool gate{false};
};

question question_from(command_line::words& asked) {
    question q;
    std::vector<std::string> named;
    while (asked.next()) {
        if (asked.is("--gate")) {
            q.gate = true;
        } else if (asked.is_option()) {
            asked.refuse();
        } else {
            named.push_back(asked.word());
        }
    }
    if (named.size() % 2 == 1) {
        q.pairs = command_line::whole("PAIRS", named.front(), 1, 1'000'000);
        named.erase(named.begin());
    }
    if (named.size() > 2) { throw std::invalid_argument("no more than two objects are compared"); }
    q.objects = named;
    return q;
}

int benchmark(const question& asked) {
    const std::uint64_t paths = asked.pairs < 5 ? 1000 : 100'000;
    std::vector<double> ratios;
    float library = 0;
    float twin = 0;
    for (std::size_t i = 0; i < asked.pairs; ++i) {
        const double a = seconds(by_library, paths, library);
        const double b = seconds(by_twin, paths, twin);
        ratios.push_back(a / b);
    }
    std::sort(ratios.begin(), ratios.end());
    const auto at = [&](double q) {
        return ratios[static_cast<std::size_t>(q * static_cast<double>(ratios.size() - 1))];
    };
    std::printf("light found     library %.9g, twin %.9g\n", static_cast<double>(library), static_cast<double>(twin));
    std::printf("time to twin's  %.3f (quartiles %.3f, %.3f), to stay below 1.03\n", at(0.5), at(0.25), at(0.75));
    bool within = true;
    if (!asked.objects.empty()) {
        const double a = static_cast<double>(code_bytes(asked.objects[0]));
        const double b = static_cast<double>(code_bytes(asked.objects[1]));
        std::printf("code to twin's  %.3f (%g bytes, %g bytes), to stay within 1.02\n", a / b, a, b);
        within = a > 0 && a <= 1.02 * b;
    }
    return std::abs(library - twin) <= 1e-5f * twin && (within || !asked.gate) ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
    return command_line::run(count, arguments, usage,
                             [](command_line::words& asked) { return benchmark(question_from(asked)); });
}
