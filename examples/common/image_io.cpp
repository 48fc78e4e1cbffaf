#include "common/image_io.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <stdexcept>
#include <system_error>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#ifdef AGLOW_EXAMPLES_PNG
#include <png.h>
#endif

namespace host {
namespace {

constexpr const char* bands[3] = {"R", "G", "B"};

std::string channel(const std::string& layer, int band) {
    return layer.empty() ? bands[band] : layer + "." + bands[band];
}

/// One band as OpenEXR sees it. It writes through the same type that it reads from, hence no const.
Imf::Slice slice(char* pixels, std::size_t width, int band) {
    constexpr std::size_t step = sizeof(aglow::vec3<float>);
    return {Imf::FLOAT, pixels + sizeof(float) * static_cast<std::size_t>(band), step, step * width};
}

/// The numbers of a picture, each to the nearest half.
std::vector<half> halved(const picture& image) {
    std::vector<half> made;
    made.reserve(3 * image.pixels.size());
    for (const aglow::vec3<float>& p : image.pixels) { made.insert(made.end(), {half(p.x), half(p.y), half(p.z)}); }
    return made;
}

Imf::Slice half_slice(std::vector<half>& numbers, std::size_t width, int band) {
    constexpr std::size_t step = 3 * sizeof(half);
    return {Imf::HALF, reinterpret_cast<char*>(numbers.data() + band), step, step * width};
}

/// Lets `write` make a file beside `file`, then puts it in place; nothing is left behind where it throws.
void replace_whole(const std::filesystem::path& file, const std::function<void(const std::string&)>& write) {
    const std::filesystem::path partial = file.string() + ".part";
    try {
        write(partial.string());
        std::filesystem::rename(partial, file);
    } catch (const std::exception& e) {
        std::error_code ignored;
        std::filesystem::remove(partial, ignored);
        throw std::runtime_error("cannot write " + file.string() + ": " + e.what());
    }
}

}  // namespace

void write_exr(const std::filesystem::path& file, const std::vector<layer>& layers, precision kept) {
    if (layers.empty()) { throw std::runtime_error("cannot write " + file.string() + ": no picture"); }
    const std::size_t width = layers.front().image.width;
    const std::size_t height = layers.front().image.height;
    Imf::Header header{static_cast<int>(width), static_cast<int>(height)};
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    std::vector<std::vector<half>> halves;
    halves.reserve(layers.size());
    for (const layer& l : layers) {
        if (l.image.width != width || l.image.height != height) {
            throw std::runtime_error("cannot write " + file.string() + ": layer " + l.name + " has another size");
        }
        char* pixels = const_cast<char*>(reinterpret_cast<const char*>(l.image.pixels.data()));
        if (kept == precision::half) { halves.push_back(halved(l.image)); }
        for (int band = 0; band < 3; ++band) {
            const std::string name = channel(l.name, band);
            const bool single = kept == precision::single;
            header.channels().insert(name, Imf::Channel{single ? Imf::FLOAT : Imf::HALF});
            frame.insert(name, single ? slice(pixels, width, band) : half_slice(halves.back(), width, band));
        }
    }
    replace_whole(file, [&](const std::string& partial) {
        {
            Imf::OutputFile out{partial.c_str(), header};
            out.setFrameBuffer(frame);
            out.writePixels(static_cast<int>(height));
        }
        // The last bytes are written when `out` goes, which cannot complain.
        if (!Imf::InputFile{partial.c_str()}.isComplete()) { throw std::runtime_error("it was cut off; a full disk?"); }
    });
}

picture read_exr(const std::filesystem::path& file, const std::string& name) {
    try {
        Imf::InputFile in{file.string().c_str()};
        const auto window = in.header().dataWindow();
        picture image{static_cast<std::size_t>(window.max.x - window.min.x + 1),
                      static_cast<std::size_t>(window.max.y - window.min.y + 1)};
        // Where the pixel (0, 0) would be, which OpenEXR counts from.
        const auto shift = (window.min.y * static_cast<std::ptrdiff_t>(image.width) + window.min.x) *
                           static_cast<std::ptrdiff_t>(sizeof(aglow::vec3<float>));
        char* origin = reinterpret_cast<char*>(image.pixels.data()) - shift;
        Imf::FrameBuffer frame;
        for (int band = 0; band < 3; ++band) {
            const std::string wanted = channel(name, band);
            if (!in.header().channels().findChannel(wanted)) { throw std::runtime_error("no channel " + wanted); }
            frame.insert(wanted, slice(origin, image.width, band));
        }
        in.setFrameBuffer(frame);
        in.readPixels(window.min.y, window.max.y);
        return image;
    } catch (const std::exception& e) { throw std::runtime_error("cannot read " + file.string() + ": " + e.what()); }
}

#ifdef AGLOW_EXAMPLES_PNG

bool has_png() { return true; }

namespace {

/// IEC 61966-2-1, rounded to 8 bits; NaN is black.
std::uint8_t srgb(float linear) {
    const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;
    const float y = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(y * 255));
}

}  // namespace

