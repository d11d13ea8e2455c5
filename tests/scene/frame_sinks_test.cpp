#include "coppice/scene/animation/frame_sinks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/io_mesh/reader.h"
#include "coppice/render/picture.h"
#include "coppice/render/png.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

QuadMesh square(float z) {
    QuadMesh mesh;
    for (const Vec3 p : {Vec3{0, 0, z}, Vec3{1, 0, z}, Vec3{1, 1, z}, Vec3{0, 1, z}})
        mesh.positions.push_back(p);
    mesh.quads.push_back({0, 1, 2, 3});
    return mesh;
}

class FrameSinksTest : public test::FolderTest {
  protected:
    /// Writes two frames.
    void write(const fs::path& path, const QuadMesh* rest) {
        FrameSeries series;
        series.count = 2;
        series.rest = rest;
        series.texture = {texture_, blends_};
        series.materials = {material_};
        series.picture.camera.width = series.picture.camera.height = 16;
        series.picture.samples = 1;
        const auto sink = open_sink(path, series);
        sink->add({square(0), series.texture}, {});
        sink->add({square(0.5f), series.texture}, {});
        sink->finish({});
    }

    /// Gives the frames a material of one colour.
    void add_material(Image::Pixel color) {
        Image image(1, 1);
        image.pixels[0] = color;
        write_file(folder_ / "bark_color.png", encode_png(image));
        texture_ = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        material_.color = folder_ / "bark_color.png";
    }
    std::string text(const char* name) const { return read_file(folder_ / name); }

    std::vector<TexturePoint> texture_;
    std::vector<TextureBlend> blends_;
    MaterialFiles material_;
};

TEST_F(FrameSinksTest, WriteTheListedFiles) {
    const QuadMesh rest = square(0);
    for (const char* name : {"a.png", "b.gif", "c.ply", "d.obj", "e.stl", "f.glb", "g.usda"}) {
        write(folder_ / name, &rest);
        for (const fs::path& file : frame_files(folder_ / name, 2)) EXPECT_TRUE(fs::remove(file)) << file;
        EXPECT_TRUE(fs::is_empty(folder_)) << name;
    }
    write(folder_ / "h.usda", nullptr);
    EXPECT_TRUE(fs::exists(folder_ / "h.usda"));
}

TEST_F(FrameSinksTest, ShowTheMaterial) {
    const QuadMesh rest = square(0);
    write(folder_ / "plain.png", &rest);
    add_material({0, 255, 0, 255});
    for (const char* name : {"a.png", "b.gif", "c.ply", "d.obj", "f.glb", "g.usda"})
        write(folder_ / name, &rest);
    write(folder_ / "h.usda", nullptr);
    const auto count_green = [&](const char* name) {
        const Image image = decode_picture(text(name), name);
        return std::ranges::count_if(image.pixels, [](Image::Pixel p) { return p[1] > 60 && p[0] < 10; });
    };
    EXPECT_EQ(count_green("plain_0001.png"), 0);
    EXPECT_GT(count_green("a_0001.png"), 10);
    EXPECT_NE(text("d_0001.mtl").find("map_Kd bark_color.png"), std::string::npos);
    for (const char* part : {"TEXCOORD_0", "baseColorTexture", "targets"})
        EXPECT_NE(text("f.glb").find(part), std::string::npos) << part;
    for (const char* name : {"g.usda", "h.usda"}) {
        EXPECT_NE(text(name).find("primvars:st"), std::string::npos) << name;
        EXPECT_NE(text(name).find("bark_color.png@"), std::string::npos) << name;
    }
    EXPECT_NE(text("h.usda").find("primvars:st.timeSamples = {\n            0: [(0, 0), (1, 0)"),
              std::string::npos);
}

TEST_F(FrameSinksTest, WriteAndShowTheSecondSetOfCoordinates) {
    const QuadMesh rest = square(0);
    add_material({0, 255, 0, 255});
    blends_ = {{{0.5f, 0}, 1}, {{1.5f, 0}, 1}, {{1.5f, 1}, 0.25f}, {{0.5f, 1}, 0}};
    Image image(2, 1);
    image.pixels = {{255, 0, 0, 255}, {0, 255, 0, 255}};
    write_file(material_.color, encode_png(image));
    for (const char* name : {"a.png", "c.ply", "f.glb", "g.usda"}) write(folder_ / name, &rest);
    write(folder_ / "h.usda", nullptr);
    const PolygonMesh back = read_mesh(folder_ / "c_0001.ply");
    EXPECT_EQ(back.texture_blends, Buffer<TextureBlend>(blends_.begin(), blends_.end()));
    EXPECT_EQ(read_mesh(folder_ / "f.glb").texture_blends.size(), 6u);  // of two triangles
    EXPECT_NE(text("g.usda").find("primvars:blend = [1, 1, 0.25, 0]"), std::string::npos);
    EXPECT_NE(text("h.usda").find("primvars:blend.timeSamples = {\n            0: [1, 1, 0.25, 0]"),
              std::string::npos);
    EXPECT_NE(text("h.usda").find("primvars:st1.timeSamples = {\n            0: [(0.5, 0), (1.5, 0)"),
              std::string::npos);
    const std::string blended = text("a_0001.png");
    blends_.clear();
    write(folder_ / "a.png", &rest);
    EXPECT_NE(text("a_0001.png"), blended);
}

TEST_F(FrameSinksTest, NumberTheFilesOfASeries) {
    const std::vector<fs::path> files = frame_files("in/a.png", 11);
    ASSERT_EQ(files.size(), 11u);
    EXPECT_EQ(files.front(), "in/a_0000.png");
    EXPECT_EQ(files.back(), "in/a_0010.png");
    EXPECT_EQ(frame_files("a.GIF", 11), std::vector<fs::path>{"a.GIF"});
}

TEST_F(FrameSinksTest, RejectOtherFormats) {
    for (const char* name : {"a", "a.swc", "a.off", "a.jpg"}) {
        EXPECT_EQ(test::error_of<InvalidInput>([&] {
                      check_frames_name(name, true);
                  }).find(fmt::format("'{}' is not a valid file name for frames", name)),
                  0u);
    }
    EXPECT_NO_THROW(check_frames_name("a.glb", true));
    EXPECT_THROW(check_frames_name("a.glb", false), InvalidInput);
    EXPECT_NO_THROW(check_frames_name("a.usda", false));
}

TEST_F(FrameSinksTest, UnfinishedFileIsNotCreated) {
    FrameSeries series;
    series.count = 2;
    const QuadMesh rest = square(0);
    series.rest = &rest;
    open_sink(folder_ / "a.glb", series)->add({rest, {}}, {});
    EXPECT_TRUE(fs::is_empty(folder_));
}

// A GLB sink stores a position of 12 bytes per vertex and frame; a sink with a file per frame stores no
// frame.
TEST_F(FrameSinksTest, ReportTheirMemory) {
    const QuadMesh rest = square(0);
    FrameSeries series;
    series.count = 1000;
    series.rest = &rest;
    EXPECT_EQ(memory_of_sink("a.glb", series, rest), 1000 * 4 * 12);
    EXPECT_EQ(memory_of_sink("a.ply", series, rest), 0);
    EXPECT_GE(memory_of_sink("a.png", series, rest),
              4.0 * series.picture.camera.width * series.picture.camera.height);
    series.rest = nullptr;
    EXPECT_EQ(memory_of_sink("a.usda", series, rest), 1000 * (4 * 12 + 16));
}

}  // namespace
}  // namespace coppice
