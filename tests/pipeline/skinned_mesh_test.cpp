#include "coppice/pipeline/deform/skinned_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/edit/animate/wind.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/mesh/shape.h"
#include "coppice/pipeline/deform/valid_frames.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

// The whole tree rotated and moved.
Pose turned_whole(const Skeleton& s, const Rotation& turn, Vec3d by) {
    Pose out = rest_pose(s);
    for (Vec3& p : out.positions) p = Vec3(turn(Vec3d(p)) + by);
    std::ranges::fill(out.turns, turn);
    return out;
}

// One branch, everything carried by node n with its segment, rotated about its joint.
Pose turned_branch(const Skeleton& s, NodeId top, const Rotation& turn) {
    Pose out = rest_pose(s);
    std::vector<std::uint8_t> hangs(s.size());
    const Vec3d joint(s.position(s.parent(top)));
    for (const NodeId n : nodes(s)) {
        const bool is_below = n == top || (!s.is_root(n) && hangs[s.parent(n).index()] != 0);
        if (!is_below) continue;
        hangs[n.index()] = 1;
        out.positions[n.index()] = Vec3(joint + turn(Vec3d(s.position(n)) - joint));
        out.turns[n.index()] = turn;
    }
    return out;
}

QuadMesh with_positions(const SkinnedMesh& mesh, const Buffer<Vec3>& positions) {
    QuadMesh out = mesh.made().quads().mesh;
    out.positions = positions;
    return out;
}

std::size_t crossings(const QuadMesh& mesh) {
    return crossing_faces(SurfaceTree(to_polygons(mesh)), 1000).pairs.size();
}

float max_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, distance(a[i], b[i]));
    return most;
}

TEST(SkinnedMesh, RestPoseIsBitIdenticalToTheSurface) {
    const Skeleton s = random_tree(120, 4);
    SkinnedMesh mesh(s);
    EXPECT_EQ(mesh.deform(rest_pose(s)).positions, mesh_skeleton(s).quads().mesh.positions);
}

TEST(SkinnedMesh, MovesWholeTreesRigidly) {
    const Rotation turn = rotation_about(normalized(Vec3d{1, 2, 3}), 0.7);
    const Vec3d by{2, -1, 0.5};
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        SkinnedMesh mesh(skeleton);
        const SkinnedFrame frame = mesh.deform(turned_whole(skeleton, turn, by));
        const Buffer<Vec3>& rest = mesh.made().quads().mesh.positions;
        const Box3 box = skeleton.bounds();
        float most = 0;
        int far = 0;  // in a crotch, where a ray grazes the surface
        for (std::size_t v = 0; v < rest.size(); ++v) {
            const float off = distance(frame.positions[v], Vec3(turn(Vec3d(rest[v])) + by));
            far += off > 4e-3f * (box.diagonal() + 1) ? 1 : 0;
            most = std::max(most, off);
        }
        EXPECT_LE(far, 1);
        EXPECT_LT(most, 2e-2f * (box.diagonal() + 1));
    }
}

TEST(SkinnedMesh, MatchesTheFieldOfThePose) {
    // A branch far from its joint has the same surface as a new one built there.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(2), NodeId(1), NodeId(4)},
                     {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {0, 0, 6}, {2, 0, 3}, {4, 0, 4}},
                     {0.3f, 0.3f, 0.25f, 0.2f, 0.15f, 0.15f});
    SkinnedMesh mesh(s);
    const Pose pose = turned_branch(s, NodeId(4), rotation_about({0, 0, 1}, 0.5));
    const SkinnedFrame frame = mesh.deform(pose);
    EXPECT_TRUE(frame.is_sound());
    EXPECT_LT(frame.projected.not_converged, 10u);
    const Skeleton now = posed(s, pose);
    double sum = 0;
    std::size_t count = 0;
    const Segment far = now.segment(NodeId(5));
    const Vec3 axis = (far.b - far.a) / distance(far.a, far.b);
    for (const Vec3 p : frame.positions) {
        const float along = dot(p - far.a, axis);
        const float away = length(p - far.a - axis * along);
        if (along < 0.5f || along > 1.5f || away > 0.5f) continue;
        sum += double{away};
        ++count;
    }
    ASSERT_GT(count, 20u);
    EXPECT_NEAR(sum / static_cast<double>(count), 0.15, 0.002);
}

