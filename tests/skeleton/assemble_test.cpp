#include "coppice/skeleton/assemble.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>

#include "coppice/base/error.h"

namespace coppice {
namespace {

Skeleton fork(Vec3d origin = {}) {
    return Skeleton({NodeId::none(), NodeId(0), NodeId(0)}, {{1, 0, 0}, {1, 0, 2}, {2, 0, 1}},
                    {0.3f, 0.2f, 0.1f}, origin, {StableId(7), StableId(2), StableId(5)});
}

Vec3d world(const Skeleton& s, std::uint32_t n) { return Vec3d(s.position(NodeId(n))) + s.origin(); }

TEST(Assemble, TranslationPreservesAllButPositions) {
    const Skeleton s = translated(fork({10, 0, 0}), {1, 2, 3});
    EXPECT_EQ(world(s, 1), Vec3d(12, 2, 5));
    EXPECT_EQ(s.origin(), Vec3d(10, 0, 0));
    EXPECT_EQ(s.radius(NodeId(1)), 0.2f);
    EXPECT_EQ(s.parent(NodeId(2)), NodeId(0));
    EXPECT_EQ(s.stable_id(NodeId(0)), StableId(7));
}

TEST(Assemble, RotationIsCounterClockwiseAboutAWorldPosition) {
    const Skeleton s = rotated(fork({10, 0, 0}), {0, 0, 5}, std::numbers::pi / 2, {11, 0, 0});
    EXPECT_LT(length(world(s, 0) - Vec3d(11, 0, 0)), 1e-6);
    EXPECT_LT(length(world(s, 2) - Vec3d(11, 1, 1)), 1e-6);
    EXPECT_THROW(rotated(fork(), {0, 0, 0}, 1), InvalidInput);
}

TEST(Assemble, ScalingIncludesRadii) {
    const Skeleton s = scaled(fork(), 2, {1, 0, 0});
    EXPECT_EQ(world(s, 0), Vec3d(1, 0, 0));
    EXPECT_EQ(world(s, 1), Vec3d(1, 0, 4));
    EXPECT_FLOAT_EQ(s.radius(NodeId(0)), 0.6f);
    for (const double factor : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 1e300, 1e-60})
        EXPECT_THROW(scaled(fork(), factor), InvalidInput) << factor;
}

TEST(Assemble, JoiningPreservesBothTrees) {
    const Skeleton a = fork({10, 0, 0}), b = fork({0, 5, 0});
    const Skeleton s = joined(std::array{&a, &b});
    ASSERT_EQ(s.size(), 6u);
    EXPECT_EQ(s.tree_count(), 2u);
    EXPECT_EQ(s.origin(), a.origin());
    for (std::uint32_t n = 0; n < 3; ++n) {
        EXPECT_EQ(world(s, n), world(a, n));
        EXPECT_EQ(world(s, n + 3), world(b, n));
        EXPECT_EQ(s.radius(NodeId(n + 3)), b.radius(NodeId(n)));
    }
    EXPECT_EQ(s.parent(NodeId(5)), NodeId(3));
    EXPECT_TRUE(s.stable_ids().empty());
}

}  // namespace
}  // namespace coppice
