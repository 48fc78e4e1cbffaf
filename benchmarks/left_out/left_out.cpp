// What a matte scene pays for all that the library could do besides: time and code beside a twin written by hand.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "room.hpp"

namespace {

double seconds(float (*trace)(std::uint64_t), std::uint64_t count, float& seen) {
    const std::clock_t before = std::clock();
    seen = trace(count);
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
}

/// Bytes of code in an object file, by the system's `size`.
long code_bytes(const char* object) {
    std::FILE* size = popen(("size " + std::string{object} + " | tail -n 1").c_str(), "r");
    long bytes = 0;
    if (!size || std::fscanf(size, "%ld", &bytes) != 1) { bytes = 0; }
    if (size) { pclose(size); }
    return bytes;
}

}  // namespace

int main(int count, char** arguments) {
    const int pairs = count > 1 ? std::max(1, std::atoi(arguments[1])) : 41;
    const std::uint64_t paths = pairs < 5 ? 1000 : 100'000;
    std::vector<double> ratios;
    float library = 0;
    float twin = 0;
    for (int i = 0; i < pairs; ++i) {
        const double a = seconds(by_library, paths, library);
        const double b = seconds(by_twin, paths, twin);
        ratios.push_back(a / b);
    }
    std::sort(ratios.begin(), ratios.end());
    const auto at = [&](double q) { return ratios[static_cast<std::size_t>(q * static_cast<double>(pairs - 1))]; };
    std::printf("light found     library %.9g, twin %.9g\n", static_cast<double>(library), static_cast<double>(twin));
    std::printf("time to twin's  %.3f (quartiles %.3f, %.3f), to stay below 1.03\n", at(0.5), at(0.25), at(0.75));
    bool within = true;
    if (count > 3) {
        const double a = static_cast<double>(code_bytes(arguments[2]));
        const double b = static_cast<double>(code_bytes(arguments[3]));
        std::printf("code to twin's  %.3f (%g bytes, %g bytes), to stay within 1.02\n", a / b, a, b);
        within = a > 0 && a <= 1.02 * b;
    }
    const bool gate = count > 4 && std::strcmp(arguments[4], "gate") == 0;
    return std::abs(library - twin) <= 1e-5f * twin && (within || !gate) ? 0 : 1;
}
