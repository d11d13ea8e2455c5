#include "coppice/edit/anchor.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/edit/cut.h"
#include "coppice/edit/rigid.h"
#include "coppice/skeleton/assemble.h"
#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"
#include "zoo.h"

namespace coppice {
namespace {

using test::id;
using test::ids;

TEST(Anchor, BindsToItsOwnNode) {
    const EditableTree tree(random_tree(300, 1));
    const AnchorFrame frame = anchor_frame(tree);
    for (const StableId n : tree.nodes()) {
        const Binding b = bind_anchor(tree, frame, compute_anchor(tree, frame, n));
        EXPECT_EQ(b.node, n);
        EXPECT_NEAR(b.distance, 0, 1e-9);
    }
}

TEST(Anchor, BindsInAScaledMovedAndRenumberedTree) {
    const Skeleton s = random_tree(300, 1);
    std::vector<StableId> other;
    std::vector<Vec3> place;
    std::vector<float> radius;
    for (const NodeId n : nodes(s)) {
        other.emplace_back(1000 + 3 * n.index());
        place.push_back(s.position(n) * 2.5f + Vec3{10, 20, 30});
        radius.push_back(s.radius(n) * 2.5f);
    }
    const EditableTree tree(s);
    const EditableTree again(
        Skeleton({s.parents().begin(), s.parents().end()}, place, radius, {1000, 0, 0}, other));
    const AnchorFrame frame = anchor_frame(tree), frame_again = anchor_frame(again);
    for (const StableId n : tree.nodes()) {
        const Binding b = bind_anchor(again, frame_again, compute_anchor(tree, frame, n));
        EXPECT_EQ(b.node, id(1000 + 3 * n.index()));
    }
}

TEST(Anchor, ReportsTheReasonAndTheNearestNodeIfNoNodeMatches) {
    EditableTree tree(test::stem_with_branches());
    const AnchorFrame frame = anchor_frame(tree);  // 4 m along x
    const Anchor tip = compute_anchor(tree, frame, id(6));
    remove_branches(tree, ids({5}));
    const Binding gone = bind_anchor(tree, frame, tip);
    EXPECT_FALSE(gone.node);
    EXPECT_EQ(gone.nearest, id(4));
    EXPECT_NEAR(gone.distance, 2, 1e-6);
    EXPECT_EQ(gone.reason, "no node is within 0.12 m");
    Anchor other = compute_anchor(tree, frame, id(4));
    other.order = 0;
    EXPECT_EQ(bind_anchor(tree, frame, other).reason, "the order of the axis there is different");
    other.order = 1;
    other.radius *= 3;
    EXPECT_EQ(bind_anchor(tree, frame, other).reason, "the radius there is different");
}

NodeSet held(const EditableTree& tree, const std::string& text) {
    return selected(tree, parse_selection(text));
}

TEST(AnchorText, SelectsExactlyItsNodeInEveryTreeOfTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        const EditableTree tree(skeleton);
        for (const StableId n : tree.nodes()) {
            const std::string text = anchor_text(tree, n);
            EXPECT_EQ(held(tree, text), NodeSet{n}) << name << ": " << text;
        }
    }
}

TEST(AnchorText, IsShortForAUniqueNode) {
    const EditableTree tree(test::stem_with_branches());
    EXPECT_EQ(anchor_text(tree, id(2)), "at(0,0,2,0,0.08)");
    EXPECT_EQ(anchor_text(tree, id(7)), "at(2,1,1,2,0.02)");
}

TEST(AnchorText, DistinguishesIdenticalNodesByTheirIds) {
    const Skeleton one = test::stem_with_branches();
    const EditableTree twice(joined(std::vector{&one, &one}));
    for (const StableId n : twice.nodes()) EXPECT_EQ(held(twice, anchor_text(twice, n)), NodeSet{n});
    EXPECT_TRUE(test::error_of([&] {
                    held(twice, "at(0,0,2,0,0.08)");
                }).starts_with("nodes 2 and 11 are both like at(0,0,2,0,0.08)"));
}

TEST(AnchorText, DoesNotMatchTheNeighboursOfARemovedBranch) {
    const Skeleton s = random_tree(300, 1);
    std::size_t refused = 0;
    for (const NodeId gone : nodes(s)) {
        EditableTree tree(s);
        const StableId n(gone.index());
        if (tree.is_root(n)) continue;
        const std::string text = anchor_text(tree, n);
        NodeSet own = find_axis(tree, n);
        remove_branches(tree, {n});
        try {
            const StableId other = selected_node(tree, parse_selection(text));
            EXPECT_NE(std::ranges::find(own, other), own.end()) << text << " takes " << other.index();
        } catch (const InvalidInput& error) {
            EXPECT_NE(std::string(error.what()).find("the nearest is node"), std::string::npos);
            ++refused;
        }
    }
    EXPECT_GT(refused, 250u);
}

}  // namespace
}  // namespace coppice
