#include "coppice/pipeline/quads/quad_build.h"

#include <gtest/gtest.h>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"
#include "errors.h"

namespace coppice {
namespace {

Skeleton small_tree() { return random_tree(400, 3); }

TEST(QuadBuild, AtRestIsTheMeshThatIsNeitherUnfoldedNorRemeshed) {
    const Skeleton tree = small_tree();
    MeshOptions plain;
    plain.overlaps = Overlaps::graft;  // merged branches would separate while they are dragged
    plain.untangle.passes = 0;
    plain.remesh_rounds = 0;
    const MeshResult made = mesh_skeleton(tree, plain);
    const QuadBuild build = build_quads(tree);
    EXPECT_EQ(build.refined, made.quads().mesh.positions);
    EXPECT_EQ(build.refinement.quads(), made.quads().mesh.quads);
}

TEST(QuadBuild, RefusesOptionsWithoutSuchQuads) {
    using test::error_of;
    const auto refused = [](const MeshOptions& options) {
        return error_of([&] { build_quads(small_tree(), options); });
    };
    EXPECT_EQ(refused({.method = MeshMethod::tetrahedra}),
              "mesh: method must be quads or bmesh for a surface with dragged branches");
    EXPECT_EQ(refused({.fit = Fit::volume}),
              "mesh: fit must not be volume for a surface with dragged branches");
    EXPECT_EQ(refused({.field = {.weights = Weights::global}}),
              "mesh: weights must be local for a surface with dragged branches");
}

}  // namespace
}  // namespace coppice
