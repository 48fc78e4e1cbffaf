// A short sum that tells one thing from another.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace error_vs_time {

/// FNV-1a over bytes.
class fingerprint {
public:
    void add(unsigned char byte) { sum_ = (sum_ ^ byte) * 0x100000001b3u; }

    /// 16 hexadecimal digits.
    [[nodiscard]] std::string digits() const {
        char text[20];
        std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(sum_));
        return text;
    }

private:
    std::uint64_t sum_{0xcbf29ce484222325u};
};

}  // namespace error_vs_time
