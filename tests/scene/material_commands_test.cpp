#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "coppice/io_mesh/reader.h"
#include "coppice/render/picture.h"
#include "coppice/render/png_reader.h"
#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "coppice/system/file.h"
#include "coppice/system/folder_sandbox.h"
#include "errors.h"
#include "small_image.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

constexpr std::string_view kTree = "limb tree 0,0,0 0,0,1 radius=0.1 tip_radius=0.05\n";

std::string refusal(Scene& scene, const std::string& line) {
    return test::error_of<Error>([&] { scene.run(line); });
}

class SceneMaterials : public test::FolderTest {
  protected:
    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    bool has_file(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

    Scene make_scene() const {
        Scene scene;
        scene.run_text(std::string(kTree) + "material bark oak width=32", "x");
        return scene;
    }

    template <class T>
    static const T& get(const Scene& scene, ObjectKind kind, const std::string& name) {
        return std::get<T>(scene.state().objects.at({kind, name})->value);
    }
};

TEST_F(SceneMaterials, HaveTheDefaultsOfTheSpecies) {
    Scene scene;
    scene.run_text(
        "material a shoot width=20\nmaterial b oak width=24 height=12\nmaterial c plated width=16 seed=3",
        "x");
    const auto bark = [&](const std::string& name) -> const BarkMaps& {
        return *get<SurfaceMaterial>(scene, ObjectKind::material, name).bark;
    };
    // The tile of a shoot is twice as high as wide; that of oak is square, so that 24 x 12 pixels show half
    // of it.
    EXPECT_EQ(bark("a").height, 40);
    EXPECT_FLOAT_EQ(bark("a").tile_height, 0.06f);
    EXPECT_EQ(bark("b").height, 12);
    EXPECT_FLOAT_EQ(bark("b").tile_height, 0.25f);
    BarkOptions pine = *find_bark("plated");
    pine.width = pine.height = 16;
    pine.seed = 3;
    EXPECT_EQ(bark("c").heights, make_bark(pine).heights);
}

TEST_F(SceneMaterials, ArePartOfGlb) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark");
    scene.run("save tree \"" + file("a.glb") + "\"");
    EXPECT_FALSE(has_file("a_bark_color.png"));
    const std::string bytes = read_file(file("a.glb"));
    EXPECT_NE(bytes.find("TEXCOORD_0"), std::string::npos);
    EXPECT_NE(bytes.find("baseColorTexture"), std::string::npos);
    EXPECT_NE(bytes.find("normalTexture"), std::string::npos);
    EXPECT_NE(bytes.find("\x89PNG"), std::string::npos);
    EXPECT_FALSE(read_mesh(file("a.glb")).texture.empty());
}

TEST_F(SceneMaterials, AreWrittenNextToObjAndUsda) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark");
    scene.run("save tree \"" + file("a.obj") + "\" kind=mesh");
    scene.run("save tree \"" + file("b.usda") + "\"");
    for (const std::string map : {"color", "normal", "height", "orm", "roughness", "occlusion"}) {
        EXPECT_TRUE(has_file("a_bark_" + map + ".png")) << map;
        EXPECT_TRUE(has_file("b_bark_" + map + ".png")) << map;
    }
    EXPECT_NE(read_file(file("a.mtl")).find("map_Kd a_bark_color.png"), std::string::npos);
    EXPECT_NE(read_file(file("b.usda")).find("@b_bark_color.png@"), std::string::npos);
    const std::string name = file("a_bark_color.png");
    EXPECT_EQ(decode_picture(read_file(name), name).width, 32);
    EXPECT_GT(decode_height_png(read_file(file("a_bark_height.png")), "a").scale, 0);
}

TEST_F(SceneMaterials, OfFilesAreReferredTo) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark");
    scene.run("save tree \"" + file("oak.obj") + "\" kind=mesh");
    scene.run("loadmaterial wood \"" + file("oak_bark_color.png") + "\"");
    scene.run("mesh tree other uv=bark material=wood displace=true displace_share=0.1");
    scene.run("save other \"" + file("c.obj") + "\"");
    EXPECT_NE(read_file(file("c.mtl")).find("map_Kd oak_bark_color.png"), std::string::npos);
    EXPECT_FALSE(has_file("c_wood_color.png"));
}

TEST_F(SceneMaterials, AreDrawn) {
    Scene scene = make_scene();
    scene.run_text(
        "mesh tree plain uv=bark\nmesh tree oak uv=bark material=bark\nmaterial pale birch width=32\n"
        "mesh tree birch uv=bark material=pale",
        "x");
    const auto draw = [&](const std::string& objects) {
        scene.run("render " + objects + " width=48 height=48 samples=2 " + quoted_word(file("a.png")));
        return decode_picture(read_file(file("a.png")), "a.png");
    };
    EXPECT_NE(draw("plain"), draw("oak"));
    EXPECT_NE(draw("oak"), draw("birch"));
}

