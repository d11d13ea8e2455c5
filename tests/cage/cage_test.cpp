#include "coppice/cage/cage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "coppice/cage/graft.h"
#include "coppice/cage/separate_branches.h"
#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

std::vector<NodeId> same_nodes(const Skeleton& s) {
    std::vector<NodeId> ids;
    for (const NodeId n : nodes(s)) ids.push_back(n);
    return ids;
}

ControlMesh compute_cage(const Skeleton& s, const ControlOptions& options = {}, unsigned threads = 2) {
    Context ctx;
    ctx.threads = threads;
    return build_control_mesh(s, same_nodes(s), options, ctx);
}

void expect_spheres(const ControlMesh& m, std::uint32_t trees) {
    const TopologyReport t = topology(m.cage);
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.components, trees);
    EXPECT_EQ(t.euler, 2 * static_cast<std::int64_t>(trees));
    EXPECT_EQ(t.vertices, m.cage.positions.size()) << "every vertex is used";
}

TEST(BuildControlMesh, EverySkeletonInTheZooHasOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ControlMesh m = compute_cage(skeleton);
        expect_spheres(m, skeleton.tree_count());
        for (std::size_t v = 0; v < m.anchors.size(); ++v) {
            ASSERT_TRUE(is_finite(m.cage.positions[v]));
            ASSERT_TRUE(is_finite(m.anchors[v]));
        }
    }
}

TEST(BuildControlMesh, EveryPartedSkeletonInTheZooHasOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const SeparatedSkeleton parted = separate_branches(skeleton, {}, {});
        EXPECT_EQ(parted.skeleton.tree_count(), skeleton.tree_count());
        expect_spheres(build_control_mesh(parted.skeleton, parted.source, {}, {}), skeleton.tree_count());
    }
}

// Each join merges two bodies, or creates a handle.
void expect_merged(const Skeleton& skeleton) {
    const GraftResult grafted = graft_branches(skeleton, 0.6f, SectionEnd::joined, {});
    const SeparatedSkeleton parted = separate_branches(grafted.tubes, grafted.joins, {});
    const ControlMesh m =
        build_control_mesh(parted.skeleton, parted.source, {}, {}, parted.round_roots, parted.joins);
    const TopologyReport t = topology(m.cage);
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.vertices, m.cage.positions.size()) << "every vertex is used";
    EXPECT_EQ(t.euler, 2 * (static_cast<std::int64_t>(parted.skeleton.tree_count()) -
                            static_cast<std::int64_t>(parted.joins.size())));
    for (const NodeJoin& join : m.joins) {
        EXPECT_TRUE(parted.skeleton.is_tip(join.end));
        EXPECT_EQ(parted.skeleton.position(join.end), parted.skeleton.position(join.node));
    }
}

TEST(BuildControlMesh, MergedBranchesHaveOneClosedCage) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        expect_merged(skeleton);
    }
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        SCOPED_TRACE(seed);
        expect_merged(random_tree(400, seed, true));
    }
}

// Two equal limbs: the faces left and right of one are those through which the other leaves.
TEST(BuildControlMesh, ACrossingHasEightVerticesOfValenceFive) {
    const NodeId none;
    const Skeleton s({none, NodeId(0), NodeId(1), none, NodeId(3), NodeId(1)},
                     {{0, 0, -1}, {0, 0, 0}, {0, 0, 1}, {-1, 0, 0.2f}, {0, 0, 0}, {1, 0, -0.2f}},
                     {0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f});
    const std::vector<NodeJoin> joins{{NodeId(4), NodeId(1)}};
    const ControlMesh m = build_control_mesh(s, same_nodes(s), {.base = BaseShape::round}, {}, {}, joins);
    const TopologyReport t = topology(m.cage);
    EXPECT_TRUE(t.watertight());
    EXPECT_EQ(t.components, 1u);
    EXPECT_EQ(t.euler, 2);
    EXPECT_EQ(t.irregular_vertices, 8u + 4 * 4);
    EXPECT_EQ(std::ranges::count(m.part, TubeFace::fork), 2);
}

TEST(BuildControlMesh, EveryNumberOfSidesIsClosed) {
    for (const int sides : {4, 8, 16}) {
        for (const auto& [name, skeleton] : skeleton_zoo()) {
            SCOPED_TRACE(name + " with " + std::to_string(sides) + " sides");
            expect_spheres(compute_cage(skeleton, {.sides = sides}), skeleton.tree_count());
        }
    }
}

