#include "coppice/texture/picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "errors.h"

namespace coppice {
namespace {

BarkMaps flat_maps(BarkMaps::Texel color) {
    BarkMaps m{.width = 2, .height = 2, .low = 0, .high = 0, .tile_width = 0.5f, .tile_height = 0.5f};
    m.color.assign(4, color);
    m.normal.assign(4, {128, 128, 255});
    m.roughness.assign(4, 200);
    m.occlusion.assign(4, 255);
    m.heights.assign(4, 0);
    return m;
}

BarkMaps::Texel pixel(const BarkPicture& p, double x, double y) {
    const auto column = static_cast<std::size_t>(x * p.width), row = static_cast<std::size_t>(y * p.height);
    return p.pixels[row * static_cast<std::size_t>(p.width) + column];
}

TEST(BarkPicture, ShowsABallAndAStem) {
    const BarkPicture p = draw_bark(flat_maps({200, 30, 30}), 0.5f, 200, 100);
    EXPECT_EQ(p.width, 200);
    EXPECT_EQ(p.pixels.size(), 20000u);
    // The ball has its centre at a quarter of the width, the stem at three quarters; the stem also covers the
    // upper edge, where the ball has ended.
    const auto is_red = [](BarkMaps::Texel t) { return t[0] > 2 * t[1]; };
    EXPECT_TRUE(is_red(pixel(p, 0.25, 0.5)));
    EXPECT_TRUE(is_red(pixel(p, 0.75, 0.5)));
    EXPECT_TRUE(is_red(pixel(p, 0.75, 0.02)));
    EXPECT_FALSE(is_red(pixel(p, 0.25, 0.02)));
    EXPECT_FALSE(is_red(pixel(p, 0.5, 0.5)));
}

TEST(BarkPicture, TheSunShinesFromTheUpperLeft) {
    const BarkPicture p = draw_bark(flat_maps({128, 128, 128}), 0.5f, 200, 100);
    EXPECT_GT(pixel(p, 0.17, 0.35)[1], pixel(p, 0.33, 0.65)[1] + 20);
    EXPECT_GT(pixel(p, 0.6, 0.5)[1], pixel(p, 0.9, 0.5)[1] + 20);
}

TEST(BarkPicture, NormalsTurnTheSurface) {
    BarkMaps up = flat_maps({128, 128, 128}), down = up;
    up.normal.assign(4, {128, 218, 218});  // 45 degrees towards v: green is up
    down.normal.assign(4, {128, 38, 218});
    EXPECT_GT(pixel(draw_bark(up, 0.5f, 200, 100), 0.75, 0.5)[1],
              pixel(draw_bark(down, 0.5f, 200, 100), 0.75, 0.5)[1] + 20);
}

TEST(BarkPicture, TheNumberOfThreadsChangesNoBit) {
    BarkOptions o;
    o.width = o.height = 64;
    const BarkMaps m = make_bark(o);
    EXPECT_EQ(draw_bark(m, 0.6f, 120, 60, {.threads = 1}).pixels,
              draw_bark(m, 0.6f, 120, 60, {.threads = 7}).pixels);
}

TEST(BarkPicture, RejectsInvalidInput) {
    const BarkMaps m = flat_maps({1, 2, 3});
    EXPECT_EQ(test::error_of([&] { draw_bark({}, 1, 100, 100); }),
              "a picture of bark requires maps of at least one texel");
    EXPECT_NE(test::error_of([&] { draw_bark(m, 1, 15, 100); }), "no error");
    EXPECT_NE(test::error_of([&] { draw_bark(m, 0, 100, 100); }), "no error");
    EXPECT_NE(test::error_of([&] { draw_bark(m, std::nanf(""), 100, 100); }), "no error");
}

}  // namespace
}  // namespace coppice
