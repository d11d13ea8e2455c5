#include "coppice/render/height_map.h"

#include <gtest/gtest.h>

#include <limits>
#include <stop_token>

#include "coppice/base/error.h"

namespace coppice {
namespace {

int brightness(const Image::Pixel& p) { return p[0] + p[1] + p[2]; }

/// Increases by one from pixel to pixel.
std::vector<double> ramp(int width, int height) {
    std::vector<double> out;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) out.push_back(x);
    return out;
}

TEST(HeightMap, BrightnessIncreasesWithTheValues) {
    const Image image = height_map(ramp(50, 4), 50, {.low = 0, .high = 49});
    EXPECT_EQ(image.height, 4);
    for (int x = 0; x + 1 < 50; ++x)
        EXPECT_LT(brightness(image.at(x, 2)), brightness(image.at(x + 1, 2))) << x;
    EXPECT_EQ(image.at(0, 0), (Image::Pixel{26, 28, 94, 255}));
    EXPECT_EQ(image.at(49, 0), (Image::Pixel{252, 240, 176, 255}));
}

TEST(HeightMap, ValuesBeyondTheRangeHaveTheColourOfItsEnd) {
    const std::vector<double> values{-5, 0, 1, 7, std::numeric_limits<double>::quiet_NaN()};
    const Image image = height_map(values, 5, {});
    EXPECT_EQ(image.at(0, 0), image.at(1, 0));
    EXPECT_EQ(image.at(2, 0), image.at(3, 0));
    EXPECT_EQ(image.at(4, 0), (Image::Pixel{128, 128, 128, 255}));
}

TEST(HeightMap, IsolinesAreAtTheirValues) {
    const Image plain = height_map(ramp(50, 4), 50, {.low = 0, .high = 49});
    const Image lined = height_map(ramp(50, 4), 50, {.low = 0, .high = 49, .isolines = {20.4}});
    for (int x = 0; x < 50; ++x) EXPECT_EQ(plain.at(x, 1) == lined.at(x, 1), x != 20 && x != 21) << x;
    const Image outlined = height_map(ramp(50, 4), 50, {.low = 0, .high = 49, .outlines = {20.4}});
    EXPECT_EQ(outlined.at(20, 1), (Image::Pixel{255, 255, 255, 255}));
    EXPECT_EQ(outlined.at(15, 1), plain.at(15, 1));
    // A step without values in between is a line too.
    const std::vector<double> step{0, 0, 0, 1, 1, 1};
    EXPECT_NE(height_map(step, 6, {.isolines = {0.5}}).at(3, 0), height_map(step, 6, {}).at(3, 0));
}

TEST(HeightMap, IsBitIdenticalForAnyNumberOfThreadsAndStopsWhenCancelled) {
    const HeightMapOptions options{.low = 0, .high = 49, .isolines = {3.3, 20.4}, .outlines = {30}};
    EXPECT_EQ(height_map(ramp(50, 40), 50, options, {.threads = 1}),
              height_map(ramp(50, 40), 50, options, {.threads = 7}));
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW(height_map(ramp(50, 40), 50, options, {.stop = source.get_token()}), Cancelled);
}

TEST(HeightMap, DotsAreWhiteWithARimAndMayExceedTheImage) {
    Image image = height_map(ramp(20, 20), 20, {.low = 0, .high = 100});
    const Image before = image;
    draw_dot(image, 10, 10, 3);
    EXPECT_EQ(image.at(9, 9), (Image::Pixel{255, 255, 255, 255}));
    EXPECT_EQ(image.at(2, 2), before.at(2, 2));
    EXPECT_LT(brightness(image.at(13, 9)), brightness(before.at(13, 9)));
    draw_dot(image, -1, 5, 3);
    draw_dot(image, 500, 500, 3);
    EXPECT_EQ(image.at(0, 5), (Image::Pixel{255, 255, 255, 255}));
}

}  // namespace
}  // namespace coppice
