#include "coppice/extract/stem/stem_form.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/skeleton/branches.h"
#include "coppice/skeleton/measure.h"
#include "extract/cloud_support.h"

namespace coppice {
namespace {

/// Returns a stem of 8 m that leans by 0.1 and tapers from 0.15 to 0.05 m, with a lateral every metre.
PointSet leaning_stem(double noise = 0.004, bool half = false) {
    PointSet set;
    strew_cone(set, {0, 0, 0}, {0.8, 0, 8}, 0.15, 0.05, 20000, noise, half, 1);
    for (int i = 0; i < 8; ++i) {
        const double z = i + 0.6, turn = 2.4 * i;
        const Vec3d from{0.1 * z, 0, z};
        strew_cone(set, from, from + Vec3d{std::cos(turn), std::sin(turn), 0.4}, 0.02, 0.01, 300, 0.002,
                   false, static_cast<std::uint64_t>(i) + 2);
    }
    return set;
}

void add_ground(PointSet& set, double slope, double wide = 4) {
    const CounterRandom random(9, 9);
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double x = random.uniform(3 * i, -wide, wide), y = random.uniform(3 * i + 1, -wide, wide);
        set.positions.push_back(Vec3(Vec3d{x, y, slope * x + 0.01 * random.uniform(3 * i + 2)}));
    }
}

// At 1.3 m above the foot the stem has a radius of 0.15 - 0.1 * 1.3 / 8 = 0.13375 m.
constexpr double kBreast = 0.2675;

TEST(StemForm, StemSkeletonHasTheVolumeOfItsCone) {
    PointSet points = leaning_stem();
    points.origin = {500000, 5400000, 300};
    const auto stem = stem_skeleton(stem_form(points));
    ASSERT_TRUE(stem);
    EXPECT_EQ(measure(*stem).tips, 1u);
    // Up to a diameter of 0.15 m it is a cone from 0.15 to 0.075 m in radius, 6 m high with a horizontal
    // offset of 0.6 m.
    const TimberVolume timber = timber_volumes(*stem, list_branches(*stem), 0.15)[0];
    const double length = std::hypot(6, 0.6);
    EXPECT_NEAR(timber.stem_length, length, 0.02 * length);
    const double volume = std::numbers::pi / 3 * length * (0.0225 + 0.01125 + 0.005625);
    EXPECT_NEAR(timber.stem_volume, volume, 0.02 * volume);
    EXPECT_FALSE(stem_skeleton({}));
}

TEST(StemForm, MeasuresDiameterAndHeightOfALeaningStem) {
    const StemForm form = stem_form(leaning_stem());
    EXPECT_FALSE(form.on_ground);
    EXPECT_EQ(form.stems, 1u);
    EXPECT_NEAR(form.height, 8, 0.05);
    EXPECT_NEAR(form.breast.diameter, kBreast, 0.01 * kBreast);
    EXPECT_LT(form.breast.deviation, 0.01 * kBreast);
    EXPECT_GT(form.breast.coverage, 0.9);
    EXPECT_NEAR(form.foot.x, 0, 0.02);
    EXPECT_NEAR(form.foot.z, 0, 0.02);
}

TEST(StemForm, TaperReachesTheTop) {
    const StemForm form = stem_form(leaning_stem());
    ASSERT_GT(form.taper.size(), 25u);
    EXPECT_LT(form.taper.front().height, 0.5);
    EXPECT_GT(form.taper.back().height, 7);
    for (const StemDiameter& d : form.taper) {
        const double z = d.center.z, expected = 2 * (0.15 - 0.1 * z / 8);
        if (z < 0.2 || z > 7.8) continue;
        EXPECT_NEAR(d.diameter, expected, 0.03 * expected) << z;
    }
}

TEST(StemForm, MeasuresHalfAStem) {
    const StemForm form = stem_form(leaning_stem(0.004, true));
    EXPECT_NEAR(form.breast.diameter, kBreast, 0.03 * kBreast);
    EXPECT_LT(form.breast.coverage, 0.6);
}

TEST(StemForm, MeasuresASparseArcOfAStemBesideAGap) {
    // A third of a cylinder, 120 degrees, with 400 points on 4.2 m2, and none from 1.4 to 2.1 m: a slice of
    // 20 cm has 8 points, too few for a circle, one of a metre 40.
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        PointSet points;
        strew_cone(points, {0, 0, 0}, {0, 0, 10}, 0.2, 0.2, 600, 0.01, true, seed);
        std::erase_if(points.positions, [](Vec3 p) { return p.x < 0.1f || (p.z > 1.4f && p.z < 2.1f); });
        const StemForm form = stem_form(points);
        EXPECT_EQ(form.stems, 1u) << seed;
        EXPECT_NEAR(form.breast.diameter, 0.4, 0.04) << seed;
    }
}

