#include "coppice/scene/scene.h"

#include <gtest/gtest.h>

#include "coppice/implicit/solid/solid_field.h"
#include "errors.h"

namespace coppice {
namespace {

std::string refusal(Scene& scene, const std::string& text) {
    return test::error_of<Error>([&] { scene.run_text(text, "f.coppice"); });
}

const Solid& solid_of_scene(const Scene& scene, const std::string& name) {
    return std::get<Solid>(scene.state().objects.at({ObjectKind::solid, name})->value);
}

const PointSet& points_of_scene(const Scene& scene, const std::string& name) {
    return std::get<PointSet>(scene.state().objects.at({ObjectKind::points, name})->value);
}

std::vector<Vec3> nodes_of_tips(const Skeleton& tree) {
    std::vector<Vec3> tips;
    for (const NodeId n : nodes(tree)) {
        if (tree.is_tip(n)) tips.push_back(tree.position(n));
    }
    return tips;
}

float value_at(const Scene& scene, const std::string& name, Vec3 p) {
    float value = 0;
    SolidField(solid_of_scene(scene, name)).values(std::span(&p, 1), std::span(&value, 1));
    return value;
}

// The commands of the thesis: an ellipsoid, and a ball minus a line.
TEST(Scene, RunsTheCommandsOfTheThesis) {
    Scene scene;
    scene.run_text(
        "sphere s\nscale s 50 80 50\nsphere s1\nline s2\ndiff s1 s2 s3\n"
        "pointset gen s poisson count=200\nsphere secondary\nscale secondary 30\n"
        "pointset thin s secondary 80",
        "thesis");
    EXPECT_NEAR(value_at(scene, "s", {0, 80, 0}), 0.5f, 1e-3f);
    EXPECT_NEAR(value_at(scene, "s", {50, 0, 0}), 0.5f, 1e-3f);
    EXPECT_GT(value_at(scene, "s1", {0, 0, 0.5f}), 0.5f);
    EXPECT_LT(value_at(scene, "s3", {0, 0, 0.5f}), 0.5f);  // inside the line
    EXPECT_GT(value_at(scene, "s3", {0, 0, -0.7f}), 0.5f);
}

TEST(Scene, ThinningRemovesTheGivenFraction) {
    Scene scene;
    scene.run_text("sphere s\npointset gen s uniform count=1000\nsphere whole radius=3", "x");
    scene.run("pointset thin s whole 80");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 200u);
    scene.run("pointset densify s whole count=50");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 250u);
    scene.run("copy s more kind=points");
    scene.run("pointset add s more");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 500u);
}

TEST(Scene, FailingLineChangesNothing) {
    Scene scene;
    scene.run_text("sphere a\nsphere b\nset seed 3\npointset gen a count=10", "x");
    const SceneState before = scene.state();
    for (const char* line :
         {"sphere a radius=-1", "scale a 0", "diff a c d", "union a b 2x", "pointset thin a b 101", "bogus",
          "polygonize a cell=1e-6", "set seed -1", "undo 50", "grow t a root=nan,0,0", "delete a b c",
          "delete a", "bend a 170 to=0,0,0.1", "twist a 1 axis=0,0,0", "save recipe x.txt", "sphere \"",
          "copy a z"}) {
        EXPECT_NE(refusal(scene, line), "no error") << line;
        EXPECT_EQ(scene.state().objects, before.objects) << line;
        EXPECT_EQ(scene.state().history, before.history) << line;
        EXPECT_EQ(scene.state().seed, 3) << line;
        EXPECT_EQ(scene.state().bytes, before.bytes) << line;
    }
}

TEST(Scene, ErrorsReportFileLineAndCommand) {
    Scene scene;
    EXPECT_EQ(refusal(scene, "sphere s\n\nsphre t"),
              "f.coppice:3: there is no command 'sphre'; did you mean sphere?");
    EXPECT_EQ(refusal(scene, "\nprofile p 0,0 1,0 2,0").substr(0, 22), "f.coppice:2: profile: ");
    EXPECT_EQ(refusal(scene, "sphere \\\n s \\\n x=1").substr(0, 12), "f.coppice:1:");
    EXPECT_TRUE(scene.state().objects.contains(
        {ObjectKind::solid, "s"}));  // the effects before the failing line remain
}

