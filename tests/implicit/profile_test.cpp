#include "coppice/implicit/shape/profile.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

const std::vector<Vec2d> kSquare{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

TEST(Profile, ComputesTheDistanceToASquare) {
    const Profile square(kSquare);
    EXPECT_DOUBLE_EQ(square.distance({0, 0}).value, -1);
    EXPECT_DOUBLE_EQ(square.distance({0.5, 0.25}).value, -0.5);
    EXPECT_DOUBLE_EQ(square.distance({3, 0}).value, 2);
    EXPECT_DOUBLE_EQ(square.distance({4, 5}).value, 5);  // 3, 4 from the corner
    EXPECT_DOUBLE_EQ(square.distance({4, 5}).gradient.x, 0.6);
    EXPECT_DOUBLE_EQ(square.distance({1, 0}).value, 0);
    EXPECT_DOUBLE_EQ(square.distance({1, 0}).gradient.x, 1);
    EXPECT_DOUBLE_EQ(square.distance({0.5, 0.25}).gradient.x, 1);
    EXPECT_DOUBLE_EQ(square.reach(), std::sqrt(2));
}

TEST(Profile, IsIndependentOfTheOrientation) {
    std::vector<Vec2d> turned(kSquare.rbegin(), kSquare.rend());
    const Profile a(kSquare), b(turned);
    for (const Vec2d p : {Vec2d{0.2, 0.1}, {1, 0.3}, {2, 2}, {-1, 0.5}}) {
        EXPECT_DOUBLE_EQ(a.distance(p).value, b.distance(p).value);
        EXPECT_NEAR(a.distance(p).gradient.x, b.distance(p).gradient.x, 1e-12);
    }
}

TEST(Profile, NestedContoursAreHoles) {
    const std::vector<std::vector<Vec2d>> contours{
        kSquare, circle_contour({0, 0}, 0.5, 256), {{3, 0}, {4, 0}, {4, 1}}};
    const Profile profile(contours);
    EXPECT_NEAR(profile.distance({0, 0}).value, 0.5, 1e-4);
    EXPECT_NEAR(profile.distance({0.75, 0}).value, -0.25, 1e-4);
    EXPECT_LT(profile.distance({3.9, 0.5}).value, 0);
    EXPECT_EQ(profile.contours().size(), 3u);
}

TEST(Profile, SplinesApproximateTheCircle) {
    const std::vector<Vec2d> points = circle_contour({0, 0}, 1, 16);
    for (const CurveKind kind : {CurveKind::catmull_rom, CurveKind::natural}) {
        const Profile round(points, kind);
        for (int i = 0; i < 100; ++i) {
            const double a = 0.0628 * i;
            const PlaneSample s = round.distance({2 * std::cos(a), 2 * std::sin(a)});
            EXPECT_NEAR(s.value, 1, 2e-3);
            EXPECT_NEAR(s.gradient.x, std::cos(a), 0.02);
        }
    }
}

TEST(Profile, OpenLinesHaveNoInside) {
    const Profile open(std::vector<Vec2d>{{0, 0}, {2, 0}, {2, 2}}, CurveKind::polyline, false);
    EXPECT_FALSE(open.closed());
    EXPECT_DOUBLE_EQ(open.distance({1, 0.5}).value, 0.5);
    EXPECT_DOUBLE_EQ(open.distance({1, -0.5}).value, 0.5);
    EXPECT_DOUBLE_EQ(open.distance({0, 1}).value, 1);
}

TEST(Profile, BatchesMatchSinglePoints) {
    const Profile square(kSquare);
    const std::vector<Vec2d> points{{0, 0}, {2, 1}, {100, -3}};
    std::vector<PlaneSample> samples(3);
    square.distance(points, samples);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(samples[i].value, square.distance(points[i]).value);
}

TEST(Profile, RejectsInvalidContours) {
    const auto profile = [](std::vector<Vec2d> points, bool closed = true) {
        return error_of([&] { Profile(points, CurveKind::polyline, closed); });
    };
    EXPECT_EQ(profile({{0, 0}, {1, 1}, {2, 2}}),
              "profile: contour 1 encloses no area; its points must not be on one line");
    EXPECT_NE(profile({{0, 0}, {1, 1}}).find("3 to 1000000 points"), std::string::npos);
    EXPECT_NE(profile({{0, 0}, {1, std::nan("")}, {2, 0}}).find("point 2"), std::string::npos);
    EXPECT_NE(profile({{0, 0}, {1e300, 1}, {2, 0}}).find("point 2"), std::string::npos);
    EXPECT_NE(error_of([] { Profile(std::span<const std::vector<Vec2d>>{}); }).find("no contour"),
              std::string::npos);
    EXPECT_NE(error_of([] { circle_contour({0, 0}, -1); }).find("radius"), std::string::npos);
    EXPECT_NE(error_of([] { circle_contour({0, 0}, 1, 2); }).find("corners"), std::string::npos);
}

}  // namespace
}  // namespace coppice
