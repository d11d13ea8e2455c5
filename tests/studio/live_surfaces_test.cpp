#include "coppice/studio/show/live_surfaces_internal.h"

#include <gtest/gtest.h>

#include "coppice/base/error.h"
#include "coppice/scene/scene.h"

namespace coppice {
namespace {

constexpr const char* kTree =
    "limb t 0,0,0 0,0,1 0,0,2 0,0,3 0,0,4 0,0,5 0,0,6\nedit draw t 0,0,2 1,0,2.5 2,0,3 radius=0.02\n";

ObjectPtr get_tree(const Scene& scene) { return scene.state().objects.at({ObjectKind::skeleton, "t"}); }

MeshOptions coarse() {
    MeshOptions options;
    options.levels = 1;
    return options;
}

TEST(ChangedNodes, ContainTheNodesThatDiffer) {
    Scene scene;
    scene.run_text(kTree, "test");
    const ObjectPtr before = get_tree(scene);
    scene.run("edit delete t 8");
    const auto& a = std::get<Skeleton>(before->value);
    const auto& b = std::get<Skeleton>(get_tree(scene)->value);
    EXPECT_TRUE(changed_nodes(a, a).empty());
    const auto gone = changed_nodes(a, b);
    EXPECT_EQ(gone.size(), a.size() - b.size());
    EXPECT_EQ(changed_nodes(b, a), gone);
}

TEST(LiveSurfaces, FollowEditsAndReportTheChanges) {
    Scene scene;
    scene.run_text(kTree, "test");
    LiveSurfaces surfaces;
    const ObjectPtr first = get_tree(scene);
    const std::uint64_t one = surfaces.follow("t", first, coarse(), "", {}).number;
    EXPECT_EQ(surfaces.follow("t", first, coarse(), "", {}).number, one);
    scene.run("edit rotate t order(1) 20");
    surfaces.follow("t", get_tree(scene), coarse(), "", {});
    scene.run("edit rotate t order(1) 20");
    const LiveSurfaces::Shown& shown = surfaces.follow("t", get_tree(scene), coarse(), "", {});
    EXPECT_NE(shown.number, one);
    EXPECT_TRUE(LiveSurfaces::since(shown, shown.number)->quads.empty());
    const auto change = LiveSurfaces::since(shown, one);
    if (change) {
        EXPECT_FALSE(change->vertices.empty());
        for (std::size_t i = 1; i < change->vertices.size(); ++i)
            EXPECT_GT(change->vertices[i].first,
                      change->vertices[i - 1].first + change->vertices[i - 1].count);
    }
    EXPECT_FALSE(LiveSurfaces::since(shown, one + 1000));
    const LiveSurface fresh(std::get<Skeleton>(get_tree(scene)->value), coarse());
    EXPECT_EQ(shown.surface.mesh().quads.size(), fresh.mesh().quads.size());
}

TEST(LiveSurfaces, DependOnTheirOptions) {
    Scene scene;
    scene.run_text(kTree, "test");
    LiveSurfaces surfaces;
    const std::size_t one = surfaces.follow("t", get_tree(scene), coarse(), "", {}).surface.quads().size();
    EXPECT_GT(surfaces.follow("t", get_tree(scene), MeshOptions{}, "fine", {}).surface.quads().size(), one);
}

TEST(LiveSurfaces, StoreAsManyAsFitIntoMemory) {
    Scene scene;
    scene.run_text(kTree, "test");
    const ObjectPtr tree = get_tree(scene);
    LiveSurfaces any;
    any.follow("t", tree, coarse(), "", {});
    const std::uint64_t one = any.bytes();
    LiveSurfaces surfaces(2 * one + one / 2);
    for (const char* name : {"a", "b", "c", "a"}) {
        surfaces.follow(name, tree, coarse(), "", {});
        EXPECT_LE(surfaces.bytes(), 2 * one);
    }
    EXPECT_EQ(surfaces.size(), 2u);
    MeshOptions fine = coarse();
    fine.levels = 3;  // ten times as much
    EXPECT_THROW(surfaces.follow("a", tree, fine, "fine", {}), InvalidInput);
    EXPECT_EQ(surfaces.size(), 2u);
}

}  // namespace
}  // namespace coppice