TEST(Scene, ObjectsAreIndependentOfLaterChanges) {
    Scene scene;
    scene.run_text("sphere a\nsphere b center=3,0,0\nunion a b u\ntranslate a 0 0 10", "x");
    EXPECT_GT(value_at(scene, "u", {0, 0, 0}), 0.5f);
    EXPECT_LT(value_at(scene, "a", {0, 0, 0}), 0.5f);
    scene.run("delete a b");
    EXPECT_GT(value_at(scene, "u", {3, 0, 0}), 0.5f);
}

TEST(Scene, UndoRevertsChanges) {
    Scene scene;
    scene.run_text("sphere a\nscale a 2\nlist\ndescribe a\nset seed 9\npointset gen a count=5", "x");
    EXPECT_EQ(scene.undo_depth(), 4u);
    scene.run("undo");
    EXPECT_FALSE(scene.state().objects.contains({ObjectKind::points, "a"}));
    EXPECT_EQ(scene.state().seed, 9);
    scene.run("undo 2");
    EXPECT_EQ(scene.state().seed, 0);
    EXPECT_NEAR(value_at(scene, "a", {1, 0, 0}), 0.5f, 1e-3f);
    EXPECT_EQ(scene.state().history.size(), 1u);
    scene.run("undo");
    EXPECT_TRUE(scene.state().objects.empty());
    EXPECT_EQ(scene.state().bytes, 0u);
    EXPECT_EQ(refusal(scene, "undo"), "f.coppice:1: undo: there is no command to undo");
}

TEST(Scene, UndoRestoresDeletedObjects) {
    Scene scene;
    scene.run_text("sphere a\npointset gen a count=5\ndelete a kind=points\nundo", "x");
    EXPECT_EQ(points_of_scene(scene, "a").size(), 5u);
    scene.run_text("delete a kind=points\nundo\nundo\nundo", "x");
    EXPECT_TRUE(scene.state().objects.empty());
}

TEST(Scene, MeshHasAboutTheRequestedNumberOfFaces) {
    Scene scene;
    scene.run_text("limb t 0,0,0 0,0,4 0.5,0,8 radius=0.3\nmesh t small faces=300\nmesh t large faces=5000",
                   "x");
    const auto faces = [&](const std::string& name) {
        return static_cast<double>(
            face_count(std::get<Surface>(scene.state().objects.at({ObjectKind::mesh, name})->value)));
    };
    EXPECT_NEAR(faces("small"), 300, 15);
    EXPECT_NEAR(faces("large"), 5000, 250);
    EXPECT_NE(
        refusal(scene, "mesh t faces=300 levels=1").find("faces= determines the levels; leave levels= out"),
        std::string::npos);
    EXPECT_NE(refusal(scene, "mesh t faces=50").find("faces must be from 100 to"), std::string::npos);
}

TEST(Scene, RejectsCommandsThatNeedTooMuchMemory) {
    Scene scene({.max_memory = 20});
    scene.run_text("sphere s\npointset gen s count=1000\ngrow t s root=0,0,-1 kill_radius=0.05 step=0.03",
                   "x");
    for (const char* line :
         {"pointset gen s count=100000000", "pointset gen s uniform count=100000000", "mesh t levels=6",
          "polygonize s cell=0.001", "render t big.png width=16384 height=16384",
          "pointset gen s jittered count=100000000", "pointset gen s blue_noise count=100000000"}) {
        EXPECT_NE(refusal(scene, line).find("MiB"), std::string::npos) << line << refusal(scene, line);
    }
}

TEST(Scene, StopsWhenCancelled) {
    Scene scene;
    std::stop_source stop;
    stop.request_stop();
    EXPECT_THROW(scene.run("sphere s", {}, {.stop = stop.get_token()}), Cancelled);
    EXPECT_TRUE(scene.state().objects.empty());
}

