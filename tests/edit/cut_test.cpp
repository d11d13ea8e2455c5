#include "coppice/edit/cut.h"

#include <gtest/gtest.h>

#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;
using test::near;

TEST(Cut, SplitsSegmentsAndPreservesTheSurface) {
    EditableTree tree(test::stem_with_branches());
    const EditChange change = split(tree, ids({2, 4}), 4);
    EXPECT_EQ(change.added, ids({9, 10, 11, 12, 13, 14}));
    EXPECT_TRUE(near(tree.position(id(9)), {0, 0, 1.25f}));
    EXPECT_FLOAT_EQ(tree.radius(id(10)), 0.09f);  // half-way from 0.1 to 0.08
    EXPECT_FLOAT_EQ(tree.radius(id(13)), 0.05f);  // a lateral starts with its own radius
    EXPECT_EQ(tree.leader(id(1)), id(9));         // continues the stem
    EXPECT_EQ(tree.parent(id(4)), id(14));
    split_at(tree, ids({3}), 0.25);
    EXPECT_TRUE(near(tree.position(id(15)), {0, 0, 2.25f}));
}

TEST(Cut, DetachesABranchWithItsFirstSegment) {
    EditableTree tree(test::stem_with_branches());
    const EditChange change = detach(tree, ids({4}));
    EXPECT_EQ(change.added, ids({9}));
    EXPECT_EQ(tree.position(id(9)), tree.position(id(1)));
    EXPECT_FLOAT_EQ(tree.radius(id(9)), 0.05f);
    EXPECT_EQ(tree.find_root(id(7)), id(9));
    EXPECT_NE(error_of([&] {
                  detach(tree, ids({0, 9}));
              }).find("only roots are selected"),
              std::string::npos);
}

TEST(Cut, RemovesBranchesOrSingleNodes) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(remove_branches(tree, ids({5, 8})).removed, ids({5, 6, 7, 8}));
    tree.undo();
    EXPECT_EQ(dissolve(tree, ids({4, 5})).removed, ids({4, 5}));
    EXPECT_EQ(tree.parent(id(7)), id(1));
    EXPECT_EQ(error_of([&] { remove_branches(tree, ids({0})); }), "no node would remain; keep at least one");
    dissolve(tree, ids({0}));
    EXPECT_TRUE(tree.is_root(id(1)));
}

TEST(Cut, ResamplesEvenly) {
    EditableTree tree(test::stem_with_branches());
    resample(tree, tree.nodes(), 0.25);
    // Between forks, each metre has four segments: seven sections of 1 m, with 8 between the fork and the tip
    // of the lateral.
    for (const StableId n : tree.nodes()) {
        if (!tree.is_root(n)) {
            EXPECT_NEAR(distance(tree.position(n), tree.position(tree.parent(n))), 0.25, 1e-6);
        }
    }
    EXPECT_EQ(tree.size(), 8u * 4 + 1);
    EXPECT_TRUE(tree.contains(id(4)));  // kept, but moved
    EXPECT_TRUE(near(tree.position(id(4)), {0.25f, 0, 1}));
    resample(tree, tree.nodes(), 10);
    EXPECT_EQ(tree.nodes(), ids({0, 1, 2, 3, 5, 6, 7, 8}));  // forks, tips and the root remain
    EXPECT_NE(error_of([&] { resample(tree, tree.nodes(), 1e-9); }).find("use a larger spacing"),
              std::string::npos);
}

TEST(Prune, RemovesByRadiusLengthAndOrder) {
    EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(prune(tree, tree.nodes(), {.radius = 0.035f}).removed, ids({6, 7, 8}));
    tree.undo();
    EXPECT_EQ(prune(tree, tree.nodes(), {.length = 1.5f}).removed, ids({7, 8}));  // 4 is 3 m long
    tree.undo();
    EXPECT_EQ(prune(tree, tree.nodes(), {.order = 0}).removed, ids({4, 5, 6, 7, 8}));
    tree.undo();
    EXPECT_EQ(prune(tree, ids({6, 7, 8}), {.order = 0}).removed, ids({6, 7, 8}));
    EXPECT_TRUE(prune(tree, tree.nodes(), {}).empty());
}

