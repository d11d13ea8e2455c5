#include "coppice/edit/bend_apart.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/base/kernel/segment_distance.h"
#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;
using test::ids;

/// A stem along the z axis, and a thin tree of 20 segments of 0.1 m that begins at x = -1 and crosses it.
Skeleton stem_and_branch(float offset) {
    std::vector<NodeId> parent{NodeId::none(), NodeId(0), NodeId(1), NodeId::none()};
    std::vector<Vec3> place{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {-1, offset, 1.5f}};
    std::vector<float> radius{0.1f, 0.1f, 0.1f, 0.02f};
    for (std::uint32_t i = 0; i < 20; ++i) {
        parent.emplace_back(3 + i);
        place.push_back({-1 + 0.1f * static_cast<float>(i + 1), offset, 1.5f});
        radius.push_back(0.02f);
    }
    return {std::move(parent), std::move(place), std::move(radius)};
}

/// Returns the minimum of distance minus radii over segments of different trees.
double min_gap(const Skeleton& s, std::uint32_t first_of_second) {
    double least = 1e30;
    for (const NodeId a : nodes(s)) {
        for (const NodeId b : nodes(s)) {
            if (s.is_root(a) || s.is_root(b) || a.index() >= first_of_second || b.index() < first_of_second)
                continue;
            const Segment f = s.segment(a), g = s.segment(b);
            const double d = segment_distance(Vec3d(f.a), Vec3d(f.b), Vec3d(g.a), Vec3d(g.b));
            least = std::min(least, d - std::max(f.radius_a, f.radius_b) - std::max(g.radius_a, g.radius_b));
        }
    }
    return least;
}

TEST(BendApart, MovesTheThinBranchAndPreservesBoth) {
    for (const float offset : {0.0f, 0.03f, -0.08f}) {
        const Skeleton s = stem_and_branch(offset);
        const BendApartResult r = bend_apart(s);
        EXPECT_GT(r.report.before, 0u);
        EXPECT_EQ(r.report.after, 0u);
        EXPECT_GT(min_gap(r.skeleton, 3), 0);
        // The compliance ratio is (0.02 / 0.1)^2 = 1/25 at equal length, so that the stem hardly moves.
        EXPECT_LT(distance(r.skeleton.position(NodeId(2)), s.position(NodeId(2))), 0.02f);
        EXPECT_EQ(r.skeleton.position(NodeId(0)), s.position(NodeId(0)));
        EXPECT_EQ(r.skeleton.position(NodeId(3)), s.position(NodeId(3)));
        // The branch is moved to the side on which it was.
        const float y = r.skeleton.position(NodeId(13)).y;
        if (offset != 0) {
            EXPECT_GT(y * offset, 0);
        }
        EXPECT_LT(std::abs(y), 0.2f);  // and not farther than necessary: 0.12 and the gap
        // The section beyond the contact keeps its shape.
        const Vec3 before = s.position(NodeId(23)) - s.position(NodeId(20));
        const Vec3 after = r.skeleton.position(NodeId(23)) - r.skeleton.position(NodeId(20));
        EXPECT_LT(distance(before, after), 0.01f);
    }
}

TEST(BendApart, SeparateTreesAndIntersectionsWithinATreeAreUnchanged) {
    const Skeleton apart = stem_and_branch(0.5f);
    EXPECT_TRUE(test::same(bend_apart(apart).skeleton, apart));
    const Skeleton hard = random_tree(300, 5, true);
    const BendApartResult r = bend_apart(hard);
    EXPECT_TRUE(test::same(r.skeleton, hard));
    EXPECT_EQ(r.report.rounds, 0);
}

TEST(BendApart, RootInsideABranchIsUnchangedAndReported) {
    const NodeId none;
    const Skeleton s({none, NodeId(0), none, NodeId(2)}, {{0, 0, 0}, {0, 0, 2}, {0.05f, 0, 0}, {0.05f, 0, 2}},
                     {0.1f, 0.1f, 0.1f, 0.1f});
    const BendApartResult r = bend_apart(s);
    EXPECT_EQ(r.report.after, 1u);
    EXPECT_EQ(r.skeleton.position(NodeId(0)), s.position(NodeId(0)));
    EXPECT_EQ(r.skeleton.position(NodeId(2)), s.position(NodeId(2)));
    // At most half the path length from the root.
    EXPECT_LE(r.report.farthest, 1.0f);
}

TEST(BendApart, MovesOnlyTheSelectionAndCanBeUndone) {
    const Skeleton s = stem_and_branch(0.01f);
    EditableTree tree(s);
    const EditChange change = bend_apart(tree, ids({3}));
    EXPECT_FALSE(change.moved.empty());
    EXPECT_TRUE(change.reparented.empty());
    for (const StableId n : change.moved) EXPECT_GT(n, id(3));
    EXPECT_GT(min_gap(tree.skeleton(), 3), 0);
    tree.undo();
    EXPECT_TRUE(test::same(tree.skeleton(), s));
    // The stem alone cannot move so far: half its path length is enough at its top, but it is thick.
    bend_apart(tree, ids({0}));
    EXPECT_EQ(tree.position(id(13)), s.position(NodeId(13)));
    EXPECT_NE(error_of([&] { bend_apart(tree, ids({})); }), "");
    EXPECT_NE(error_of([&] { bend_apart(tree, ids({3}), {.gap = -1}); }).find("gap"), std::string::npos);
}

TEST(BendApart, SeparatesTwoOverlappingCrowns) {
    const Skeleton one = random_tree(1000, 3, false), two = random_tree(1000, 4, false);
    std::vector<NodeId> parent;
    std::vector<Vec3> place;
    std::vector<float> radius;
    const Vec3 by = (one.bounds().size() + two.bounds().size()) * 0.2f;
    for (const NodeId n : nodes(one)) {
        parent.push_back(one.parent(n));
        place.push_back(one.position(n));
        radius.push_back(one.radius(n));
    }
    for (const NodeId n : nodes(two)) {
        parent.push_back(two.is_root(n) ? NodeId::none() : NodeId(two.parent(n).index() + one.size()));
        place.push_back(two.position(n) + Vec3{by.x, 0, 0});
        radius.push_back(two.radius(n));
    }
    const Skeleton both(std::move(parent), std::move(place), std::move(radius));
    const BendApartResult r = bend_apart(both, {}, {.threads = 1});
    EXPECT_GT(r.report.before, 10u);
    EXPECT_LE(r.report.after, r.report.before / 20);
    EXPECT_TRUE(test::same(r.skeleton, bend_apart(both, {}, {.threads = 7}).skeleton));
}

}  // namespace
}  // namespace coppice
