#include <gtest/gtest.h>

#include <algorithm>

#include "coppice/compose/compose.h"
#include "coppice/io_database/tree_library.h"
#include "coppice/scene/save.h"
#include "coppice/scene/scene.h"
#include "coppice/skeleton/random_tree.h"
#include "errors.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

class SceneCompose : public test::FolderTest {
  protected:
    void SetUp() override {
        test::FolderTest::SetUp();
        scene.hold_tree("oak", random_tree(200, 1));
        scene.hold_tree("elm", random_tree(200, 2));
    }

    std::string file(const std::string& name) const { return quoted_word((folder_ / name).string()); }
    std::string refusal(const std::string& line) {
        return test::error_of<Error>([&] { scene.run(line); });
    }
    const Skeleton& tree(const std::string& name) const {
        return std::get<Skeleton>(scene.state().objects.at({ObjectKind::skeleton, name})->value);
    }
    static bool same(const Skeleton& a, const Skeleton& b) {
        return std::ranges::equal(a.parents(), b.parents()) &&
               std::ranges::equal(a.positions(), b.positions()) && std::ranges::equal(a.radii(), b.radii());
    }

    Scene scene;
};

TEST_F(SceneCompose, MatchesTheComposerOfTheLibrary) {
    const std::string message = scene.run("compose a oak branches=elm seed=5 probability=1 roll=10 pose=own");
    const ComposeOptions options{.probability = 1, .pose = ComposePose::own, .roll = 0.17453292f};
    const ComposeResult made = TreeComposer(child_trees(tree("elm")), options).compose(tree("oak"), 5);
    EXPECT_TRUE(same(tree("a"), made.skeleton));
    EXPECT_GT(made.report.replaced, 10u);
    EXPECT_NE(message.find(std::to_string(made.report.replaced) + " of "), std::string::npos) << message;
}

TEST_F(SceneCompose, UsesTheBranchesOfTheTemplateByDefault) {
    scene.run_text("compose a oak seed=2\ncompose b oak branches=oak seed=2\nset seed 2\ncompose c oak", "x");
    EXPECT_TRUE(same(tree("a"), tree("b")));
    EXPECT_TRUE(same(tree("a"), tree("c")));
    EXPECT_FALSE(same(tree("a"), tree("oak")));
}

TEST_F(SceneCompose, LibraryStoresBranchesOfTrees) {
    scene.run("library add " + file("b.branches") + " elm oak tag=bent tag=old min_length=0.001");
    EXPECT_NE(scene.run("library add " + file("b.branches") + " elm").find("0 branches added"),
              std::string::npos);
    const std::string listed = scene.run("library list " + file("b.branches") + " from=elm tag=bent");
    EXPECT_NE(listed.find("elm, bent, old"), std::string::npos) << listed;
    scene.run("compose a oak seed=3 from=elm library=" + file("b.branches"));
    scene.run("compose b oak seed=3 branches=elm");
    EXPECT_TRUE(same(tree("a"), tree("b")));
    scene.run("compose both oak seed=3 branches=elm from=oak library=" + file("b.branches"));
    EXPECT_FALSE(same(tree("a"), tree("both")));
}

TEST_F(SceneCompose, RecipeReproducesTheTree) {
    scene.run("library add " + file("b.branches") + " elm tag=bent");
    scene.run("compose a oak library=" + file("b.branches") + " tag=bent seed=3");
    Scene again;
    again.hold_tree("oak", tree("oak"));
    again.run_text(make_recipe(scene.state()), "recipe");
    EXPECT_TRUE(
        same(tree("a"), std::get<Skeleton>(again.state().objects.at({ObjectKind::skeleton, "a"})->value)));
}

