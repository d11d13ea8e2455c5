#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "coppice/scene/scene.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

/// A stem of 2 m: 200 pixels at 100 per metre, 20 wide at its base and 10 at its tip, so that the radii are
/// 0.1 m and 0.05 m.
class SceneSketch : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        scene = Scene({.sandbox = std::make_shared<const FolderSandbox>(folder_)});
        write("stem.sketch.json", R"("orthographic": "side", "pixels_per_metre": 100, "origin": [200, 300])",
              "");
    }

    /// `side` is the camera of the second view; `more` contains branches after the stem.
    void write(const std::string& name, const std::string& side, const std::string& more) {
        const std::string stroke = R"({"points": [[200, 300], [200, 100]], "widths": [20, 10]})";
        std::ofstream(folder_ / name) << fmt::format(
            R"({{"format": "coppice-sketch", "version": 1, "views": [
                {{"name": "front", "orthographic": "front", "pixels_per_metre": 100, "origin": [200, 300]}},
                {{"name": "side", {0}}}],
                "branches": [{{"name": "stem", "strokes": {{"front": {1}, "side": {1}}}}}{2}]}})",
            side, stroke, more);
    }
    const Skeleton& tree(const std::string& name) const {
        return std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, name})->value);
    }
    std::string refusal(const std::string& line) {
        return test::error_of<Error>([&] { scene.run(line); });
    }

    Scene scene;
};

TEST_F(SceneSketch, ReconstructsATreeFromStrokes) {
    const std::string message = scene.run("sketch t stem.sketch.json");
    const Skeleton& t = tree("t");
    EXPECT_EQ(message, fmt::format("{} nodes of 1 branch\n", t.size()));
    const NodeId root(0), tip(static_cast<std::uint32_t>(t.size() - 1));
    EXPECT_NEAR(t.position(root).z, 0, 0.02);
    EXPECT_NEAR(t.position(tip).z, 2, 0.02);
    EXPECT_NEAR(t.radius(root), 0.1, 0.005);
    EXPECT_NEAR(t.radius(tip), 0.05, 0.005);
}

TEST_F(SceneSketch, ReportsOmittedBranches) {
    write(
        "fork.sketch.json", R"("orthographic": "side", "pixels_per_metre": 100, "origin": [200, 300])",
        R"(, {"name": "twig", "parent": "stem", "strokes": {"front": {"points": [[200, 200], [260, 120]]}}})");
    const std::string message = scene.run("sketch t fork.sketch.json");
    EXPECT_NE(message.find("nodes of 1 branch\nleft out: "), std::string::npos) << message;
    EXPECT_NE(message.find("twig"), std::string::npos) << message;
}

TEST_F(SceneSketch, AcceptsOptions) {
    EXPECT_NE(refusal("sketch t stem.sketch.json min_angle=100").find("min_angle"), std::string::npos);
    EXPECT_EQ(refusal("sketch t stem.sketch.json max_error=5"), "no error");
}

TEST_F(SceneSketch, RejectsFilesOutsideTheFolder) {
    EXPECT_NE(refusal("sketch t ../stem.sketch.json").find("../stem.sketch.json"), std::string::npos);
    write("led.sketch.json", R"("image": "a.png", "colmap": "../sparse")", "");
    EXPECT_NE(refusal("sketch t led.sketch.json").find("../sparse"), std::string::npos);
}

}  // namespace
}  // namespace coppice
