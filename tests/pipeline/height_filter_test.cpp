#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/pipeline/texture/height_filter_internal.h"

namespace coppice::pipeline_internal {
namespace {

constexpr int kWidth = 5, kHeight = 3;

/// Returns the height of a pixel, counted from the lower left corner of the tile, which repeats.
int height_of_pixel(int x, int y) {
    const int i = ((x % kWidth) + kWidth) % kWidth, j = ((y % kHeight) + kHeight) % kHeight;
    return 1000 * ((7 * i + 3 * j) % 11) + 50 * j;
}

HeightTexture make_texture() {
    HeightTexture out{kWidth, kHeight, 1, {}};
    for (int row = 0; row < kHeight; ++row) {
        for (int x = 0; x < kWidth; ++x)
            out.heights.push_back(static_cast<std::uint16_t>(height_of_pixel(x, kHeight - 1 - row)));
    }
    return out;
}

TexturePoint in_tiles(double x, double y) {
    return {static_cast<float>(x / kWidth), static_cast<float>(y / kHeight)};
}

TEST(HeightFilter, AveragesWholePixels) {
    const HeightFilter filter(make_texture());
    for (int x = -7; x < 9; ++x) {
        for (int y = -5; y < 6; ++y) {
            for (const int size : {1, 2, 4, 9}) {
                double sum = 0;
                for (int i = 0; i < size; ++i) {
                    for (int j = 0; j < size; ++j) sum += height_of_pixel(x + i, y + j);
                }
                const double mean =
                    filter.mean(in_tiles(x + size / 2.0, y + size / 2.0), in_tiles(size, size));
                ASSERT_NEAR(mean * 65535, sum / (size * size), 0.05) << x << ' ' << y << ' ' << size;
            }
        }
    }
}

// A rectangle between the centres of two pixels covers half of each.
TEST(HeightFilter, InterpolatesBetweenPixels) {
    const HeightFilter filter(make_texture());
    EXPECT_NEAR(filter.mean(in_tiles(2, 1.5), {}) * 65535,
                (height_of_pixel(1, 1) + height_of_pixel(2, 1)) / 2.0, 0.05);
}

TEST(HeightFilter, MeasuresTheTexture) {
    const HeightFilter filter(make_texture());
    double sum = 0, high = 0;
    for (int x = 0; x < kWidth; ++x) {
        for (int y = 0; y < kHeight; ++y) {
            sum += height_of_pixel(x, y);
            high = std::max(high, static_cast<double>(height_of_pixel(x, y)));
        }
    }
    const double mean = sum / (kWidth * kHeight);
    EXPECT_NEAR(filter.mean() * 65535, mean, 1e-6);
    EXPECT_NEAR(filter.amplitude() * 65535, std::max(high - mean, mean), 1e-6);  // the minimum is 0
    EXPECT_NEAR(filter.mean({0.3f, 0.7f}, {1, 1}), filter.mean(), 1e-6);
    EXPECT_NEAR(filter.mean({-41.3f, 25.7f}, {3, 2}), filter.mean(), 1e-6);
}

TEST(HeightFilter, RejectsMissingPixels) {
    EXPECT_THROW(HeightFilter({}), InvalidInput);
    EXPECT_THROW(HeightFilter({2, 2, 1, {1, 2, 3}}), InvalidInput);
    EXPECT_THROW(HeightFilter({-1, -1, 1, {1}}), InvalidInput);
}

}  // namespace
}  // namespace coppice::pipeline_internal
