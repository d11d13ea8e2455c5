#include "coppice/scene/save.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "coppice/base/hash.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

constexpr std::string_view kScene =
    "set seed 5\nsphere crown\nscale crown 1 1 1.5\nrotate crown 33.3 axis=1,0.3,0\n"
    "pointset gen crown poisson count=400\nsphere part center=0.3,0,0\npointset thin crown part 50\n"
    "grow tree crown root=0,0,-2 influence_radius=1.5 kill_radius=0.15 step=0.07 max_turn=80\n"
    "radii tree\ntidy tree\nmesh tree levels=1\n";

std::uint64_t compute_hash(const Scene& scene) {
    Hash hash;
    const auto& objects = scene.state().objects;
    const auto& points = std::get<PointSet>(objects.at({ObjectKind::points, "crown"})->value);
    const auto& tree = std::get<Skeleton>(objects.at({ObjectKind::skeleton, "tree"})->value);
    const PolygonMesh mesh = make_polygons(std::get<Surface>(objects.at({ObjectKind::mesh, "tree"})->value));
    hash.add(std::span<const Vec3>(points.positions)).add(tree.positions()).add(tree.radii());
    hash.add(std::span<const Vec3>(mesh.positions)).add(std::span<const std::uint32_t>(mesh.corners));
    return hash.value();
}

class SceneSave : public test::FolderTest {
  protected:
    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    static std::string refusal(Scene& scene, const std::string& line) {
        return test::error_of<Error>([&] { scene.run(line); });
    }
};

TEST_F(SceneSave, PreservesAttributesOfNodesThroughEditsAndMoves) {
    Scene scene;
    scene.run("limb t 0,0,0 0,0,1 0,0,2");
    const auto& limb = std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "t"})->value);
    std::vector<float> evidence(limb.size());
    for (std::size_t i = 0; i < evidence.size(); ++i) evidence[i] = static_cast<float>(i) / 100;
    write_skeleton(file("t.json"), limb, {}, std::vector<NodeAttribute>{{"evidence", evidence}});
    scene.run("loadtree m \"" + file("t.json") + "\"");
    scene.run("edit split m 2");
    scene.run("translate m 0 0 1");
    scene.run("save m \"" + file("m.json") + "\" kind=skeleton");
    const SkeletonFile read = read_skeleton(file("m.json"));
    ASSERT_EQ(read.attributes.size(), 1u);
    EXPECT_EQ(read.attributes[0].name, "evidence");
    ASSERT_EQ(read.attributes[0].values.size(), limb.size() + 1);
    EXPECT_FLOAT_EQ(read.attributes[0].values.back(), evidence.back());
}

TEST_F(SceneSave, RecipeIsBitIdentical) {
    Scene scene, again, third;
    scene.run_text(kScene, "scene");
    const std::string recipe = make_recipe(scene.state());
    again.run_text(recipe, "recipe");
    EXPECT_EQ(compute_hash(scene), compute_hash(again));
    EXPECT_EQ(make_recipe(again.state()), recipe);
    EXPECT_NE(recipe.find("seed=5"), std::string::npos);
    EXPECT_NE(recipe.find("pipe_exponent=2.5"), std::string::npos);
    third.run_text("set seed 6\n" + std::string(kScene.substr(kScene.find('\n') + 1)), "other");
    EXPECT_NE(compute_hash(scene), compute_hash(third));
}

TEST_F(SceneSave, RecipeFindsItsFilesFromAnotherFolder) {
    Scene scene;
    scene.run_text("sphere s\npolygonize s", "x");
    scene.run("save s " + quoted_word(file("ball.obj")));
    Scene adjacent({.folder = folder_});
    adjacent.run_text("loadmesh m ball.obj\nsolid m", "x");
    adjacent.run("save recipe " + quoted_word(file("r.coppice")));
    Scene elsewhere;
    elsewhere.run_text(read_file(file("r.coppice")), "r");
    EXPECT_TRUE(elsewhere.state().objects.contains({ObjectKind::solid, "m"}));
}

