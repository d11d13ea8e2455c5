#include "coppice/extract/stem/loose_components.h"

#include <gtest/gtest.h>

#include <vector>

namespace coppice {
namespace {

/// Returns a forest of straight segments, each with its two ends.
Skeleton pieces(const std::vector<std::pair<Vec3, Vec3>>& ends) {
    std::vector<NodeId> parents;
    std::vector<Vec3> positions;
    for (const auto& [from, to] : ends) {
        parents.push_back(NodeId::none());
        parents.push_back(NodeId(static_cast<std::uint32_t>(positions.size())));
        positions.push_back(from);
        positions.push_back(to);
    }
    std::vector<float> radii(positions.size(), 0.1f);
    return Skeleton(std::move(parents), std::move(positions), std::move(radii), {1000, 2000, 300});
}

TEST(LooseComponents, ShortPartsAboveTheGroundAreLoose) {
    const Skeleton s = pieces({{{0, 0, 0}, {0, 0, 20}}, {{3, 0, 12}, {4, 0, 12}}, {{0, 2, 9}, {0, 2, 12}}});
    const LooseComponents parts = find_loose_components(s);
    EXPECT_EQ(parts.trees, (std::vector<NodeId>{NodeId(0)}));
    EXPECT_EQ(parts.loose, (std::vector<NodeId>{NodeId(2), NodeId(4)}));
    EXPECT_DOUBLE_EQ(parts.length, 4);
    EXPECT_DOUBLE_EQ(parts.share, 4.0 / 24);
}

TEST(LooseComponents, SmallPartsOnTheGroundAreTrees) {
    // Next to a tall tree: one of 3 m, one at a position 4 m higher because of a slope of 1 in 5, and a
    // stump. The second tree may have its root at its tip.
    const Skeleton s = pieces({{{0, 0, 0}, {0, 0, 20}},
                               {{5, 0, 0.5f}, {5, 0, 3.5f}},
                               {{20, 0, 7}, {20, 0, 4}},
                               {{2, 0, 0}, {2, 0, 1}}});
    EXPECT_EQ(find_loose_components(s).trees, (std::vector<NodeId>{NodeId(0), NodeId(2), NodeId(4)}));
}

TEST(LooseComponents, LongPartsAreTreesAtAnyHeight) {
    const Skeleton s =
        pieces({{{0, 0, 0}, {0, 0, 20}}, {{3, 0, 9}, {3, 0, 14}}, {{-6, 0, 9}, {-6, 0, 13.9f}}});
    EXPECT_EQ(find_loose_components(s).trees, (std::vector<NodeId>{NodeId(0), NodeId(2)}));
}

TEST(LooseComponents, SinglePointsAreTreesIfThereAreNoOtherParts) {
    const Skeleton s({NodeId::none(), NodeId::none()}, {{0, 0, 0}, {0, 0, 9}}, {1, 1});
    const LooseComponents parts = find_loose_components(s);
    EXPECT_EQ(parts.trees.size(), 2u);
    EXPECT_EQ(parts.share, 0);
}

TEST(LooseComponents, PartsPreserveTheirNodesAndIds) {
    const Skeleton s = pieces({{{0, 0, 0}, {0, 0, 20}}, {{3, 0, 12}, {4, 0, 12}}, {{0, 2, 0}, {0, 2, 12}}});
    const Skeleton trees = extract_parts(s, find_loose_components(s).trees);
    ASSERT_EQ(trees.size(), 4u);
    EXPECT_EQ(trees.origin(), s.origin());
    EXPECT_EQ(trees.parent(NodeId(3)), NodeId(2));
    EXPECT_EQ(trees.position(NodeId(3)), Vec3(0, 2, 12));
    EXPECT_EQ(trees.stable_id(NodeId(3)), s.stable_id(NodeId(5)));
}

}  // namespace
}  // namespace coppice