TEST(StemForm, MeasuresAboveTheGroundOnASlope) {
    PointSet set = leaning_stem();
    add_ground(set, 0.3);
    const StemForm form = stem_form(set);
    EXPECT_TRUE(form.on_ground);
    EXPECT_NEAR(form.foot.z, 0, 0.05);
    EXPECT_NEAR(form.height, 8, 0.1);
    EXPECT_NEAR(form.breast.diameter, kBreast, 0.01 * kBreast);
}

TEST(StemForm, IsIndependentOfTheOrigin) {
    PointSet set = leaning_stem();
    const StemForm at_home = stem_form(set);
    set.origin = {500'000, 5'200'000, 300};
    const StemForm far = stem_form(set);
    EXPECT_EQ(far.breast.diameter, at_home.breast.diameter);
    EXPECT_NEAR(far.foot.x - at_home.foot.x, 500'000, 1e-6);
    EXPECT_NEAR(far.foot.z - at_home.foot.z, 300, 1e-6);
}

TEST(StemForm, IgnoresOutliers) {
    PointSet set = leaning_stem();
    set.positions.push_back({20, 3, -5});
    set.positions.push_back({-12, 3, 30});
    const StemForm form = stem_form(set);
    EXPECT_NEAR(form.height, 8, 0.05);
    EXPECT_NEAR(form.breast.diameter, kBreast, 0.01 * kBreast);
}

TEST(StemForm, HasNoStemsWithoutAStem) {
    PointSet ball;
    const CounterRandom random(3, 3);
    for (std::uint64_t i = 0; ball.size() < 4000; ++i) {
        const Vec3 p(static_cast<float>(random.uniform(3 * i, -1, 1)),
                     static_cast<float>(random.uniform(3 * i + 1, -1, 1)),
                     static_cast<float>(random.uniform(3 * i + 2, -1, 1)));
        if (length(p) < 1) ball.positions.push_back(p * 2.0f);
    }
    const StemForm form = stem_form(ball);
    EXPECT_EQ(form.stems, 0u);
    EXPECT_EQ(form.breast.diameter, 0);
    EXPECT_THROW(stem_form(PointSet{{{0, 0, 0}, {0, 0, 1}}, {}}), InvalidInput);
}

TEST(StemForm, TaperEndsInsideADenseCrown) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        PointSet set;
        strew_cone(set, {0, 0, 0}, {0, 0, 3}, 0.08, 0.06, 3000, 0.004);
        const CounterRandom random(seed, 3);
        // A ball of leaves about the top of the stem.
        for (std::uint64_t i = 0; i < 60000; ++i) {
            const Vec3d p{random.uniform(3 * i, -1, 1), random.uniform(3 * i + 1, -1, 1),
                          random.uniform(3 * i + 2, -1, 1)};
            if (length(p) < 1) set.positions.push_back(Vec3(Vec3d{0, 0, 4} + 2.0 * p));
        }
        const StemForm form = stem_form(set);
        ASSERT_FALSE(form.taper.empty());
        EXPECT_GT(form.taper.back().height, 2.5) << seed;
        EXPECT_LT(form.taper.back().height, 3.3) << seed;
    }
}

