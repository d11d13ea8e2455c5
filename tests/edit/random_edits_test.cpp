// Thousands of random edits of every kind, on every skeleton of the zoo and on grown trees: each preserves
// the invariants, or is refused with a sentence and leaves the tree unchanged, and undoing all of them
// restores a bit-identical tree.

#include <gtest/gtest.h>

#include <functional>
#include <iterator>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/base/sort.h"
#include "coppice/edit/cut.h"
#include "coppice/edit/deform.h"
#include "coppice/edit/join.h"
#include "coppice/edit/rigid.h"
#include "coppice/edit/thickness.h"
#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "zoo.h"

namespace coppice {
namespace {

/// Sequence of random numbers.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : random_(seed, 0) {}
    double uniform(double low, double high) { return random_.uniform(next_++, low, high); }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_.bits(next_++) % n); }
    Vec3d vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    StableId node(const EditableTree& tree) {
        const NodeSet all = tree.nodes();
        return all[below(all.size())];
    }
    NodeSet some(const EditableTree& tree) {
        NodeSet out{node(tree), node(tree), node(tree)};
        sort_unique(out);
        return out;
    }

  private:
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

using Edit = std::function<EditChange(EditableTree&, Dice&)>;

std::vector<Edit> all_edits() {
    using T = EditableTree;
    return {
        [](T& t, Dice& d) { return translate(t, d.some(t), d.vector(1)); },
        [](T& t, Dice& d) {
            return rotate(t, d.some(t), {d.uniform(-3, 3), static_cast<TurnAxis>(d.below(4)), d.vector(1)});
        },
        [](T& t, Dice& d) { return scale(t, d.some(t), d.uniform(0.5, 1.6)); },
        [](T& t, Dice& d) { return mirror(t, d.some(t), d.vector(1), t.size() < 500 && d.below(2) == 0); },
        [](T& t, Dice& d) { return bend(t, d.some(t), d.uniform(-2, 2), d.vector(1)); },
        [](T& t, Dice& d) { return twist(t, d.some(t), d.uniform(-2, 2)); },
        [](T& t, Dice& d) { return straighten(t, d.some(t), d.uniform(0, 1)); },
        [](T& t, Dice&) { return smooth(t, t.nodes(), 2); },
        [](T& t, Dice& d) {
            const StableId n = d.node(t);
            const Vec3d to = t.origin() + Vec3d(t.position(n)) + d.vector(0.3);
            return move_node(t, n, to, d.uniform(0, 2));
        },
        [](T& t, Dice& d) { return split(t, d.some(t), 2); },
        [](T& t, Dice& d) { return split_at(t, d.some(t), d.uniform(0.1, 0.9)); },
        [](T& t, Dice& d) { return detach(t, d.some(t)); },
        [](T& t, Dice& d) { return remove_branches(t, {d.node(t)}); },
        [](T& t, Dice& d) { return dissolve(t, d.some(t)); },
        [](T& t, Dice& d) {
            return resample(t, t.subtree(d.node(t)).size() > 1 ? t.nodes() : d.some(t), d.uniform(0.2, 0.5));
        },
        [](T& t, Dice& d) { return prune(t, t.nodes(), {.length = static_cast<float>(d.uniform(0, 0.05))}); },
        [](T& t, Dice& d) {
            const std::vector<Vec3d> points{t.origin() + Vec3d(t.position(d.node(t))), d.vector(3),
                                            d.vector(3)};
            return draw(t, points, {.alone = d.below(4) == 0});
        },
        [](T& t, Dice& d) { return append(t, d.node(t), d.vector(1)); },
        [](T& t, Dice& d) {
            return graft(t, d.node(t), d.node(t), {d.uniform(0, 1), d.below(2) == 0});
        },
        [](T& t, Dice&) { return attach(t, t.nodes()); },
        [](T& t, Dice&) { return attach(t, t.nodes(), Crossings::join); },
        [](T& t, Dice& d) { return set_radii(t, d.some(t), d.uniform(0.01, 0.1)); },
        [](T& t, Dice& d) { return scale_radii(t, d.some(t), d.uniform(0.5, 1.5)); },
        [](T& t, Dice& d) { return taper(t, d.some(t), d.uniform(0, 0.1), d.uniform(0, 0.1)); },
        [](T& t, Dice&) { return smooth_radii(t, t.nodes(), 1); },
        [](T& t, Dice& d) { return pipe_radii(t, d.some(t), 2.3); },
    };
}

