#include "coppice/scene/animation/frame_sinks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "coppice/base/error.h"
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
        series.picture.camera.width = series.picture.camera.height = 16;
        series.picture.samples = 1;
        const auto sink = open_sink(path, series);
        sink->add(square(0), {});
        sink->add(square(0.5f), {});
        sink->finish({});
    }
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
    open_sink(folder_ / "a.glb", series)->add(rest, {});
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