TEST(BuildControlMesh, AChainHasOneRingPerNodeAndACapAtEachEnd) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}},
                     {0.1f, 0.1f, 0.1f});
    const ControlOptions round{.base = BaseShape::round};
    EXPECT_EQ(compute_cage(s, round).cage.positions.size(), 3u * 4);
    EXPECT_EQ(compute_cage(s, round).cage.quads.size(), 2u * 4 + 2);
    EXPECT_EQ(compute_cage(s, {.sides = 8, .base = BaseShape::round}).cage.quads.size(), 2u * 8 + 2 * 4);
}

// A stem, its leader, and laterals that leave it.
Skeleton stem_with(const std::vector<Vec3>& laterals, float lateral_radius) {
    std::vector<NodeId> parent{NodeId::none(), NodeId(0), NodeId(1)};
    std::vector<Vec3> position{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}};
    std::vector<float> radius{0.1f, 0.1f, 0.1f};
    for (const Vec3 direction : laterals) {
        parent.push_back(NodeId(1));
        position.push_back(Vec3{0, 0, 1} + direction);
        radius.push_back(lateral_radius);
    }
    return {parent, position, radius};
}

// A fork only adds two poles of valence 6; each tip adds the four corners of its cap.
TEST(BuildControlMesh, ForkHasTwoExtraordinaryVertices) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 1}, {1, 0, 1.7f}, {-1, 0, 1.7f}}, {0.1f, 0.1f, 0.08f, 0.08f});
    const ControlMesh m = compute_cage(s, {.base = BaseShape::round});
    EXPECT_EQ(m.cage.quads.size(), 3u * 4 + 3);
    EXPECT_EQ(topology(m.cage).irregular_vertices, 2u + 3 * 4);
}

// Four vertices of valence 5; a thick one occupies one of the four faces around the node, a thin one leaves a
// ring of four within it.
TEST(BuildControlMesh, LateralStartsAtAnOpening) {
    for (const float radius : {0.07f, 0.04f, 0.005f}) {
        for (const Vec3 direction : {Vec3{1, 0, 0}, Vec3{0.3f, 0.6f, 0.7f}, Vec3{-0.5f, 0.6f, -0.4f}}) {
            SCOPED_TRACE(radius);
            const Skeleton s = stem_with({direction}, radius);
            const ControlMesh m = compute_cage(s, {.base = BaseShape::round});
            expect_spheres(m, 1);
            EXPECT_EQ(m.cage.quads.size(), 3u * 4 + 3 + (radius < 0.05f ? 7 : 3));
            EXPECT_EQ(topology(m.cage).irregular_vertices, 4u + 3 * 4);
            EXPECT_EQ(std::ranges::count(m.part, TubeFace::fork), radius < 0.05f ? 7 : 3);
        }
    }
}

// The rings of the stem and its leader are perpendicular to them, for any direction of the lateral.
TEST(BuildControlMesh, RingsNextToAnOpeningArePerpendicularToTheStem) {
    const Skeleton s = stem_with({{0.4f, 0.3f, 0.5f}}, 0.05f);
    const ControlMesh m = compute_cage(s, {.base = BaseShape::round});
    for (std::size_t f = 0; f < m.cage.quads.size(); ++f) {
        if (m.part[f] != TubeFace::side || m.region[f] == 3) continue;
        const Quad& q = m.cage.quads[f];
        const auto z = [&](std::size_t k) { return m.cage.positions[q[k]].z; };
        EXPECT_NEAR(z(0), z(1), 1e-6f);
        EXPECT_NEAR(z(2), z(3), 1e-6f);
        EXPECT_GT(z(2), z(1));
    }
}

// If two leave on opposite sides, each has a face; if there is no room for one, a hub replaces it.
TEST(BuildControlMesh, SeveralLateralsShareTheFacesOfANode) {
    const auto with = [](const std::vector<Vec3>& laterals) {
        const ControlMesh m = compute_cage(stem_with(laterals, 0.03f), {.base = BaseShape::round});
        expect_spheres(m, 1);
        return std::ranges::count(m.part, TubeFace::fork);
    };
    EXPECT_EQ(with({{1, 0, 0}, {-1, 0, 0}}), 2 + 2 * 4);
    EXPECT_EQ(with({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}), 4 * 4);
    EXPECT_EQ(with({{1, 0, 0}, {1, 0.1f, 0.3f}}), 0) << "both through one face";
    EXPECT_EQ(with({{0.05f, 0, 1}}), 0) << "along the leader";
}