TEST(Scene, NestingAndNumbersOfObjectsAreLimited) {
    Scene scene;
    std::string deep = "sphere s\n";
    for (int i = 0; i < 300; ++i) deep += "twist s 1\n";
    EXPECT_NE(refusal(scene, deep), "no error");
    Scene wide;
    std::string parts = "sphere s0\n";
    for (int i = 0; i < 30; ++i)
        parts +=
            "union s" + std::to_string(i) + " s" + std::to_string(i) + " s" + std::to_string(i + 1) + "\n";
    EXPECT_NE(refusal(wide, parts), "no error");
    Scene many;
    std::string names;
    for (int i = 0; i <= 10'000; ++i) names += "path p" + std::to_string(i) + " 0,0,0 1,0,0\n";
    EXPECT_NE(refusal(many, names).find("at most 10000 objects"), std::string::npos);
}

TEST(Scene, IsBitIdenticalForAnyNumberOfThreads) {
    std::vector<std::vector<Vec3>> positions;
    for (const unsigned threads : {1u, 2u, 7u}) {
        Scene scene;
        scene.run_text(
            "sphere s\npointset gen s poisson count=2000\n"
            "grow t s root=0,0,-1.5 influence_radius=1 kill_radius=0.08 step=0.04\nradii t\ntidy t",
            "x", {.threads = threads});
        const auto& tree = std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "t"})->value);
        positions.emplace_back(tree.positions().begin(), tree.positions().end());
    }
    EXPECT_GT(positions[0].size(), 500u);
    EXPECT_EQ(positions[0], positions[1]);
    EXPECT_EQ(positions[0], positions[2]);
}

TEST(Scene, GuardExcludesTheTreeFromTheSolid) {
    Scene scene;
    scene.run_text(
        "sphere s\npointset gen s density=outside_boundary count=800\n"
        "grow t s root=0,0,-1.05 influence_radius=0.5 kill_radius=0.1 step=0.05 guard=s",
        "x");
    const auto& tree = std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "t"})->value);
    std::vector<float> values(tree.size());
    SolidField(solid_of_scene(scene, "s")).values(tree.positions(), values);
    EXPECT_GT(tree.size(), 200u);
    EXPECT_EQ(std::ranges::count_if(values, [](float v) { return v > 0.5f; }), 0);
    EXPECT_EQ(scene.state().last_grown, "t");
}

TEST(Scene, SeveralRootsBecomeSeveralTrees) {
    Scene scene;
    scene.run_text(
        "sphere s\npointset gen s count=300\n"
        "grow t s root=-1,0,-1.2 root=1,0,-1.2,0,0,1 influence_radius=2 kill_radius=0.2 step=0.1",
        "x");
    EXPECT_EQ(std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, "t"})->value).tree_count(),
              2u);
}

TEST(Scene, EverySolidAcceptsAFieldLaw) {
    Scene scene;
    scene.run_text(
        "sphere s law=soft\nprofile p circle=1\npath up 0,0,-2 0,0,2\nsweep r p up influence=0.5 law=soft",
        "x");
    // 0.75 of the influence, of 2 radii; for the rod 0.25 m above its surface at 1 m.
    EXPECT_NEAR(value_at(scene, "s", {1.5f, 0, 0}), 0.1435546875f, 1e-5f);
    EXPECT_NEAR(value_at(scene, "r", {1.25f, 0, 0}), 0.1435546875f, 5e-3f);
    for (const SceneCommand& c : scene_commands()) {
        const bool has_field =
            std::ranges::any_of(c.arguments, [](auto& a) { return a.name == "influence"; });
        const bool has_law = std::ranges::any_of(c.arguments, [](auto& a) { return a.name == "law"; });
        EXPECT_EQ(has_field, has_law) << c.name;
    }
    EXPECT_NE(refusal(scene, "sphere t law=sofd").find("soft"), std::string::npos);
}

