#include "coppice/extract/tree/initial_tree_internal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coppice/base/id.h"
#include "coppice/extract/tree/tree_edit_internal.h"

namespace coppice {
namespace {

InitialTree chain(const std::vector<Vec3d>& at, double radius) {
    InitialTree t;
    for (const Vec3d p : at) t.add(t.size() == 0 ? kNoIndex : t.size() - 1, p, radius);
    return t;
}

TEST(InitialTree, RerootReversesThePathToTheRoot) {
    InitialTree t = chain({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, 1);
    t.add(1, {1, 0, 1}, 1);
    reroot(t, 3);
    EXPECT_EQ(t.parent, (std::vector<std::uint32_t>{1, 3, 1, kNoIndex}));
    const std::vector<std::uint32_t> new_of_old = sort_parents_first(t);
    EXPECT_EQ(new_of_old, (std::vector<std::uint32_t>{2, 1, 3, 0}));
    EXPECT_EQ(t.parent, (std::vector<std::uint32_t>{kNoIndex, 0, 1, 1}));
}

// A ring of eight nodes, closed between the last and the first, thinnest between nodes 2 and 3.
TEST(CutLoops, CutsTheThinnestSegment) {
    InitialTree t;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const double a = std::numbers::pi * i / 4;
        t.add(i == 0 ? kNoIndex : i - 1, {std::cos(a), std::sin(a), 0}, i == 3 ? 0.05 : 0.1);
    }
    t.radius[2] = 0.08;
    InitialTree kept = t;
    const auto new_of_old = extract_internal::cut_loops(t, {{7, 0}}, false);
    // 3 was a child of 2; now it is one of 4, and 7 of 0.
    EXPECT_EQ(t.parent[new_of_old[7]], new_of_old[0]);
    EXPECT_EQ(t.parent[new_of_old[3]], new_of_old[4]);
    EXPECT_EQ(t.size(), 8u);
    extract_internal::cut_loops(kept, {{7, 0}}, true);
    EXPECT_EQ(kept.size(), 9u);  // node 3 is extended to the position of node 2
}

TEST(JoinTrees, AttachesThinEndsToThickAxes) {
    InitialTree t = chain({{0, 0, 0}, {0, 0, 3}}, 0.2);
    t.add(kNoIndex, {1, 0, 2}, 0.1);
    t.add(2, {0.1, 0, 1}, 0.1);
    EXPECT_EQ(extract_internal::join_trees(t, 1, {}), 1u);
    sort_parents_first(t);
    ASSERT_EQ(t.size(), 5u);
    const InitialTreeLinks links(t);
    std::uint32_t forks = 0;
    for (std::uint32_t n = 0; n < t.size(); ++n) {
        if (links.children(n).size() < 2) continue;
        ++forks;
        EXPECT_LT(distance(t.position[n], Vec3d(0, 0, 1)), 1e-9);
    }
    EXPECT_EQ(forks, 1u);
}

TEST(JoinTrees, AttachesThickStartsToThinAxesWithinReach) {
    // A needle of twice the twig's radius that starts 1.3 radii of the twig from its axis.
    const auto joined = [](double radius, double distance) {
        InitialTree t = chain({{0, 0, 0}, {0, 0, 3}}, 0.1);
        t.add(kNoIndex, {distance, 0, 2}, radius);
        t.add(2, {distance + 1, 0, 2}, 0.01);
        return extract_internal::join_trees(t, 1.2, {});
    };
    EXPECT_EQ(joined(0.2, 0.13), 1u);
    EXPECT_EQ(joined(0.2, 0.25), 0u);   // beyond 1.2 of the thicker radius
    EXPECT_EQ(joined(0.26, 0.05), 0u);  // a trunk next to a twig
}

TEST(RemoveReversals, RemovesANodeBeyondItsFork) {
    InitialTree t = chain({{0, 0, 0}, {0, 0, 1.2}, {0, 0, 1}, {0, 0, 2}}, 0.1);
    t.add(2, {1, 0, 1}, 0.1);
    FitSamples samples{{}, {}, {0, 1, 2, 3, 4}};
    EXPECT_EQ(extract_internal::remove_reversals(t, samples), 1u);
    EXPECT_EQ(t.size(), 4u);
    EXPECT_EQ(t.position[1], Vec3d(0, 0, 1));
    EXPECT_EQ(samples.node, (std::vector<std::uint32_t>{0, 1, 1, 2, 3}));
}

TEST(PruneStubs, RemovesBumpsAndPreservesTwigs) {
    InitialTree t = chain({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, 0.2);
    t.add(1, {0.15, 0, 1}, 0.1);  // rises by 0.05, a quarter of the radius
    t.add(1, {0, 0.5, 1}, 0.1);   // by 0.4
    FitSamples samples{{}, {}, {3, 4, 2}};
    EXPECT_EQ(extract_internal::prune_stubs(t, samples, 0.3), 1u);
    EXPECT_EQ(t.size(), 4u);
    EXPECT_EQ(samples.node[0], 1u);
}

}  // namespace
}  // namespace coppice
