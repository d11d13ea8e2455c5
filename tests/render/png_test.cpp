#include "coppice/render/png.h"

#include <gtest/gtest.h>
#include <png.h>

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

TEST(Png, RejectsAnImageWithoutPixels) { EXPECT_THROW(encode_png(Image{}), InvalidInput); }

}  // namespace
}  // namespace coppice
