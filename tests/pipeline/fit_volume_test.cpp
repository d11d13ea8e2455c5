#include "coppice/pipeline/fit_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stop_token>

#include "coppice/base/error.h"
#include "coppice/measure/intersections.h"
#include "coppice/measure/surface_tree.h"
#include "coppice/measure/union_volume.h"
#include "coppice/mesh/shape.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "zoo.h"

namespace coppice {
namespace {

constexpr NodeId kRoot = NodeId::none();
constexpr double kPi = std::numbers::pi;

Skeleton pole() { return Skeleton({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 10}}, {0.5f, 0.5f}); }

/// A trunk with a bend, a fork and a twig.
Skeleton small_tree(float x = 0) {
    return Skeleton({kRoot, NodeId(0), NodeId(1), NodeId(2), NodeId(2), NodeId(1)},
                    {{x, 0, 0}, {x, 0, 3}, {x + 1, 0, 6}, {x + 3, 0, 9}, {x - 1, 0, 9}, {x - 2, 1, 4}},
                    {0.5f, 0.45f, 0.4f, 0.3f, 0.3f, 0.1f});
}

double compute_volume(const PolygonMesh& m) { return shape(m).signed_volume; }
std::uint64_t crossings(const PolygonMesh& m) {
    return crossing_faces(SurfaceTree(m), 1'000'000).pairs.size();
}

MeshResult mesh_with(const Skeleton& s, Fit fit, MeshMethod method = MeshMethod::quads, int levels = 2,
                     const Context& ctx = {}) {
    MeshOptions options;
    options.method = method;
    options.fit = fit;
    options.levels = levels;
    return mesh_skeleton(s, options, ctx);
}

TEST(FitVolume, CylinderHasTheAreaOfItsCircle) {
    const MeshResult r = mesh_with(pole(), Fit::volume);
    ASSERT_TRUE(r.fitted);
    EXPECT_TRUE(r.fitted->closed);
    const double exact = kPi * 0.25 * 10 + 2 * kPi / 3 * 0.125;
    EXPECT_NEAR(r.fitted->cones, exact, r.fitted->error);
    EXPECT_NEAR(compute_volume(to_polygons(r)), exact, 1e-3 * exact);
    EXPECT_NEAR(r.fitted->after, compute_volume(to_polygons(r)), 1e-4 * exact);
    // Sixteen sides have the area of the circle if their corners are at r sqrt(a / sin a), a = 2 pi / 16.
    const double a = kPi / 8, corner = 0.5 * std::sqrt(a / std::sin(a));
    std::size_t seen = 0;
    for (const Vec3 p : r.quads().mesh.positions) {
        if (p.z < 3 || p.z > 7) continue;
        EXPECT_NEAR(std::hypot(p.x, p.y), corner, 0.003 * corner);
        ++seen;
    }
    EXPECT_GT(seen, 0u);
}

TEST(FitVolume, FlatEndsRemainFlat) {
    MeshOptions options;
    options.field.radius_scale = 1;  // so that the fit has an effect
    options.control.tips = TipShape::flat;
    const MeshResult before = mesh_skeleton(pole(), options);
    options.fit = Fit::volume;
    const MeshResult after = mesh_skeleton(pole(), options);
    std::size_t flat = 0, wider = 0;
    for (std::size_t v = 0; v < before.quads().mesh.positions.size(); ++v) {
        const Vec3 p = before.quads().mesh.positions[v], q = after.quads().mesh.positions[v];
        if (std::fabs(p.z) > 1e-4f && std::fabs(p.z - 10) > 1e-4f) continue;
        EXPECT_NEAR(p.z, q.z, 1e-6);
        wider += std::hypot(q.x, q.y) > std::hypot(p.x, p.y) * 1.005 ? 1 : 0;
        ++flat;
    }
    EXPECT_GT(flat, wider);  // the rim, but not the vertices within
    EXPECT_EQ(wider, 32u);
    EXPECT_NEAR(compute_volume(to_polygons(after)), kPi * 2.5, 1e-3 * kPi * 2.5);
}

TEST(FitVolume, OpenBaseIsMeasuredAsClosed) {
    MeshOptions options;
    options.control.base = BaseShape::open;
    options.fit = Fit::volume;
    const MeshResult r = mesh_skeleton(small_tree(7), options);
    EXPECT_TRUE(r.fitted->closed);
    // The base is at z = 0, so that its disc adds no volume to the open surface.
    EXPECT_NEAR(compute_volume(to_polygons(r)), r.fitted->cones, 1e-3 * r.fitted->cones);
}

TEST(FitVolume, MatchesTheVolumeForLevelsAndMethods) {
    for (const int level : {0, 1, 2, 3}) {
        SCOPED_TRACE(level);
        const MeshResult r = mesh_with(small_tree(), Fit::volume, MeshMethod::quads, level);
        EXPECT_NEAR(compute_volume(to_polygons(r)), r.fitted->cones, 1e-3 * r.fitted->cones);
    }
    for (const float edge : {0.25f, 0.5f, 1.0f}) {
        SCOPED_TRACE(edge);
        MeshOptions options;
        options.method = MeshMethod::tetrahedra;
        options.fit = Fit::volume;
        options.tetra.edge = edge;
        const MeshResult r = mesh_skeleton(small_tree(), options);
        EXPECT_NEAR(compute_volume(to_polygons(r)), r.fitted->cones, 1e-3 * r.fitted->cones);
    }
}

TEST(FitVolume, AutomaticFitsIfTheVolumeDeviates) {
    // On a long pole, the volume that the ends lose is a small share.
    const Skeleton longer({kRoot, NodeId(0)}, {{0, 0, 0}, {0, 0, 60}}, {0.5f, 0.5f});
    const MeshResult near = mesh_with(longer, Fit::automatic);
    ASSERT_TRUE(near.measured);
    EXPECT_FALSE(near.fitted);
    EXPECT_TRUE(near.quads().mesh.positions == mesh_with(longer, Fit::surface).quads().mesh.positions);
    const MeshResult shorter = mesh_with(pole(), Fit::automatic);
    ASSERT_TRUE(shorter.measured && shorter.fitted);
    EXPECT_LT(shorter.measured->ratio(), 0.99);
    EXPECT_NEAR(compute_volume(to_polygons(shorter)), shorter.fitted->cones, 1e-3 * shorter.fitted->cones);
    const MeshResult coarse = mesh_with(pole(), Fit::automatic, MeshMethod::quads, 0);
    ASSERT_TRUE(coarse.fitted);
    EXPECT_NEAR(coarse.fitted->after, coarse.fitted->cones, 1e-3 * coarse.fitted->cones);
}

TEST(FitVolume, AutomaticSkipsOtherKindsOfSurfaces) {
    MeshOptions options;
    options.fit = Fit::automatic;
    options.levels = 0;
    const auto is_untouched = [](const MeshOptions& o) {
        const MeshResult r = mesh_skeleton(pole(), o);
        return !r.measured && !r.fitted;
    };
    EXPECT_FALSE(is_untouched(options));
    MeshOptions open = options, cylinders = options, scaled = options, triangles = options;
    open.control.base = BaseShape::open;
    cylinders.method = MeshMethod::cylinders;
    triangles.method = MeshMethod::tetrahedra;
    scaled.field.radius_scale = 1;
    EXPECT_TRUE(is_untouched(open));
    EXPECT_TRUE(is_untouched(cylinders));
    EXPECT_TRUE(is_untouched(scaled));
    EXPECT_TRUE(is_untouched(triangles));
    EXPECT_FALSE(mesh_solid(small_tree(), {}, triangles).fitted);
}

TEST(FitVolume, ThinBranchesOfABallPreserveTheirRadius) {
    // The excess volume of the ball must not be removed from the neurite that leaves it.
    const Skeleton cell({kRoot, NodeId(0), NodeId(1), NodeId(0), NodeId(3)},
                        {{0, 0, 0}, {0, 0, 4}, {0, 0, 10}, {0, 4, 0}, {0, 10, 0}},
                        {3, 0.2f, 0.2f, 0.2f, 0.2f});
    const MeshResult r = mesh_with(cell, Fit::volume);
    EXPECT_NEAR(r.fitted->after, r.fitted->cones, 2e-3 * r.fitted->cones);
    for (const Vec3 p : r.quads().mesh.positions) {
        if (p.z > 3.3f && p.z < 9) {
            EXPECT_GT(std::hypot(p.x, p.y), 0.15);
        }
    }
}

TEST(FitVolume, SomaOfThreePointsIsClosed) {
    const MeshResult r = mesh_with(zoo_skeleton("soma_of_three_points"), Fit::volume);
    EXPECT_TRUE(r.fitted->closed);
    EXPECT_GT(r.fitted->before, 0.9 * r.fitted->cones);
    EXPECT_EQ(crossings(to_polygons(r)), 0u);
}

TEST(FitVolume, ComponentsAreFittedSeparately) {
    // A pole with round sides loses less by chords than a tree with forks and bends; they are one surface.
    const Skeleton tree = small_tree(20), bare = pole();
    std::vector<NodeId> parent(bare.parents().begin(), bare.parents().end());
    std::vector<Vec3> position(bare.positions().begin(), bare.positions().end());
    std::vector<float> radius(bare.radii().begin(), bare.radii().end());
    for (const NodeId n : nodes(tree)) {
        parent.push_back(tree.is_root(n) ? kRoot : NodeId(tree.parent(n).index() + 2));
        position.push_back(tree.position(n));
        radius.push_back(tree.radius(n));
    }
    const MeshResult r = mesh_with(Skeleton(parent, position, radius), Fit::volume);
    QuadMesh of_pole = r.quads().mesh;
    std::erase_if(of_pole.quads, [&](const Quad& q) { return of_pole.positions[q[0]].x > 10; });
    const double exact = kPi * 2.5 + kPi / 12;
    EXPECT_NEAR(shape(of_pole).signed_volume, exact, 3e-3 * exact);
}

TEST(FitVolume, DoesNotCompensateForMissingParts) {
    // The surface of a thin pole, compared with a skeleton that has a ball in its middle.
    const Skeleton thin({kRoot, NodeId(0), NodeId(1)}, {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}},
                        {0.5f, 0.5f, 0.5f});
    const Skeleton ball({kRoot, NodeId(0), NodeId(1), kRoot}, {{0, 0, 0}, {0, 0, 5}, {0, 0, 10}, {0, 0, 5}},
                        {0.5f, 0.5f, 0.5f, 2});
    QuadMesh mesh = mesh_with(thin, Fit::surface).quads().mesh;
    const FitVolumeReport r = fit_volume(mesh, ball, EndShape::flat, EndShape::round);
    EXPECT_FALSE(r.closed);
    EXPECT_LT(r.after, 0.5 * r.cones);
    for (const Vec3 p : mesh.positions) {
        if (p.z > 8) {
            EXPECT_LT(std::hypot(p.x, p.y), 0.54);
        }
    }
}

