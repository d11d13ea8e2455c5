#include "coppice/measure/union_handles.h"
#include "measure/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "coppice/measure/cone_union.h"

namespace coppice {
namespace {

std::optional<std::int64_t> count(const Skeleton& s) {
    const ConeUnion solid(s, s.origin(), EndShape::flat, EndShape::round);
    return count_union_handles(solid.capsules(), s);
}

/// Trees of chains of nodes.
class Chains {
  public:
    void add(const std::vector<Vec3>& chain, float r) {
        for (std::size_t k = 0; k < chain.size(); ++k) {
            parent_.push_back(k == 0 ? kRoot : NodeId(static_cast<std::uint32_t>(parent_.size() - 1)));
            position_.push_back(chain[k]);
            radius_.push_back(r);
        }
    }
    Skeleton skeleton() const { return {parent_, position_, radius_}; }

  private:
    std::vector<NodeId> parent_;
    std::vector<Vec3> position_;
    std::vector<float> radius_;
};

/// Returns `count` points on an arc about z of the given angle [rad] and radius 1.
std::vector<Vec3> arc(int count, double angle) {
    std::vector<Vec3> out;
    for (int k = 0; k < count; ++k) {
        const double a = angle * k / (count - 1);
        out.emplace_back(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)), 0.0f);
    }
    return out;
}

TEST(CountUnionHandles, OfManyConesInOnePlaceAreNotCounted) {
    Chains chains;
    for (int i = 0; i < 2000; ++i) {
        const auto x = static_cast<float>(1e-4 * i);
        chains.add({{x, 0, 0}, {x, 0, 1}}, 1);
    }
    EXPECT_EQ(count(chains.skeleton()), std::nullopt);
}

TEST(CountUnionHandles, OfTreesWithoutOverlapsIsZero) {
    EXPECT_EQ(count(Skeleton({kRoot}, {{0, 0, 0}}, {1})), 0);
    EXPECT_EQ(
        count(Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(1), NodeId(1)},
                       {{0, 0, 0}, {0, 0, 5}, {0, 0, 9}, {3, 0, 9}, {0, 4, 6}}, {1, 0.9f, 0.8f, 0.3f, 0.2f})),
        0);
    // A soma, with a ball of its own at the root.
    EXPECT_EQ(count(Skeleton({kRoot, NodeId(0), NodeId(0), NodeId(0)},
                             {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}}, {3, 0.2f, 0.2f, 0.1f})),
              0);
}

TEST(CountUnionHandles, OfDenseNodesIsZero) {
    Chains dense;
    dense.add(arc(300, std::numbers::pi), 0.3f);
    EXPECT_EQ(count(dense.skeleton()), 0);
}

TEST(CountUnionHandles, ABranchThatTouchesItsOwnStartMakesARing) {
    // The balls of the ends overlap where the chord of the gap is less than 0.4: at 2 pi - 2 asin(0.2).
    const double closing = 2 * std::numbers::pi - 2 * std::asin(0.2);
    for (const int nodes : {8, 100}) {
        Chains closed, open, filled;
        closed.add(arc(nodes, closing + 0.02), 0.2f);
        open.add(arc(nodes, closing - 0.02), 0.2f);
        filled.add(arc(nodes, closing + 0.02), 1.01f);  // the hole has a radius of at most 1
        EXPECT_EQ(count(closed.skeleton()), 1) << nodes;
        EXPECT_EQ(count(open.skeleton()), 0) << nodes;
        EXPECT_EQ(count(filled.skeleton()), 0) << nodes;
    }
}

TEST(CountUnionHandles, AGridOfRodsHasAHandlePerMesh) {
    Chains grid;
    for (int k = 0; k < 4; ++k) {
        const auto x = static_cast<float>(k);
        grid.add({{x, -1, 0}, {x, 0.4f, 0}, {x, 5, 0}}, 0.1f);
        if (k < 3) grid.add({{-1, x, 0.05f}, {5, x, 0.05f}}, 0.1f);
    }
    EXPECT_EQ(count(grid.skeleton()), 3 * 2);  // 4 by 3 rods
}

TEST(CountUnionHandles, CrossingsInOnePlaneMakeLoopsWithTheFork) {
    // Two limbs leave a stem, and cross twice; each crossing after the fork closes one loop.
    const Skeleton limbs(
        {kRoot, NodeId(0), NodeId(1), NodeId(2), NodeId(3), NodeId(1), NodeId(5), NodeId(6)},
        {{0, 0, -2}, {0, 0, 0}, {2, 0, 2}, {-2, 0, 6}, {3, 0, 11}, {-2, 0, 2}, {2, 0, 6}, {-3, 0, 11}},
        std::vector<float>(8, 0.2f));
    EXPECT_EQ(count(limbs), 2);
}

TEST(CountUnionHandles, ThreeRodsMakeALoopAsLongAsTheTriangleIsOpen) {
    // An equilateral triangle with an inscribed circle of radius 1: sides of 2 sqrt(3).
    const double side = 2 * std::numbers::sqrt3;
    std::vector<Vec3> corner;
    for (int k = 0; k < 3; ++k) {
        const double a = 2 * std::numbers::pi * k / 3;
        corner.emplace_back(static_cast<float>(2 * std::cos(a)), static_cast<float>(2 * std::sin(a)), 0.0f);
    }
    ASSERT_NEAR(distance(corner[0], corner[1]), side, 1e-5);
    for (const auto& [radius, handles] : {std::pair{0.2f, 1}, std::pair{0.99f, 1}, std::pair{1.01f, 0}}) {
        Chains rods;
        for (std::size_t k = 0; k < 3; ++k) rods.add({corner[k], corner[(k + 1) % 3]}, radius);
        EXPECT_EQ(count(rods.skeleton()), handles) << radius;
    }
}

TEST(CountUnionHandles, ACageOfRodsHasAHandlePerFaceExceptOne) {
    // The 12 edges of a cube are a graph with 12 - 8 + 1 independent cycles.
    Chains cube;
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 4; ++k) {
            Vec3 from, to;
            from[(axis + 1) % 3] = to[(axis + 1) % 3] = static_cast<float>(k % 2);
            from[(axis + 2) % 3] = to[(axis + 2) % 3] = static_cast<float>(k / 2);
            to[axis] = 1;
            cube.add({from, to}, 0.1f);
        }
    }
    EXPECT_EQ(count(cube.skeleton()), 5);
}

TEST(CountUnionHandles, ConsidersTapersThatOverlapOutsideTheirClosestPoints) {
    // The closest points of the axes are at the thin end, 1 apart; the balls of radius 2 overlap the other
    // rod.
    const Skeleton s({kRoot, NodeId(0), kRoot, NodeId(2), NodeId(3)},
                     {{0, 0, 1}, {8, 0, 3}, {0, 0, 0}, {8, 0, 0}, {0, 0.1f, -0.4f}},
                     {0.1f, 2.8f, 0.3f, 0.3f, 0.3f});
    EXPECT_EQ(count(s), 0);
}

}  // namespace
}  // namespace coppice
