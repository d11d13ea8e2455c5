#include "coppice/implicit/polygonize/contour_index.h"

#include "implicit/shape_support.h"

namespace coppice {
namespace {

std::vector<PlaneSegment> closed(std::span<const Vec2d> corners) {
    std::vector<PlaneSegment> segments;
    for (std::size_t i = 0; i < corners.size(); ++i)
        segments.push_back({corners[i], corners[(i + 1) % corners.size()]});
    return segments;
}

/// A star with alternating outer and inner corners.
std::vector<Vec2d> star(int points, double inner) {
    std::vector<Vec2d> corners;
    for (int i = 0; i < 2 * points; ++i) {
        const double a = std::numbers::pi * i / points, r = i % 2 ? inner : 1.0;
        corners.push_back({r * std::cos(a), r * std::sin(a)});
    }
    return corners;
}

double distance_to_all(std::span<const PlaneSegment> segments, Vec2d p) {
    double least = 1e300;
    for (const auto& [a, b] : segments) {
        const Vec2d d = b - a, v = p - a;
        const double t = std::clamp((v.x * d.x + v.y * d.y) / (d.x * d.x + d.y * d.y), 0.0, 1.0);
        least = std::min(least, std::hypot(v.x - t * d.x, v.y - t * d.y));
    }
    return least;
}

/// Sums the angle that the contour turns around p: does not use rays.
bool winds_around(std::span<const PlaneSegment> segments, Vec2d p) {
    double angle = 0;
    for (const auto& [a, b] : segments) {
        const Vec2d u = a - p, v = b - p;
        angle += std::atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
    }
    return std::abs(angle) > std::numbers::pi;
}

TEST(ContourIndex, MatchesAllSegments) {
    for (const int points : {3, 10, 500}) {
        const std::vector<PlaneSegment> segments = closed(star(points, 0.4));
        const ContourIndex index(segments, true);
        Box3 box;
        box.extend({-1, -1, 0});
        box.extend({1, 1, 0});
        for (const float margin : {0.1f, 3.0f})
            for (const Vec3 q : points_in(box, 2000, margin)) {
                const Vec2d p{q.x, q.y};
                const double d = distance_to_all(segments, p), found = index.distance(p).value;
                EXPECT_NEAR(std::abs(found), d, 1e-12);
                EXPECT_EQ(found < 0, winds_around(segments, p));
                EXPECT_EQ(index.inside(p), winds_around(segments, p));
            }
    }
}

TEST(ContourIndex, RaysThroughCornersCountOnce) {
    const ContourIndex index(closed(std::vector<Vec2d>{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}), true);
    EXPECT_TRUE(index.inside({0, 0}));
    EXPECT_FALSE(index.inside({-1.5, 0}));
    EXPECT_FALSE(index.inside({-0.5, 1}));
    EXPECT_TRUE(index.inside({-0.25, 0.5}));
}

TEST(ContourIndex, HighZigzagsNeedLittleMemory) {
    // 20,000 segments of the full height: with one stripe each, the lists would have 400 million entries.
    std::vector<Vec2d> corners;
    for (int i = 0; i < 20000; ++i) corners.push_back({static_cast<double>(i), i % 2 ? 10000.0 : 0.0});
    corners.push_back({20000, -1});
    corners.push_back({0, -1});
    const ContourIndex index(closed(corners), true);
    EXPECT_TRUE(index.inside({10000.1, -0.5}));
    EXPECT_FALSE(index.inside({10000, 9000}));
    EXPECT_NEAR(index.distance({10000.3, 10100}).value, std::hypot(0.7, 100), 1e-9);
}

TEST(ContourIndex, NonFinitePointsHaveInfiniteDistance) {
    const ContourIndex index(closed(star(5, 0.4)), true);
    EXPECT_EQ(index.distance({kNan, 0}).value, kInfinite);
    EXPECT_FALSE(index.inside({0, kNan}));
}

}  // namespace
}  // namespace coppice