TEST_F(SceneMaterials, AreBlendedByTheSecondCoordinates) {
    Scene scene = make_scene();
    write_file(file("fork.swc"),
               "1 0 0 0 0 0.1 -1\n2 0 0 0 1 0.1 1\n3 0 0 0 2 0.09 2\n4 0 0.8 0 1.6 0.04 2\n");
    scene.run("loadtree fork " + quoted_word(file("fork.swc")));
    scene.run_text(
        "mesh fork plain uv=bark material=bark\nmesh fork blended uv=bark material=bark uv_blend=true", "x");
    const auto draw = [&](const std::string& objects) {
        scene.run("render " + objects + " kind=mesh width=48 height=48 samples=2 " +
                  quoted_word(file("a.png")));
        return decode_picture(read_file(file("a.png")), "a.png");
    };
    EXPECT_NE(draw("plain"), draw("blended"));
    EXPECT_NE(draw("blended plain"), draw("plain"));  // both in one drawing
    scene.run("save blended " + quoted_word(file("b.ply")));
    EXPECT_FALSE(read_mesh(file("b.ply")).texture_blends.empty());
}

TEST_F(SceneMaterials, OfFilesAreDrawnAsThoseOfBark) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark");
    const std::string options = " kind=mesh width=48 height=48 samples=2 ";
    scene.run("render tree" + options + quoted_word(file("a.png")));
    scene.run("save tree kind=mesh " + quoted_word(file("a.obj")));  // writes the images
    scene.run("loadmaterial wood " + quoted_word(file("a_bark_color.png")));
    scene.run("mesh tree uv=bark material=wood");
    scene.run("render tree" + options + quoted_word(file("b.png")));
    EXPECT_EQ(read_file(file("a.png")), read_file(file("b.png")));
    // One drawing may contain meshes with and without materials, and other objects.
    scene.run_text("mesh tree oak uv=bark material=wood\nmesh tree plain\nsphere ball", "x");
    scene.run("render oak plain ball width=16 height=16 samples=1 " + quoted_word(file("c.png")));
    EXPECT_TRUE(has_file("c.png"));
}

// The limb ends flat at its base, and its upper half is thinner than 0.15 m.
TEST_F(SceneMaterials, HaveSlotsOfTwigsAndCuts) {
    Scene scene = make_scene();
    scene.run_text("material twig birch width=32\ncutmaterial wood oak size=32", "x");
    scene.run("mesh tree uv=bark material=bark twig_material=twig twig_diameter=0.15 cut_material=wood");
    const Surface& surface = get<Surface>(scene, ObjectKind::mesh, "tree");
    ASSERT_EQ(surface.materials.size(), 3u);
    EXPECT_EQ(surface.slots.size(), face_count(surface));
    for (const std::uint32_t slot : {0u, 1u, 2u})
        EXPECT_GT(std::ranges::count(surface.slots, slot), 0) << slot;
    EXPECT_NE(scene.run("describe tree").find("material   bark, twig, wood"), std::string::npos);
    scene.run("save tree kind=mesh " + quoted_word(file("a.obj")));
    for (const char* name : {"bark", "twig", "wood"}) {
        EXPECT_TRUE(has_file(std::string("a_") + name + "_color.png")) << name;
        EXPECT_NE(read_file(file("a.obj")).find(std::string("usemtl ") + name), std::string::npos) << name;
    }
    scene.run("save tree kind=mesh " + quoted_word(file("a.glb")));
    EXPECT_EQ(read_mesh(file("a.glb")).group_names.size(), 3u);
    scene.run("mesh tree plain uv=bark material=bark");
    const auto draw = [&](const std::string& object) {
        scene.run("render " + object + " kind=mesh width=48 height=48 samples=2 " +
                  quoted_word(file("a.png")));
        return decode_picture(read_file(file("a.png")), "a.png");
    };
    EXPECT_NE(draw("tree"), draw("plain"));
    Scene again;
    again.run_text(make_recipe(scene.state()), "recipe");
    EXPECT_EQ(get<Surface>(again, ObjectKind::mesh, "tree").slots, surface.slots);
}

// The same material for two slots needs two names in a file.
TEST_F(SceneMaterials, OfSlotsHaveDifferentNames) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark twig_material=bark twig_diameter=0.15");
    EXPECT_EQ(get<Surface>(scene, ObjectKind::mesh, "tree").materials[2].empty(), true);
    scene.run("save tree kind=mesh " + quoted_word(file("a.usda")));
    EXPECT_NE(read_file(file("a.usda")).find("bark_2"), std::string::npos);
    scene.run("save tree kind=mesh " + quoted_word(file("a.ply")));
}

TEST_F(SceneMaterials, RejectSlotsWithoutMaterials) {
    Scene scene = make_scene();
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark twig_material=bark"),
              "mesh: twig_material= and cut_material= need material= for the other faces");
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark cut_material=bark"),
              "mesh: twig_material= and cut_material= need material= for the other faces");
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark material=bark twig_diameter=0.1"),
              "mesh: twig_diameter= needs twig_material=");
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark material=bark twig_material=bark method=cylinders"),
              "mesh: twig_material= needs another method than cylinders");
    EXPECT_NE(refusal(scene, "cutmaterial x okk"), "no error");
    EXPECT_NE(refusal(scene, "cutmaterial x oak size=100000"), "no error");
}

