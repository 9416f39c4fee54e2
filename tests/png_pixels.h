#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tristim::test {

/// 8-bit RGB of a PNG file.
struct Pixels {
    int width = 0, height = 0;
    std::vector<std::array<int, 3>> rgb; ///< rows from the top

    int count(const std::array<int, 3>& colour) const {
        return static_cast<int>(std::count(rgb.begin(), rgb.end(), colour));
    }
};

inline Pixels read_png(const std::string& path) {
    Pixels pixels;
    const auto file = OIIO::ImageInput::open(path);
    if (!file) {
        ADD_FAILURE() << "no image: " << OIIO::geterror();
        return pixels;
    }
    const OIIO::ImageSpec& spec = file->spec();
    pixels.width = spec.width;
    pixels.height = spec.height;
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                                    channels);
    EXPECT_GE(channels, 3U);
    EXPECT_TRUE(file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, bytes.data()));
    for (std::size_t i = 0; i + 2 < bytes.size(); i += channels)
        pixels.rgb.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
    return pixels;
}

} // namespace tristim::test