TEST_F(SceneCompose, BranchesRemainInsideACrownForAnyOrigin) {
    const Skeleton& oak = tree("oak");
    const Vec3 center = oak.bounds().center();
    const float radius = 0.2f * oak.bounds().diagonal();
    const auto ball = [&](Vec3d c) {
        return "sphere crown center=" + std::to_string(c.x) + "," + std::to_string(c.y) + "," +
               std::to_string(c.z) + " radius=" + std::to_string(radius);
    };
    const Vec3d origin(1000, -2000, 50);
    scene.run(ball(Vec3d(center)));
    scene.run("compose near oak crown=crown probability=1 seed=4");
    const std::vector<NodeId> parents(oak.parents().begin(), oak.parents().end());
    const std::vector<Vec3> positions(oak.positions().begin(), oak.positions().end());
    const std::vector<float> radii(oak.radii().begin(), oak.radii().end());
    scene.hold_tree("far_oak", Skeleton(parents, positions, radii, origin));
    scene.run(ball(Vec3d(center) + origin));
    scene.run("compose far far_oak branches=oak crown=crown probability=1 seed=4");
    EXPECT_EQ(tree("far").size(), tree("near").size());
    scene.run("compose open oak probability=1 seed=4");
    EXPECT_FALSE(same(tree("open"), tree("near")));
}

TEST_F(SceneCompose, RejectsInvalidInput) {
    scene.hold_tree("stick", Skeleton({NodeId::none(), NodeId(0)}, {{0, 0, 0}, {0, 0, 1}}, {0.1f, 0.1f}));
    EXPECT_NE(refusal("compose a oak tag=bent").find("library=FILE"), std::string::npos);
    EXPECT_NE(refusal("compose a stick").find("no such branches"), std::string::npos);
    EXPECT_NE(refusal("compose a oak library=gone.branches").find("gone.branches"), std::string::npos);
    EXPECT_NE(refusal("compose a oak proability=1").find("did you mean probability?"), std::string::npos);
    EXPECT_NE(refusal("compose a oak branches=ok").find("did you mean oak?"), std::string::npos);
    Scene closed({.files = false});
    closed.hold_tree("oak", tree("oak"));
    EXPECT_NO_THROW(closed.run("compose a oak"));
    EXPECT_THROW(closed.run("compose a oak library=b.branches"), IoError);
    EXPECT_THROW(closed.run("library add b.branches oak"), IoError);
}

// A trunk with laterals at nodes 3 (along +x) and 5 (along +y); the latter has a lateral 7.
Skeleton trunk() {
    const auto id = [](std::uint32_t i) { return NodeId(i); };
    return {{NodeId::none(), id(0), id(1), id(1), id(3), id(2), id(5), id(5)},
            {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {1, 0, 1}, {2, 0, 1}, {0, 1, 2}, {0, 2, 2}, {0, 1, 3}},
            {0.1f, 0.1f, 0.1f, 0.05f, 0.05f, 0.05f, 0.05f, 0.02f}};
}

TEST_F(SceneCompose, SelectedBranchIsAddedToTheLibrary) {
    scene.hold_tree("t", trunk());
    EXPECT_EQ(scene.run("library add " + file("b.branches") + " t nodes=id(3)"),
              "1 branches added, 0 already existed\n");
    scene.run("library add " + file("b.branches") + " t nodes=id(6,7)");
    const auto entries = TreeLibrary(folder_ / "b.branches", LibraryAccess::read).list({});
    ASSERT_EQ(entries.size(), 3u);
    EXPECT_EQ(entries[0].tree.source_node, 3u);
    EXPECT_EQ(entries[0].measures.nodes, 3u);
    EXPECT_EQ(refusal("library add b.branches t nodes=id(4)"),
              "library add: node 4 does not begin a branch; select the first node after a fork");
    EXPECT_NE(refusal("library add b.branches t nodes=roots").find("node 0 does not begin"),
              std::string::npos);
    EXPECT_NE(refusal("library add b.branches t oak nodes=id(3)").find("of one tree"), std::string::npos);
    EXPECT_NE(refusal("library add b.branches t nodes=id(3) leaders=false").find("leave leaders="),
              std::string::npos);
    EXPECT_NE(refusal("library add b.branches t nodes=id(99)").find("99"), std::string::npos);
}

