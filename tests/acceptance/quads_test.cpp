#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "acceptance/support.h"
#include "coppice/base/hash.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/measure/surface_report.h"
#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

// The whole pipeline from skeleton to quads, compared with its promises.

namespace coppice {
namespace {

using namespace test;

bool all_finite(const QuadMesh& mesh) {
    return std::all_of(mesh.positions.begin(), mesh.positions.end(),
                       [](Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); });
}

/// Expects closed quads, oriented outwards, without self-intersections: a sphere per tree that does not begin
/// inside another one, less those merged by the repair.
void expect_closed(const QuadSurface& surface, const Skeleton& skeleton) {
    const QuadMesh& mesh = surface.mesh;
    const bool has_repairs = surface.repair.rounds > 0;
    const std::uint64_t parts =
        has_repairs ? surface.repair.parts : skeleton.tree_count() - surface.grafted.joined;
    const TopologyReport t = topology(mesh);
    EXPECT_TRUE(t.watertight()) << t.open_edges << " open, " << t.non_manifold_edges << " non-manifold and "
                                << t.misoriented_edges << " misoriented edges, " << t.non_manifold_vertices
                                << " non-manifold vertices";
    EXPECT_EQ(t.quads, t.faces);
    EXPECT_EQ(t.vertices, mesh.positions.size());
    EXPECT_LE(parts, skeleton.tree_count());
    EXPECT_EQ(t.components, parts);
    EXPECT_EQ(t.euler, 2 * (static_cast<std::int64_t>(parts) - surface.repair.handles));
    EXPECT_EQ(surface.repair.pairs_after, 0u);
    ASSERT_TRUE(all_finite(mesh));
    EXPECT_GT(shape(mesh).signed_volume, 0);
}

std::uint64_t compute_hash(const QuadSurface& result) {
    return Hash()
        .add(std::span<const Vec3>(result.mesh.positions))
        .add(std::span<const Quad>(result.mesh.quads))
        .add(std::span<const Vec3>(result.cage.cage.positions))
        .add(std::span<const Quad>(result.cage.cage.quads))
        .value();
}

void expect_same_bits(const Skeleton& skeleton) {
    const std::uint64_t one = compute_hash(mesh_skeleton(skeleton, {}, {.threads = 1}).quads());
    for (const unsigned threads : {2u, 7u}) {
        EXPECT_EQ(compute_hash(mesh_skeleton(skeleton, {}, {.threads = threads}).quads()), one)
            << threads << " threads";
    }
}

SurfaceReport judge(const Skeleton& skeleton, const MeshOptions& options = {}) {
    return check_surface(to_polygons(mesh_skeleton(skeleton, options).quads().mesh), &skeleton);
}

/// Vertices at the radius instead of rings with the area of the circles.
MeshOptions at_radius() {
    MeshOptions options;
    options.field.radius_scale = 1;
    return options;
}

/// Minimum quality for a tree with well separated branches.
void expect_faithful(const Skeleton& skeleton) {
    const double ratio = judge(skeleton).volume->ratio();
    EXPECT_GT(ratio, 0.99);
    EXPECT_LT(ratio, 1.01);
    const SurfaceReport r = judge(skeleton, at_radius());
    EXPECT_EQ(r.intersections->total, 0u);
    EXPECT_LE(r.radius->regular.mean_abs, 0.010);
    EXPECT_LE(std::abs(r.radius->regular.mean), 0.004);
    EXPECT_GE(r.radius->regular.p1, -0.05);
    EXPECT_LE(r.radius->regular.p99, 0.05);
    EXPECT_EQ(r.axes->missing, 0u);
    EXPECT_LE(r.axes->severed, 1 + skeleton.size() / 1000);  // branches that touch others
    EXPECT_GE(r.axes->tip_reach.p1, 0.7);
    EXPECT_LE(r.axes->tip_reach.p99, 1.2);
    EXPECT_EQ(r.shape.inverted_faces, 0u);
    EXPECT_GE(r.shape.scaled_jacobian.p1, 0.40);
}

// --- the zoo -----------------------------------------------------------------------------------------

class AcceptanceZoo : public testing::TestWithParam<int> {};

TEST_P(AcceptanceZoo, EverySkeletonHasClosedQuadsWithoutSelfIntersections) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        MeshOptions options;
        options.levels = GetParam();
        expect_closed(mesh_skeleton(skeleton, options).quads(), skeleton);
    }
}

