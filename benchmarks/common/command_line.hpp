// What a benchmark is asked for, word by word, and how it says that it was asked wrongly.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace command_line {

/// `text` as a whole number in [least, most]; throws in the name of `what` if it is none.
inline std::size_t whole(std::string_view what, std::string_view text, std::size_t least, std::size_t most) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number < least || number > most) {
        throw std::invalid_argument(std::string{what} + " wants a whole number from " + std::to_string(least) + " to " +
                                    std::to_string(most) + ", not \"" + std::string{text} + '"');
    }
    return number;
}

/// The words after a program's name, one after the other. What the program does not know it refuses.
class words {
public:
    explicit words(std::vector<std::string> all) : all_{std::move(all)} {}

    /// Goes on to the next word; false at the end.
    [[nodiscard]] bool next() { return ++at_ <= all_.size(); }
    [[nodiscard]] const std::string& word() const { return all_[at_ - 1]; }
    [[nodiscard]] bool is(std::string_view name) const { return word() == name; }
    [[nodiscard]] bool is_option() const { return word().starts_with('-'); }

    /// The word after this one, which is its value.
    [[nodiscard]] const std::string& value() {
        const std::string option = word();
        if (!next()) { throw std::invalid_argument(option + " wants a value"); }
        return word();
    }
    [[nodiscard]] std::size_t number(std::size_t least, std::size_t most) {
        const std::string option = word();
        return whole(option, value(), least, most);
    }

    [[noreturn]] void refuse() const {
        throw std::invalid_argument((is_option() ? "no option " : "no use for ") + word() +
                                    "; --help tells of those there are");
    }

private:
    std::vector<std::string> all_;
    std::size_t at_{0};  // one more than the present word's number
};

/// The program whose `body` takes its words and returns its exit status: `usage` and 0 where help is asked for, one
/// line about what went wrong and 2 where an exception ends it.
template <typename Body>
int run(int count, char** arguments, std::string_view usage, const Body& body) {
    const std::vector<std::string> all(arguments + 1, arguments + count);
    for (const std::string& word : all) {
        if (word == "--help" || word == "-h") {
            std::fwrite(usage.data(), 1, usage.size(), stdout);
            return 0;
        }
    }
    try {
        words asked{all};
        return body(asked);
    } catch (const std::exception& trouble) {
        const std::string name = std::filesystem::path{arguments[0]}.filename().string();
        std::fprintf(stderr, "%s: %s\n", name.c_str(), trouble.what());
        return 2;
    }
}

}  // namespace command_line
