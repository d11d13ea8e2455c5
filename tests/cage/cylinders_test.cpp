#include "coppice/cage/cylinders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "zoo.h"

namespace coppice {
namespace {

Skeleton chain(std::vector<Vec3> positions, std::vector<float> radii) {
    std::vector<NodeId> parents{NodeId::none()};
    for (std::uint32_t i = 1; i < positions.size(); ++i) parents.push_back(NodeId(i - 1));
    return Skeleton(parents, std::move(positions), std::move(radii));
}

/// Returns the number of roots and of children that are not the leader of their parent; each has a tube.
std::uint32_t find_axes(const Skeleton& s) {
    std::uint32_t axes = 0;
    for (const NodeId n : nodes(s)) axes += s.is_root(n) || s.leader(s.parent(n)) != n;
    return axes;
}

TEST(Cylinders, EveryTubeOfTheZooIsClosed) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        for (const int sides : {3, 4, 5, 6, 16, 32}) {
            SCOPED_TRACE(name + ", sides " + std::to_string(sides));
            for (const auto base : {BaseShape::flat, BaseShape::round}) {
                const CylinderMesh made = cylinders(skeleton, {.sides = sides, .rows = 2, .base = base});
                const TopologyReport t = topology(made.mesh);
                EXPECT_TRUE(t.watertight());
                EXPECT_EQ(t.components, find_axes(skeleton));
                EXPECT_EQ(t.components, made.report.tubes);
                EXPECT_EQ(t.euler, 2 * static_cast<std::int64_t>(t.components));
                EXPECT_EQ(t.vertices, made.mesh.positions.size());
                EXPECT_TRUE(sides % 2 == 1 || t.quads == t.faces);
            }
        }
    }
}

// Texture coordinates: around the axis, the faces divide the range without inversions; along the axis, the
// range extends from cap to cap.
TEST(Cylinders, TextureCoordinatesHaveNoInversions) {
    for (const int sides : {3, 4, 5, 16}) {
        SCOPED_TRACE(sides);
        const CylinderMesh made =
            cylinders(chain({{0, 0, 0}, {0, 0, 2}, {0, 0, 3}}, {0.5f, 0.5f, 0.25f}), {.sides = sides});
        ASSERT_EQ(made.texture.size(), made.mesh.corners.size());
        double area = 0;
        for (std::uint32_t f = 0; f < made.mesh.face_count(); ++f) {
            const std::uint32_t first = made.mesh.first[f], end = made.mesh.first[f + 1];
            double turned = 0;
            for (std::uint32_t i = first; i < end; ++i) {
                const TexturePoint a = made.texture[i], b = made.texture[i + 1 < end ? i + 1 : first];
                EXPECT_GE(a.u, 0.0f);
                EXPECT_LE(a.u, 1.0f);
                turned += (double{a.u} * double{b.v} - double{b.u} * double{a.v}) / 2;
            }
            EXPECT_GE(turned, -1e-7);
            area += turned;
        }
        // The length of the lateral surface, 2 + sqrt(1 + 0.0625), over the circumference; in addition half
        // of the area of caps at their poles, and no area of discs with few sides.
        const double around = std::numbers::pi;
        EXPECT_GT(area, 3 / around);
        EXPECT_LT(area, (3 + 0.5 + std::numbers::pi / 8) / around);
    }
}

TEST(Cylinders, VerticesAreOnTheCylinderAndItsEnds) {
    const Skeleton bar = chain({{0, 0, 0}, {0, 0, 3}}, {0.5f, 0.5f});
    const CylinderMesh made = cylinders(bar, {.sides = 16, .rows = 3});
    float low = 1, high = 0;
    for (const Vec3 p : made.mesh.positions) {
        low = std::min(low, p.z);
        high = std::max(high, p.z);
        // On the lateral surface, in the disc of the base, or on the hemisphere beyond the tip.
        if (p.z > 0 && p.z <= 3) {
            EXPECT_NEAR(std::hypot(p.x, p.y), 0.5, 1e-6);
        }
        if (p.z > 3) {
            EXPECT_NEAR(length(p - Vec3(0, 0, 3)), 0.5, 1e-6);
        }
    }
    EXPECT_EQ(low, 0);
    EXPECT_FLOAT_EQ(high, 3.5f);
    // A prism of 16 sides has the area 16 / 2 sin(2 pi / 16) r^2 = 0.7654 over 3 m; the cap has less than the
    // volume of a hemisphere, 2 / 3 pi r^3 = 0.2618, and more than nine tenths of it.
    const double prism = 8 * std::sin(std::numbers::pi / 8) * 0.25 * 3;
    EXPECT_GT(shape(made.mesh).signed_volume, prism + 0.9 * 0.2618);
    EXPECT_LT(shape(made.mesh).signed_volume, prism + 0.2618);
}

