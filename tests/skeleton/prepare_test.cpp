#include "coppice/skeleton/prepare.h"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "coppice/base/error.h"
#include "coppice/skeleton/measure.h"
#include "described_options.h"
#include "zoo.h"

namespace coppice {
namespace {

const PrepareOptions kNothing{.merge_branches = 0, .resample = {.method = ResampleMethod::none}};

TEST(Prepare, DoesNothingIfAllStepsAreDisabled) {
    const Skeleton s = zoo_skeleton("random_hard_1");
    const PrepareResult r = prepare(s, kNothing);
    EXPECT_EQ(r.skeleton.size(), s.size());
    EXPECT_EQ(r.new_of_old[5], NodeId(5));
}

TEST(Prepare, ReportsEveryStep) {
    const Skeleton s = zoo_skeleton("tip_cluster");
    PrepareOptions options;
    options.smooth_passes = 2;
    options.max_children = 3;
    const PrepareResult r = prepare(s, options);
    EXPECT_GT(r.report.merged_branches, 0u);
    EXPECT_GT(prepare(zoo_skeleton("whorl_5"), options).report.split_nodes, 0u);
    EXPECT_EQ(prepare(s, kNothing).report.merged_branches, 0u);
    EXPECT_GT(prepare(zoo_skeleton("helix"), options).report.smoothed_radii, 0u);
    EXPECT_GT(prepare(zoo_skeleton("short_segments_010")).report.merged_branches, 0u);
    EXPECT_GT(prepare(zoo_skeleton("long_thin")).report.resample.inserted, 0u);
}

TEST(Prepare, PreservesTreesAndTipsAndMapsEveryNode) {
    for (const auto& [name, s] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        PrepareOptions options;
        options.smooth_passes = 1;
        options.max_children = 4;
        const PrepareResult r = prepare(s, options);
        EXPECT_EQ(measure(r.skeleton).trees, measure(s).trees);
        EXPECT_EQ(measure(r.skeleton).tips, measure(s).tips);
        EXPECT_LE(measure(r.skeleton).max_children, 4u);
        for (const NodeId n : nodes(s)) {
            ASSERT_LT(r.new_of_old[n.index()].index(), r.skeleton.size());
            if (!s.is_tip(n)) continue;
            EXPECT_EQ(r.skeleton.position(r.new_of_old[n.index()]), s.position(n));
        }
    }
}

TEST(Prepare, RefusesASkeletonWithoutNodes) {
    PrepareOptions off;
    off.resample.method = ResampleMethod::none;
    EXPECT_THROW(prepare(Skeleton(), off), InvalidInput);
    EXPECT_THROW(prepare(Skeleton()), InvalidInput);
}

TEST(Prepare, RejectsOptionsOutOfRange) {
    EXPECT_THROW(prepare(zoo_skeleton("fork_60"), {.merge_branches = -1}), InvalidInput);
    EXPECT_THROW(prepare(zoo_skeleton("fork_60"), {.resample = {.max_length = 0}}), InvalidInput);
    EXPECT_THROW(prepare(zoo_skeleton("fork_60"), {.max_children = 1}), InvalidInput);
}

TEST(Prepare, DescribesEveryOptionOnceWithItsDefaultInRange) { test::expect_described<PrepareOptions>(); }

}  // namespace
}  // namespace coppice