INSTANTIATE_TEST_SUITE_P(Levels, AcceptanceZoo, testing::Values(0, 2),
                         [](const auto& chosen) { return std::to_string(chosen.param); });

TEST(Acceptance, OpenBaseHasOneHolePerTreeThatStartsWithOneBranch) {
    MeshOptions options;
    options.control.base = BaseShape::open;
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        std::uint64_t holes = 0;
        const PrepareResult prepared = prepare(skeleton, options.prepare);
        const GraftResult grafted = graft_branches(prepared.skeleton, options.graft, SectionEnd::joined, {});
        const SeparatedSkeleton parted = separate_branches(grafted.tubes, grafted.joins, {});
        for (const NodeId n : nodes(parted.skeleton)) {
            const bool is_round = std::ranges::find(parted.round_roots, n) != parted.round_roots.end();
            holes +=
                parted.skeleton.is_root(n) && parted.skeleton.children(n).size() == 1 && !is_round ? 1 : 0;
        }
        const TopologyReport t = topology(mesh_skeleton(skeleton, options).quads().mesh);
        EXPECT_EQ(t.open_edges, holes * 4 * (1u << options.levels));
        EXPECT_EQ(t.euler,
                  static_cast<std::int64_t>(2 * (grafted.tubes.tree_count() - parted.joins.size()) - holes));
        EXPECT_EQ(t.components, grafted.tubes.tree_count());
        EXPECT_EQ(t.non_manifold_edges + t.misoriented_edges + t.non_manifold_vertices, 0u);
    }
}

/// Compares rim and cap of a flat end with the disc of radius r about c in the normal plane.
void expect_disc(const QuadSurface& result, int levels, const ClipPlane& clip, Vec3 c, float r) {
    const std::size_t begin = std::size_t{clip.first_quad} << (2 * levels);
    const std::size_t end = begin + (std::size_t{clip.quad_count} << (2 * levels));
    std::vector<int> uses(result.mesh.positions.size(), 0);
    for (std::size_t q = 0; q < result.mesh.quads.size(); ++q) {
        for (const std::uint32_t v : result.mesh.quads[q]) uses[v] |= q >= begin && q < end ? 1 : 2;
    }
    float off_plane = 0, off_circle = 0, widest_inside = 0;
    for (std::size_t v = 0; v < uses.size(); ++v) {
        if ((uses[v] & 1) == 0) continue;
        const Vec3 p = result.mesh.positions[v] - c;
        off_plane = std::max(off_plane, std::abs(dot(clip.normal, p)) / r);
        const float out = length(cross(clip.normal, p)) / r;
        if (uses[v] == 3) off_circle = std::max(off_circle, std::abs(out - 1));
        if (uses[v] == 1) widest_inside = std::max(widest_inside, out);
    }
    EXPECT_LE(off_plane, 1e-5f);
    EXPECT_LE(off_circle, 1e-3f);
    EXPECT_LT(widest_inside, 0.98f);
}

TEST(Acceptance, FlatEndsAreDiscsOfTheBranchRadius) {
    const Skeleton bent({NodeId::none(), NodeId(0), NodeId(1), NodeId(2)},
                        {{0.1f, 0.2f, 0.4f}, {0.5f, 0.5f, 1.5f}, {1.3f, 0.7f, 2.3f}, {2.6f, 0.2f, 2.6f}},
                        {0.5f, 0.45f, 0.4f, 0.3f});
    const Skeleton stump({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 0.3f}}, {0.5f, 0.5f});
    for (const Skeleton& s : {bent, stump}) {
        for (const int sides : {4, 8, 16}) {
            for (const int levels : {1, 2, 3}) {
                SCOPED_TRACE(std::to_string(s.size()) + " nodes, " + std::to_string(sides) +
                             " sides, level " + std::to_string(levels));
                MeshOptions options = at_radius();
                options.levels = levels;
                options.control = {.sides = sides, .tips = TipShape::flat, .base = BaseShape::flat};
                const QuadSurface result = mesh_skeleton(s, options).quads();
                expect_closed(result, s);
                ASSERT_EQ(result.cage.clip.size(), 2u);
                const NodeId tip(s.size() - 1);
                expect_disc(result, levels, result.cage.clip[0], s.position(NodeId(0)), s.radius(NodeId(0)));
                expect_disc(result, levels, result.cage.clip[1], s.position(tip), s.radius(tip));
                const SurfaceReport r = check_surface(to_polygons(result.mesh), nullptr);
                EXPECT_EQ(r.intersections->local + r.intersections->remote, 0u);
                EXPECT_EQ(r.shape.inverted_faces, 0u);
                EXPECT_GE(r.shape.scaled_jacobian.min, 0.3);
                if (s.size() > 2) continue;
                // half a turn, in rim vertices
                const double corner = std::numbers::pi / (sides << (levels - 1));
                const double prism = std::numbers::pi * 0.25 * 0.3 * std::sin(corner) / corner;
                EXPECT_NEAR(r.shape.signed_volume / prism, 1, 1e-3);
            }
        }
    }
}

