#include "coppice/measure/union_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stop_token>

#include "coppice/base/error.h"
#include "measure/support.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;

UnionVolume volume(const Skeleton& s, EndShape base = EndShape::round, EndShape tips = EndShape::round,
                   const UnionVolumeOptions& options = {}) {
    return union_volume(ConeUnion(s, s.origin(), base, tips), options);
}

Skeleton segment(Vec3 to, float from_radius, float to_radius) {
    return Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, to}, {from_radius, to_radius});
}

TEST(UnionVolume, OfOneSegmentIsExact) {
    // A cylinder of length 5 and two half balls of radius 2.
    EXPECT_NEAR(volume(segment({3, 0, 4}, 2, 2)).total, kPi * 4 * 5 + 4 * kPi / 3 * 8, 1e-9);
    // A cone between radii 1 and 2, and half balls of both.
    EXPECT_NEAR(volume(segment({0, 5, 0}, 1, 2)).total, kPi * 5 / 3 * (1 + 2 + 4) + 2 * kPi / 3 * (1 + 8),
                1e-9);
    EXPECT_NEAR(volume(segment({0, 5, 0}, 1, 2), EndShape::flat).total,
                kPi * 5 / 3 * (1 + 2 + 4) + 2 * kPi / 3 * 8, 1e-9);
    EXPECT_NEAR(volume(segment({0, 5, 0}, 1, 2), EndShape::flat, EndShape::flat).total,
                kPi * 5 / 3 * (1 + 2 + 4), 1e-9);
    EXPECT_NEAR(volume(Skeleton({kRoot}, {{1, 2, 3}}, {2})).total, 4 * kPi / 3 * 8, 1e-9);
    EXPECT_NEAR(volume(segment({0, 0, 0}, 2, 1)).total, 4 * kPi / 3 * 8, 1e-9);
}

TEST(UnionVolume, OfAStraightBranchIsIndependentOfItsNodes) {
    std::vector<NodeId> parent{kRoot};
    std::vector<Vec3> position{{0, 0, 0}};
    for (std::uint32_t i = 1; i <= 200; ++i) {
        parent.emplace_back(i - 1);
        position.push_back({0, 0, 0.05f * static_cast<float>(i)});
    }
    const UnionVolume v = volume(Skeleton(parent, position, std::vector<float>(201, 1.0f)));
    const double exact = kPi * 10 + 4 * kPi / 3;
    EXPECT_NEAR(v.total, exact, v.error);
    EXPECT_LE(v.error, 0.0011 * exact);
}

TEST(UnionVolume, CountsOverlapsOnce) {
    // Two cylinders of radius 1 that intersect at right angles share 16/3 (Archimedes). Flat ends.
    const Skeleton cross({kRoot, NodeId(0), kRoot, NodeId(2)}, {{-4, 0, 0}, {4, 0, 0}, {0, -4, 0}, {0, 4, 0}},
                         {1, 1, 1, 1});
    const UnionVolume v = volume(cross, EndShape::flat, EndShape::flat);
    const double exact = 2 * kPi * 8 - 16.0 / 3;
    EXPECT_NEAR(v.total, exact, v.error);
    EXPECT_LE(v.error, 0.0011 * exact);
    EXPECT_GT(v.error, 0);
    // Two balls of radius 1 with centres 1 apart: each lacks a cap of height 1/2, pi h^2 (3 - h) / 3.
    const UnionVolume balls = volume(Skeleton({kRoot, kRoot}, {{0, 0, 0}, {1, 0, 0}}, {1, 1}));
    EXPECT_NEAR(balls.total, 2 * (4 * kPi / 3 - kPi * 0.25 * 2.5 / 3), balls.error);
}

TEST(UnionVolume, OfARingMatchesATorus) {
    // A closed polygon of 120 segments about the origin, major radius 3, minor 1: 2 pi^2 R r^2 minus the
    // deficit of the polygon, a share of (pi / 120)^2 / 2.
    std::vector<NodeId> parent;
    std::vector<Vec3> position;
    for (std::uint32_t i = 0; i <= 120; ++i) {
        parent.push_back(i == 0 ? kRoot : NodeId(i - 1));
        const double turn = 2 * kPi * i / 120;
        position.push_back(Vec3(Vec3d(3 * std::cos(turn), 3 * std::sin(turn), 0)));
    }
    const UnionVolume v = volume(Skeleton(parent, position, std::vector<float>(121, 1.0f)));
    const double exact = 2 * kPi * kPi * 3;
    EXPECT_NEAR(v.total, exact, v.error + 4e-4 * exact);
}

