#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "coppice/base/disjoint_sets.h"
#include "coppice/base/random.h"
#include "coppice/cuda/exec/host_executor_internal.h"
#include "coppice/cuda/tetra/march_stages_internal.h"
#include "coppice/tetra/march/components_internal.h"
#include "coppice/tetra/march/held_internal.h"
#include "coppice/tetra/polyhedron/polyhedron.h"
#include "cuda/tetra_scene.h"
#include "tetra/support.h"
#include "tetra/surfaces.h"

// Tests of the stages of marching on an executor, compared with the CPU.

namespace coppice {
namespace {

using cuda::HostExecutor;

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
    return std::ranges::equal(a, b);
}

/// Expects that every array of a refinement is bit-identical.
void expect_same_refinement(const TetraMesh& mesh, int levels) {
    const TetraRefinement refinement(mesh, levels);
    const RefinementView expected = refinement.view();
    HostExecutor exec(Context{.threads = 2});
    const cuda::DeviceRefinement found = cuda::refine(exec, mesh, levels);
    EXPECT_TRUE(same(found.view.elements, expected.elements));
    EXPECT_TRUE(same(found.view.shortest_at, expected.shortest_at));
    EXPECT_EQ(found.view.first_element, expected.first_element);
    EXPECT_EQ(found.view.edge_count, expected.edge_count);
    EXPECT_EQ(found.view.vertices.first_of_kind, expected.vertices.first_of_kind);
    EXPECT_EQ(found.view.edges.first_of_kind, expected.edges.first_of_kind);
    EXPECT_EQ(found.vertex_count, refinement.vertex_count());
    ASSERT_EQ(found.view.traits.size(), expected.traits.size());
    for (std::size_t t = 0; t < expected.traits.size(); ++t) {
        const TetraTraits &a = found.view.traits[t], &b = expected.traits[t];
        ASSERT_EQ(a.owned, b.owned) << t;
        ASSERT_EQ(a.diagonal, b.diagonal) << t;
        ASSERT_EQ(a.mirrored, b.mirrored) << t;
        ASSERT_EQ(a.shortest_edge, b.shortest_edge) << t;
        ASSERT_EQ(a.width, b.width) << t;
    }
    for (std::size_t d = 0; d < 3; ++d) {
        EXPECT_TRUE(same(found.view.patterns[d].around, expected.patterns[d].around));
        EXPECT_TRUE(same(found.view.patterns[d].tetra_edges, expected.patterns[d].tetra_edges));
    }
}

TEST(RefinementStages, MatchTheCpu) {
    TetraMesh block = shuffled(bent(bcc_block({4, 3, 3}, 1, {0, 0, 0}), 0.12f, 1), 1);
    block.positions.push_back({2, 2, 2});  // without a tetrahedron
    for (int levels = 0; levels <= 5; ++levels) {
        SCOPED_TRACE(levels);
        expect_same_refinement(one_tetra(), levels);
        expect_same_refinement(block, levels);
    }
    expect_same_refinement(TetraMesh{}, 2);
    for (const auto& [name, skeleton] : small_trees()) {
        SCOPED_TRACE(name);
        const std::vector<Segment> axes = segment_axes(skeleton);
        expect_same_refinement(Lattice(axes, {.cell = 4}).mesh(), 1);
        expect_same_refinement(Polyhedron(skeleton, axes).mesh(), 2);
    }
}

void expect_refused_alike(const TetraMesh& mesh, int levels) {
    const auto said_by = [](const auto& what) {
        try {
            what();
        } catch (const InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    HostExecutor exec;
    const std::string expected = said_by([&] { const TetraRefinement refinement(mesh, levels); });
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(said_by([&] { cuda::refine(exec, mesh, levels); }), expected);
}

TEST(RefinementStages, RejectTheInputThatTheCpuRejects) {
    const TetraMesh one = one_tetra();
    expect_refused_alike(one, -1);
    expect_refused_alike(one, 6);
    TetraMesh bad = one;
    bad.tetra[0][2] = 4;
    expect_refused_alike(bad, 1);
    bad = one;
    std::swap(bad.tetra[0][0], bad.tetra[0][1]);
    expect_refused_alike(bad, 1);
    bad = one;
    bad.positions[3].x = std::numeric_limits<float>::quiet_NaN();
    expect_refused_alike(bad, 1);
    bad = one;
    bad.first = {0, 1, 0, 1};
    expect_refused_alike(bad, 1);
    // Three tetrahedra on one face.
    expect_refused_alike(
        tetra_mesh(std::array<Vec3, 6>{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1},
                                       Vec3{0, 0, 2}, Vec3{0, 0, -1}},
                   std::array<Tetra, 3>{Tetra{0, 1, 2, 3}, Tetra{0, 1, 2, 4}, Tetra{0, 1, 2, 5}}),
        1);
}

/// Expects that the same vertices hold the same axes and represent the same sets.
std::size_t expect_same_held(const TetraMesh& mesh, const InsideAxes& axes, int levels) {
    const TetraRefinement refinement(mesh, levels);
    const tetra_internal::HeldVertices expected = tetra_internal::hold_axes(refinement, axes, {});
    HostExecutor exec(Context{.threads = 2});
    const cuda::DeviceRefinement refined = cuda::refine(exec, mesh, levels);
    const cuda::DeviceHeld found = cuda::hold_axes(exec, cuda::upload_axes(exec, axes, refined), refined);
    EXPECT_EQ(found.bits.count, expected.list.size());
    if (found.bits.count != expected.list.size()) return 0;
    for (std::size_t i = 0; i < expected.list.size(); ++i) {
        EXPECT_EQ(found.vertex[i], expected.list[i].vertex);
        EXPECT_EQ(found.segment[i], expected.list[i].segment);
    }
    EXPECT_TRUE(same(cuda::first_of_sets(exec, found, refined),
                     std::span<const std::uint32_t>(expected.of_each_set)));
    return expected.list.size();
}

TEST(AxesStages, HeldVerticesMatchTheCpu) {
    std::size_t held = 0;
    for (const auto& [name, skeleton] : small_trees()) {
        SCOPED_TRACE(name);
        const std::vector<Segment> axes = segment_axes(skeleton);
        for (const int levels : {0, 2}) {
            const Lattice lattice(axes, {.cell = 4});
            held += expect_same_held(lattice.mesh(), {axes, lattice.passing()}, levels);
        }
        const Polyhedron polyhedron(skeleton, axes);
        held += expect_same_held(polyhedron.mesh(), {axes, polyhedron.passing()}, 2);
    }
    EXPECT_GT(held, 10000u);
}

TEST(TouchingStages, ListsMatchTheCpu) {
    std::size_t entries = 0, turn = 0;
    for (const auto& [name, skeleton] : small_trees()) {
        for (const Weights weights : {Weights::local, Weights::global}) {  // blended by axes, or summed
            if (weights == Weights::global && ++turn % 4 != 0) continue;
            SCOPED_TRACE(name);
            TetraScene scene(skeleton, 1, 0.6f, {.weights = weights});
            std::vector<float> factors(skeleton.size(), 1);
            factors.back() = 0;  // no influence
            scene.field.scale_weights(factors);
            scene.set_regions();
            HostExecutor exec(Context{.threads = 2});
            const cuda::DeviceRefinement refined = cuda::refine(exec, scene.lattice.mesh(), 1);
            const cuda::FieldArrays found =
                cuda::set_regions(exec, cuda::upload_segments(exec, scene.field),
                                  cuda::region_boxes(exec, refined), longest_list(refined.first.size() - 1));
            const CandidateLists& expected = scene.field.own_lists();
            EXPECT_TRUE(std::ranges::equal(found.own.first, expected.first));
            EXPECT_TRUE(std::ranges::equal(found.own.segments, expected.segments));
            EXPECT_EQ(found.competitors.first.size(), expected.first.size());
            EXPECT_EQ(std::ranges::count(found.competitors.first, 0), std::ssize(expected.first));
            entries += expected.segments.size();
        }
    }
    EXPECT_GT(entries, 10000u);
}

// 300 twigs end in one cell: more than a list can store.
TEST(TouchingStages, ThrowIfTooManySegmentsMeet) {
    std::vector<NodeId> parents{NodeId()};
    std::vector<Vec3> positions{{0, 0, 0}};
    for (int y = 0; y < 15; ++y) {
        for (int x = 0; x < 20; ++x) {
            parents.push_back(NodeId(0));
            positions.push_back({0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 1});
        }
    }
    const std::vector<float> radii(positions.size(), 0.3f);
    const Skeleton star(std::move(parents), std::move(positions), radii);
    const ConvolutionField field(star, {});
    HostExecutor exec;
    std::vector<Box3> boxes(5000);  // fewer regions allow longer lists
    boxes[0] = {{0, 0, 0.9f}, {0.1f, 0.1f, 1}};
    for (std::size_t i = 1; i < boxes.size(); ++i) boxes[i] = {{9, 9, 9}, {10, 10, 10}};
    const cuda::DeviceSegments segments = cuda::upload_segments(exec, field);
    EXPECT_THROW(cuda::set_regions(exec, segments, std::span<const Box3>(boxes), longest_list(boxes.size())),
                 DeviceError);
}

/// Joins the two numbers of every pair.
struct JoinPairs {
    std::span<const std::array<std::uint32_t, 2>> pairs;
    cuda::DeviceSets sets;
    void operator()(std::uint32_t i) const { sets.join(pairs[i][0], pairs[i][1]); }
};

TEST(DeviceSets, RootIsTheSmallestMemberInAnyOrder) {
    constexpr std::uint32_t kNumbers = 20000;
    const CounterRandom random(1, 2);
    std::vector<std::array<std::uint32_t, 2>> pairs(kNumbers);
    DisjointSets expected(kNumbers);
    for (std::uint32_t i = 0; i < kNumbers; ++i) {
        const auto number = [&](std::uint64_t k) {
            return static_cast<std::uint32_t>(random.uniform(2 * i + k, 0, 0.999 * kNumbers));
        };
        pairs[i] = {number(0), number(1)};
        expected.join(pairs[i][0], pairs[i][1]);
    }
    for (const unsigned threads : {1u, 2u, 7u}) {
        HostExecutor exec(Context{.threads = threads});
        const cuda::DeviceSets sets{exec.array<std::uint32_t>(kNumbers)};
        exec.each("begin", kNumbers, cuda::BeginSets{sets});
        exec.each("join", kNumbers, JoinPairs{pairs, sets});
        exec.each("flatten", kNumbers, cuda::FlattenSets{sets});
        for (std::uint32_t i = 0; i < kNumbers; ++i) ASSERT_EQ(sets.parent[i], expected.find(i));
    }
}

/// A ball of triangles, inside out for a hollow.
void add_ball(Vec3 center, float radius, bool inside_out, TriMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3 way :
         {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}})
        mesh.positions.push_back(center + way * radius);
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
        const std::uint32_t x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
        Triangle t{first + x, first + 2 + y, first + 4 + z};
        if (((x ^ y ^ z) != 0) != inside_out) std::swap(t[1], t[2]);
        mesh.triangles.push_back(t);
    }
}