TEST(StemForm, IsBitIdenticalForAnyNumberOfThreads) {
    const PointSet set = leaning_stem();
    const StemForm one = stem_form(set, {.threads = 1, .stop = {}, .progress = {}});
    for (const unsigned threads : {2u, 7u}) {
        const StemForm many = stem_form(set, {.threads = threads, .stop = {}, .progress = {}});
        EXPECT_EQ(many.breast.diameter, one.breast.diameter);
        EXPECT_EQ(many.taper.size(), one.taper.size());
    }
}

TEST(StemForm, OfASkeletonFollowsItsNodes) {
    // The stem has a radius of 0.2 - 0.05 z at height z: 0.135 m at breast height, the mean from 1.1 to 1.5
    // m.
    const Skeleton s({NodeId(), NodeId(0), NodeId(1), NodeId(1), NodeId()},
                     {{0, 0, 10}, {0, 0, 12}, {0, 0, 13}, {1, 0, 12.5}, {5, 5, 0}},
                     {0.2f, 0.1f, 0.05f, 0.04f, 0.1f}, {100, 200, 300});
    const auto forms = stem_forms(s);
    ASSERT_EQ(forms.size(), 2u);
    EXPECT_NEAR(forms[0].breast.diameter, 0.27, 1e-6);
    EXPECT_NEAR(forms[0].height, 3.05, 1e-5);
    EXPECT_EQ(forms[0].stems, 1u);
    EXPECT_EQ(forms[0].taper.size(), 3u);
    EXPECT_NEAR(forms[0].foot.z, 310, 1e-5);
    EXPECT_NEAR(forms[0].breast.center.z, 311.3, 1e-5);
    EXPECT_EQ(forms[1].breast.diameter, 0);  // it ends below breast height
}

TEST(StemForm, OfASkeletonIgnoresButtresses) {
    // At 0.4 m a buttress of 0.2 m radius ends at 0.6 m next to the stem of 0.1 m.
    const Skeleton s({NodeId(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 0.4f}, {0.3f, 0, 0.6f}, {0, 0, 8}}, {0.2f, 0.2f, 0.2f, 0.1f});
    const auto forms = stem_forms(s);
    ASSERT_EQ(forms.size(), 1u);
    EXPECT_NEAR(forms[0].breast.diameter, 0.2, 1e-6);
    EXPECT_NEAR(forms[0].height, 8.1, 1e-5);
}

TEST(StemForm, SlicesOfAPlotHaveDiametersAndNoHeight) {
    PointSet slice;
    slice.origin = {5e5, 5e6, 300};
    // Three stems in a slice of 10 cm, the last with points on one side only, and a bush.
    strew_cone(slice, {0, 0, 0}, {0, 0, 0.1}, 0.1, 0.1, 900, 0.004);
    strew_cone(slice, {2, 1, 0}, {2, 1, 0.1}, 0.2, 0.2, 1500, 0.004, false, 2);
    strew_cone(slice, {4, 0, 0}, {4, 0, 0.1}, 0.15, 0.15, 700, 0.004, true, 3);
    const CounterRandom random(4, 4);
    for (std::uint64_t i = 0; i < 300; ++i)
        slice.positions.push_back(Vec3(Vec3d{random.uniform(3 * i, 5, 6), random.uniform(3 * i + 1, 0, 1),
                                             random.uniform(3 * i + 2, 0, 0.1)}));
    const std::vector<StemForm> found = slice_forms(slice);
    ASSERT_EQ(found.size(), 3u);
    constexpr double kDiameters[] = {0.4, 0.3, 0.2};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i].breast.diameter, kDiameters[i], 0.03 * kDiameters[i]);
        EXPECT_EQ(found[i].height, 0);
        EXPECT_FALSE(found[i].on_ground);
    }
    EXPECT_LT(distance(found[0].foot, {5e5 + 2, 5e6 + 1, 300}), 0.01);
    EXPECT_TRUE(slice_forms(leaning_stem()).empty());
    PointSet flat;  // level ground
    for (std::uint64_t i = 0; i < 3000; ++i)
        flat.positions.push_back(Vec3(
            Vec3d{random.uniform(2 * i, 0, 5), random.uniform(2 * i + 1, 0, 5), 0.01 * random.uniform(i)}));
    EXPECT_TRUE(slice_forms(flat).empty());
}

}  // namespace
}  // namespace coppice
