// Numbers as people read them: their significant digits, however small or large they are.
#pragma once

#include <charconv>
#include <string>

namespace aglow {

/// `x` with so many significant digits at the most and no zeros behind them, such as "0.1", "2.5e-09" or "nan".
/// Expects 1 to 17 `digits`.
[[nodiscard]] inline std::string significant(double x, int digits = 6) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, digits).ptr};
}

}  // namespace aglow