TEST_F(SceneMaterials, DisplaceSurfaces) {
    Scene scene = make_scene();
    scene.run("mesh tree plain uv=bark tile=0.1");
    const std::string output = scene.run("mesh tree rough uv=bark tile=0.1 material=bark displace=true");
    EXPECT_EQ(output.find("displaced by up to "), 0u) << output;
    const auto positions = [&](const std::string& name) {
        return std::get<QuadMesh>(get<Surface>(scene, ObjectKind::mesh, name).mesh).positions;
    };
    EXPECT_EQ(positions("plain").size(), positions("rough").size());
    EXPECT_NE(positions("plain"), positions("rough"));
}

TEST_F(SceneMaterials, AreRecorded) {
    Scene scene = make_scene();
    scene.run("mesh tree uv=bark material=bark displace=true");
    Scene again;
    again.run_text(make_recipe(scene.state()), "recipe");
    const auto positions = [](const Scene& s) {
        return std::get<QuadMesh>(get<Surface>(s, ObjectKind::mesh, "tree").mesh).positions;
    };
    EXPECT_EQ(positions(scene), positions(again));
    EXPECT_EQ(get<SurfaceMaterial>(scene, ObjectKind::material, "bark").bark->color,
              get<SurfaceMaterial>(again, ObjectKind::material, "bark").bark->color);
}

TEST_F(SceneMaterials, RejectUnsuitableValues) {
    Scene scene = make_scene();
    EXPECT_EQ(refusal(scene, "mesh tree material=bark"), "mesh: material= needs uv=bark");
    EXPECT_EQ(refusal(scene, "mesh tree uv=atlas material=bark"), "mesh: material= needs uv=bark");
    for (const char* options : {"", " uv=atlas", " uv=bark method=cylinders"}) {
        EXPECT_EQ(refusal(scene, std::string("mesh tree uv_blend=true") + options),
                  "mesh: uv_blend= needs uv=bark, and another method than cylinders");
    }
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark displace=true"),
              "mesh: displace= needs a material with heights; add material=");
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark material=tree"), "'tree' is a skeleton, not a material");
    EXPECT_EQ(refusal(scene, "mesh tree uv=bark material=brak"),
              "there is no material 'brak'; did you mean bark?");
    EXPECT_NE(refusal(scene, "mesh tree uv=bark tile=0"), "no error");
    EXPECT_NE(refusal(scene, "mesh tree uv=bark tile=nan"), "no error");
    EXPECT_NE(refusal(scene, "mesh tree uv=none material=bark displace=true"), "no error");
    EXPECT_NE(refusal(scene, "mesh tree uv=bark material=bark displace=true displace_height=-1"), "no error");
    EXPECT_NE(refusal(scene, "material x okk"), "no error");
    EXPECT_NE(refusal(scene, "material x"), "no error");
    EXPECT_NE(refusal(scene, "material x oak width=100000"), "no error");
    EXPECT_NE(refusal(scene, "material x oak color=1,2"), "no error");
    EXPECT_EQ(refusal(scene, "loadmaterial x nothing.png"),
              "loadmaterial: 'nothing.png' is not the name of a colour; name PREFIX_color.png, as coppice "
              "texture writes it");
    EXPECT_NE(refusal(scene, "loadmaterial x nothing_color.png"), "no error");
    EXPECT_EQ(
        refusal(scene, "save bark bark.png"),
        "save: 'bark.png' is not a valid file name for a material; it is saved by: save recipe FILE.coppice");
    EXPECT_EQ(refusal(scene, "render bark a.png"),
              "render: a material cannot be drawn; draw a mesh that has it");
    EXPECT_NE(scene.run("describe bark").find("pixels     32 x 32"), std::string::npos);
}

TEST_F(SceneMaterials, RespectTheMemoryLimit) {
    Scene scene({.max_memory = 8});
    EXPECT_NE(refusal(scene, "material x oak width=2048").find("MiB"), std::string::npos);
}

// Images next to an allowed colour may lead out of the sandbox.
TEST_F(SceneMaterials, StayInTheSandbox) {
    std::filesystem::create_directory(folder_ / "inner");
    write_file(folder_ / "secret.png", "secret");
    write_file(folder_ / "inner/a_color.png", small_image());
    std::filesystem::create_symlink(folder_ / "secret.png", folder_ / "inner/a_normal.png");
    SceneSettings settings;
    settings.sandbox = std::make_shared<FolderSandbox>(folder_ / "inner");
    Scene scene(settings);
    EXPECT_NE(refusal(scene, "loadmaterial x a_color.png"), "no error");
    std::filesystem::remove(folder_ / "inner/a_normal.png");
    EXPECT_EQ(refusal(scene, "loadmaterial x a_color.png"), "no error");
    EXPECT_NE(refusal(scene, "loadmaterial x ../secret_color.png"), "no error");
}

}  // namespace
}  // namespace coppice