/// Checks the members of a state that depend on ids, without using the links of the tree.
void expect_sound(const EditableTree& tree) {
    const Skeleton s = tree.skeleton();  // throws if parents, positions or radii are invalid
    ASSERT_EQ(s.size(), tree.size());
    std::uint32_t linked = 0;
    for (StableId root = tree.first_root(); root; root = tree.next_sibling(root)) {
        tree.visit_subtree(root, [&](StableId n) {
            ++linked;
            if (!tree.is_root(n)) {
                ASSERT_TRUE(tree.contains(tree.parent(n)));
            }
            if (const StableId next = tree.next_sibling(n)) {
                ASSERT_LT(n, next);
            }
        });
    }
    ASSERT_EQ(linked, tree.size());
}

/// Compares a change with the difference between two states.
void expect_reported(const EditChange& change, const Skeleton& before, const EditableTree& after) {
    const EditableTree was(before);
    EditChange truth;
    for (std::uint32_t i = 0; i < std::max(was.slots(), after.slots()); ++i) {
        const StableId n(i);
        const bool there = was.contains(n), here = after.contains(n);
        if (here && !there) truth.added.push_back(n);
        if (there && !here) truth.removed.push_back(n);
        if (!there || !here) continue;
        if (was.position(n) != after.position(n)) truth.moved.push_back(n);
        if (was.radius(n) != after.radius(n)) truth.resized.push_back(n);
        if (was.parent(n) != after.parent(n)) truth.reparented.push_back(n);
    }
    ASSERT_EQ(change.added, truth.added);
    ASSERT_EQ(change.removed, truth.removed);
    ASSERT_EQ(change.moved, truth.moved);
    ASSERT_EQ(change.resized, truth.resized);
    ASSERT_EQ(change.reparented, truth.reparented);
}

int run_random_edits(const Skeleton& first, std::uint64_t seed, int count) {
    const std::vector<Edit> edits = all_edits();
    EditableTree tree(first);
    Dice dice(seed);
    int made = 0;
    std::vector<Skeleton> states{first};
    for (int i = 0; i < count; ++i) {
        const std::size_t which = dice.below(edits.size());
        SCOPED_TRACE(testing::Message() << "edit " << i << " of kind " << which);
        const std::size_t depth = tree.undo_depth();
        try {
            const EditChange change = edits[which](tree, dice);
            expect_reported(change, states.back(), tree);
            if (!change.empty()) ++made;
        } catch (const InvalidInput& error) {
            EXPECT_EQ(tree.undo_depth(), depth);
            EXPECT_TRUE(test::same(tree.skeleton(), states.back())) << error.what();
        }
        if (tree.size() > 2000) tree.undo();
        expect_sound(tree);
        if (testing::Test::HasFatalFailure()) return made;
        states.resize(tree.undo_depth() + 1, first);
        states.back() = tree.skeleton();
    }
    for (std::size_t depth = tree.undo_depth(); depth-- > 0;) {
        tree.undo();
        EXPECT_TRUE(test::same(tree.skeleton(), states[depth])) << "at depth " << depth;
    }
    EXPECT_EQ(tree.slots(), EditableTree(first).slots());
    while (tree.redo_depth() > 0) tree.redo();
    EXPECT_TRUE(test::same(tree.skeleton(), states.back()));
    return made;
}

TEST(RandomEdits, PreserveInvariantsOnEverySkeletonOfTheZoo) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        if (skeleton.size() > 2000) continue;
        EXPECT_GT(run_random_edits(skeleton, 1, 60), 5);
    }
}

TEST(RandomEdits, ThousandsAreUndoneExactly) {
    int made = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE(seed);
        made += run_random_edits(test::stem_with_branches(), seed, 250);
    }
    EXPECT_GT(made, 2000);
}

}  // namespace
}  // namespace coppice
