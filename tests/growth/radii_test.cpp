#include "coppice/growth/radii.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "coppice/base/error.h"
#include "described_options.h"

namespace coppice {
namespace {

Skeleton fork() {
    return Skeleton({NodeId(), NodeId(0), NodeId(1), NodeId(1)},
                    {{0, 0, 0}, {0, 0, 1}, {1, 0, 2}, {-1, 0, 2}}, {1, 1, 1, 1}, {10, 20, 30});
}

TEST(Radii, FollowThePipeModel) {
    const Skeleton square = with_pipe_radii(fork(), {.tip_radius = 3, .pipe_exponent = 2, .leaf_share = 0});
    EXPECT_FLOAT_EQ(square.radius(NodeId(3)), 3);
    EXPECT_FLOAT_EQ(square.radius(NodeId(1)), std::sqrt(18.0f));
    EXPECT_FLOAT_EQ(square.radius(NodeId(0)), std::sqrt(18.0f));
    const Skeleton cube = with_pipe_radii(fork(), {.tip_radius = 1, .pipe_exponent = 3, .leaf_share = 0.5f});
    EXPECT_FLOAT_EQ(cube.radius(NodeId(1)), std::cbrt(2.5f));
    EXPECT_FLOAT_EQ(cube.radius(NodeId(0)), std::cbrt(2.5f));
}

TEST(Radii, PreserveAllOtherProperties) {
    const Skeleton s = with_pipe_radii(fork());
    EXPECT_EQ(s.origin(), Vec3d(10, 20, 30));
    EXPECT_TRUE(std::ranges::equal(s.positions(), fork().positions()));
    EXPECT_TRUE(std::ranges::equal(s.parents(), fork().parents()));
}

TEST(Radii, RejectOptionsOutOfRange) {
    const float kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(with_pipe_radii(fork(), {.tip_radius = 0}), InvalidInput);
    EXPECT_THROW(with_pipe_radii(fork(), {.tip_radius = kNan}), InvalidInput);
    EXPECT_THROW(with_pipe_radii(fork(), {.tip_radius = 1e9f}), InvalidInput);
    EXPECT_THROW(with_pipe_radii(fork(), {.pipe_exponent = 1}), InvalidInput);
    EXPECT_THROW(with_pipe_radii(fork(), {.pipe_exponent = 3.5f}), InvalidInput);
    EXPECT_THROW(with_pipe_radii(fork(), {.leaf_share = -0.1f}), InvalidInput);
}

TEST(Radii, DescribeEveryOption) { test::expect_described<RadiiOptions>(); }

}  // namespace
}  // namespace coppice