void write_png(const std::filesystem::path& file, const picture& image, float exposure) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(image.pixels.size() * 3);
    for (const aglow::vec3<float>& p : image.pixels) {
        for (int band = 0; band < 3; ++band) { bytes.push_back(srgb(p[band] * exposure)); }
    }
    replace_whole(file, [&](const std::string& partial) {
        png_image out{};
        out.version = PNG_IMAGE_VERSION;
        out.width = static_cast<png_uint_32>(image.width);
        out.height = static_cast<png_uint_32>(image.height);
        out.format = PNG_FORMAT_RGB;
        if (!png_image_write_to_file(&out, partial.c_str(), 0, bytes.data(), 0, nullptr)) {
            throw std::runtime_error(out.message);
        }
    });
}

namespace {

/// What `srgb` makes of light, back again.
float linear(std::uint8_t code) {
    const float y = static_cast<float>(code) / 255;
    return y <= 0.04045f ? y / 12.92f : std::pow((y + 0.055f) / 1.055f, 2.4f);
}

/// The pixels of a PNG whose head was read. Frees what libpng holds.
picture decoded(png_image& in, bool begun, const std::string& name) {
    std::vector<std::uint8_t> bytes;
    if (begun) {
        in.format = PNG_FORMAT_RGB;
        bytes.resize(PNG_IMAGE_SIZE(in));
        begun = png_image_finish_read(&in, nullptr, bytes.data(), 0, nullptr) != 0;
    }
    const std::string why = in.message;
    png_image_free(&in);
    if (!begun) { throw std::runtime_error("cannot read " + name + ": " + why); }
    picture image{in.width, in.height};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = {linear(bytes[3 * i]), linear(bytes[3 * i + 1]), linear(bytes[3 * i + 2])};
    }
    return image;
}

}  // namespace

picture read_png(const std::filesystem::path& file) {
    png_image in{};
    in.version = PNG_IMAGE_VERSION;
    const bool begun = png_image_begin_read_from_file(&in, file.c_str()) != 0;
    return decoded(in, begun, file.string());
}

picture read_png(std::span<const unsigned char> bytes, const std::string& name) {
    png_image in{};
    in.version = PNG_IMAGE_VERSION;
    const bool begun = png_image_begin_read_from_memory(&in, bytes.data(), bytes.size()) != 0;
    return decoded(in, begun, name);
}

#else

bool has_png() { return false; }

picture read_png(const std::filesystem::path& file) {
    throw std::runtime_error("cannot read " + file.string() + ": built without libpng");
}

picture read_png(std::span<const unsigned char>, const std::string& name) {
    throw std::runtime_error("cannot read " + name + ": built without libpng");
}

void write_png(const std::filesystem::path& file, const picture&, float) {
    throw std::runtime_error("cannot write " + file.string() + ": built without libpng");
}

#endif

}  // namespace host
