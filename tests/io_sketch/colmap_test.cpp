#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "coppice/io_sketch/colmap_internal.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

using test::error_of;

void write(const std::filesystem::path& path, const std::string& text) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
}

/// A folder with two cameras and two images: a.jpg looks along +z of COLMAP's world, b.jpg along +x.
class Colmap : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        write(folder_ / "cameras.txt",
              "# Camera list\n1 OPENCV 4000 3000 3100 3110 2000 1500 0.1 -0.02 0.001 0.002\n2 SIMPLE_RADIAL "
              "800 600 700 400 300 0.05\n"
              "3 FISHEYE 800 600 700\n");
        write(folder_ / "images.txt",
              "# Image list\n1 1 0 0 0 0.5 1 2 1 a.jpg\n10 20 -1 30 40 7\n2 0.70710678 0 -0.70710678 0 0 1 3 "
              "2 b.jpg\n\n3 1 0 0 0 0 0 0 3 c.jpg\n\n");
    }
};

TEST_F(Colmap, ReadsCameras) {
    const SketchView a = read_colmap_view(folder_, "a.jpg");
    EXPECT_EQ(a.width, 4000);
    EXPECT_EQ(a.k, (Matrix3{{{3100, 0, 2000}, {0, 3110, 1500}, {0, 0, 1}}}));
    EXPECT_EQ(a.distortion, (std::array<double, 5>{0.1, -0.02, 0.001, 0.002, 0}));
    EXPECT_EQ(a.t, (Vec3d{0.5, 1, 2}));
    const SketchView b = read_colmap_view(folder_, "b.jpg");
    EXPECT_EQ(b.k[1][1], 700);
    EXPECT_EQ(b.distortion[0], 0.05);
    // A quarter turn about -y: points along +x are then in front of the camera.
    EXPECT_NEAR(length(b.r * Vec3d{1, 0, 0} - Vec3d{0, 0, 1}), 0, 1e-7);
}

TEST_F(Colmap, ReportsErrors) {
    const std::string path = folder_.string();
    EXPECT_EQ(error_of([&] { read_colmap_view(folder_, "d.jpg"); }),
              path + "/images.txt: no image is named 'd.jpg'");
    EXPECT_EQ(error_of<Unsupported>([&] { read_colmap_view(folder_, "c.jpg"); }),
              path +
                  "/cameras.txt:4: the camera model 'FISHEYE' is not read; undistort the images with COLMAP, "
                  "which writes PINHOLE");
    write(folder_ / "images.txt", "1 1 0 0 zero 0 0 0 1 a.jpg\n\n");
    EXPECT_EQ(error_of([&] { read_colmap_view(folder_, "a.jpg"); }),
              path + "/images.txt:1: 'zero' is not a number");
    write(folder_ / "images.txt", "1 1 0 0 0 0 0 0 9 a.jpg\n\n");
    EXPECT_EQ(error_of([&] { read_colmap_view(folder_, "a.jpg"); }),
              path + "/cameras.txt: there is no camera 9, which took 'a.jpg'");
    for (const char* const size : {"1e30 600", "800 nan", "0 600"}) {
        write(folder_ / "cameras.txt", fmt::format("9 PINHOLE {} 700 700 400 300\n", size));
        EXPECT_EQ(error_of([&] { read_colmap_view(folder_, "a.jpg"); }),
                  path + "/cameras.txt:1: the width and height of a camera must be whole numbers of pixels");
    }
    EXPECT_NE(error_of<IoError>([&] { read_colmap_view(folder_ / "gone", "a.jpg"); }), "no error");
}

TEST_F(Colmap, ReadsSketchesWithColmapCameras) {
    // COLMAP's y points down as in its first image, and its unit is half a metre.
    const std::string text =
        R"({"format": "coppice-sketch", "version": 1, "world": {"up": [0, -1, 0], "metres_per_unit": 0.5},
        "views": [{"name": "a", "image": "a.jpg", "colmap": "."}, {"name": "b", "image": "b.jpg", "colmap": "."}],
        "branches": [{"name": "stem", "strokes": {"a": {"points": [[1, 2], [3, 4]], "widths": [1, 1]}, "b": {"points": [[1, 2], [3, 4]]}}}]})";
    const Sketch sketch = parse_sketch(text, "x", folder_);
    // Up in our world is up in the image.
    EXPECT_LT(project(without_distortion(sketch.views[0]), {0, 2, 1}).y,
              project(without_distortion(sketch.views[0]), {0, 2, 0}).y);
    EXPECT_EQ(sketch.views[0].t, (Vec3d{0.25, 0.5, 1}));
    EXPECT_EQ(parse_sketch(text, "x", FolderSandbox(folder_)).views[0].t, sketch.views[0].t);
}

TEST_F(Colmap, SketchesInASandboxReadNothingOutside) {
    std::filesystem::create_directory(folder_ / "home");
    std::filesystem::create_directory_symlink(folder_, folder_ / "home" / "link");
    const FolderSandbox sandbox(folder_ / "home");
    const auto sketch_with = [](const std::string& view) {
        return R"({"format": "coppice-sketch", "version": 1, "views": [{"name": "a", )" + view +
               R"(}], "branches": []})";
    };
    for (const std::string& name : {std::string(".."), folder_.string(), std::string("link")}) {
        for (const std::string& view :
             {R"("image": "a.jpg", "colmap": ")" + name + "\"",
              R"("phenomenal": ")" + name + R"(/cameras.txt", "camera": "a", "angle": 0)"}) {
            SCOPED_TRACE(view);
            EXPECT_NE(error_of<IoError>([&] { parse_sketch(sketch_with(view), "x", sandbox); }), "no error");
        }
    }
}

TEST(Rotation, VectorsAndQuaternionsMatch) {
    // A third of a turn about (1, 1, 1) maps x to y and y to z.
    const double angle = 2 * std::numbers::pi / 3 / std::sqrt(3);
    const Matrix3 r = rotation_about({angle, angle, angle});
    EXPECT_NEAR(length(r * Vec3d{1, 0, 0} - Vec3d{0, 1, 0}), 0, 1e-12);
    EXPECT_NEAR(length(r * Vec3d{0, 1, 0} - Vec3d{0, 0, 1}), 0, 1e-12);
    EXPECT_EQ(rotation_about({0, 0, 0}), (Matrix3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}));
}

}  // namespace
}  // namespace coppice
