#include "coppice/pipeline/face_budget.h"

#include <gtest/gtest.h>

#include "coppice/mesh/topology.h"
#include "coppice/skeleton/random_tree.h"
#include "zoo.h"

namespace coppice {
namespace {

std::uint64_t faces_of(const FaceBudget& budget) {
    return mesh_skeleton(budget.skeleton, budget.options).quads().mesh.quads.size();
}

TEST(PlanFaces, MeetsTheNumberThatIsWanted) {
    const Skeleton tree = random_tree(2000, 3);
    for (const std::uint64_t wanted : {500u, 2000u, 7000u, 20'000u, 50'000u, 200'000u}) {
        SCOPED_TRACE(wanted);
        const FaceBudget budget = plan_faces(tree, {}, wanted);
        EXPECT_NEAR(static_cast<double>(budget.faces), static_cast<double>(wanted), 0.02 * wanted);
        const QuadMesh mesh = mesh_skeleton(budget.skeleton, budget.options).quads().mesh;
        EXPECT_TRUE(topology(mesh).watertight());
        // Rings that stand near each other cross at forks, and what is remeshed there has more faces.
        EXPECT_GE(mesh.quads.size(), budget.faces);
        EXPECT_LE(mesh.quads.size(),
                  (budget.options.prepare.resample.max_length < 5 ? 3 : 1.1) * budget.faces);
    }
}

TEST(PlanFaces, DropsBranchesOnlyWhereFewFacesAreWanted) {
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

// The thin lateral goes before the thick one, and a branch never before what it carries.
TEST(PlanFaces, DropsTheLeastSilhouetteFirst) {
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

TEST(PlanFaces, KeepsTheAxesThatBeginAtRoots) {
    for (const auto& [name, skeleton] : skeleton_zoo()) {
        SCOPED_TRACE(name);
        const FaceBudget budget = plan_faces(skeleton, {}, 100);
        EXPECT_EQ(budget.skeleton.tree_count(), skeleton.tree_count());
        EXPECT_GT(faces_of(budget), 0u);
    }
}

TEST(PlanFaces, OfASingleBranchComesNear) {
    const Skeleton stick({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 2}}, {0.1f, 0.1f});
    for (const std::uint64_t wanted : {500u, 1000u, 2000u, 5000u}) {
        SCOPED_TRACE(wanted);
        EXPECT_NEAR(static_cast<double>(faces_of(plan_faces(stick, {}, wanted))), static_cast<double>(wanted),
                    0.1 * wanted);
    }
}

TEST(PlanFaces, RefusesWhatItCannotDo) {
    const Skeleton tree = zoo_skeleton("one_segment");
    EXPECT_THROW(plan_faces(tree, {}, 99), InvalidInput);
    EXPECT_THROW(plan_faces(tree, {}, 100'000'001), InvalidInput);
    MeshOptions options;
    options.method = MeshMethod::tetrahedra;
    EXPECT_THROW(plan_faces(tree, options, 1000), InvalidInput);
}

}  // namespace
}  // namespace coppice
