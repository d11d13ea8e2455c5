#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

/// A stem of 2 m and a radius of 0.2 m, as a surface and as points.
class SceneExtract : public test::FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        scene = Scene(settings());
        std::ofstream(folder_ / "stem.xyz") << ring_points(0);
        std::ofstream(folder_ / "lying.xyz") << ring_points(1);
        std::ofstream(folder_ / "stem.swc") << "1 1 0 0 0 0.2 -1\n2 1 0 0 2 0.2 1\n";
        scene.run_text(
            "limb t 0,0,0 0,0,2 radius=0.2 tip_radius=0.2\nmesh t levels=2\nsave t tube.ply kind=mesh",
            "made");
        scene.run("pointset load p stem.xyz");
    }

    SceneSettings settings(int max_memory = 4096) const {
        return {.max_memory = max_memory, .sandbox = std::make_shared<const FolderSandbox>(folder_)};
    }

    /// Rings of 30 points; with `up` 1 the y axis points up.
    static std::string ring_points(int up, int rings = 40) {
        std::string out = "x y z\n";
        for (int ring = 0; ring < rings; ++ring) {
            for (int k = 0; k < 30; ++k) {
                const double a = 2 * std::numbers::pi * k / 30, x = 0.2 * std::cos(a), y = 0.2 * std::sin(a),
                             z = 2.0 * ring / rings;
                out += up == 1 ? fmt::format("{} {} {}\n", x, z, -y) : fmt::format("{} {} {}\n", x, y, z);
            }
        }
        return out;
    }

    const SceneObject& object(const std::string& name) const {
        return *scene.state().objects.at({ObjectKind::skeleton, name});
    }
    const Skeleton& tree(const std::string& name) const { return std::get<Skeleton>(object(name).value); }
    std::string refusal(const std::string& line) {
        return test::error_of<Error>([&] { scene.run(line); });
    }
    static bool same(const Skeleton& a, const Skeleton& b) {
        return std::ranges::equal(a.parents(), b.parents()) &&
               std::ranges::equal(a.positions(), b.positions()) && std::ranges::equal(a.radii(), b.radii());
    }
    /// Checks that the skeleton is that stem, within a tenth of its radius.
    static void expect_stem(const Skeleton& s) {
        float low = 9, high = -9;
        for (const NodeId n : nodes(s)) {
            EXPECT_NEAR(s.radius(n), 0.2f, 0.02f);
            low = std::min(low, s.position(n).z);
            high = std::max(high, s.position(n).z);
        }
        EXPECT_NEAR(low, 0.0f, 0.25f);
        EXPECT_NEAR(high, 2.0f, 0.25f);
    }
    std::vector<std::string> attributes(const std::string& name) const {
        std::vector<std::string> out;
        for (const NodeAttribute& a : object(name).attributes) {
            EXPECT_EQ(a.values.size(), tree(name).size());
            out.push_back(a.name);
        }
        return out;
    }

    Scene scene;
};

TEST_F(SceneExtract, ReadsAMesh) {
    const std::string message = scene.run("extract a tube.ply");
    EXPECT_EQ(message,
              fmt::format("tube.ply taken for a mesh: {} nodes in 1 tree, 0 loops cut\n", tree("a").size()));
    expect_stem(tree("a"));
    EXPECT_EQ(attributes("a"), (std::vector<std::string>{"samples", "residual"}));
    scene.run("extract b from=t");
    EXPECT_TRUE(same(tree("a"), tree("b")));
}

TEST_F(SceneExtract, ReadsACloud) {
    const std::string message = scene.run("extract a stem.xyz ground=none");
    EXPECT_TRUE(message.starts_with(
        fmt::format("stem.xyz taken for a cloud of points: {} nodes in 1 tree, height ", tree("a").size())))
        << message;
    expect_stem(tree("a"));
    EXPECT_EQ(attributes("a"),
              (std::vector<std::string>{"samples", "residual", "radius_low", "radius_high", "evidence"}));
    scene.run("extract b from=p ground=none");
    EXPECT_TRUE(same(tree("a"), tree("b")));
}

TEST_F(SceneExtract, RotatesInputWithYUp) {
    scene.run("extract a stem.xyz ground=none");
    scene.run("extract b lying.xyz ground=none up=y");
    EXPECT_TRUE(same(tree("a"), tree("b")));
}

TEST_F(SceneExtract, RootFollowsTheOption) {
    scene.run("extract a tube.ply root=0,0,2");
    scene.run("extract b stem.xyz ground=none root=0,0,2");
    for (const char* name : {"a", "b"}) EXPECT_GT(tree(name).position(NodeId(0)).z, 1.5f) << name;
}

TEST_F(SceneExtract, EvidenceIsPreservedByEdits) {
    scene.run("extract a stem.xyz ground=none");
    scene.run("edit scale a roots 2");
    EXPECT_EQ(attributes("a").back(), "evidence");
}

TEST_F(SceneExtract, RejectsOptionsWithoutEffect) {
    EXPECT_EQ(refusal("extract a tube.ply voxel=0.1"),
              "extract: voxel= is for clouds of points, and 'tube.ply' is taken for a mesh");
    EXPECT_EQ(refusal("extract a tube.ply wood_classes=4"),
              "extract: wood_classes= is for clouds of points, and 'tube.ply' is taken for a mesh");
    EXPECT_EQ(refusal("extract a from=p method=contraction"),
              "extract: method= is for meshes, and 'p' is taken for a cloud of points");
    EXPECT_EQ(refusal("extract a from=p up=y"), "extract: up= is for files, and 'p' is an object");
    EXPECT_EQ(refusal("extract a stem.xyz ground_height=1"),
              "extract: ground_height= applies only to the rule height; add ground=height");
    EXPECT_EQ(refusal("extract a tube.ply voxel=0"), "no error");  // the default
}

