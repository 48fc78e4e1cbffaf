#include "error_vs_time/json.hpp"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include <aglow/core/numbers.hpp>

namespace error_vs_time {

namespace {

std::string quoted(const std::string& text) {
    static constexpr char digits[] = "0123456789abcdef";
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out += {'\\', c};
        } else if (c == '\n') {
            out += "\\n";
        } else if (code < 0x20) {
            out += std::string{"\\u00"} + digits[code >> 4] + digits[code & 15];
        } else {
            out += c;
        }
    }
    return out + '"';
}

std::string written(double number) {
    if (!aglow::is_finite(number)) { return "null"; }
    char digits[64];
    return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

/// Reads one value after the other from a text.
class reader {
public:
    explicit reader(std::string_view text) : text_{text} {}

    json whole() {
        json value = next(0);
        skip_space();
        if (at_ != text_.size()) { fail(); }
        return value;
    }

private:
    static constexpr int deepest = 64;

    [[noreturn]] void fail() const { throw std::runtime_error("not JSON at byte " + std::to_string(at_)); }

    void skip_space() {
        while (at_ < text_.size() && std::string_view{" \t\r\n"}.find(text_[at_]) != std::string_view::npos) { ++at_; }
    }

    bool take(std::string_view word) {
        skip_space();
        if (text_.substr(at_, word.size()) != word) { return false; }
        at_ += word.size();
        return true;
    }

    void expect(std::string_view word) {
        if (!take(word)) { fail(); }
    }

    json next(int depth) {
        if (depth > deepest) { fail(); }
        if (take("null")) { return {}; }
        if (take("true")) { return true; }
        if (take("false")) { return false; }
        if (take("[")) { return elements(depth); }
        if (take("{")) { return members(depth); }
        if (take("\"")) { return string(); }
        return number();
    }

    json elements(int depth) {
        json::list all;
        if (take("]")) { return all; }
        do { all.push_back(next(depth + 1)); } while (take(","));
        expect("]");
        return all;
    }

    json members(int depth) {
        json::object all;
        if (take("}")) { return all; }
        do {
            expect("\"");
            std::string name = string();
            expect(":");
            all.emplace_back(std::move(name), next(depth + 1));
        } while (take(","));
        expect("}");
        return all;
    }

    std::string string() {
        std::string out;
        while (at_ < text_.size() && text_[at_] != '"') {
            if (text_[at_] == '\\') {
                ++at_;
                out += escaped();
            } else {
                out += text_[at_++];
            }
        }
        expect("\"");
        return out;
    }

    char escaped() {
        if (at_ >= text_.size()) { fail(); }
        const char c = text_[at_++];
        switch (c) {
            case 'n': return '\n';
            case 't': return '\t';
            case 'r': return '\r';
            case 'u': return control();
            case '"':
            case '\\':
            case '/': return c;
            default: fail();
        }
    }

    /// Only what `dump` writes: control characters.
    char control() {
        unsigned code = 0;
        const auto [end, error] =
            std::from_chars(text_.data() + at_, text_.data() + std::min(at_ + 4, text_.size()), code, 16);
        if (error != std::errc{} || end != text_.data() + at_ + 4 || code > 0x7f) { fail(); }
        at_ += 4;
        return static_cast<char>(code);
    }

    json number() {
        double value = 0;
        const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
        if (error != std::errc{}) { fail(); }
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }

    std::string_view text_;
    std::size_t at_{0};
};

}  // namespace

const json& json::operator[](std::string_view name) const {
    static const json nothing;
    for (const auto& [key, value] : members()) {
        if (key == name) { return value; }
    }
    return nothing;
}

double json::number(double otherwise) const {
    const double* value = std::get_if<double>(&value_);
    return value ? *value : otherwise;
}

const std::string& json::text() const {
    static const std::string nothing;
    const std::string* value = std::get_if<std::string>(&value_);
    return value ? *value : nothing;
}

const json::list& json::elements() const {
    static const list nothing;
    const list* value = std::get_if<list>(&value_);
    return value ? *value : nothing;
}

const json::object& json::members() const {
    static const object nothing;
    const object* value = std::get_if<object>(&value_);
    return value ? *value : nothing;
}

std::string json::dump(std::size_t level) const {
    const std::string inner = '\n' + std::string(2 * level + 2, ' ');
    const std::string outer = '\n' + std::string(2 * level, ' ');
    std::string out;
    if (const double* value = std::get_if<double>(&value_)) { return written(*value); }
    if (const bool* value = std::get_if<bool>(&value_)) { return *value ? "true" : "false"; }
    if (std::holds_alternative<std::string>(value_)) { return quoted(text()); }
    if (std::holds_alternative<std::nullptr_t>(value_)) { return "null"; }
    if (std::holds_alternative<list>(value_)) {
        for (const json& e : elements()) { out += (out.empty() ? inner : ',' + inner) + e.dump(level + 1); }
        return '[' + out + (out.empty() ? "" : outer) + ']';
    }
    for (const auto& [name, value] : members()) {
        out += (out.empty() ? inner : ',' + inner) + quoted(name) + ": " + value.dump(level + 1);
    }
    return '{' + out + (out.empty() ? "" : outer) + '}';
}

json parse_json(std::string_view text) { return reader{text}.whole(); }

}  // namespace error_vs_time