struct Ball {
    Vec3 center;
    float radius;
    bool inside_out = false;
};

void expect_same_parts(const std::vector<Ball>& balls, const std::vector<Vec3>& places,
                       std::uint64_t dropped) {
    TriMesh mesh;
    for (const Ball& b : balls) add_ball(b.center, b.radius, b.inside_out, mesh);
    HostExecutor exec(Context{.threads = 2});
    cuda::DeviceSurface found{exec.upload(std::span<const Vec3>(mesh.positions)),
                              exec.upload(std::span<const Triangle>(mesh.triangles))};
    EXPECT_EQ(cuda::drop_parts(exec, found, places, {}), dropped);
    EXPECT_EQ(drop_parts(mesh, places, true, {}).count, dropped);
    EXPECT_TRUE(same(found.positions, std::span<const Vec3>(mesh.positions)));
    EXPECT_TRUE(same(found.triangles, std::span<const Triangle>(mesh.triangles)));
}

TEST(PartsStages, RemoveTheComponentsThatTheCpuRemoves) {
    const Ball large{{0, 0, 0}, 4}, hollow{{1, 0, 0}, 0.5f, true}, aside{{9, 0, 0}, 1};
    expect_same_parts({large}, {{0, 0, 0}}, 0);
    expect_same_parts({aside, large}, {{0, 0, 0}}, 1);
    expect_same_parts({large, hollow, aside}, {{0, 0, 0}}, 2);
    // Two sets of axes: the component that is tested last is the one with the most triangles.
    expect_same_parts({large, hollow, aside}, {{0, 0, 0}, {9, 0, 0}}, 1);
    expect_same_parts({aside, large}, {{0, 0, 0}, {9, 0, 0}}, 0);
    expect_same_parts({aside, large}, {{9, 0, 0}}, 1);
    // A component inside a hollow.
    expect_same_parts({{{0, 0, 0}, 4}, {{0, 0, 0}, 3, true}, {{0, 0, 0}, 1}}, {{0, 3.5f, 0}}, 2);
}

}  // namespace
}  // namespace coppice
