#include "coppice/render/png.h"
#include "coppice/render/png_reader.h"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <string>
#include <vector>

#include "coppice/base/error.h"

namespace coppice {
namespace {

Image decode(const std::string& bytes) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) << header.message;
    header.format = PNG_FORMAT_RGBA;
    Image image(static_cast<int>(header.width), static_cast<int>(header.height));
    EXPECT_TRUE(png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr)) << header.message;
    return image;
}

Image ramp(std::uint8_t alpha) {
    Image image(5, 3);
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 5; ++x) {
            image.at(x, y) = {static_cast<std::uint8_t>(50 * x), static_cast<std::uint8_t>(100 * y), 7,
                              alpha};
        }
    }
    return image;
}

TEST(Png, OpaqueImagesRoundTrip) { EXPECT_EQ(decode(encode_png(ramp(255))), ramp(255)); }

TEST(Png, TransparentImagesRoundTrip) { EXPECT_EQ(decode(encode_png(ramp(128))), ramp(128)); }

TEST(Png, OpaqueImagesHaveNoAlphaChannel) {
    constexpr std::size_t kColorType = 25;  // 8 signature, 8 chunk head, 8 size, 1 depth
    EXPECT_EQ(encode_png(ramp(255))[kColorType], PNG_COLOR_TYPE_RGB);
    EXPECT_EQ(encode_png(ramp(0))[kColorType], PNG_COLOR_TYPE_RGB_ALPHA);
}

TEST(Png, MapsOf16BitsRoundTrip) {
    constexpr int kWidth = 7, kHeight = 3;
    std::vector<std::uint16_t> samples;
    for (int i = 0; i < kWidth * kHeight; ++i) samples.push_back(static_cast<std::uint16_t>(3001 * i));
    const std::string bytes = encode_png(PngMap{kWidth, kHeight, 1, 16, std::as_bytes(std::span(samples))});
    constexpr std::size_t kDepth = 24;  // 8 signature, 8 chunk head, 8 size
    EXPECT_EQ(bytes[kDepth], 16);
    EXPECT_EQ(bytes[kDepth + 1], PNG_COLOR_TYPE_GRAY);
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size()));
    // The high bytes survive a conversion to 8 bits of a linear format; all 16 bits are in the linear one.
    header.format = PNG_FORMAT_LINEAR_Y;
    header.flags = PNG_IMAGE_FLAG_16BIT_sRGB;  // no gamma: the file has no colour space
    std::vector<std::uint16_t> read(samples.size());
    ASSERT_TRUE(png_image_finish_read(&header, nullptr, read.data(), 0, nullptr)) << header.message;
    EXPECT_EQ(read.front(), samples.front());
    EXPECT_TRUE(std::ranges::is_sorted(read));
    EXPECT_EQ(encode_png(PngMap{kWidth, kHeight, 1, 16, std::as_bytes(std::span(samples))}), bytes);
}

TEST(Png, MapsOfThreeChannelsRoundTrip) {
    const Image image = ramp(255);
    std::vector<std::uint8_t> samples;
    for (const auto& p : image.pixels) samples.insert(samples.end(), p.begin(), p.begin() + 3);
    EXPECT_EQ(decode(encode_png(PngMap{5, 3, 3, 8, std::as_bytes(std::span(samples))})), image);
}

TEST(Png, RejectsMapsOfAnotherSize) {
    const std::vector<std::uint8_t> samples(12);
    const auto bytes = std::as_bytes(std::span(samples));
    EXPECT_THROW(encode_png(PngMap{4, 4, 1, 8, bytes}), InvalidInput);
    EXPECT_THROW(encode_png(PngMap{0, 4, 1, 8, bytes}), InvalidInput);
    EXPECT_THROW(encode_png(PngMap{6, 1, 2, 8, bytes}), InvalidInput);
    EXPECT_THROW(encode_png(PngMap{4, 3, 1, 4, bytes}), InvalidInput);
}

std::string encode_tile(float width, float height) {
    const std::vector<std::uint8_t> samples(12);
    return encode_png(PngMap{.width = 4,
                             .height = 3,
                             .samples = std::as_bytes(std::span(samples)),
                             .tile_width = width,
                             .tile_height = height});
}

TEST(Png, StatesTheExtentOfATile) {
    const auto size = read_tile_size(encode_tile(0.5f, 1.25f));
    ASSERT_TRUE(size);
    EXPECT_FLOAT_EQ(size->width, 0.5f);
    EXPECT_FLOAT_EQ(size->height, 1.25f);
    EXPECT_FALSE(read_tile_size(encode_tile(0, 0)));
    EXPECT_FALSE(read_tile_size(encode_tile(1e-6f, 1e-6f)));
    EXPECT_FALSE(read_tile_size("\xff\xd8"));
}

TEST(Png, IgnoresDamagedExtents) {
    const std::string whole = encode_tile(0.5f, 1.25f);
    const std::size_t chunk = whole.find("sCAL"), data = whole.find("IDAT");
    ASSERT_NE(chunk, std::string::npos);
    for (std::size_t size = 0; size < chunk; ++size) EXPECT_FALSE(read_tile_size(whole.substr(0, size)));
    std::string radians = whole, text = whole, longer = whole;
    radians[chunk + 4] = 2;
    text[chunk + 5] = 'x';
    longer[chunk - 4] = '\x7f';
    for (const std::string& damaged : {radians, text, longer}) EXPECT_FALSE(read_tile_size(damaged));
    EXPECT_TRUE(read_tile_size(whole.substr(0, data)));
}

TEST(Png, RejectsAnImageWithoutPixels) { EXPECT_THROW(encode_png(Image{}), InvalidInput); }

}  // namespace
}  // namespace coppice
