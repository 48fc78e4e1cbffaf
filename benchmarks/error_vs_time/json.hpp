// A JSON value: enough to write a report and to read it back.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace error_vs_time {

/// null, true or false, a number, a string, a list, or an object whose members keep their order.
class json {
public:
    using list = std::vector<json>;
    using object = std::vector<std::pair<std::string, json>>;

    json() = default;
    json(bool value) : value_{value} {}
    json(double value) : value_{value} {}
    json(int value) : value_{static_cast<double>(value)} {}
    json(std::size_t value) : value_{static_cast<double>(value)} {}
    json(const char* value) : value_{std::string{value}} {}
    json(std::string value) : value_{std::move(value)} {}
    json(list value) : value_{std::move(value)} {}
    json(object value) : value_{std::move(value)} {}

    /// The member `name`; null where there is none or this is not an object.
    [[nodiscard]] const json& operator[](std::string_view name) const;

    /// The number; `otherwise` where this is not a number (what is not finite is written as null).
    [[nodiscard]] double number(double otherwise = 0) const;

    /// The string; empty where this is not one.
    [[nodiscard]] const std::string& text() const;

    /// The elements; none where this is not a list.
    [[nodiscard]] const list& elements() const;

    /// The members; none where this is not an object.
    [[nodiscard]] const object& members() const;

    /// As text, two spaces of indentation a level; numbers with as many digits as bring back the same number.
    [[nodiscard]] std::string dump(std::size_t level = 0) const;

private:
    std::variant<std::nullptr_t, bool, double, std::string, list, object> value_{nullptr};
};

/// Reads a whole JSON text. Throws `std::runtime_error` that names the byte where it stops making sense.
[[nodiscard]] json parse_json(std::string_view text);

}  // namespace error_vs_time