TEST(Scene, AVariationalCurveIsAProfile) {
    Scene scene;
    scene.run_text(
        "contour bean 1,0 0,0.8 -1,0 0,0.2\n"
        "contour ring 2,0,1,0 0,2,0,1 -2,0,-1,0 0,-2,0,-1 1,0,-1,0 0,1,0,-1 -1,0,1,0 0,-1,0,1\n"
        "path up 0,0,0 0,0,3\nsweep rod bean up\nsweep pipe ring up",
        "x");
    EXPECT_GT(value_at(scene, "rod", {0, 0.5f, 1.5f}), 0.5f);
    EXPECT_LT(value_at(scene, "rod", {0, 0, 1.5f}), 0.5f);
    EXPECT_NEAR(value_at(scene, "rod", {1, 0, 1.5f}), 0.5f, 0.01f);
    EXPECT_GT(value_at(scene, "pipe", {1.5f, 0, 1.5f}), 0.5f);
    EXPECT_LT(value_at(scene, "pipe", {0, 0, 1.5f}), 0.5f);
    EXPECT_NE(refusal(scene, "contour c 1,0 0,1,0,1 -1,0").find("x,y,nx,ny"), std::string::npos);
    EXPECT_NE(refusal(scene, "contour c 1,0 0,1").find("3"), std::string::npos);
}

TEST(Scene, PointsetAcceptsADensityCurveAndACachedField) {
    Scene scene;
    scene.run_text("sphere s\npointset gen s uniform count=300 curve=0.6,1 curve=0.7,1\n", "x");
    for (const Vec3 p : points_of_scene(scene, "s").positions) {
        EXPECT_GE(value_at(scene, "s", p), 0.599f);
        EXPECT_LE(value_at(scene, "s", p), 0.701f);
    }
    scene.run("pointset gen s uniform count=300 cached=true");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 300u);
    // Densities of the whole inside are cached everywhere, and curves in their range.
    scene.run("pointset gen s uniform count=300 density=inverse cached=true cell=0.05");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 300u);
    scene.run("pointset gen s uniform count=300 cached=true cell=0.02 curve=0.2,1 curve=0.3,1");
    EXPECT_EQ(points_of_scene(scene, "s").size(), 300u);
    for (const Vec3 p : points_of_scene(scene, "s").positions) {
        EXPECT_GE(value_at(scene, "s", p), 0.195f);
        EXPECT_LE(value_at(scene, "s", p), 0.305f);
    }
    EXPECT_NE(refusal(scene, "pointset gen s cell=0.1").find("cached=true"), std::string::npos);
}

TEST(Scene, PointsetAcceptsAKernel) {
    Scene scene;
    // No point is nearer than 0.2 m, and the closest ones are usually within 0.3 m.
    scene.run_text("sphere s radius=2\npointset gen s kernel=0.2,1 count=200", "x");
    scene.run("pointset gen s distance=0.2 count=200 name=disks");
    EXPECT_EQ(points_of_scene(scene, "s").positions, points_of_scene(scene, "disks").positions);
    scene.run("pointset gen s kernel=0.2,30 kernel=0.3,30 kernel=0.3,1 count=200 name=pairs");
    const auto near = [&](const std::string& name) {
        const auto& p = points_of_scene(scene, name).positions;
        int count = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                EXPECT_GE(distance(p[i], p[k]), 0.2f);
                if (distance(p[i], p[k]) < 0.3f) ++count;
            }
        }
        return count;
    };
    EXPECT_GT(near("pairs"), 4 * near("disks"));
    scene.run("pointset densify pairs s kernel=0.2,1 count=50");
    EXPECT_EQ(points_of_scene(scene, "pairs").size(), 250u);
    near("pairs");
    EXPECT_NE(refusal(scene, "pointset gen s kernel=0.2,1 distance=0.3").find("distance"), std::string::npos);
    EXPECT_NE(refusal(scene, "pointset gen s uniform kernel=0.2,1").find("uniform"), std::string::npos);
    EXPECT_NE(refusal(scene, "pointset gen s kernel=0.2,1 kernel=0.1,1").find("knot 2"), std::string::npos);
    EXPECT_NE(refusal(scene, "pointset densify s s kernel=0.2,1 distance=0.3").find("distance"),
              std::string::npos);
}

const Skeleton& tree_of_scene(const Scene& scene, const std::string& name) {
    return std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, name})->value);
}