TEST(FitVolume, AddsNoFoldsOrSelfIntersections) {
    int closed = 0, all = 0;
    constexpr std::uint32_t kSmall = 300;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        if (skeleton.size() > kSmall) continue;
        for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
            SCOPED_TRACE(name);
            PolygonMesh before;
            try {
                before = to_polygons(mesh_with(skeleton, Fit::surface, method));
            } catch (const InvalidInput&) {
                continue;  // no surface is left with tetrahedra
            }
            const MeshResult r = mesh_with(skeleton, Fit::volume, method);
            const PolygonMesh after = to_polygons(r);
            EXPECT_LE(crossings(after), crossings(before));
            EXPECT_EQ(topology(after).watertight(), topology(before).watertight());
            closed += r.fitted->closed ? 1 : 0;
            if (r.fitted->closed) {
                EXPECT_NEAR(r.fitted->after, r.fitted->cones, 3e-3 * r.fitted->cones);
            }
            ++all;
        }
    }
    EXPECT_GT(closed, 0.8 * all);  // others are self-intersections, and jumps that a field does not follow
}

TEST(FitVolume, IsBitIdenticalForAnyNumberOfThreads) {
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        const MeshResult one = mesh_with(small_tree(), Fit::volume, method, 3, {.threads = 1});
        for (const unsigned threads : {2u, 7u}) {
            const MeshResult many = mesh_with(small_tree(), Fit::volume, method, 3, {.threads = threads});
            EXPECT_EQ(to_polygons(many).positions, to_polygons(one).positions);
            EXPECT_EQ(*many.fitted, *one.fitted);
        }
    }
}

TEST(FitVolume, ReportsProgressAndStopsWhenCancelled) {
    float last = 0;
    mesh_with(small_tree(), Fit::volume, MeshMethod::quads, 2, {.progress = [&](float f) {
                  EXPECT_GE(f, last);
                  last = f;
              }});
    EXPECT_EQ(last, 1);
    QuadMesh mesh = mesh_with(small_tree(), Fit::surface).quads().mesh;
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(fit_volume(mesh, small_tree(), EndShape::flat, EndShape::round, {.stop = stop.get_token()}),
                 Cancelled);
}

}  // namespace
}  // namespace coppice
