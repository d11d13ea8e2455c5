#include <gtest/gtest.h>

#include <string>

#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

constexpr std::string_view kTree = "limb tree 0,0,0 0,0,1 radius=0.02 tip_radius=0.004\nmesh tree levels=1\n";
constexpr std::string_view kLeaves = "leaves tree oak min_order=0 max_radius=1 shoot_length=0.5 leaf_rows=4";

class SceneLeaves : public test::FolderTest {
  protected:
    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    std::string quoted(const std::string& name) const { return "\"" + file(name) + "\""; }

    static const Surface& surface(const Scene& scene) {
        return std::get<Surface>(scene.state().objects.at({ObjectKind::mesh, "tree"})->value);
    }
    static Scene make_scene(const std::string& options = {}) {
        Scene scene;
        scene.run_text(std::string(kTree) + std::string(kLeaves) + options, "x");
        return scene;
    }
};

TEST_F(SceneLeaves, belong_to_the_surface) {
    const Scene scene = make_scene();
    const Surface& tree = surface(scene);
    ASSERT_TRUE(tree.leaves);
    // One leaf every 1.8 cm of half a metre, and one at the tip.
    EXPECT_EQ(tree.leaves->tree.foliage.report.leaves, 28u);
    EXPECT_NE(describe_object(*scene.state().objects.at({ObjectKind::mesh, "tree"})).find("leaves     28"),
              std::string::npos);
}

TEST_F(SceneLeaves, options_replace_those_of_the_species) {
    const Scene scene =
        make_scene(" leaf_internode=0.05 season=winter branchlet_length=0.2 branchlet_spacing=0.1");
    EXPECT_EQ(surface(scene).leaves->tree.branchlets, 6u);
    EXPECT_EQ(surface(scene).leaves->tree.foliage.report.leaves, 0u);
}

TEST_F(SceneLeaves, are_saved_and_drawn) {
    Scene scene = make_scene();
    scene.run("save tree " + quoted("tree.glb") + " kind=mesh");
    scene.run("save tree " + quoted("tree.obj") + " kind=mesh");
    EXPECT_NE(read_file(file("tree.glb"), 1 << 20).find("EXT_mesh_gpu_instancing"), std::string::npos);
    EXPECT_NE(read_file(file("tree.obj"), 1 << 22).find("usemtl leaf"), std::string::npos);
    const auto draw = [&](Scene& drawn, const std::string& name) {
        drawn.run("render tree " + quoted(name) + " kind=mesh width=80 height=80 samples=4");
        return read_file(file(name), 1 << 20);
    };
    Scene bare;
    bare.run_text(kTree, "x");
    EXPECT_NE(draw(scene, "leaves.png"), draw(bare, "bare.png"));
}

TEST_F(SceneLeaves, refuse_other_species_and_surfaces_without_a_skeleton) {
    Scene scene;
    scene.run_text(kTree, "x");
    EXPECT_NE(test::error_of<Error>([&] { scene.run("leaves tree lamp"); }).find("species"),
              std::string::npos);
    scene.run("sphere ball");
    scene.run("polygonize ball");
    EXPECT_NE(test::error_of<Error>([&] { scene.run("leaves ball oak"); }).find("ball"), std::string::npos);
}

}  // namespace
}  // namespace coppice
