#include "coppice/measure/radius.h"
#include "measure/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mesh/shapes.h"

namespace coppice {
namespace {

using namespace shapes;

/// One segment of ten metres along z, of radius 0.5.
Skeleton pole() { return Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f}); }

RadiusReport radius(const PolygonMesh& m, const Skeleton& s) {
    const CapsuleTree capsules(s, m.origin);
    return radius_deviation(m, capsules, vertex_places(m, s, capsules));
}
TEST(RadiusDeviation, IsZeroForAnExactCapsule) {
    const PolygonMesh m = capsule(64, 16, 0.5f, 0, 10);
    const RadiusReport r = radius(m, pole());
    EXPECT_EQ(r.all.n, m.positions.size());
    EXPECT_NEAR(r.all.min, 0, 1e-5);
    EXPECT_NEAR(r.all.max, 0, 1e-5);
    // Rings are 0.625 m apart; those from 1.25 to 8.75 m are at least two radii away from root and tip.
    EXPECT_EQ(r.regular.n, 13u * 64);
}

TEST(RadiusDeviation, OverAreasIncludesTheChords) {
    // Four sides: distances on a chord are r cos(pi / 4) sqrt(1 + x^2), x uniform in [-1, 1]; the mean of the
    // root is (sqrt 2 + asinh 1) / 2.
    const double mean = std::cos(std::numbers::pi / 4) * (std::numbers::sqrt2 + std::asinh(1.0)) / 2 - 1;
    const RadiusReport r = radius(tube(4, 2, 0.5f, 10), pole());
    EXPECT_NEAR(r.areas.mean, mean, 1e-3);
    EXPECT_NEAR(r.areas.min, std::cos(std::numbers::pi / 4) - 1, 1e-3);
    EXPECT_EQ(r.areas.n, 10'000u);
}

TEST(RadiusDeviation, HasTheSignOfTheDeviation) {
    const RadiusReport thick = radius(capsule(32, 8, 0.6f, 0, 10), pole());
    EXPECT_NEAR(thick.regular.mean, 0.2, 1e-5);
    const RadiusReport thin = radius(capsule(32, 8, 0.4f, 0, 10), pole());
    EXPECT_NEAR(thin.regular.mean, -0.2, 1e-5);
    EXPECT_NEAR(thin.regular.mean_abs, 0.2, 1e-5);
}

TEST(RadiusDeviation, RegularExcludesForksButNotOtherNodes) {
    const PolygonMesh m = capsule(32, 16, 0.5f, 0, 10);
    const Skeleton joint({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 4.9f}, {0, 0, 10}},
                         {0.5f, 0.5f, 0.5f});
    EXPECT_EQ(radius(m, joint).regular.n, 13u * 32);
    // A thin lateral at 4.9 m excludes the rings at 4.375, 5 and 5.625 m.
    const Skeleton fork({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                        {{0, 0, 0}, {0, 0, 4.9f}, {0, 0, 10}, {9, 0, 4.9f}}, {0.5f, 0.5f, 0.5f, 0.01f});
    EXPECT_EQ(radius(m, fork).regular.n, 10u * 32);
}

TEST(RadiusDeviation, IgnoresUnusedVertices) {
    PolygonMesh m = capsule(16, 4, 0.5f, 0, 10);
    m.positions.push_back({0, 0, 99});
    EXPECT_NEAR(radius(m, pole()).all.max, 0, 1e-5);
}

TEST(RadiusDeviation, IsEmptyForASingleNode) {
    const RadiusReport r = radius(cube(), Skeleton({kRoot}, {{0, 0, 0}}, {1}));
    EXPECT_EQ(r.all.n, 0u);
}

TEST(RadiusDeviation, ConvertsOrigins) {
    PolygonMesh m = capsule(32, 8, 0.5f, -2, 8);
    m.origin = {5e5, 4e6, 102};
    const Skeleton s({kRoot, NodeId(0)}, {{1, 0, 0}, {1, 0, 10}}, {0.5f, 0.5f}, {5e5 - 1, 4e6, 100});
    const RadiusReport r = radius(m, s);
    EXPECT_NEAR(r.all.min, 0, 1e-5);
    EXPECT_NEAR(r.all.max, 0, 1e-5);
}

}  // namespace
}  // namespace coppice
