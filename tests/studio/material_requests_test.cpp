#include <gtest/gtest.h>

#include <filesystem>

#include "coppice/scene/bark_images.h"
#include "coppice/system/file.h"
#include "coppice/texture/bark.h"
#include "coppice/texture/cut.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

BarkMaps make_small_bark() {
    BarkOptions options;
    options.width = options.height = 32;
    return make_bark(options);
}

/// A limb with a surface of bark.
class MaterialRequests : public test::SessionTest {
  protected:
    void make_surface(const std::string& material) {
        run("limb t 0,0,0 0,0,1 0,0,2 radius=0.1");
        run(material);
        run("mesh t levels=0 uv=bark material=m");
    }
    /// Returns the keys of the images of all slots.
    Json slots() { return must({{"type", "material"}, {"name", "t"}})["images"]; }
    Json images() { return slots().at(0); }
    std::string image(const Json& keys, const char* map) {
        const auto bytes = blobs_.get(keys[map].get<std::string>());
        return bytes ? *bytes : "";
    }
    void write_bark(const BarkMaps& maps) {
        for (const BarkImage& image : encode_bark(maps))
            write_file(folder_ / make_bark_file_name("small", image.map), image.bytes);
    }
};

TEST_F(MaterialRequests, OfferTheImagesOfBarkByProgram) {
    make_surface("material m oak width=32");
    const Json keys = images();
    ASSERT_EQ(keys.size(), 4u);
    const BarkMaps maps = make_small_bark();
    for (const char* map : {"color", "normal", "roughness", "occlusion"})
        EXPECT_EQ(image(keys, map), encode_bark_map(maps, map)) << map;
}

TEST_F(MaterialRequests, KeepTheKeysOfEqualImages) {
    make_surface("material m oak width=32");
    const Json before = images();
    must({{"type", "text"},
          {"text",
           "limb t 0,0,0 0,0,1 radius=0.1\nmaterial m oak width=32\nmesh t levels=0 uv=bark material=m\n"},
          {"revision", session_->state()["revision"]}});
    EXPECT_EQ(images(), before);
    EXPECT_FALSE(image(before, "color").empty());  // of the second bark: the first one no longer exists
    run("material m pine width=32");
    run("mesh t levels=0 uv=bark material=m");
    EXPECT_NE(images(), before);
}

// The limb ends flat at its base; its slot of twigs has no material.
TEST_F(MaterialRequests, OfferTheImagesOfSlots) {
    run("limb t 0,0,0 0,0,1 0,0,2 radius=0.1");
    run("material m oak width=32");
    run("cutmaterial wood oak size=32");
    run("mesh t levels=0 uv=bark material=m cut_material=wood");
    const Json keys = slots();
    ASSERT_EQ(keys.size(), 3u);
    EXPECT_EQ(keys[0].size(), 4u);
    EXPECT_EQ(keys[1], Json::object());
    CutOptions wood;
    wood.size = 32;
    EXPECT_EQ(image(keys[2], "color"), encode_bark_map(make_cut(wood), "color"));
}

TEST_F(MaterialRequests, OfferTheImagesInFiles) {
    write_bark(make_small_bark());
    std::filesystem::remove(folder_ / "small_occlusion.png");
    make_surface("loadmaterial m small_color.png");
    const Json keys = images();
    EXPECT_EQ(keys.size(), 3u);
    for (const char* map : {"color", "normal", "roughness"})
        EXPECT_EQ(image(keys, map), read_file(folder_ / make_bark_file_name("small", map))) << map;
    EXPECT_EQ(images(), keys);
    write_file(folder_ / "small_color.png", "another image");
    EXPECT_NE(images()["color"], keys["color"]);
    EXPECT_EQ(image(images(), "color"), "another image");
}

TEST_F(MaterialRequests, RefuseFilesOutsideOfTheFolder) {
    const std::filesystem::path outside = folder_.parent_path() / "outside_color.png";
    write_bark(make_small_bark());
    EXPECT_FALSE(refused({{"type", "run"}, {"line", "loadmaterial m ../outside_color.png"}}).empty());
    make_surface("loadmaterial m small_color.png");
    std::filesystem::remove(folder_ / "small_color.png");
    std::filesystem::create_symlink(outside, folder_ / "small_color.png");
    EXPECT_FALSE(refused({{"type", "material"}, {"name", "t"}}).empty());
    EXPECT_EQ(blobs_.get("small_color.png"), nullptr);
    EXPECT_EQ(blobs_.get("../outside_color.png"), nullptr);
}

TEST_F(MaterialRequests, HaveNoImagesForOtherMeshes) {
    run("limb t 0,0,0 0,0,1 radius=0.1");
    run("mesh t levels=0");
    EXPECT_EQ(slots(), Json::array());
    EXPECT_EQ(refused({{"type", "material"}, {"name", "u"}}), "there is no mesh 'u'");
}

TEST_F(MaterialRequests, RefuseImagesBeyondTheMemoryLimit) {
    options_.scene.max_memory = 64;  // MiB, of which a 32nd is for one blob: 2 MiB
    reopen();
    make_surface("material m oak width=900");  // 2.3 MiB of colours
    EXPECT_NE(refused({{"type", "material"}, {"name", "t"}}).find("--max-memory"), std::string::npos);
}

TEST_F(MaterialRequests, MaterialsAreObjectsOfTheState) {
    make_surface("material m oak width=32");
    const Json objects = session_->state()["objects"];
    ASSERT_EQ(objects.size(), 3u);
    const Json& material = objects.back();
    EXPECT_EQ(material["kind"], "material");
    EXPECT_EQ(material["name"], "m");
    EXPECT_EQ(material["statement"], 1);
    EXPECT_LT(material["bounds"][3], material["bounds"][0]);  // no extent
    must({{"type", "preview"}, {"seq", 1}, {"line", "material m pine width=32"}});
    EXPECT_TRUE(frames_.empty());
}

}  // namespace
}  // namespace coppice