TEST(UnionVolume, EndsInsideOtherSegmentsAddNothing) {
    // A branch at a right angle to a trunk, with a third of its radius: the trunk contains the whole start.
    const Skeleton fork({kRoot, NodeId(0), NodeId(1), NodeId(1)},
                        {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {9, 0, 5}}, {3, 3, 3, 1});
    const UnionVolume v = volume(fork, EndShape::flat, EndShape::flat);
    // The trunk; and the portion of the branch beyond it: at height y off its axis the trunk's surface is at
    // sqrt(9 - y^2), on average over the disc at 3 - E[y^2] / 6 - E[y^4] / 216 = 3 - 1/24 - 1/1728, (E[y^2] =
    // 1/4, E[y^4] = 1/8).
    const double exact = kPi * 9 * 10 + kPi * (9 - 3 + 1.0 / 24 + 1.0 / 1728);
    EXPECT_NEAR(v.total, exact, v.error);
    EXPECT_NEAR(v.of_capsule[0] + v.of_capsule[1], kPi * 90, v.error);
}

TEST(UnionVolume, CountsMarkedPointsSeparately) {
    const Skeleton s = segment({0, 0, 10}, 1, 1);
    const ConeUnion solid(s, {}, EndShape::flat, EndShape::flat);
    const UnionVolume v = union_volume(solid, {}, [](std::uint32_t, Vec3d p, double radius) {
        EXPECT_EQ(radius, 1);
        return p.z > 7.5;
    });
    ASSERT_EQ(v.marked.size(), 1u);
    EXPECT_NEAR(v.marked[0], kPi * 2.5, v.error);
}

TEST(UnionVolume, ErrorIsWithinTheTolerance) {
    const Skeleton cross({kRoot, NodeId(0), kRoot, NodeId(2)}, {{-4, 0, 0}, {4, 0, 0}, {0, -4, 0}, {0, 4, 0}},
                         {1, 1, 1, 1});
    const UnionVolume rough = volume(cross, EndShape::flat, EndShape::flat, {.tolerance = 1e-2});
    EXPECT_LE(rough.error, 0.011 * rough.total);
    EXPECT_LT(rough.samples, 20'000u);
    EXPECT_LE(volume(cross, EndShape::flat, EndShape::flat, {.max_samples = 1000}).samples, 1200u);
}

TEST(UnionVolume, IsBitIdenticalForAnyNumberOfThreads) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ConeUnion solid(skeleton, skeleton.origin(), EndShape::flat, EndShape::round);
        const UnionVolumeOptions options{.tolerance = 1e-2};
        const UnionVolume one = union_volume(solid, options, {}, {.threads = 1});
        EXPECT_GT(one.total, 0);
        EXPECT_TRUE(std::isfinite(one.total));
        for (const unsigned threads : {2u, 7u}) {
            const UnionVolume many = union_volume(solid, options, {}, {.threads = threads});
            EXPECT_EQ(many.total, one.total);
            EXPECT_EQ(many.of_capsule, one.of_capsule);
        }
    }
}

TEST(UnionVolume, StopsWhenCancelled) {
    std::stop_source stop;
    stop.request_stop();
    const Skeleton s = segment({0, 0, 10}, 1, 1);
    const ConeUnion solid(s, {}, EndShape::flat, EndShape::flat);
    EXPECT_THROW(union_volume(solid, {}, {}, {.stop = stop.get_token()}), Cancelled);
}

TEST(EstimateUnionVolume, MatchesTheMeasuredVolume) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ConeUnion solid(skeleton, skeleton.origin(), EndShape::flat, EndShape::round);
        const UnionVolume measured = union_volume(solid, {});
        const VolumeEstimate estimate = estimate_union_volume(solid, 1 << 15);
        EXPECT_NEAR(estimate.volume, measured.total, 2 * (measured.error + estimate.error));
        EXPECT_LE(estimate.error, 0.02 * measured.total);
        const VolumeEstimate again = estimate_union_volume(solid, 1 << 15, {.threads = 1});
        EXPECT_EQ(again.volume, estimate.volume);
        EXPECT_EQ(again.error, estimate.error);
    }
}

TEST(EstimateUnionVolume, OfOneConeIsExact) {
    const ConeUnion cone(segment({0, 5, 0}, 1, 2), {}, EndShape::round, EndShape::round);
    EXPECT_NEAR(estimate_union_volume(cone, 1000).volume, kPi * 5 / 3 * (1 + 2 + 4) + 2 * kPi / 3 * (1 + 8),
                1e-9);
}

}  // namespace
}  // namespace coppice
