// Which lanes a mask names, as tables: how packs without a compress instruction compress.
#pragma once

#include <array>
#include <cstdint>

namespace aglow::simd {

/// Byte j of entry m is the j-th lane of the eight-bit mask m.
inline constexpr std::array<std::uint64_t, 256> lanes_of_8 = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint32_t mask = 0; mask < 256; ++mask) {
        for (std::uint64_t lane = 0, n = 0; lane < 8; ++lane) {
            if ((mask >> lane & 1u) != 0) { table[mask] |= lane << (8 * n++); }
        }
    }
    return table;
}();

/// Bytes 4j to 4j+3 of entry m are the bytes of the j-th lane of the four-bit mask m.
inline constexpr std::array<std::array<std::uint8_t, 16>, 16> bytes_of_4 = [] {
    std::array<std::array<std::uint8_t, 16>, 16> table{};
    for (std::uint32_t mask = 0; mask < 16; ++mask) {
        std::uint32_t n = 0;
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            if ((mask >> lane & 1u) == 0) { continue; }
            for (std::uint32_t byte = 0; byte < 4; ++byte) {
                table[mask][n++] = static_cast<std::uint8_t>(4 * lane + byte);
            }
        }
    }
    return table;
}();

}  // namespace aglow::simd