TEST_F(SceneSave, ExtensionDeterminesTheKind) {
    Scene scene;
    scene.run_text(kScene, "scene");
    scene.run("save tree " + quoted_word(file("tree.swc")));
    EXPECT_EQ(read_skeleton(file("tree.swc")).skeleton.size(),
              std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "tree"})->value).size());
    scene.run("save tree " + quoted_word(file("tree.glb")));
    scene.run("save crown " + quoted_word(file("crown.xyz")));
    EXPECT_TRUE(std::filesystem::exists(file("tree.glb")) && std::filesystem::exists(file("crown.xyz")));
    const std::string both = refusal(scene, "save tree " + quoted_word(file("tree.ply")));
    EXPECT_NE(both.find("add kind= and one of skeleton, mesh"), std::string::npos) << both;
    EXPECT_FALSE(std::filesystem::exists(file("tree.ply")));
    EXPECT_EQ(refusal(scene, "save tree kind=mesh " + quoted_word(file("tree.ply"))), "no error");
    const std::string solid = refusal(scene, "save part " + quoted_word(file("part.obj")));
    EXPECT_NE(solid.find("write the mesh that polygonize creates"), std::string::npos) << solid;
}

TEST_F(SceneSave, FindsTheLastSuitableObject) {
    Scene scene;
    scene.run_text(kScene, "scene");
    EXPECT_EQ(object_for_file(scene.state(), {}, "a.glb")->kind(), ObjectKind::mesh);
    EXPECT_EQ(object_for_file(scene.state(), {}, "a.ply")->kind(), ObjectKind::mesh);
    EXPECT_EQ(object_for_file(scene.state(), {}, "a.swc")->kind(), ObjectKind::skeleton);
    EXPECT_EQ(object_for_file(scene.state(), {}, "a.xyz")->kind(), ObjectKind::points);
    EXPECT_THROW(object_for_file(scene.state(), {}, "a.off"), InvalidInput);
    scene.run("undo 4");
    EXPECT_THROW(object_for_file(scene.state(), {}, "a.swc"), InvalidInput);
}

TEST_F(SceneSave, WritesNothingIfOutputsAreDisabled) {
    Scene dry({.outputs = false}), closed({.files = false});
    for (Scene* scene : {&dry, &closed}) scene->run_text("sphere s\npolygonize s", "x");
    dry.run("save s " + quoted_word(file("a.obj")));
    dry.run("render s kind=solid " + quoted_word(file("a.png")));
    dry.run("save recipe " + quoted_word(file("a.coppice")));
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
    EXPECT_NE(refusal(dry, "save s a.xyz"), "no error");
    EXPECT_THROW(closed.run("save s a.obj"), IoError);
    EXPECT_THROW(closed.run("loadmesh m a.obj"), IoError);
    EXPECT_THROW(Scene().run_text("sphere s\npolygonize s\nsave s gone/a.obj", "x"), IoError);
}

TEST_F(SceneSave, RendersEveryKindButProfiles) {
    Scene scene;
    scene.run_text(
        "sphere s\npointset gen s count=20\npolygonize s m\npath p 0,0,0 0,0,2\nprofile f circle=1\n"
        "grow t s root=0,0,-1",
        "x");
    const std::string small = " width=16 height=16 samples=1 ";
    scene.run("render m p t" + small + quoted_word(file("all.png")));
    scene.run("render s kind=solid" + small + quoted_word(file("solid.png")));
    scene.run("render s kind=points" + small + quoted_word(file("points.png")));
    EXPECT_NE(read_file(file("solid.png")), read_file(file("points.png")));
    const std::string message = refusal(scene, "render f" + small + quoted_word(file("f.png")));
    EXPECT_NE(message.find("a profile cannot be drawn"), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(file("f.png")));
}

TEST_F(SceneSave, UnsupportedOutputsAreRejectedBeforeTheSceneRuns) {
    const auto refused = [](std::string_view scene, const std::string& name) {
        return test::error_of<InvalidInput>(
            [&] { check_scene_output(*find_commands(scene_lines(scene, "x")), name); });
    };
    const std::string tree = "sphere s\npointset generate s\ngrow t s\nmesh t\n";
    for (const char* name : {"a.obj", "a.glb", "a.swc", "a.json", "a.xyz", "a.ply"})
        EXPECT_EQ(refused(tree, name), "no error") << name;
    EXPECT_NE(refused(tree, "a.foo").find("the extension of 'a.foo' is not a known format"),
              std::string::npos);
    EXPECT_NE(refused("sphere s\n", "a.swc").find("makes no object that 'a.swc' can store"),
              std::string::npos);
    EXPECT_NE(refused("sphere s\npointset generate s\n", "a.obj").find("makes no object"), std::string::npos);
    EXPECT_EQ(find_commands(scene_lines("sphere s\nshpere t\n", "x")), std::nullopt);
}

}  // namespace
}  // namespace coppice
