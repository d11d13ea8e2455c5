#include "coppice/pipeline/texture/blend_zone_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace coppice::pipeline_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kWraps = 2;
constexpr float kRim = 5;  // v of the rim

// A zone beyond a closed curve of 64 points.
template <class Curve>
BlendZone zone(const Curve& curve) {
    std::vector<TexturePoint> rim;
    for (int i = 0; i <= 64; ++i) rim.push_back(curve(static_cast<float>(i % 64) / 64));
    BlendZone out(kRim, kWraps, kWraps);
    out.set_rim(kRim, rim);
    return out;
}

TexturePoint rectangle(float turns) {
    const float x = 4 * turns - std::floor(4 * turns);  // of the side
    switch (static_cast<int>(4 * turns)) {
        case 0:
            return {2 - 4 * x, 1};
        case 1:
            return {-2, 1 - 2 * x};
        case 2:
            return {4 * x - 2, -1};
        default:
            return {2, 2 * x - 1};
    }
}

// The maximum stretch over the minimum at a place `along` the branch.
float find_stretch(const BlendZone& zone, float turns, float along) {
    const float step = 0.01f;  // [tiles]
    const auto at = [&](float u, float v) { return zone.at({kWraps * turns + u, kRim + along + v}).second; };
    const TexturePoint a = at(-step, 0), b = at(step, 0), c = at(0, -step), d = at(0, step);
    const float xx = b.u - a.u, yx = b.v - a.v, xy = d.u - c.u, yy = d.v - c.v;
    const float det = xx * yy - xy * yx, sum = xx * xx + xy * xy + yx * yx + yy * yy;
    const float max = 0.5f * (sum + std::sqrt(std::max(sum * sum - 4 * det * det, 0.0f)));
    return max / std::abs(det);
}

TEST(BlendZone, BeginsAtTheRim) {
    const BlendZone own = zone(rectangle);
    for (const float turns : {0.0f, 0.25f, 0.46875f, 0.75f}) {
        const TextureBlend at = own.at({kWraps * turns, kRim});
        EXPECT_EQ(at.weight, 1);
        EXPECT_NEAR(at.second.u, rectangle(turns).u, 1e-5f);
        EXPECT_NEAR(at.second.v, rectangle(turns).v, 1e-5f);
    }
    EXPECT_EQ(own.at({0, kRim + kWraps / kPi}).weight, 0);  // two radii
}

TEST(BlendZone, ShrinksACircleWithoutStretchingIt) {
    const BlendZone own = zone([](float turns) {
        return TexturePoint{3 + std::cos(2 * kPi * turns), 7 + std::sin(2 * kPi * turns)};
    });
    // Half a radius, wraps / (4 pi) tiles, beyond the rim: exp(-1/2) of the circle, at a quarter turn.
    const TexturePoint p = own.at({kWraps / 4, kRim + kWraps / (4 * kPi)}).second;
    EXPECT_NEAR(p.u, 3, 1e-4f);
    EXPECT_NEAR(p.v, 7 + std::exp(-0.5f), 1e-4f);
    EXPECT_NEAR(find_stretch(own, 0.3f, 0.2f), 1, 0.01f);
}

TEST(BlendZone, DecreasesTheStretchOfARim) {
    // At the rim, a side of 4 and one of 2 tiles are both a quarter turn, and corners are sheared. Half a
    // radius beyond it, an ellipse with axes of 2 to 1 and a little of its third wave remain.
    const BlendZone own = zone(rectangle);
    for (int i = 0; i < 16; ++i) {
        const float turns = static_cast<float>(i) / 16 + 0.03f;
        EXPECT_LT(find_stretch(own, turns, kWraps / (4 * kPi)), 2.6f) << turns;
    }
}

TEST(BlendZone, LeavesACurveThatDoesNotRunAroundItsMean) {
    const BlendZone own = zone([](float turns) { return TexturePoint{turns, 0}; });
    EXPECT_EQ(own.at({0.5f, kRim}), (TextureBlend{{0.5f, kRim}, 0}));
}

}  // namespace
}  // namespace coppice::pipeline_internal
