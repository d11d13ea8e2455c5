#include "coppice/scene/edit_session.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "coppice/io_skeleton/reader.h"
#include "coppice/io_skeleton/writer.h"
#include "coppice/skeleton/random_tree.h"
#include "edit/trees.h"
#include "errors.h"

namespace coppice {
namespace {

using test::error_of;
using test::id;

EditSession session() { return EditSession(test::stem_with_branches(), {.files = false, .outputs = false}); }

TEST(EditSession, RunsAndUndoesEdits) {
    EditSession s = session();
    s.run_text("bend 4 40; prune order=1 ; # a comment; delete roots\nsplit \"order(0) & !roots\" parts=3",
               "x");
    EXPECT_EQ(s.history().size(), 3u);
    EXPECT_EQ(s.history()[1].command.substr(0, 17), "prune all radius=");
    EXPECT_EQ(s.last_change().added.size(), 6u);
    const Skeleton after = s.tree().skeleton();
    s.run("undo 3");
    EXPECT_TRUE(test::same(s.tree().skeleton(), test::stem_with_branches()));
    s.run("redo 3");
    EXPECT_TRUE(test::same(s.tree().skeleton(), after));
    EXPECT_EQ(error_of([&] { s.run("undo 4"); }), "undo: only 3 edits can be undone; history lists them");
    EXPECT_NE(s.run("history").find("3  split order(0)&!roots parts=3 at=0  # 6 added, 3 on other parents"),
              std::string::npos);
}

TEST(EditSession, AcceptsTheWordEditBeforeACommand) {
    EditSession s = session();
    s.run("edit delete 8");
    EXPECT_EQ(s.history().at(0).command, "delete 8 alone=false");
}

TEST(EditSession, SelectListsTheSelectedNodes) {
    EditSession s = session();
    EXPECT_EQ(s.run("select 7|8"),
              "2 of 9 nodes\nnode 7 at 2,1,1 radius 0.02 on 5 order 2: at(2,1,1,2,0.02)\n"
              "node 8 at -1,0,2 radius 0.02 on 2 order 1: at(-1,0,2,1,0.02)\n");
    EXPECT_EQ(s.run("select radius(5,)"), "0 of 9 nodes\n");
}

TEST(EditSession, SolidsOfSceneCommandsAndTheTreeAreAvailable) {
    EditSession s = session();
    s.run("sphere crown center=0,0,2 radius=1.5");
    s.run("prune solid=crown");
    EXPECT_FALSE(s.tree().contains(id(6)));
    EXPECT_NE(s.run("describe tree").find("skeleton   7 nodes"), std::string::npos);
    s.run("undo");
    EXPECT_NE(s.run("describe tree").find("skeleton   9 nodes"), std::string::npos);
    EXPECT_EQ(error_of([&] { s.run("tidy tree"); }),
              "tidy creates a tree, but edits apply to the existing one; run a scene first");
}

TEST(EditSession, ErrorsReportTheirPosition) {
    EditSession s = session();
    EXPECT_EQ(error_of([&] { s.run("graft 4 7", "a:3"); }),
              "a:3: graft: node 7 hangs on node 4, so that 4 would be grafted into itself; choose a host "
              "outside the "
              "subtree of 4");
    EXPECT_EQ(error_of([&] { s.run("bend radius(5,) 30"); }),
              "bend: 'radius(5,)' contains no node of the tree; try other bounds with: select radius(5,)");
    EXPECT_EQ(error_of([&] { s.run("radius tips 0"); }),
              "radius takes a number of metres from 1e-09 to 1e+06, not '0'");
    EXPECT_NE(error_of([&] { s.run("bned 4 30"); }).find("there is no command 'bned'"), std::string::npos);
    EXPECT_NE(error_of([&] { s.run("bend subtree 4"); }).find("needs ( after subtree"), std::string::npos);
    EXPECT_TRUE(s.history().empty());
    EXPECT_EQ(s.run("straighten 4"), "nothing changed\n");
    EXPECT_TRUE(s.history().empty());
}

TEST(EditSession, PreservesIdsInJson) {
    EditSession s = session();
    s.run_text("delete 5; split 2; graft 8 0; append 3 0 0 1", "x");
    const Skeleton edited = s.tree().skeleton();
    const std::string json = encode_skeleton(edited, {.format = SkeletonFormat::json});
    EXPECT_NE(json.find("\"stable_id\": [0,"), std::string::npos);
    const Skeleton again = parse_skeleton(json, "a.json").skeleton;
    EXPECT_TRUE(test::same(again, edited));
    EXPECT_EQ(EditSession(again).run("select 10"), s.run("select 10"));
    const std::string plain = encode_skeleton(test::stem_with_branches(), {.format = SkeletonFormat::json});
    EXPECT_EQ(plain.find("stable_id"), std::string::npos);
    std::string twice = json;
    twice.replace(twice.find("[0,1,"), 5, "[1,1,");
    EXPECT_NE(error_of([&] { parse_skeleton(twice, "a.json"); }).find("the id 1 is used by two nodes"),
              std::string::npos);
}

/// The same tree with other ids, 1.5 times as large, at another position.
Skeleton other_growth(const Skeleton& s) {
    std::vector<StableId> ids;
    std::vector<Vec3> place;
    std::vector<float> radius;
    for (const NodeId n : nodes(s)) {
        ids.emplace_back(s.size() + n.index());
        place.push_back(s.position(n) * 1.5f + Vec3{3, 4, 5});
        radius.push_back(s.radius(n) * 1.5f);
    }
    return Skeleton({s.parents().begin(), s.parents().end()}, place, radius, {}, ids);
}

TEST(SavedEdits, AreReplayedOnATreeWithOtherIds) {
    const Skeleton first = random_tree(200, 3);
    EditSession s(first);
    s.run_text(
        "split 100 parts=3; detach 150; rotate subtree(120) 30 about=side; translate 201 0 0 1; radius 202 "
        "0.02",
        "x");
    EditSession again(other_growth(first));
    const auto replayed = again.replay(s.saved(), "edits.json");
    EXPECT_EQ(replayed.made, 5u);
    EXPECT_TRUE(replayed.unbound.empty());
    EXPECT_EQ(again.history()[0].command, "split 301 parts=3 at=0");       // the tree has 201 nodes
    EXPECT_EQ(again.history()[3].command.substr(0, 13), "translate 402");  // added by the first edit
    EditSession same(first);
    same.replay(s.saved(), "edits.json");
    EXPECT_TRUE(test::same(same.tree().skeleton(), s.tree().skeleton()));
}

TEST(SavedEdits, ReportUnboundSelections) {
    EditSession s = session();
    s.run_text("split 6; append 9 0 0 0.3; radius tips 0.01", "x");
    EditSession cut = session();
    cut.run("delete 5");
    const auto replayed = cut.replay(s.saved(), "edits.json");
    EXPECT_EQ(replayed.edits, 3u);
    EXPECT_EQ(replayed.made, 1u);
    ASSERT_EQ(replayed.unbound.size(), 2u);
    EXPECT_EQ(replayed.unbound[0].reason,
              "node 6 is not found: no node is within 0.12 m; the nearest is node 4, 2 m away");
    EXPECT_EQ(replayed.unbound[1].reason, "node 9 was made by edit 1, which has not made it this time");
    EXPECT_FLOAT_EQ(cut.tree().radius(id(3)), 0.01f);
}

TEST(SavedEdits, RejectInvalidFiles) {
    EditSession s = session();
    const auto refused = [&](const std::string& text) {
        return error_of<Error>([&] { s.replay(text, "e.json"); });
    };
    const std::string head = R"({"format": "coppice-edits", "version": 1, "edits": )";
    EXPECT_EQ(refused("{"), "e.json: this is not valid JSON");
    EXPECT_EQ(refused("[]"),
              "e.json: this JSON is not a file of edits: it needs \"format\": \"coppice-edits\"");
    EXPECT_EQ(refused(R"({"format": "coppice-edits", "version": 2, "edits": []})"),
              "e.json: this version of coppice-edits is newer than the program");
    EXPECT_EQ(refused(head + "3}"), "e.json.edits is not a list of at most 100000 edits");
    EXPECT_EQ(refused(head + R"([{"command": 3, "nodes": []}]})"), "e.json: edits[0].command is not a text");
    EXPECT_EQ(refused(head + R"([{"command": "delete 8", "nodes": [{"place": [0, 0]}]}]})"),
              "e.json: edits[0].nodes[0].place is not a list of three numbers");
    EXPECT_NE(refused(head + R"([{"command": "delete 8", "nodes": []}, {"command": "list", "nodes": []}]})")
                  .find("e.json: edits[1]"),
              std::string::npos);
    EXPECT_TRUE(test::same(s.tree().skeleton(), test::stem_with_branches()));  // the tree is unchanged
}

TEST(EditSession, SurfaceFollowsEdits) {
    const auto is_same = [](const QuadMesh& a, const QuadMesh& b) {
        return std::ranges::equal(a.positions, b.positions) && std::ranges::equal(a.quads, b.quads);
    };
    EditSession session(random_tree(200, 2));
    EXPECT_EQ(session.surface(), nullptr);
    session.keep_surface({});
    const QuadMesh before = session.surface()->mesh();
    session.run("rotate 40 20");
    EXPECT_FALSE(is_same(before, session.surface()->mesh()));
    session.run("delete 90");
    session.run("bend 12 10");
    EXPECT_TRUE(is_same(session.surface()->mesh(), LiveSurface(session.tree().skeleton(), {}).mesh()));
    session.run("undo 3");
    EXPECT_TRUE(is_same(session.surface()->mesh(), before));
}

}  // namespace
}  // namespace coppice
