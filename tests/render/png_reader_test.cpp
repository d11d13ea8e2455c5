#include "coppice/render/png_reader.h"

#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "coppice/render/png.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;

constexpr int kWidth = 7, kHeight = 3;

std::vector<std::uint16_t> make_samples() {
    std::vector<std::uint16_t> out;
    for (int i = 0; i < kWidth * kHeight; ++i) out.push_back(static_cast<std::uint16_t>(3001 * i));
    return out;
}

std::string encode(float low, float high) {
    const std::vector<std::uint16_t> samples = make_samples();
    return encode_png(PngMap{kWidth, kHeight, 1, 16, std::as_bytes(std::span(samples)), low, high});
}

TEST(HeightPng, KeepsSamplesAndScale) {
    const HeightTexture read = decode_height_png(encode(-0.0125f, 0.03f), "a.png");
    EXPECT_EQ(read.width, kWidth);
    EXPECT_EQ(read.height, kHeight);
    EXPECT_EQ(read.heights, make_samples());
    EXPECT_FLOAT_EQ(read.scale, 0.0425f);
}

TEST(HeightPng, HasNoScaleWithoutRange) { EXPECT_EQ(decode_height_png(encode(0, 0), "a.png").scale, 0.0f); }

TEST(HeightPng, RejectsOtherImages) {
    const std::vector<std::uint8_t> grey(12);
    const std::string bytes = encode_png(PngMap{4, 3, 1, 8, std::as_bytes(std::span(grey))});
    EXPECT_EQ(error_of([&] { decode_height_png(bytes, "a.png"); }),
              "a.png: heights need a grey PNG of 16 bits, as coppice texture writes it");
    EXPECT_EQ(error_of([] { decode_height_png("text", "a.png"); }), "a.png: this is not a PNG image");
    EXPECT_EQ(error_of([] { decode_height_png("", "a.png"); }), "a.png: this is not a PNG image");
}

// Every beginning of a file is an error: none crashes, and none is read as complete.
TEST(HeightPng, RejectsTruncatedFiles) {
    const std::string bytes = encode(0, 0.1f);
    for (std::size_t size = 4; size < bytes.size() - 12; ++size) {
        EXPECT_NE(error_of([&] { decode_height_png(bytes.substr(0, size), "a.png"); }), "no error") << size;
    }
}

TEST(HeightPng, RejectsDamagedBytes) {
    const std::string bytes = encode(0, 0.1f);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string damaged = bytes;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
        error_of([&] { decode_height_png(damaged, "a.png"); });  // throws InvalidInput or reads
    }
}

}  // namespace
}  // namespace coppice