TEST(Scene, ALimbPassesThroughItsPoints) {
    Scene scene;
    scene.run_text(
        "limb stem 0,0,0 0,0,4 radius=0.2 spacing=0.5\n"
        "limb bent 0,0,0 1,0,0 1,1,0 radius=0.1 tip_radius=0.02 kind=polyline spacing=0.3\nlimb short 0,0,0 "
        "1,0,0",
        "x");
    const Skeleton& stem = tree_of_scene(scene, "stem");
    EXPECT_EQ(stem.size(), 9u);
    EXPECT_FLOAT_EQ(stem.radius(NodeId(0)), 0.2f);
    EXPECT_FLOAT_EQ(stem.radius(NodeId(8)), 0.05f);
    EXPECT_FLOAT_EQ(stem.radius(NodeId(4)), 0.125f);
    const Skeleton& bent = tree_of_scene(scene, "bent");
    EXPECT_EQ(bent.size(), 9u);
    EXPECT_LT(distance(bent.position(NodeId(4)), Vec3(1, 0, 0)), 1e-5f);
    EXPECT_FLOAT_EQ(bent.radius(NodeId(8)), 0.02f);
    EXPECT_EQ(tree_of_scene(scene, "short").size(), 17u);
    EXPECT_NE(refusal(scene, "limb a 0,0,0"), "no error");
    EXPECT_NE(refusal(scene, "limb a 0,0,0 1,0,0 spacing=1e-9").find("MiB"), std::string::npos);
}

TEST(Scene, SkeletonsAreMovedRotatedScaledAndJoined) {
    Scene scene;
    scene.run_text(
        "limb bough 0,0,0 2,0,0 radius=0.1 spacing=1\nlimb stem 0,0,0 0,0,4 radius=0.2 spacing=1\n"
        "for k in 1..4\ncopy bough one kind=skeleton\nrotate one ${90 * k}\nscale one 0.5\ntranslate one 0 0 "
        "${k - 0.5}\n"
        "join stem one stem\nend\nedit attach stem",
        "x");
    const Skeleton& tree = tree_of_scene(scene, "stem");
    EXPECT_EQ(tree.tree_count(), 1u);
    EXPECT_EQ(std::ranges::count_if(nodes_of_tips(tree),
                                    [](Vec3 p) { return p.z < 4 && length(Vec3(p.x, p.y, 0)) > 0.99f; }),
              4);
    // If both kinds have the name, the solid takes precedence; kind= overrides this.
    scene.run_text("sphere bough\ntranslate bough 5 0 0", "x");
    EXPECT_EQ(tree_of_scene(scene, "bough").position(NodeId(0)), Vec3(0, 0, 0));
    scene.run("translate bough 5 0 0 kind=skeleton");
    EXPECT_EQ(tree_of_scene(scene, "bough").position(NodeId(0)), Vec3(5, 0, 0));
    EXPECT_EQ(refusal(scene, "scale stem 1 2 3"),
              "f.coppice:1: scale: a skeleton is scaled by a single factor, so that its branches stay round");
    EXPECT_EQ(refusal(scene, "translate stem 1 2 3 kind=solid"),
              "f.coppice:1: translate: there is no solid 'stem'");
    EXPECT_EQ(refusal(scene, "twist stem 30"), "f.coppice:1: 'stem' is a skeleton, not a solid");
}

TEST(Scene, GrowthContinuesASkeleton) {
    Scene scene;
    scene.run_text(
        "limb stem 0,0,0 0,0,3 radius=0.2 spacing=0.25\nsphere s radius=1 center=0,0,4\n"
        "pointset gen s count=200\ngrow tree s from=stem influence_radius=1 kill_radius=0.2 step=0.1",
        "x");
    const Skeleton &stem = tree_of_scene(scene, "stem"), &tree = tree_of_scene(scene, "tree");
    EXPECT_GT(tree.size(), 100u);
    EXPECT_EQ(tree.tree_count(), 1u);
    for (const NodeId n : nodes(stem)) EXPECT_EQ(tree.position(n), stem.position(n));
    EXPECT_EQ(scene.state().history.back().find("root="), std::string::npos) << scene.state().history.back();
    scene.run("grow two s from=stem root=1,0,0 influence_radius=1 kill_radius=0.2 step=0.1");
    EXPECT_EQ(tree_of_scene(scene, "two").tree_count(), 2u);
}

}  // namespace
}  // namespace coppice