TEST(SkinnedMesh, IsBitIdenticalForAnyNumberOfThreads) {
    const Skeleton s = random_tree(200, 5);
    const Pose pose = Wind(s, {.speed = 15, .flexibility = 10}, 8, 10).swayed(rest_pose(s), 2);
    Buffer<Vec3> first;
    for (const unsigned threads : {1u, 2u, 7u}) {
        const Context ctx{.threads = threads, .stop = {}, .progress = {}};
        SkinnedMesh mesh(s, {}, ctx);
        const SkinnedFrame frame = mesh.deform(pose, {}, ctx);
        if (first.empty()) first = frame.positions;
        EXPECT_EQ(frame.positions, first);
    }
}

TEST(SkinnedMesh, ScalesWithTheRadii) {
    const Skeleton s({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 3}}, {0.2f, 0.2f});
    SkinnedMesh mesh(s);
    Pose pose = rest_pose(s);
    for (float& r : pose.radii) r *= 2;
    const SkinnedFrame frame = mesh.deform(pose);
    float widest = 0;
    for (const Vec3 p : frame.positions) widest = std::max(widest, length(Vec3{p.x, p.y, 0}));
    EXPECT_NEAR(widest, 0.4f, 0.01f);
}

TEST(SkinnedMesh, RejectsOtherMethods) {
    const Skeleton s = random_tree(20, 1);
    EXPECT_THROW(SkinnedMesh(s, {.method = MeshMethod::cylinders}), InvalidInput);
    MeshOptions global;
    global.field.weights = Weights::global;
    EXPECT_THROW(SkinnedMesh(s, global), InvalidInput);
}

TEST(ValidFrames, HaveNoFoldsOrSelfIntersections) {
    const Skeleton s = random_tree(150, 6);
    SkinnedMesh mesh(s);
    const QuadMesh& rest = mesh.made().quads().mesh;
    ASSERT_EQ(shape(rest).inverted_faces, 0u);
    ASSERT_EQ(crossings(rest), 0u);
    const Wind wind(s, {.speed = 30, .flexibility = 40}, 4, 2);
    ValidFrames frames(mesh);
    int frozen = 0;
    for (int i = 0; i < 6; ++i) {
        const ValidFrame frame = frames.next(wind.swayed(rest_pose(s), 0.6 * i));
        frozen += frame.is_frozen() ? 1 : 0;
        const QuadMesh now = with_positions(mesh, frame.positions);
        EXPECT_EQ(shape(now).inverted_faces, 0u);
        EXPECT_EQ(crossings(now), 0u);
    }
    EXPECT_GT(frozen, 0) << "the wind is too weak for this test";
}

TEST(ValidFrames, FreezeOnlyTheBranchThatWouldIntersect) {
    // Two parallel branches; one is rotated through the other; a distant third one moves freely.
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(1), NodeId(4)},
                     {{0, 0, 0}, {0, 0, 3}, {3, 0.6f, 4}, {3, -0.6f, 4}, {0, 0, 5}, {-3, 0, 6}},
                     {0.3f, 0.25f, 0.1f, 0.1f, 0.2f, 0.1f});
    SkinnedMesh mesh(s);
    Pose wanted = turned_branch(s, NodeId(2), rotation_about({0, 0, 1}, -0.39));
    const Pose other = turned_branch(s, NodeId(5), rotation_about({0, 0, 1}, 0.3));
    wanted.positions[5] = other.positions[5];
    wanted.turns[5] = other.turns[5];
    ValidFrames frames(mesh);
    const ValidFrame frame = frames.next(wanted);
    EXPECT_GT(frame.crossings, 0u);
    EXPECT_TRUE(frame.is_frozen());
    EXPECT_FALSE(frame.whole_tree_frozen);
    // It has moved from rest until the two met, and not beyond.
    EXPECT_LT(frame.pose.positions[2].y, 0.6f);
    EXPECT_GT(frame.pose.positions[2].y, -0.4f);
    EXPECT_LT(distance(frame.pose.positions[5], wanted.positions[5]), 1e-5f);
    EXPECT_EQ(crossings(with_positions(mesh, frame.positions)), 0u);
}

TEST(ValidFrames, ContinueWhenThePoseIsSoundAgain) {
    const Skeleton s({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                     {{0, 0, 0}, {0, 0, 3}, {3, 0.6f, 4}, {3, -0.6f, 4}}, {0.3f, 0.25f, 0.1f, 0.1f});
    SkinnedMesh mesh(s);
    ValidFrames frames(mesh);
    EXPECT_TRUE(frames.next(turned_branch(s, NodeId(2), rotation_about({0, 0, 1}, -0.39))).is_frozen());
    const Pose back = turned_branch(s, NodeId(2), rotation_about({0, 0, 1}, 0.05));
    const ValidFrame frame = frames.next(back);
    EXPECT_FALSE(frame.is_frozen());
    EXPECT_LT(max_distance(frame.pose.positions, back.positions), 1e-6f);
}

}  // namespace
}  // namespace coppice
