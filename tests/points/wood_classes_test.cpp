#include "coppice/points/wood_classes.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Returns a plan of 20 by 20 points of class `ground` on a slope of 1 in 2, and a stem of 300 points of
/// class `stem` above its middle.
PointCloud plot(std::uint8_t ground, std::uint8_t stem) {
    PointCloud out;
    const auto add = [&](Vec3 p, std::uint8_t c) {
        out.points.positions.push_back(p);
        out.classes.push_back(c);
        out.intensities.push_back(p.z);
    };
    for (int i = 0; i < 400; ++i) {
        const auto x = static_cast<float>(i % 20), y = static_cast<float>(i / 20);
        add({x, y, 0.5f * x}, ground);
    }
    for (int i = 0; i < 300; ++i) add({10, 10, 5 + 0.1f * static_cast<float>(i)}, stem);
    return out;
}

std::string error_of(const auto& run) {
    try {
        run();
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "no error";
}

TEST(WoodClasses, ParsesLists) {
    EXPECT_TRUE(parse_wood_classes("auto").automatic);
    EXPECT_TRUE(parse_wood_classes("all").classes.all());
    const WoodClasses some = parse_wood_classes("4,5,20-22,255");
    EXPECT_FALSE(some.automatic);
    EXPECT_EQ(some.classes.count(), 6u);
    for (const std::size_t c : {4u, 5u, 20u, 21u, 22u, 255u}) EXPECT_TRUE(some.classes[c]) << c;
    for (const char* text :
         {"", "4,", ",4", "4;5", "256", "5-4", "4-", "-4", "wood", "4 5", "99999999999999999999"})
        EXPECT_THROW(parse_wood_classes(text), InvalidInput) << text;
}

TEST(WoodClasses, RuleExcludesGround) {
    PointCloud points = plot(2, 1);
    points.classes[600] = 7;  // noise
    const ClassSelection out = keep_wood_classes(points, {});
    EXPECT_EQ(out.count, 401u);
    EXPECT_EQ(out.left_out[2], 400u);
    EXPECT_EQ(out.left_out[7], 1u);
    EXPECT_FALSE(out.doubt);
    ASSERT_EQ(points.points.size(), 299u);
    ASSERT_EQ(points.classes.size(), 299u);
    ASSERT_EQ(points.intensities.size(), 299u);
    for (std::size_t i = 0; i < 299; ++i) {
        EXPECT_EQ(points.classes[i], 1);
        EXPECT_EQ(points.intensities[i], points.points.positions[i].z);
    }
}

TEST(WoodClasses, RulePreservesGroundThatIsNotLow) {
    PointCloud points = plot(1, 2);  // a file that uses class 2 for wood
    const ClassSelection out = keep_wood_classes(points, {});
    EXPECT_EQ(out.count, 0u);
    EXPECT_EQ(out.doubt, "points of class 2, which is ground, are not low: they were kept");
    EXPECT_EQ(points.points.size(), 700u);
}

TEST(WoodClasses, RulePreservesAllIfLittleWouldRemain) {
    PointCloud points = plot(6, 6);
    points.classes[5] = 4;
    const ClassSelection out = keep_wood_classes(points, {});
    EXPECT_EQ(out.doubt, "by their classes only 1 of 700 points could be trees: all were kept");
    EXPECT_EQ(points.points.size(), 700u);
    PointCloud unknown = plot(0, 1);
    EXPECT_EQ(keep_wood_classes(unknown, {}).count, 0u);
    unknown.classes.clear();
    EXPECT_EQ(keep_wood_classes(unknown, {}).count, 0u);
}

TEST(WoodClasses, RequestedClassesRemain) {
    PointCloud points = plot(2, 5);
    const ClassSelection out = keep_wood_classes(points, parse_wood_classes("2"));
    EXPECT_EQ(out.left_out[5], 300u);
    EXPECT_EQ(points.points.size(), 400u);
    EXPECT_EQ(error_of([&] { keep_wood_classes(points, parse_wood_classes("4")); }),
              "no point has one of the requested classes; there are 2 (400)");
    points.classes.clear();
    EXPECT_EQ(error_of([&] { keep_wood_classes(points, parse_wood_classes("4")); }),
              "its points have no classes to choose from");
    EXPECT_EQ(keep_wood_classes(points, parse_wood_classes("all")).count, 0u);
}

}  // namespace
}  // namespace coppice
