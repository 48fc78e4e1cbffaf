// Whose random numbers are whose.
#pragma once

#include <cstddef>
#include <cstdint>

namespace error_vs_time {

/// Pictures have seeds from here on, where no reference has one: path traced with a reference's seed, a picture is part
/// of that reference, and its error comes out too small.
inline constexpr std::uint64_t first_seed = 1001;
inline constexpr std::size_t most_seeds = 1000;

/// Of the two halves that `render --reference` made of each scene, and of those that are made here.
inline constexpr std::uint64_t kept_reference_seeds[]{0, 1};
inline constexpr std::uint64_t reference_seeds[]{90001, 90002};

}  // namespace error_vs_time
