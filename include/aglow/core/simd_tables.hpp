// Which lanes a mask names, as tables: how packs without a compress instruction compress.
#pragma once

#include <array>
#include <cstdint>

namespace aglow::simd {

/// How many bits each byte has.
inline constexpr std::array<std::uint8_t, 256> counts_of_8 = [] {
    std::array<std::uint8_t, 256> table{};
    for (std::uint32_t mask = 1; mask < 256; ++mask) {
        table[mask] = static_cast<std::uint8_t>(table[mask >> 1] + (mask & 1u));
    }
    return table;
}();

/// Byte j of entry m is the j-th lane of the eight-bit mask m.
inline constexpr std::array<std::uint64_t, 256> lanes_of_8 = [] {
    std::array<std::uint64_t, 256> table{};
    for (std::uint32_t mask = 1, lane = 0; mask < 256; ++mask) {
        lane += mask >> (lane + 1);  // the last of the mask
        const std::uint32_t others = mask ^ (1u << lane);
        table[mask] = table[others] | std::uint64_t{lane} << (8 * counts_of_8[others]);
    }
    return table;
}();

/// Every bit of a four-bit mask, twice.
inline constexpr std::array<std::uint8_t, 16> both_halves{0x00, 0x03, 0x0c, 0x0f, 0x30, 0x33, 0x3c, 0x3f,
                                                          0xc0, 0xc3, 0xcc, 0xcf, 0xf0, 0xf3, 0xfc, 0xff};

/// The bytes of four lanes of a register.
struct alignas(16) sixteen_bytes {
    std::uint8_t at[16];
    constexpr std::uint8_t operator[](std::uint32_t i) const { return at[i]; }
};

/// Bytes 4j to 4j+3 of entry m are the bytes of the j-th lane of the four-bit mask m.
inline constexpr std::array<sixteen_bytes, 16> bytes_of_4 = [] {
    std::array<sixteen_bytes, 16> table{};
    for (std::uint32_t mask = 0; mask < 16; ++mask) {
        std::uint32_t n = 0;
        for (std::uint32_t lane = 0; lane < 4; ++lane) {
            if ((mask >> lane & 1u) == 0) { continue; }
            for (std::uint32_t byte = 0; byte < 4; ++byte) {
                table[mask].at[n++] = static_cast<std::uint8_t>(4 * lane + byte);
            }
        }
    }
    return table;
}();

}  // namespace aglow::simd
