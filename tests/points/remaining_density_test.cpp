#include "coppice/points/sampling/remaining_density.h"

#include <gtest/gtest.h>

#include "coppice/points/sampling/dart_throwing.h"
#include "points/support.h"

namespace coppice {
namespace {

using namespace points_support;

const Ramp kRamp;

/// Returns a region with density x from 0 to 10, in a box of that length.
PointRegion rod() { return {FieldRef(kRamp), {{0, -1, -1}, {10, 1, 1}}, DensityCurve({{0, 0}, {10, 10}})}; }

PointSet points_at(std::vector<Vec3> positions) {
    PointSet set;
    set.positions.assign(positions.begin(), positions.end());
    return set;
}

TEST(RemainingDensity, IsTheProductOfTheRegionAndAllKernels) {
    const RadialKernel kernel({{1, 3}, {2, 1}});
    const std::vector<Vec3> places{{4, 0, 0}, {5.5f, 0, 0}, {6.5f, 0, 0}, {9, 0, 0}, {9, 2, 0}, {-1, 0, 0}};
    const auto left = remaining_density(rod(), kernel, points_at({{5, 0, 0}, {8, 0, 0}}), places);
    EXPECT_NEAR(left[0], 12, 1e-5);           // 3 at the border of the core, not inside
    EXPECT_EQ(left[1], 0);                    // inside a core
    EXPECT_NEAR(left[2], 6.5 * 2 * 2, 1e-4);  // in the middle of the kernels of both
    EXPECT_NEAR(left[3], 27, 1e-4);
    EXPECT_EQ(left[4], 0);  // outside the box
    EXPECT_EQ(left[5], 0);
}

TEST(RemainingDensity, WithoutPointsOrKernelIsTheRegion) {
    const std::vector<Vec3> places{{1, 0, 0}, {2, 0, 0}};
    EXPECT_EQ(remaining_density(rod(), RadialKernel::disk(1), {}, places), (std::vector<double>{1, 2}));
    EXPECT_EQ(remaining_density(rod(), {}, points_at({{1, 0, 0}}), places), (std::vector<double>{1, 2}));
}

TEST(RemainingDensity, FactorsAreBounded) {
    const std::vector<Vec3> places{{2, 0, 0}};
    const PointSet heap = points_at(std::vector<Vec3>(20, Vec3{2.5f, 0, 0}));
    EXPECT_NEAR(remaining_density(rod(), RadialKernel({{0.1f, 4}, {5, 4}}), heap, places, 50)[0], 100, 1e-6);
}

TEST(RemainingDensity, RespectsTheOriginOfPoints) {
    PointSet set = points_at({{-1, 0, 0}});
    set.origin = {6, 0, 0};
    const std::vector<Vec3> places{{5, 0, 0}, {7, 0, 0}};
    EXPECT_EQ(remaining_density(rod(), RadialKernel::disk(1), set, places), (std::vector<double>{0, 7}));
}

// The next point of Lane's method is never at a position without remaining density.
TEST(RemainingDensity, IsPositiveAtThePointsOfDartThrowing) {
    const RadialKernel kernel({{0.3f, 5}, {1, 1}});
    const auto set = sample_dart_throwing(rod(), kernel, {.count = 60}).points;
    for (std::size_t n : {1u, 10u, 30u, 59u}) {
        PointSet before = set;
        before.positions.resize(n);
        const std::vector<Vec3> next{set.positions[n]};
        EXPECT_GT(remaining_density(rod(), kernel, before, next)[0], 0) << n;
        EXPECT_EQ(remaining_density(rod(), kernel, set, next)[0], 0) << n;
    }
}

}  // namespace
}  // namespace coppice
