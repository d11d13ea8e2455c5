#include <gtest/gtest.h>

#include <numbers>

#include "coppice/io_sketch/phenomenal_internal.h"
#include "coppice/io_sketch/sketch_file.h"
#include "coppice/system/file.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

using test::error_of;

/// Five metres in front of the table, level, rotated to the left by 0.01 radians; its lateral offset shifts
/// it back.
constexpr const char* kCalibration = R"({"angle_factor": 2, "clockwise": true, "cameras_parameters": {
 "side": {"_focal_length_x": 1000, "_focal_length_y": 1100, "_height_image": 800, "_width_image": 600,
          "_pos_x": 50, "_pos_y": -5000, "_pos_z": 100, "_rot_x": -1.5707963267948966, "_rot_y": 0, "_rot_z": 0.01},
 "top": {"_focal_length_x": 1000, "_focal_length_y": 1000, "_height_image": 600, "_width_image": 800,
         "_pos_x": 0, "_pos_y": 0, "_pos_z": 2000, "_rot_x": 3.141592653589793, "_rot_y": 0, "_rot_z": 0}}})";

class Phenomenal : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        AtomicFile file(folder_ / "c.json");
        file.write(kCalibration);
        file.commit();
    }
};

TEST_F(Phenomenal, ReadsCameras) {
    const SketchView side = read_phenomenal_view(folder_ / "c.json", "side", 0);
    EXPECT_EQ(side.width, 600);
    EXPECT_EQ(side.height, 800);
    // A rotation to the left by 0.01 about z moves points straight ahead to the right: by 50 mm at 5 m, equal
    // to the offset of the camera to the right, except for the cosine.
    const PicturePoint p = project(side, {0, 0, 0.1});
    EXPECT_NEAR(p.x, 300, 0.1);
    EXPECT_NEAR(p.y, 400, 1e-9);
    EXPECT_NEAR(depth(side, {0, 0, 0.1}), 5, 1e-3);
    // 0.2 m above the axis at 5 m: 1100 * 0.2 / 5 pixels up.
    EXPECT_NEAR(project(side, {0, 0, 0.3}).y, 400 - 44, 0.01);
}

TEST_F(Phenomenal, AngleRotatesThePlant) {
    // 45 degrees by a factor of 2 clockwise: points to the right of the side camera are then in front of it.
    const double angle = std::numbers::pi / 4;
    const SketchView side = read_phenomenal_view(folder_ / "c.json", "side", angle);
    EXPECT_NEAR(depth(side, {1, 0, 0.1}), 4, 2e-3);
    // The upper camera looks down, its x is the world's: that point is then at -y, the lower half of the
    // image.
    const SketchView top = read_phenomenal_view(folder_ / "c.json", "top", angle);
    EXPECT_NEAR(project(top, {1, 0, 0}).x, 400, 1e-9);
    EXPECT_NEAR(project(top, {1, 0, 0}).y, 300 + 500, 1e-9);
}

TEST_F(Phenomenal, ReadsSketchesWithPhenomenalCameras) {
    const std::string view = R"({"name": "a", "phenomenal": "c.json", "camera": "side", "angle": 45})";
    const std::string text = R"({"format": "coppice-sketch", "version": 1, "views": [)" + view + R"(,
        {"name": "b", "phenomenal": "c.json", "camera": "top", "angle": 45}], "branches": [
        {"name": "stem", "diameters": [0.1, 0.1], "strokes": {"a": {"points": [[0, 0], [1, 1]]}, "b": {"points": [[0, 0], [1, 1]]}}}]})";
    const Sketch sketch = parse_sketch(text, "t", folder_);
    EXPECT_NEAR(depth(sketch.views[0], {1, 0, 0.1}), 4, 2e-3);
}

TEST_F(Phenomenal, ReportsErrors) {
    const std::string file = (folder_ / "c.json").string();
    EXPECT_EQ(error_of([&] { read_phenomenal_view(file, "back", 0); }),
              file + ": cameras_parameters has no 'back'; there are side, top");
    AtomicFile other(folder_ / "old.json");
    other.write(R"({"cam_focal_length_x": 4000})");
    other.commit();
    EXPECT_EQ(error_of([&] { read_phenomenal_view(folder_ / "old.json", "side", 0); }),
              (folder_ / "old.json").string() + ": cameras_parameters is missing");
}

}  // namespace
}  // namespace coppice
