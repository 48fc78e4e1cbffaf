// Which aglow this is.
#pragma once

#include <compare>

namespace aglow {

/// A release: the first number that differs decides which of two is newer.
struct version_number {
    int major;
    int minor;
    int patch;

    friend constexpr auto operator<=>(const version_number&, const version_number&) = default;
};

/// This release. The build takes its version from this line.
inline constexpr version_number version{.major = 0, .minor = 1, .patch = 0};

}  // namespace aglow