TEST_F(SceneExtract, ReportsMissingInput) {
    const std::string one =
        "extract: a file or from=OBJECT is the source of the skeleton; give exactly one of them";
    EXPECT_EQ(refusal("extract a"), one);
    EXPECT_EQ(refusal("extract a tube.ply from=t"), one);
    EXPECT_EQ(refusal("extract a stem.swc"),
              "extract: 'stem.swc' is a skeleton already; read it with: loadtree a stem.swc");
    EXPECT_NE(refusal("extract a gone.ply").find("cannot read"), std::string::npos);
    EXPECT_NE(refusal("extract a from=nothing").find("there is no mesh 'nothing'"), std::string::npos);
}

TEST_F(SceneExtract, ExcludesPointsByTheirClass) {
    std::ofstream classed(folder_ / "classed.xyz");
    classed << "x y z classification\n";
    std::ifstream points(folder_ / "stem.xyz");
    std::string line;
    std::getline(points, line);
    while (std::getline(points, line)) classed << line << " 5\n";
    classed << "7 7 0 7\n8 7 0 7\n";  // noise
    classed.close();
    scene.run("extract a stem.xyz ground=none");
    EXPECT_NE(
        scene.run("extract b classed.xyz ground=none").find("2 of 1,202 points left out by their class"),
        std::string::npos);
    EXPECT_TRUE(same(tree("a"), tree("b")));
    EXPECT_NE(refusal("extract c classed.xyz wood_classes=wood").find("not classes of points"),
              std::string::npos);
}

TEST_F(SceneExtract, RecipeReproducesTheTree) {
    scene.run("extract a stem.xyz ground=none leaves=keep");
    Scene again(settings());
    again.run_text(make_recipe(scene.state()), "recipe");
    EXPECT_TRUE(
        same(tree("a"), std::get<Skeleton>(again.state().objects.at({ObjectKind::skeleton, "a"})->value)));
}

TEST_F(SceneExtract, ChecksTheMemoryFirst) {
    scene.run("mesh t levels=5");
    scene.run("save t fine.ply kind=mesh");
    std::ofstream(folder_ / "fine.xyz") << ring_points(0, 200);
    Scene small(settings(1));
    for (const char* line : {"extract a fine.ply", "extract a fine.xyz"})
        EXPECT_NE(test::error_of<InvalidInput>([&] { small.run(line); }).find("allowed"), std::string::npos)
            << line;
}

TEST_F(SceneExtract, StopsWhenCancelledAndReportsProgress) {
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(scene.run("extract a stem.xyz", {}, {.stop = stop.get_token()}), Cancelled);
    EXPECT_FALSE(scene.state().objects.contains({ObjectKind::skeleton, "a"}));
    for (const char* line : {"extract a stem.xyz ground=none", "extract a tube.ply"}) {
        std::vector<float> seen;
        scene.run(line, {}, {.progress = [&](float f) { seen.push_back(f); }});
        EXPECT_TRUE(std::ranges::is_sorted(seen)) << line;
        EXPECT_FALSE(seen.empty()) << line;
    }
}

TEST_F(SceneExtract, RejectsFilesOutsideTheFolder) {
    EXPECT_NE(refusal("extract a ../stem.xyz").find("cannot"), std::string::npos);
    EXPECT_NE(refusal("extract a /etc/passwd").find("cannot"), std::string::npos);
}

TEST_F(SceneExtract, ReadsTreesByTheIdsOfPoints) {
    std::ofstream file(folder_ / "two.txt");
    file << "x y z tree_id\n";
    for (int ring = 0; ring < 60; ++ring) {
        for (int k = 0; k < 30; ++k) {
            const double a = 2 * std::numbers::pi * k / 30, x = 0.2 * std::cos(a), y = 0.2 * std::sin(a);
            file << fmt::format("{} {} {} 7\n{} {} {} 4\n", x, y, 0.05 * ring, x + 5, y, 0.05 * ring);
        }
    }
    file.close();
    scene.run("extract all two.txt trees_by=ids");
    ASSERT_EQ(tree("all").tree_count(), 2u);
    const std::vector<std::string> names = attributes("all");
    EXPECT_EQ(names.back(), "tree");
    const std::vector<float>& ids = object("all").attributes.back().values;
    for (const NodeId n : nodes(tree("all"))) {
        const double x = tree("all").origin().x + double{tree("all").position(n).x};
        EXPECT_EQ(ids[n.index()], x > 2.5 ? 4.0f : 7.0f);  // in the order of the ids
    }
    EXPECT_EQ(ids.front(), 4.0f);
    EXPECT_NE(refusal("extract a stem.xyz trees_by=ids").find("its points have no ids of trees"),
              std::string::npos);
    EXPECT_NE(refusal("extract a from=p trees_by=ids").find("trees_by= is for files"), std::string::npos);
    EXPECT_NE(refusal("extract a two.txt trees_by=ids max_trees=1")
                  .find("max_trees= has no effect with trees_by=ids"),
              std::string::npos);
}

}  // namespace
}  // namespace coppice