TEST(Acceptance, EverySkeletonInTheZooIsClosedWithFlatEnds) {
    MeshOptions options;
    options.control = {.tips = TipShape::flat, .base = BaseShape::flat};
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        expect_closed(mesh_skeleton(skeleton, options).quads(), skeleton);
    }
}

TEST(Acceptance, IsBitIdenticalForAnyNumberOfThreads) {
    for (const char* name : {"soma", "forest", "thin_lateral_15", "whorl_on_short_trunk",
                             "short_segments_010", "random_hard_2", "random_large", "random_large_hard"}) {
        SCOPED_TRACE(name);
        expect_same_bits(zoo_skeleton(name));
    }
}

TEST(Acceptance, RandomTreesHaveAccurateSurfaces) {
    for (const std::uint64_t seed : {1u, 6u}) {
        SCOPED_TRACE(seed);
        expect_faithful(random_tree(300, seed));
    }
}

TEST(Acceptance, BranchesThatAllOverlapAreClosed) {
    // Every branch overlaps hundreds of others: the surface must be closed, and computed soon.
    constexpr std::uint32_t kBranches = 256;
    std::vector<NodeId> parent{NodeId::none(), NodeId(0)};
    std::vector<Vec3> position{{0, 0, 0}, {0, 0, 1}};
    std::vector<float> radius{0.3f, 0.3f};
    for (std::uint32_t i = 0; i < kBranches; ++i) {
        parent.emplace_back(1u);
        position.push_back({1, 0.0003f * static_cast<float>(i), 1.2f});
        radius.push_back(0.05f);
    }
    const Skeleton skeleton(parent, position, radius);
    expect_closed(mesh_skeleton(skeleton).quads(), skeleton);
}

// --- foreign skeletons ---------------------------------------------------------------------------------

TEST(AcceptanceFiles, EverySkeletonHasClosedQuadsWithoutSelfIntersections) {
    const std::vector<fs::path> files = skeleton_files();
    if (files.empty()) GTEST_SKIP() << "there is no " << kShared;
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.filename());
        const Skeleton skeleton = read_skeleton(file).skeleton;
        const MeshResult made = mesh_skeleton(skeleton);
        expect_closed(made.quads(), skeleton);
        EXPECT_EQ(shape(made.quads().mesh).inverted_faces, 0u);
    }
}

class AcceptanceWorkload : public testing::TestWithParam<const char*> {
  protected:
    fs::path file() const { return workload(GetParam()); }
};

TEST_P(AcceptanceWorkload, SurfaceIsAccurate) {
    if (!fs::exists(file())) GTEST_SKIP() << "there is no " << file();
    expect_faithful(read_skeleton(file()).skeleton);
}

TEST_P(AcceptanceWorkload, IsBitIdenticalForAnyNumberOfThreads) {
    if (!fs::exists(file())) GTEST_SKIP() << "there is no " << file();
    expect_same_bits(read_skeleton(file()).skeleton);
}

INSTANTIATE_TEST_SUITE_P(Trees, AcceptanceWorkload, testing::Values("tree300", "tree3k"),
                         [](const auto& chosen) { return std::string(chosen.param); });

}  // namespace
}  // namespace coppice
