#include "coppice/pipeline/face_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "coppice/mesh/topology.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

std::uint64_t count_faces(const FaceBudget& budget) {
    return mesh_skeleton(budget.skeleton, budget.options).quads().mesh.quads.size();
}

TEST(PlanFaces, MatchesTheRequestedNumberOfFaces) {
    const Skeleton tree = random_tree(2000, 3);
    MeshOptions equal;
    equal.tube_sides = TubeSides::equal;
    for (const std::uint64_t wanted : {500u, 2000u, 7000u, 20'000u, 50'000u, 200'000u}) {
        SCOPED_TRACE(wanted);
        const FaceBudget budget = plan_faces(tree, equal, wanted);
        EXPECT_NEAR(static_cast<double>(budget.faces), static_cast<double>(wanted), 0.02 * wanted);
        const QuadMesh mesh = mesh_skeleton(budget.skeleton, budget.options).quads().mesh;
        EXPECT_TRUE(topology(mesh).watertight());
        // Close rings cross at forks, and remeshed regions have more faces.
        EXPECT_GE(mesh.quads.size(), budget.faces);
        EXPECT_LE(mesh.quads.size(),
                  (budget.options.prepare.resample.max_length < 5 ? 3 : 1.1) * budget.faces);
    }
}

TEST(MeshWithFaces, MatchesTheNumberForAllTubeSides) {
    const Skeleton tree = random_tree(300, 1);
    MeshOptions equal;
    equal.tube_sides = TubeSides::equal;
    for (const std::uint64_t wanted : {500u, 4000u, 9000u, 20'000u}) {
        SCOPED_TRACE(wanted);
        const BudgetedMesh made = mesh_with_faces(tree, {}, {}, wanted);
        const QuadMesh& mesh = made.result.quads().mesh;
        EXPECT_NEAR(static_cast<double>(mesh.quads.size()), static_cast<double>(wanted), 0.05 * wanted);
        EXPECT_TRUE(topology(mesh).watertight());
        EXPECT_EQ(made.result.quads().coarsened.has_value(),
                  made.budget.options.tube_sides == TubeSides::by_radius);
        EXPECT_FALSE(mesh_with_faces(tree, {}, equal, wanted).result.quads().coarsened);
    }
    EXPECT_EQ(mesh_with_faces(tree, {}, {}, 20'000).budget.options.tube_sides, TubeSides::by_radius);
}

// A trunk with laterals of many nodes that wind by a fifth of their radius.
Skeleton winding_laterals() {
    std::vector<NodeId> parent{NodeId::none()};
    std::vector<Vec3> position{{0, 0, 0}};
    std::vector<float> radius{0.1f};
    const auto add = [&](std::uint32_t p, Vec3 at, float r) {
        parent.emplace_back(p);
        position.push_back(at);
        radius.push_back(r);
        return static_cast<std::uint32_t>(parent.size()) - 1;
    };
    std::uint32_t stem = 0;
    for (int i = 1; i <= 8; ++i) {
        const auto z = 0.5f * static_cast<float>(i);
        stem = add(stem, {0, 0, z}, 0.1f - 0.008f * static_cast<float>(i));
        std::uint32_t last = stem;
        for (int k = 1; k <= 60; ++k) {
            const auto t = static_cast<float>(k);
            const float turn = 2.4f * static_cast<float>(i) + 0.02f * std::sin(0.9f * t);
            last = add(last, {0.05f * t * std::cos(turn), 0.05f * t * std::sin(turn), z + 0.01f * t}, 0.02f);
        }
    }
    return {parent, position, radius};
}

// If chords between distant rings cut corners, moving the surface outward does not end at the specified
// volume.
TEST(MeshWithFaces, PreservesTheVolumeWithFewFaces) {
    const Skeleton tree = winding_laterals();
    for (const std::uint64_t faces : {200u, 400u, 800u}) {
        SCOPED_TRACE(faces);
        const auto share = [&](Fit fit) {
            MeshOptions options;
            options.fit = fit;
            const BudgetedMesh made = mesh_with_faces(tree, {}, options, faces);
            const auto volume = judge_surface(made.result, made.budget.skeleton, {})->volume;
            return volume->mesh / volume->cones;
        };
        EXPECT_NEAR(share(Fit::automatic), 1, 0.02);
        if (faces == 200) {
            EXPECT_LT(share(Fit::volume), 0.9);
        }
    }
}

TEST(PlanFaces, DropsBranchesOnlyForFewFaces) {
    const Skeleton tree = random_tree(2000, 3);
    const FaceBudget few = plan_faces(tree, {}, 1000), many = plan_faces(tree, {}, 100'000);
    EXPECT_GT(few.dropped, 0u);
    EXPECT_LT(few.dropped, few.axes);
    EXPECT_GT(few.dropped_silhouette, 0);
    EXPECT_LT(few.dropped_silhouette, 0.9);
    EXPECT_LT(few.skeleton.size(), tree.size());
    EXPECT_EQ(many.dropped, 0u);
    EXPECT_EQ(many.dropped_silhouette, 0);
    EXPECT_EQ(many.skeleton.size(), tree.size());
    EXPECT_LT(few.options.levels, many.options.levels);
}

// The thin lateral is removed before the thick one, and a branch never before those that it carries.
TEST(PlanFaces, DropsTheSmallestSilhouettesFirst) {
    const Skeleton tree = random_tree(500, 7);
    std::uint32_t last = 0;
    for (const std::uint64_t wanted : {4000u, 2000u, 1000u, 500u, 300u}) {
        const FaceBudget budget = plan_faces(tree, {}, wanted);
        EXPECT_GE(budget.dropped, last);
        last = budget.dropped;
        EXPECT_EQ(budget.skeleton.tree_count(), tree.tree_count());
    }
    EXPECT_GT(last, 0u);
}

TEST(PlanFaces, PreservesTheAxesThatStartAtRoots) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const FaceBudget budget = plan_faces(skeleton, {}, 100);
        EXPECT_EQ(budget.skeleton.tree_count(), skeleton.tree_count());
        EXPECT_GT(count_faces(budget), 0u);
    }
}

TEST(PlanFaces, MatchesTheNumberForASingleBranch) {
    const Skeleton stick({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 2}}, {0.1f, 0.1f});
    for (const std::uint64_t wanted : {500u, 1000u, 2000u, 5000u}) {
        SCOPED_TRACE(wanted);
        EXPECT_NEAR(static_cast<double>(count_faces(plan_faces(stick, {}, wanted))),
                    static_cast<double>(wanted), 0.1 * wanted);
    }
}

TEST(PlanFaces, RejectsInvalidOptions) {
    const Skeleton tree = zoo_skeleton("one_segment");
    EXPECT_THROW(plan_faces(tree, {}, 99), InvalidInput);
    EXPECT_THROW(plan_faces(tree, {}, 100'000'001), InvalidInput);
    MeshOptions options;
    options.method = MeshMethod::tetrahedra;
    EXPECT_THROW(plan_faces(tree, options, 1000), InvalidInput);
}

}  // namespace
}  // namespace coppice
