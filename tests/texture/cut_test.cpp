#include "coppice/texture/cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// A cut of circles: nothing depends on the angle.
CutOptions circles() {
    CutOptions o;
    o.size = 400;
    o.diameter = 0.4f;
    o.ring_width = 0.0188f;  // 10 rings: the wood has a radius of 0.2 * 0.94
    o.rays = o.cracks = o.pores = o.irregularity = o.detail = 0;
    return o;
}

int brightness(const BarkMaps& maps, double radius, double angle) {  // radius in shares
    const double half = maps.width / 2.0;
    const auto x = static_cast<int>(half + half * radius * std::cos(angle));
    const auto y = static_cast<int>(half - half * radius * std::sin(angle));
    const auto& texel = maps.color[static_cast<std::size_t>(y * maps.width + x)];
    return texel[0] + texel[1] + texel[2];
}

TEST(Cut, HasAsManyRingsAsTheRadiusHolds) {
    const BarkMaps maps = make_cut(circles());
    EXPECT_EQ(maps.width, 400);
    EXPECT_EQ(maps.height, 400);
    EXPECT_FLOAT_EQ(maps.tile_width, 0.4f);
    for (const double angle : {0.1, 1.3, 2.9, 4.4}) {
        // The end of a ring is the strongest step from dark late wood to pale early wood.
        int rings = 0;
        for (double r = 0.03; r < 0.93; r += 0.005) {
            const int step = brightness(maps, r + 0.005, angle) - brightness(maps, r, angle);
            const int before = brightness(maps, r, angle) - brightness(maps, r - 0.005, angle);
            rings += step > 40 && before <= 40 ? 1 : 0;
        }
        EXPECT_NEAR(rings, 9, 1) << angle;  // between 10 rings
    }
}

TEST(Cut, DarkBarkSurroundsPaleWood) {
    for (const CutSpecies& species : cut_species()) {
        CutOptions o = species.options;
        o.size = 128;
        o.diameter = 0.2f;
        const BarkMaps maps = make_cut(o);
        double wood = 0, bark = 0;
        for (int k = 0; k < 60; ++k) {
            const double angle = 2 * std::numbers::pi * k / 60;
            wood += brightness(maps, 0.7, angle);
            bark += brightness(maps, 0.99, angle);
        }
        EXPECT_GT(wood, 1.15 * bark) << species.name;
        // The corners continue the bark, so that a rim that is not round has no border.
        EXPECT_LT(brightness(maps, 1.3, std::numbers::pi / 4), wood / 60) << species.name;
        EXPECT_EQ(find_cut(species.name)->ring_width, species.options.ring_width);
    }
    EXPECT_FALSE(find_cut("okk"));
}

TEST(Cut, CracksAreDeepAndDark) {
    CutOptions o = circles();
    const BarkMaps whole = make_cut(o);
    o.cracks = 1;
    const BarkMaps cracked = make_cut(o);
    EXPECT_LT(cracked.low, whole.low - 0.0004f);  // the rim of bark is 1 mm deep
    const auto dark = [](const BarkMaps& maps) {
        int out = 0;
        for (int k = 0; k < 720; ++k)
            out += brightness(maps, 0.8, 2 * std::numbers::pi * k / 720) < 250 ? 1 : 0;
        return out;
    };
    EXPECT_EQ(dark(whole), 0);
    EXPECT_GT(dark(cracked), 2);
}

TEST(Cut, EqualOptionsGiveEqualBits) {
    CutOptions o;
    o.size = 96;
    const BarkMaps one = make_cut(o, {.threads = 1}), three = make_cut(o, {.threads = 3});
    EXPECT_EQ(one.color, three.color);
    EXPECT_EQ(one.normal, three.normal);
    EXPECT_EQ(one.heights, three.heights);
    o.seed = 1;
    EXPECT_NE(make_cut(o).color, one.color);
}

TEST(Cut, SmallAndExtremeOptionsAreAccepted) {
    CutOptions o;
    o.size = 16;
    o.diameter = 0.005f;
    o.ring_width = 0.1f;
    o.bark_share = 0.5f;
    o.irregularity = o.detail = 3;
    o.cracks = 1;
    EXPECT_EQ(make_cut(o).size(), 256u);
    o.diameter = 5;
    o.ring_width = 1e-4f;
    o.ray_spacing = 1e-4f;
    o.bark_share = 0;
    EXPECT_EQ(make_cut(o).size(), 256u);
    o.late_wood = 0.02f;
    o.heartwood = 0;
    EXPECT_EQ(make_cut(o).size(), 256u);
}

TEST(Cut, RejectsInvalidOptions) {
    CutOptions o;
    o.size = 5000;
    EXPECT_THROW(make_cut(o), InvalidInput);
    o.size = 16;
    o.color = Vec3d{1, 2, 0};
    EXPECT_THROW(make_cut(o), InvalidInput);
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(make_cut({}, {.stop = stop.get_token()}), Cancelled);
}

}  // namespace
}  // namespace coppice
