#include "coppice/render/colors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace coppice {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Colors, BytesRoundTrip) {
    for (int byte = 0; byte < 256; ++byte) {
        const auto b = static_cast<std::uint8_t>(byte);
        EXPECT_EQ(to_srgb(to_linear({b, 0, 255})), (Rgb{b, 0, 255}));
    }
}

TEST(Colors, UsualRangeExcludesTwoPercent) {
    std::vector<float> distances;
    for (int i = 1; i <= 101; ++i) distances.push_back(static_cast<float>(i % 2 == 0 ? i : -i));
    EXPECT_EQ(usual_range(distances), 99);  // number 98 from 0 of 101
    distances.insert(distances.end(), {kNan, std::numeric_limits<float>::infinity()});
    EXPECT_EQ(usual_range(distances), 99);
    EXPECT_GT(usual_range({}), 0);
    EXPECT_GT(usual_range(std::vector<float>(5, 0.0f)), 0);
}

TEST(Colors, InsideIsBlueAndOutsideRedUpToTheRange) {
    const std::vector<float> distances{-2, -0.5f, 0, 0.5f, 2, kNan};
    const std::vector<Rgb> colors = distance_colors(distances, 0.5f);
    EXPECT_EQ(colors[0], colors[1]);
    EXPECT_EQ(colors[3], colors[4]);
    EXPECT_GT(colors[0][2], colors[0][0] + 60);
    EXPECT_GT(colors[4][0], colors[4][2] + 60);
    EXPECT_NEAR(colors[2][0], colors[2][2], 10);
    EXPECT_LT(colors[5][0], colors[2][0] - 40);  // a grey that differs from that of 0
}

}  // namespace
}  // namespace coppice
