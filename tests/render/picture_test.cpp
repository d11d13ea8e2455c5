#include "coppice/render/picture.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

#include "coppice/render/png.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

Image colors(std::uint8_t alpha) {
    Image image(32, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            image.at(x, y) = {static_cast<std::uint8_t>(8 * x), static_cast<std::uint8_t>(16 * y), 100,
                              alpha};
    return image;
}

std::string encode_jpeg(const Image& image) {
    jpeg_compress_struct state{};
    jpeg_error_mgr errors{};
    state.err = jpeg_std_error(&errors);
    jpeg_create_compress(&state);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&state, &bytes, &size);
    state.image_width = static_cast<JDIMENSION>(image.width);
    state.image_height = static_cast<JDIMENSION>(image.height);
    state.input_components = 3;
    state.in_color_space = JCS_RGB;
    jpeg_set_defaults(&state);
    jpeg_set_quality(&state, 95, TRUE);
    jpeg_start_compress(&state, TRUE);
    for (int y = 0; y < image.height; ++y) {
        std::vector<unsigned char> row;
        for (int x = 0; x < image.width; ++x)
            row.insert(row.end(), image.at(x, y).begin(), image.at(x, y).begin() + 3);
        JSAMPROW start = row.data();
        jpeg_write_scanlines(&state, &start, 1);
    }
    jpeg_finish_compress(&state);
    jpeg_destroy_compress(&state);
    std::string out(reinterpret_cast<const char*>(bytes), size);
    std::free(bytes);
    return out;
}

TEST(Picture, PngRoundTrips) {
    EXPECT_EQ(decode_picture(encode_png(colors(255)), "a.png"), colors(255));
    EXPECT_EQ(decode_picture(encode_png(colors(90)), "a.png"), colors(90));
}

TEST(Picture, JpegIsReadApproximately) {
    const Image image = decode_picture(encode_jpeg(colors(255)), "a.jpg");
    ASSERT_EQ(image.width, 32);
    ASSERT_EQ(image.height, 16);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(image.pixels[i][c], colors(255).pixels[i][c], 16);
}

TEST(Picture, RejectsOtherFormatsAndDamagedFiles) {
    EXPECT_EQ(error_of([] { decode_picture("GIF89a", "a.gif"); }),
              "a.gif: this is neither a PNG nor a JPEG image");
    const std::string png = encode_png(colors(255)), jpeg = encode_jpeg(colors(255));
    EXPECT_EQ(error_of([&] { decode_picture(png.substr(0, 60), "a.png"); }).substr(0, 28),
              "a.png: this PNG is damaged: ");
    EXPECT_EQ(error_of([&] { decode_picture(jpeg.substr(0, 20), "a.jpg"); }).substr(0, 29),
              "a.jpg: this JPEG is damaged: ");
}

TEST(Picture, OverlayBlendsTheDrawingOverTheImage) {
    Image below(2, 1), above(2, 1);
    below.pixels = {{100, 100, 100, 255}, {100, 100, 100, 255}};
    above.pixels = {{200, 0, 100, 255}, {200, 0, 100, 0}};
    EXPECT_EQ(overlay(below, above, 0.5f).pixels[0], (Image::Pixel{150, 50, 100, 255}));
    EXPECT_EQ(overlay(below, above, 0.5f).pixels[1], below.pixels[1]);
    EXPECT_EQ(error_of([&] { overlay(below, Image(1, 1), 1); }),
              "a drawing of 1 x 1 pixels cannot be placed over an image of 2 x 1");
}

}  // namespace
}  // namespace coppice
