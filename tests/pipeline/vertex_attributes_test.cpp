#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/branches.h"
#include "coppice/skeleton/random_tree.h"

namespace coppice {
namespace {

MeshOptions with_attributes(MeshMethod method) {
    MeshOptions options;
    options.method = method;
    options.attributes = true;
    return options;
}

const Buffer<float>& values(const MeshResult& made, std::string_view name) {
    return std::ranges::find(made.attributes, name, &VertexAttribute::name)->values;
}

std::vector<Vec3> positions(const MeshResult& made) {
    const PolygonMesh mesh = to_polygons(made);
    return {mesh.positions.begin(), mesh.positions.end()};
}

// A vertical stem of 4 m that tapers from 0.2 m to 0.1 m.
Skeleton stem() {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{0.2f};
    for (std::uint32_t i = 1; i <= 4; ++i) {
        parent.emplace_back(i - 1);
        position.push_back({0, 0, static_cast<float>(i)});
        radius.push_back(0.2f - 0.025f * static_cast<float>(i));
    }
    return {parent, position, radius};
}

// A stem of 2 m with a branch of 1.5 m that leaves it horizontally at half its length.
Skeleton stem_with_branch() {
    return {{NodeId::none(), NodeId(0), NodeId(1), NodeId(1), NodeId(3)},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0.5f, 0, 1}, {1.5f, 0, 1}},
            {0.1f, 0.1f, 0.1f, 0.05f, 0.05f}};
}

TEST(VertexAttributes, EqualTheSkeletonOnAStraightStem) {
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::bmesh, MeshMethod::ramifications,
                                    MeshMethod::tetrahedra, MeshMethod::cylinders}) {
        SCOPED_TRACE(static_cast<int>(method));
        const MeshResult made = mesh_skeleton(stem(), with_attributes(method));
        ASSERT_EQ(made.attributes.size(), 4u);
        const std::vector<Vec3> all = positions(made);
        for (std::size_t v = 0; v < all.size(); ++v) {
            EXPECT_EQ(values(made, "order")[v], 0);
            EXPECT_EQ(values(made, "branch")[v], 0);
            const float z = all[v].z;
            if (z > 0.2f && z < 3.8f) {
                EXPECT_NEAR(values(made, "distance")[v], z, 1e-5f);
            }
            EXPECT_NEAR(values(made, "radius")[v], 0.2f - 0.025f * values(made, "distance")[v], 1e-6f);
        }
    }
}

TEST(VertexAttributes, BeginAgainAtALateral) {
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra, MeshMethod::cylinders}) {
        SCOPED_TRACE(static_cast<int>(method));
        const MeshResult made = mesh_skeleton(stem_with_branch(), with_attributes(method));
        const std::vector<Vec3> all = positions(made);
        int on_lateral = 0;
        for (std::size_t v = 0; v < all.size(); ++v) {
            const bool is_far = all[v].x > 0.3f;  // from the stem
            if (!is_far && all[v].x > 0.08f) continue;
            EXPECT_EQ(values(made, "order")[v], is_far ? 1 : 0);
            EXPECT_EQ(values(made, "branch")[v], is_far ? 1 : 0);
            if (!is_far || all[v].x > 1.4f) continue;
            EXPECT_NEAR(values(made, "distance")[v], all[v].x, 1e-5f);
            EXPECT_NEAR(values(made, "radius")[v], 0.05f, 1e-6f);
            ++on_lateral;
        }
        EXPECT_GT(on_lateral, 20);
    }
}

TEST(VertexAttributes, AreInTheRangesOfTheBranchesOnAnyMethod) {
    const Skeleton tree = random_tree(80, 3, true);
    const BranchTable table = list_branches(tree);
    const float thickest = std::ranges::max(tree.radii());
    for (const TubeSides sides : {TubeSides::equal, TubeSides::by_radius}) {
        MeshOptions options = with_attributes(MeshMethod::quads);
        options.tube_sides = sides;
        const MeshResult made = mesh_skeleton(tree, options);
        const std::vector<Vec3> all = positions(made);
        for (const VertexAttribute& a : made.attributes) ASSERT_EQ(a.values.size(), all.size());
        for (std::size_t v = 0; v < all.size(); ++v) {
            const auto branch = static_cast<std::size_t>(values(made, "branch")[v]);
            ASSERT_LT(branch, table.branches.size());
            EXPECT_EQ(values(made, "order")[v], static_cast<float>(table.branches[branch].order));
            EXPECT_LE(values(made, "distance")[v], table.branches[branch].length * 1.0001);
            EXPECT_LE(values(made, "radius")[v], thickest);
        }
    }
}

TEST(VertexAttributes, AreTheSameForAnyNumberOfThreads) {
    const Skeleton tree = random_tree(60, 5, true);
    for (const MeshMethod method : {MeshMethod::quads, MeshMethod::tetrahedra}) {
        const MeshResult one = mesh_skeleton(tree, with_attributes(method), {.threads = 1});
        const MeshResult four = mesh_skeleton(tree, with_attributes(method), {.threads = 4});
        ASSERT_EQ(one.attributes.size(), four.attributes.size());
        for (std::size_t i = 0; i < one.attributes.size(); ++i)
            EXPECT_TRUE(std::ranges::equal(one.attributes[i].values, four.attributes[i].values));
    }
}

}  // namespace
}  // namespace coppice
