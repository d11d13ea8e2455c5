#include "coppice/points/sampling/radial_kernel.h"

#include <gtest/gtest.h>

#include <limits>

#include "points/support.h"

namespace coppice {
namespace {

using points_support::error_of;

TEST(RadialKernel, DiskAndClusterHaveTheirDefinition) {
    EXPECT_EQ(RadialKernel().at(0), 1);
    EXPECT_EQ(RadialKernel().reach(), 0);
    const RadialKernel disk = RadialKernel::disk(2);
    EXPECT_EQ(disk.core(), 2);
    EXPECT_FALSE(disk.is_soft());
    EXPECT_EQ(disk.at(2), 1);
    const RadialKernel cluster = RadialKernel::clustered(1, 3, 5);
    EXPECT_TRUE(cluster.is_soft());
    EXPECT_EQ(cluster.core(), 1);
    EXPECT_EQ(cluster.reach(), 3);
    EXPECT_DOUBLE_EQ(cluster.at(1), 5);
    EXPECT_DOUBLE_EQ(cluster.at(2), 3);
    EXPECT_DOUBLE_EQ(cluster.at(3), 1);
    EXPECT_DOUBLE_EQ(cluster.at(99), 1);
}

TEST(RadialKernel, RejectsInvalidKernels) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float d : {-1.0f, nan, std::numeric_limits<float>::infinity()}) {
        EXPECT_NE(error_of([&] { RadialKernel::disk(d); }).find("knot 1"), std::string::npos);
    }
    EXPECT_NE(error_of([&] { RadialKernel::clustered(1, 2, nan); }).find("factor"), std::string::npos);
    EXPECT_NE(error_of([] { RadialKernel::clustered(2, 1, 3); }).find("must not decrease"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
