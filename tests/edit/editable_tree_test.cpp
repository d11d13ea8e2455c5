#include "coppice/edit/editable_tree.h"

#include <gtest/gtest.h>

#include "edit/trees.h"
#include "errors.h"
#include "zoo.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;

TEST(EditableTree, PreservesTheSkeletonOfTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const EditableTree tree(skeleton);
        EXPECT_TRUE(test::same(tree.skeleton(), skeleton));
        EXPECT_TRUE(tree.skeleton().stable_ids().empty());
        for (const NodeId n : nodes(skeleton)) {
            const StableId leader = tree.leader(StableId(n.index()));
            EXPECT_EQ(leader.index(), skeleton.leader(n).index());
        }
    }
}

TEST(EditableTree, PreservesStableIdsInAnyOrder) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                     {0.1f, 0.1f, 0.1f}, {}, {id(7), id(2), id(5)});
    const EditableTree tree(s);
    EXPECT_EQ(tree.slots(), 8u);
    EXPECT_EQ(tree.parent(id(5)), id(2));
    EXPECT_EQ(tree.parent(id(2)), id(7));
    EXPECT_TRUE(test::same(tree.skeleton(), s));  // 2 can only be added after its parent 7
}

TEST(EditableTree, RejectsIdsThatNeedTooMuchMemory) {
    const Skeleton s({NodeId::none()}, {{0, 0, 0}}, {0.1f}, {}, {id(4'000'000'000)});
    EXPECT_EQ(error_of([&] { const EditableTree tree(s); }),
              "the stable ids go up to 4000000000 for 1 nodes; leave them out to number the nodes from 0");
}

TEST(EditableTree, ReportsTheChangesOfAnEdit) {
    EditableTree tree(test::stem_with_branches());
    TreeEdit edit(tree);
    const StableId added = edit.add(id(3), {0, 0, 4}, 0.05f);
    edit.remove_subtree(id(5));
    edit.move(id(8), {-2, 0, 2});
    edit.set_radius(id(4), 0.06f);
    edit.set_parent(id(4), id(2));
    edit.move(id(0), {0, 0, 0});  // its current position: no change
    const EditChange change = edit.commit();
    EXPECT_EQ(added, id(9));
    EXPECT_EQ(change.added, ids({9}));
    EXPECT_EQ(change.removed, ids({5, 6, 7}));
    EXPECT_EQ(change.moved, ids({8}));
    EXPECT_EQ(change.resized, ids({4}));
    EXPECT_EQ(change.reparented, ids({4}));
    const EditChange undone = tree.undo();
    EXPECT_EQ(undone.added, change.removed);
    EXPECT_EQ(undone.removed, change.added);
    EXPECT_EQ(undone.moved, change.moved);
    EXPECT_TRUE(test::same(tree.skeleton(), test::stem_with_branches()));
    EXPECT_EQ(tree.slots(), 9u);
}

TEST(EditableTree, RedoRestoresAnUndoneEdit) {
    EditableTree tree(test::stem_with_branches());
    {
        TreeEdit edit(tree);
        edit.set_parent(id(1), StableId::none());
        edit.remove(id(0));
        edit.commit();
    }
    const Skeleton after = tree.skeleton();
    EXPECT_EQ(after.stable_id(NodeId(0)), id(1));
    tree.undo();
    EXPECT_EQ(tree.redo_depth(), 1u);
    tree.redo();
    EXPECT_TRUE(test::same(tree.skeleton(), after));
    tree.undo();
    TreeEdit edit(tree);
    edit.set_radius(id(3), 0.01f);
    edit.commit();
    EXPECT_EQ(tree.redo_depth(), 0u);
}

TEST(EditableTree, OrdersParentsFirstAfterAGraft) {
    EditableTree tree(test::stem_with_branches());
    TreeEdit edit(tree);
    edit.set_parent(id(2), id(6));
    edit.commit();
    const Skeleton s = tree.skeleton();
    std::vector<StableId> order(s.stable_ids().begin(), s.stable_ids().end());
    EXPECT_EQ(order, (std::vector<StableId>{id(0), id(1), id(4), id(5), id(6), id(2), id(3), id(7), id(8)}));
    EXPECT_TRUE(test::same(EditableTree(s).skeleton(), s));
}

TEST(TreeEdit, DiscardsUncommittedChanges) {
    EditableTree tree(test::stem_with_branches());
    {
        TreeEdit edit(tree);
        edit.remove_subtree(id(4));
        edit.add(id(0), {5, 0, 0}, 1);
        edit.move(id(3), {9, 9, 9});
        edit.move(id(3), {8, 8, 8});
    }
    EXPECT_TRUE(test::same(tree.skeleton(), test::stem_with_branches()));
    EXPECT_EQ(tree.undo_depth(), 0u);
    EXPECT_EQ(tree.slots(), 9u);
}

TEST(TreeEdit, RejectsChangesThatBreakAnInvariant) {
    EditableTree tree(test::stem_with_branches());
    const auto refused = [&](auto change) {
        return error_of([&] {
            TreeEdit edit(tree);
            change(edit);
            edit.commit();
        });
    };
    EXPECT_EQ(refused([&](TreeEdit& e) { e.set_parent(id(1), id(7)); }),
              "node 7 hangs on node 1, so 1 cannot hang on 7: that would be a cycle; choose a node outside "
              "the subtree "
              "of 1");
    EXPECT_EQ(refused([&](TreeEdit& e) { e.set_parent(id(1), id(1)); }),
              "node 1 hangs on node 1, so 1 cannot hang on 1: that would be a cycle; choose a node outside "
              "the subtree "
              "of 1");
    EXPECT_EQ(refused([&](TreeEdit& e) { e.set_radius(id(1), 0); }),
              "node 1 would get the radius 0; enter a radius above 0");
    EXPECT_EQ(refused([&](TreeEdit& e) {
                  e.move(id(1), {0, 0, NAN});
              }),
              "node 1 would get a position that is not finite or beyond 1e15 m; move it less far");
    EXPECT_EQ(refused([&](TreeEdit& e) {
                  e.move(id(2), {0, 0, 1});
              }),
              "node 2 would coincide with its parent 1; move it elsewhere, or delete one of them");
    EXPECT_EQ(refused([&](TreeEdit& e) {
                  e.move(id(8), {0, 0, 3});
              }),
              "node 8 would coincide with its sibling 3; move it elsewhere, or delete one of them");
    EXPECT_EQ(refused([&](TreeEdit& e) { e.remove_subtree(id(0)); }),
              "no node would remain; keep at least one");
    EXPECT_TRUE(test::same(tree.skeleton(), test::stem_with_branches()));
}

TEST(TreeEdit, AcceptsNodesThatCoincidedBefore) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}},
                     {0.1f, 0.1f, 0.1f});
    EditableTree tree(s);
    TreeEdit edit(tree);
    edit.move(id(0), {1, 0, 0});
    edit.move(id(1), {1, 0, 0});
    EXPECT_EQ(edit.commit().moved, ids({0, 1}));
}

TEST(EditableTree, DiscardsTheOldestStepsFirst) {
    EditableTree tree(test::stem_with_branches());
    for (int i = 1; i <= 100; ++i) {
        TreeEdit edit(tree);
        edit.move(id(3), {0, 0, 3 + 0.01f * static_cast<float>(i)});
        edit.commit();
    }
    const std::size_t all = tree.history_bytes();
    EXPECT_LT(all, 100 * 200u);
    tree.limit_history(all / 2);
    EXPECT_NEAR(static_cast<double>(tree.undo_depth()), 50, 2);
    EXPECT_LE(tree.history_bytes(), all / 2);
}

}  // namespace
}  // namespace coppice
