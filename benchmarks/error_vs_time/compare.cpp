// Compares two reports of error_vs_time: exit status 1 where the second is significantly worse.
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>

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

}  // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        std::cerr << "usage: compare_reports BEFORE.json AFTER.json\n";
        return 2;
    }
    try {
        const auto found = error_vs_time::differences(read(arguments[1]), read(arguments[2]));
        if (found.empty()) {
            throw std::runtime_error("the reports share no scene, method and step with two equal seeds");
        }
        std::cout << error_vs_time::told(found);
        return error_vs_time::worse(found) ? 1 : 0;
    } catch (const std::exception& error) {
        std::cerr << error.what() << '\n';
        return 2;
    }
}