TEST(BuildControlMesh, OpenBaseHasOneHoleOfFourEdges) {
    const Skeleton s({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 1}}, {0.1f, 0.1f});
    const ControlMesh m = compute_cage(s, {.base = BaseShape::open});
    const TopologyReport t = topology(m.cage);
    EXPECT_EQ(t.open_edges, 4u);
    EXPECT_EQ(t.non_manifold_edges, 0u);
    EXPECT_EQ(t.euler, 1);
    EXPECT_TRUE(m.clip.empty());
    for (std::size_t v = 0; v < 4; ++v) EXPECT_EQ(m.cage.positions[v].z, 0) << "the border is in the plane";
}

TEST(BuildControlMesh, BaseIsFlatByDefault) {
    const Skeleton s = zoo_skeleton("one_segment");
    EXPECT_EQ(compute_cage(s).clip.size(), 1u);
    EXPECT_TRUE(compute_cage(s, {.base = BaseShape::round}).clip.empty());
}

// Both ends of a single segment, with all quads in one region.
TEST(BuildControlMesh, FlatEndsAreCutAtTheirNodes) {
    const Skeleton s({NodeId::none(), NodeId(0)}, {{0, 0, 1}, {0, 0, 3}}, {0.1f, 0.1f});
    for (const int sides : {4, 8, 16}) {
        SCOPED_TRACE(sides);
        const ControlMesh m =
            compute_cage(s, {.sides = sides, .tips = TipShape::flat, .base = BaseShape::flat});
        ASSERT_EQ(m.clip.size(), 2u);
        EXPECT_EQ(m.clip[0].normal, (Vec3{0, 0, -1}));
        EXPECT_FLOAT_EQ(m.clip[0].offset, -1);
        EXPECT_EQ(m.clip[1].normal, (Vec3{0, 0, 1}));
        EXPECT_FLOAT_EQ(m.clip[1].offset, 3);
        // A ring around a grid; the rim, where it meets the tube, is in the plane, with its anchors.
        const auto across = static_cast<std::uint32_t>(sides) / 4;
        for (const ClipPlane& clip : m.clip) {
            EXPECT_EQ(clip.quad_count, static_cast<std::uint32_t>(sides) + across * across);
            std::vector<int> uses(m.cage.positions.size(), 0);
            for (std::uint32_t q = 0; q < m.cage.quads.size(); ++q) {
                const bool in_cap = q - clip.first_quad < clip.quad_count;
                for (const std::uint32_t v : m.cage.quads[q]) uses[v] |= in_cap ? 1 : 2;
            }
            EXPECT_EQ(std::count(uses.begin(), uses.end(), 3), sides);
            for (std::size_t v = 0; v < uses.size(); ++v) {
                if (uses[v] != 3) continue;
                EXPECT_NEAR(dot(clip.normal, m.cage.positions[v]), clip.offset, 1e-6f);
                EXPECT_NEAR(dot(clip.normal, m.anchors[v]), clip.offset, 1e-6f);
            }
        }
    }
}

TEST(BuildControlMesh, EverySkeletonWithFlatEndsHasOneSpherePerTree) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const ControlMesh m = compute_cage(skeleton, {.tips = TipShape::flat, .base = BaseShape::flat});
        expect_spheres(m, skeleton.tree_count());
        EXPECT_EQ(m.clip.empty(), name == "single_node");  // a ball, which has no ends to be cut
        std::uint64_t taken = 0;
        for (const ClipPlane& clip : m.clip) {
            EXPECT_GE(clip.first_quad, taken);
            taken = clip.first_quad + clip.quad_count;
            EXPECT_NEAR(length(clip.normal), 1, 1e-5f);
        }
        EXPECT_LE(taken, m.cage.quads.size());
    }
}

TEST(BuildControlMesh, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton s = zoo_skeleton("random_large_hard");
    const ControlMesh one = compute_cage(s, {}, 1);
    for (const unsigned threads : {2u, 7u}) {
        const ControlMesh m = compute_cage(s, {}, threads);
        EXPECT_EQ(m.cage.positions, one.cage.positions);
        EXPECT_EQ(m.cage.quads, one.cage.quads);
        EXPECT_EQ(m.anchors, one.anchors);
    }
}

TEST(BuildControlMesh, RejectsSixSides) {
    EXPECT_THROW(compute_cage(zoo_skeleton("one_segment"), {.sides = 6}), InvalidInput);
}

}  // namespace
}  // namespace coppice
