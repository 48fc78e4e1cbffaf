#include "error_vs_time/png.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <aglow/core/numbers.hpp>

namespace error_vs_time {

namespace {

using bytes = std::vector<std::uint8_t>;

void put_32(bytes& out, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) { out.push_back(static_cast<std::uint8_t>(value >> shift)); }
}

std::uint32_t crc(std::span<const std::uint8_t> data) {
    std::uint32_t sum = 0xffffffffu;
    for (const std::uint8_t byte : data) {
        sum ^= byte;
        for (int bit = 0; bit < 8; ++bit) { sum = (sum >> 1) ^ ((sum & 1u) != 0 ? 0xedb88320u : 0u); }
    }
    return ~sum;
}

std::uint32_t adler(std::span<const std::uint8_t> data) {
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const std::uint8_t byte : data) {
        a = (a + byte) % 65521;
        b = (b + a) % 65521;
    }
    return (b << 16) | a;
}

void put_chunk(bytes& out, std::string_view name, std::span<const std::uint8_t> data) {
    put_32(out, static_cast<std::uint32_t>(data.size()));
    const std::size_t start = out.size();
    for (const char c : name) { out.push_back(static_cast<std::uint8_t>(c)); }
    out.insert(out.end(), data.begin(), data.end());
    put_32(out, crc(std::span{out}.subspan(start)));
}

/// A zlib stream of stored blocks (RFC 1950, RFC 1951 section 3.2.4).
bytes stored(std::span<const std::uint8_t> data) {
    bytes out{0x78, 0x01};
    constexpr std::size_t most = 65535;
    for (std::size_t at = 0; at < data.size(); at += most) {
        const auto size = static_cast<std::uint16_t>(std::min(most, data.size() - at));
        const auto rest = static_cast<std::uint16_t>(~size);
        const bool last = at + most >= data.size();
        out.push_back(last ? 1 : 0);
        for (const std::uint16_t word : {size, rest}) {
            out.push_back(static_cast<std::uint8_t>(word & 0xff));
            out.push_back(static_cast<std::uint8_t>(word >> 8));
        }
        out.insert(out.end(), data.begin() + static_cast<std::ptrdiff_t>(at),
                   data.begin() + static_cast<std::ptrdiff_t>(at + size));
    }
    put_32(out, adler(data));
    return out;
}

constexpr std::array<std::uint8_t, 3> broken_colour{255, 0, 255};

std::uint8_t as_byte(double x) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0, 1.0))); }

double srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

bool whole(std::span<const float> pixel) {
    return std::all_of(pixel.begin(), pixel.end(), [](float x) { return aglow::is_finite(x); });
}

/// Black, violet, red, orange, pale yellow: rising lightness, so that it also reads in gray.
std::array<double, 3> heat(double way) {
    static constexpr std::array<std::array<double, 3>, 5> stops{
        {{0, 0, 0.02}, {0.34, 0.06, 0.43}, {0.73, 0.21, 0.33}, {0.98, 0.56, 0.04}, {0.99, 1, 0.65}}};
    const double place = std::clamp(way, 0.0, 1.0) * (stops.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    std::array<double, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        colour[c] = std::lerp(stops[below][c], stops[below + 1][c], place - static_cast<double>(below));
    }
    return colour;
}

}  // namespace

bytes png(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height) {
    if (width == 0 || height == 0 || rgb.size() != 3 * width * height) {
        throw std::invalid_argument("png: sizes do not fit");
    }
    bytes rows;
    for (std::size_t y = 0; y < height; ++y) {
        rows.push_back(0);  // no filter
        const auto row = rgb.subspan(3 * width * y, 3 * width);
        rows.insert(rows.end(), row.begin(), row.end());
    }
    bytes header;
    put_32(header, static_cast<std::uint32_t>(width));
    put_32(header, static_cast<std::uint32_t>(height));
    header.insert(header.end(), {8, 2, 0, 0, 0});  // 8 bits a channel, RGB
    bytes out{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    put_chunk(out, "IHDR", header);
    put_chunk(out, "IDAT", stored(rows));
    put_chunk(out, "IEND", {});
    return out;
}

std::string base64(std::span<const std::uint8_t> data) {
    static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((data.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < data.size(); i += 3) {
        const std::size_t have = std::min<std::size_t>(3, data.size() - i);
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) { word = (word << 8) | (k < have ? data[i + k] : 0u); }
        for (std::size_t k = 0; k < 4; ++k) { out += k <= have ? letters[(word >> (18 - 6 * k)) & 63u] : '='; }
    }
    return out;
}

std::string png_uri(std::span<const std::uint8_t> rgb, std::size_t width, std::size_t height) {
    return "data:image/png;base64," + base64(png(rgb, width, height));
}

bytes shown(std::span<const float> linear_rgb, double exposure) {
    bytes out;
    out.reserve(linear_rgb.size());
    for (std::size_t i = 0; i + 2 < linear_rgb.size(); i += 3) {
        const auto pixel = linear_rgb.subspan(i, 3);
        for (std::size_t c = 0; c < 3; ++c) {
            const double light = exposure * std::max(0.0, static_cast<double>(pixel[c]));
            out.push_back(whole(pixel) ? as_byte(srgb(light)) : broken_colour[c]);
        }
    }
    return out;
}

bytes shown_error(std::span<const float> image_rgb, std::span<const float> reference_rgb, double floor, double full) {
    if (image_rgb.size() != reference_rgb.size()) { throw std::invalid_argument("shown_error: sizes differ"); }
    const auto gray = [](std::span<const float> p) {
        return (static_cast<double>(p[0]) + static_cast<double>(p[1]) + static_cast<double>(p[2])) / 3;
    };
    bytes out;
    out.reserve(image_rgb.size());
    for (std::size_t i = 0; i + 2 < image_rgb.size(); i += 3) {
        const auto image = image_rgb.subspan(i, 3);
        const auto reference = reference_rgb.subspan(i, 3);
        const bool good = whole(image) && whole(reference);
        const double gap = std::abs(gray(image) - gray(reference)) / (std::abs(gray(reference)) + floor);
        const std::array<double, 3> colour = heat(good ? gap / full : 0);
        for (std::size_t c = 0; c < 3; ++c) { out.push_back(good ? as_byte(colour[c]) : broken_colour[c]); }
    }
    return out;
}

}  // namespace error_vs_time