TEST(Prune, ShadeCountsTheTipsAbove) {
    // A stem to z = 10 with horizontal branches at 1 and 3; the lower one is directly below the upper one.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(2)},
                     {{0.5f, 0.5f, 0.5f},
                      {0.5f, 0.5f, 1.5f},
                      {0.5f, 0.5f, 3.5f},
                      {0.5f, 0.5f, 20.5f},
                      {6.5f, 0.5f, 1.5f},
                      {6.5f, 0.5f, 3.5f}},
                     {1, 1, 1, 1, 0.1f, 0.1f});
    EditableTree tree(s);
    const auto shade = shade_of_tips(tree, 1);
    EXPECT_NEAR(shade[id(4)], 0.2 * 0.25, 1e-12);  // two cells above: 0.2 halved twice
    EXPECT_NEAR(shade[id(5)], 0, 1e-12);
    EXPECT_EQ(prune(tree, tree.nodes(), {.shade = 0.01f, .shade_cell = 1}).removed, ids({4}));
    tree.undo();
    // With an additional tip in the light, the lower branch is kept, and only its shaded tip is removed.
    TreeEdit edit(tree);
    edit.add(id(4), {6.5f, 0.6f, 1.6f}, 0.05f);
    edit.add(id(4), {16.5f, 0.5f, 1.5f}, 0.1f);
    edit.commit();
    EXPECT_EQ(prune(tree, tree.nodes(), {.shade = 0.01f, .shade_cell = 1}).removed, ids({6}));
}

// The meaning of a shade of 1 differs between trees; a fraction of the tips does not.
TEST(Prune, RemovesAFractionOfTheMostShadedTips) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        EditableTree tree(random_tree(400, seed));
        const auto shade = shade_of_tips(tree, 0.1);
        NodeSet tips;
        for (const StableId n : tree.nodes()) {
            if (tree.is_tip(n)) tips.push_back(n);
        }
        const EditChange change = prune(tree, tree.nodes(), {.shade_share = 0.25f, .shade_cell = 0.1f});
        double min_removed_shade = 1e9;
        std::size_t gone = 0;
        for (const StableId n : tips) {
            if (tree.contains(n)) continue;
            ++gone;
            min_removed_shade = std::min(min_removed_shade, shade[n]);
        }
        EXPECT_GT(gone, 0u);
        EXPECT_LE(gone, tips.size() / 4);
        EXPECT_GT(min_removed_shade, 0);
        EXPECT_LE(std::ranges::count_if(tips, [&](StableId n) { return shade[n] >= min_removed_shade; }),
                  static_cast<std::ptrdiff_t>(tips.size() / 4));
        tree.undo();
        EXPECT_TRUE(prune(tree, tree.nodes(), {}).empty());
    }
}

TEST(Prune, TrimsToTheSurfaceOfASolid) {
    EditableTree tree(test::stem_with_branches());
    const Solid crown = sphere({0, 0, 2}, {.radius = 1.5f});
    const EditChange change = prune_by_solid(tree, tree.nodes(), crown);
    // The root is below the crown and on the path to it; 4 is inside, 5 to 7 are not.
    EXPECT_EQ(change.removed, ids({5, 6, 7}));
    ASSERT_EQ(change.added.size(), 1u);
    EXPECT_NEAR(distance(tree.position(change.added[0]), {0, 0, 2}), 1.5, 1e-3);
    EXPECT_TRUE(tree.contains(id(0)));
    EXPECT_NE(error_of([&] {
                  prune_by_solid(tree, tree.nodes(), sphere({50, 0, 0}));
              }).find("no node would remain"),
              std::string::npos);
}

TEST(Prune, CutsBranchesThatEnterASolid) {
    EditableTree tree(test::stem_with_branches());
    const EditChange change = prune_by_solid(tree, tree.nodes(), sphere({2, 0, 1}, {.radius = 0.5f}), false);
    EXPECT_EQ(change.removed, ids({5, 6, 7}));  // 6 is beyond the wires, and is removed too
    ASSERT_EQ(change.added.size(), 1u);
    EXPECT_NEAR(tree.position(change.added[0]).x, 1.5, 1e-3);
}

}  // namespace
}  // namespace coppice