TEST_F(SceneCompose, ABranchOfALibraryIsGrafted) {
    scene.hold_tree("t", trunk());
    const std::string library = file("b.branches");
    scene.run("library add " + library + " t nodes=id(3)");
    const auto end = [&] { return tree("t").position(NodeId(tree("t").size() - 1)); };
    // The direction of the parent branch at the tip is +z, and the branch is inclined by a right angle.
    scene.run("library graft t " + library + " 1 id(7) direction=1,0,0");
    ASSERT_EQ(tree("t").size(), 10u);
    for (std::uint32_t i = 0; i < 8; ++i) {
        EXPECT_EQ(tree("t").position(NodeId(i)), trunk().position(NodeId(i)));
        EXPECT_EQ(tree("t").stable_id(NodeId(i)), StableId(i));
    }
    EXPECT_LT(distance(end(), Vec3{2, 1, 3}), 1e-5f);
    EXPECT_FLOAT_EQ(tree("t").radius(NodeId(9)), 0.02f);  // limited to the radius of the parent node
    scene.run("undo");
    // Next to the existing laterals, and not on them.
    scene.hold_tree("t", trunk());
    scene.run("library graft t " + library + " 1 id(1) along=0.5 scale=0.5 limit_radius=false");
    ASSERT_EQ(tree("t").size(), 11u);  // a new node on the trunk
    scene.hold_tree("t", trunk());
    scene.run("library graft t " + library + " 1 id(1)");
    EXPECT_LT(end().x, 0.5f);
    EXPECT_NEAR(end().z, 1.0f, 1e-5f);
    EXPECT_NEAR(length(end() - Vec3{0, 0, 1}), 2.0f, 1e-5f);
}

TEST_F(SceneCompose, RejectsAnInvalidGraft) {
    scene.hold_tree("t", trunk());
    const std::string graft = "library graft t " + file("b.branches");
    EXPECT_NE(refusal(graft + " 1 id(3)").find("b.branches"), std::string::npos);
    scene.run("library add " + file("b.branches") + " t");
    EXPECT_NE(refusal(graft + " 99 id(3)").find("99"), std::string::npos);
    EXPECT_NE(refusal(graft + " 1 id(99)").find("99"), std::string::npos);
    EXPECT_NE(refusal(graft + " 1 all").find("node"), std::string::npos);
    EXPECT_NE(refusal(graft + " 1 id(3) direction=0,0,0").find("leads nowhere"), std::string::npos);
    EXPECT_EQ(tree("t").size(), trunk().size());
}

/// A stem of 1800 segments that forks into two branches of 400.
Skeleton long_fork() {
    constexpr std::uint32_t kStem = 1800, kBranch = 400;
    std::vector<NodeId> parents{NodeId::none()};
    std::vector<Vec3> positions{{0, 0, 0}};
    const auto add = [&](std::uint32_t parent, Vec3 step) {
        parents.emplace_back(parent);
        positions.push_back(positions[parent] + step);
    };
    for (std::uint32_t i = 0; i < kStem; ++i) add(i, {0, 0, 1});
    for (const float x : {-1.0f, 1.0f}) {
        for (std::uint32_t i = 0; i < kBranch; ++i)
            add(i == 0 ? kStem : static_cast<std::uint32_t>(parents.size()) - 1, {x, 0, 1});
    }
    std::vector<float> radii(parents.size(), 0.1f);
    return {std::move(parents), std::move(positions), std::move(radii)};
}

// There is enough memory for the template, but not for the inserted branches.
TEST_F(SceneCompose, LimitsItsMemory) {
    Scene small({.max_memory = 1}), large({.max_memory = 4});
    for (Scene* each : {&small, &large}) each->hold_tree("fork", long_fork());
    EXPECT_NO_THROW(large.run("compose a fork probability=1"));
    const std::string message = test::error_of<Error>([&] { small.run("compose a fork probability=1"); });
    EXPECT_NE(message.find("the tree gets more than"), std::string::npos) << message;
}

TEST_F(SceneCompose, WritesNothingIfOutputsAreDisabled) {
    Scene checked({.outputs = false});
    checked.hold_tree("oak", tree("oak"));
    checked.run("library add " + file("b.branches") + " oak");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "b.branches"));
}

}  // namespace
}  // namespace coppice
