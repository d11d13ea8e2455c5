#include "coppice/implicit/shape/variational_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/error.h"

namespace coppice {
namespace {

/// Evenly spaced on a circle; the normals of a hole point to its centre.
std::vector<OrientedPoint> ring(int count, double radius, Vec2d center, bool hole = false) {
    std::vector<OrientedPoint> out;
    for (int i = 0; i < count; ++i) {
        const double a = 2 * std::numbers::pi * i / count;
        const Vec2d u{std::cos(a), std::sin(a)};
        out.push_back({center + u * radius, u * (hole ? -3 : 3)});
    }
    return out;
}

std::vector<OrientedPoint> both(std::vector<OrientedPoint> a, const std::vector<OrientedPoint>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TEST(VariationalCurve, ReconstructsACircle) {
    const Profile p = variational_profile(ring(24, 2, {10, -5}));
    ASSERT_EQ(p.contours().size(), 1u);
    EXPECT_TRUE(p.closed());
    for (const Vec2d q : p.contours()[0]) EXPECT_NEAR(std::hypot(q.x - 10, q.y + 5), 2, 2e-3);
    EXPECT_NEAR(contour_area(p.contours()[0]), 4 * std::numbers::pi, 0.02);  // counter-clockwise
}

TEST(VariationalCurve, PassesThroughItsPointsSmoothly) {
    // An L of six corners: the curve passes through all, and swells where two are far apart.
    const std::vector<Vec2d> corners{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    const Profile p = variational_profile(with_normals(corners));
    for (const Vec2d c : corners) EXPECT_NEAR(p.distance(c).value, 0, 3e-4);
    EXPECT_LT(p.distance({0.5, 0.5}).value, -0.3);
    EXPECT_GT(p.distance({1.8, 1.8}).value, 0.3);
    EXPECT_LT(p.distance({1, -0.02}).value, 0);
    // In reverse order the normals are the same.
    const std::vector<Vec2d> reversed(corners.rbegin(), corners.rend());
    EXPECT_NEAR(variational_profile(with_normals(reversed)).distance({0.5, 0.5}).value,
                p.distance({0.5, 0.5}).value, 1e-9);
}

TEST(VariationalCurve, NormalsDetermineSeveralContoursAndHoles) {
    const Profile two = variational_profile(both(ring(16, 1, {-3, 0}), ring(16, 1, {3, 0})));
    EXPECT_EQ(two.contours().size(), 2u);
    EXPECT_LT(two.distance({3, 0}).value, -0.9);
    EXPECT_GT(two.distance({0, 0}).value, 1.8);
    const Profile hollow = variational_profile(both(ring(24, 2, {0, 0}), ring(24, 1, {0, 0}, true)));
    ASSERT_EQ(hollow.contours().size(), 2u);
    EXPECT_LT(contour_area(hollow.contours()[0]) * contour_area(hollow.contours()[1]), 0);
    EXPECT_GT(hollow.distance({0, 0}).value, 0.9);
    EXPECT_LT(hollow.distance({1.5, 0}).value, -0.45);
}

TEST(VariationalCurve, EndsAtTheMarginWithoutPoints) {
    // Half a ring: the rest of the area is open, and ends at the box.
    std::vector<OrientedPoint> half = ring(24, 1, {0, 0});
    half.resize(13);
    const Profile p = variational_profile(half, {.margin = 0.2f});
    const double size = std::hypot(2, 1);
    EXPECT_GT(p.low().y, -0.2 * size - 0.01);
    EXPECT_LT(p.high().y, 1 + 0.2 * size);
    for (const OrientedPoint& o : half) EXPECT_NEAR(p.distance(o.position).value, 0, 1e-3);
}

TEST(VariationalCurve, IsBitIdenticalForAnyNumberOfThreads) {
    const auto points = ring(40, 1, {0, 0});
    const Profile one = variational_profile(points, {}, {.threads = 1});
    const Profile more = variational_profile(points, {}, {.threads = 7});
    EXPECT_TRUE(std::ranges::equal(one.contours(), more.contours()));
}

TEST(VariationalCurve, RejectsUnsolvablePoints) {
    const auto refused = [](std::vector<OrientedPoint> points) {
        EXPECT_THROW(variational_profile(points), InvalidInput);
    };
    refused({});
    refused({{{0, 0}, {1, 0}}, {{1, 0}, {1, 0}}});
    refused({{{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}, {{1, 1}, {0, 1}}});
    refused({{{0, 0}, {1, 0}}, {{1, 0}, {0, 0}}, {{1, 1}, {0, 1}}});
    refused({{{0, 0}, {1, 0}}, {{1, 0}, {1, 0}}, {{2, 0}, {1, 0}}});  // all on one line
    refused({{{0, 0}, {NAN, 0}}, {{1, 0}, {1, 0}}, {{2, 1}, {1, 0}}});
    EXPECT_THROW(with_normals(std::vector<Vec2d>{{0, 0}, {1, 0}}), InvalidInput);
    EXPECT_THROW(with_normals(std::vector<Vec2d>{{0, 0}, {1, 0}, {0, 0}, {1, 1}}), InvalidInput);
}

}  // namespace
}  // namespace coppice