TEST(Cylinders, OpenBaseIsOneHole) {
    const Skeleton bar = chain({{0, 0, 0}, {0, 0, 3}}, {0.5f, 0.5f});
    const TopologyReport t = topology(cylinders(bar, {.sides = 9, .base = BaseShape::open}).mesh);
    EXPECT_EQ(t.open_edges, 9u);
    EXPECT_EQ(t.non_manifold_edges, 0u);
}

// The spline passes through the nodes; for collinear nodes with uneven distances it is straight and
// monotonic.
TEST(Cylinders, SplinePassesThroughTheNodesWithoutLoops) {
    const Skeleton uneven = chain({{0, 0, 0}, {0, 0, 4}, {0, 0, 4.05f}, {0, 0, 9}}, {1, 1, 1, 1});
    const CylinderMesh made =
        cylinders(uneven, {.sides = 4, .rows = 8, .tips = TipShape::flat, .base = BaseShape::open});
    const std::size_t rings = made.mesh.positions.size() / 4;
    ASSERT_EQ(rings, 3u * 8 + 1);
    for (std::size_t r = 1; r < rings; ++r)
        EXPECT_GT(made.mesh.positions[4 * r].z, made.mesh.positions[4 * r - 4].z);
    EXPECT_FLOAT_EQ(made.mesh.positions[std::size_t{4} * 8].z, 4);
    EXPECT_FLOAT_EQ(made.mesh.positions[std::size_t{4} * 16].z, 4.05f);
}

// A rotation about the axis would move the first row of vertices out of the plane of the bend and back: along
// a planar bend the first normal keeps its angle to that plane.
TEST(Cylinders, FramesDoNotTwistAlongAPlanarBend) {
    std::vector<Vec3> arc;
    for (int i = 0; i <= 12; ++i) {
        const float a = 0.2f * static_cast<float>(i);
        arc.push_back({10 * std::cos(a), 0, 10 * std::sin(a)});
    }
    const Skeleton bend = chain(arc, std::vector<float>(arc.size(), 1));
    const CylinderMesh made =
        cylinders(bend, {.sides = 4, .rows = 4, .tips = TipShape::flat, .base = BaseShape::open});
    const float off_plane = made.mesh.positions[0].y;
    for (std::size_t v = 0; v < made.mesh.positions.size(); v += 4)
        EXPECT_NEAR(made.mesh.positions[v].y, off_plane, 1e-5);
}

// With the same chord error, a tube of a quarter of the radius needs half as many sides.
TEST(Cylinders, ThinAxesHaveFewerSidesIfRequested) {
    const Skeleton fork({NodeId::none(), NodeId(0), NodeId(1), NodeId(1)},
                        {{0, 0, 0}, {0, 0, 2}, {0, 0, 4}, {2, 0, 3}}, {0.4f, 0.4f, 0.4f, 0.1f});
    const CylinderMesh made = cylinders(fork, {.sides = 16, .thin = TubeSides::by_radius});
    EXPECT_EQ(made.report.max_sides, 16u);
    EXPECT_EQ(made.report.min_sides, 8u);
    EXPECT_TRUE(topology(made.mesh).watertight());
}

TEST(Cylinders, AreBitIdenticalForAnyNumberOfThreads) {
    const Skeleton tree = zoo_skeleton("helix");
    const CylinderMesh one = cylinders(tree, {}, {.threads = 1}), many = cylinders(tree, {}, {.threads = 5});
    EXPECT_TRUE(one.mesh.positions == many.mesh.positions);
    EXPECT_EQ(one.mesh.corners, many.mesh.corners);
}

TEST(Cylinders, RejectOptionsOutOfRange) {
    const Skeleton bar = chain({{0, 0, 0}, {0, 0, 3}}, {0.5f, 0.5f});
    EXPECT_THROW(cylinders(bar, {.sides = 2}), InvalidInput);
    EXPECT_THROW(cylinders(bar, {.rows = 0}), InvalidInput);
}

}  // namespace
}  // namespace coppice
