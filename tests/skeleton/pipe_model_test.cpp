#include "coppice/skeleton/pipe_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace coppice {
namespace {

// 0 - 1 - 2 and 1 - 3: two tips on a fork with a stem; 4 is isolated.
const std::vector<NodeId> kFork{NodeId(), NodeId(0), NodeId(1), NodeId(1), NodeId()};

TEST(PipeModel, SumsSquaresOfTheTips) {
    const std::vector<double> r = pipe_radii(kFork, 0.5, 2, 0);
    EXPECT_DOUBLE_EQ(r[2], 0.5);
    EXPECT_DOUBLE_EQ(r[3], 0.5);
    EXPECT_NEAR(r[1], std::sqrt(0.5), 1e-12);  // 0.25 + 0.25
    EXPECT_NEAR(r[0], std::sqrt(0.5), 1e-12);
    EXPECT_DOUBLE_EQ(r[4], 0.5);
}

TEST(PipeModel, LeafShareThickensAllButTipsAndRoots) {
    const std::vector<double> r = pipe_radii(kFork, 1, 3, 0.25);
    EXPECT_DOUBLE_EQ(r[2], 1);
    EXPECT_NEAR(r[1], std::cbrt(2.25), 1e-12);
    EXPECT_NEAR(r[0], std::cbrt(2.25), 1e-12);
    EXPECT_DOUBLE_EQ(r[4], 1);
}

}  // namespace
}  // namespace coppice
