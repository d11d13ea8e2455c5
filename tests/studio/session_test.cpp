#include "coppice/studio/session.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <stop_token>

#include "coppice/system/file.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

class Session : public test::SessionTest {};

TEST_F(Session, RunsLinesAndReturnsTheState) {
    run("sphere a radius=2");
    const Json state = session_->state();
    ASSERT_EQ(state["objects"].size(), 1u);
    EXPECT_EQ(state["objects"][0]["name"], "a");
    EXPECT_NEAR(state["objects"][0]["bounds"][5].get<double>(), 2, 1e-3);
    EXPECT_EQ(state["undo"], Json::array({"sphere a radius=2"}));
    EXPECT_EQ(state["by"], "tab");
    must({{"type", "undo"}});
    EXPECT_TRUE(session_->state()["objects"].empty());
    must({{"type", "redo"}});
    EXPECT_EQ(session_->state()["objects"].size(), 1u);
}

TEST_F(Session, RejectsInvalidRequests) {
    EXPECT_EQ(refused({{"type", "fly"}}), "there is no request 'fly'");
    EXPECT_EQ(refused(Json::object()), "the request requires a text 'type'");
    EXPECT_EQ(refused({{"type", "run"}}), "the request requires a text 'line'");
    EXPECT_EQ(refused({{"type", "undo"}, {"count", -1}}), "'count' must be a whole number");
    EXPECT_EQ(refused({{"type", "show"}, {"kind", "tree"}, {"name", "a"}}), "'tree' is not a kind of object");
    EXPECT_EQ(refused({{"type", "show"}, {"kind", "solid"}, {"name", "a"}}), "there is no solid 'a'");
    EXPECT_NE(refused({{"type", "run"}, {"line", "spher a"}}).find("sphere"), std::string::npos);
}

TEST_F(Session, SelectsUnusedNamesForNewObjects) {
    const auto names = [this](const char* line) { return must({{"type", "run"}, {"line", line}})["names"]; };
    EXPECT_EQ(names("sphere ${new ball}"), Json::array({"ball"}));
    EXPECT_EQ(names("sphere ${new ball}"), Json::array({"ball2"}));
    EXPECT_EQ(names("box ${new ball2}"), Json::array({"ball3"}));  // continues its digits
    EXPECT_EQ(names("sphere ${new a}\nsphere ${new b} center=1,0,0\nunion ${new a} ${new b} ${new ball}"),
              Json::array({"a", "b", "ball4"}));  // a repeated name is one object
    EXPECT_EQ(names("sphere plain"), Json::array());
    EXPECT_EQ(session_->state()["objects"].size(), 7u);
    must({{"type", "preview"}, {"seq", 1}, {"line", "sphere ${new ball}"}});
    EXPECT_EQ(header(frames_.back())["object"]["name"], "ball5");
    EXPECT_FALSE(refused({{"type", "run"}, {"line", "sphere ${new 2 balls}"}}).empty());
}

TEST_F(Session, ReturnsObjectsAsBlobs) {
    run("sphere a");
    const Json shown = must({{"type", "show"}, {"kind", "solid"}, {"name", "a"}, {"form", "coarse"}});
    const auto blob = blobs_.get(shown["key"].get<std::string>());
    ASSERT_TRUE(blob);
    EXPECT_EQ(header(*blob)["kind"], "surface");
    EXPECT_EQ(header(*blob)["version"], session_->state()["objects"][0]["version"]);
}

TEST_F(Session, VisibleSurfaceFollowsEdits) {
    run("limb t 0,0,0 0,0,1 0,0,2 0,0,3 0,0,4");
    run("edit draw t 0,0,2 1,0,2.5 2,0,3 radius=0.02");
    const Json show{{"type", "show"}, {"kind", "skeleton"}, {"name", "t"}, {"form", "surface"}};
    const Json first = must(show);
    const std::uint64_t number = first["number"].get<std::uint64_t>();
    EXPECT_EQ(header(*blobs_.get(first["key"].get<std::string>()))["version"], number);
    const Json about{{"kind", "skeleton"}, {"name", "t"}};
    must({{"type", "preview"},
          {"seq", 4},
          {"line", "edit rotate t order(1) 10"},
          {"about", about},
          {"surface", Json::object()},
          {"have", number}});
    ASSERT_EQ(frames_.size(), 2u);  // the axes and the surface
    EXPECT_EQ(header(frames_[1])["seq"], 4);
    const std::uint64_t previewed = header(frames_[1])["version"].get<std::uint64_t>();
    EXPECT_EQ(session_->state()["undo"].size(), 2u);
    must({{"type", "endpreview"}, {"surface", Json::object()}, {"have", previewed}});
    ASSERT_EQ(frames_.size(), 4u);
    Json again = show;
    again["have"] = header(frames_[3])["version"];
    EXPECT_TRUE(must(again)["key"].is_null());
}

TEST_F(Session, PreviewOfASolidIncludesDependentObjects) {
    run("sphere a");
    run("sphere b center=1,0,0");
    run("union a b both");
    must({{"type", "preview"},
          {"seq", 1},
          {"line", "translate a 0 0 1"},
          {"about", {{"kind", "solid"}, {"name", "a"}}}});
    ASSERT_EQ(frames_.size(), 2u);
    EXPECT_EQ(header(frames_[0])["object"]["name"], "a");
    EXPECT_EQ(header(frames_[1])["object"]["name"], "both");
    EXPECT_EQ(session_->state()["statements"].size(), 3u);
}

TEST_F(Session, RejectsTextsOfAnOldRevision) {
    const Json revision = session_->state()["revision"];
    must({{"type", "text"}, {"text", "sphere a\n"}, {"revision", revision}});
    EXPECT_NE(
        refused({{"type", "text"}, {"text", "sphere b\n"}, {"revision", revision}}).find("changed since"),
        std::string::npos);
}

TEST_F(Session, TextsRunToTheRequestedStatementAndAreJoined) {
    const auto text = [&](const std::string& scene, const Json& more) {
        Json request{{"type", "text"}, {"text", scene}, {"revision", session_->state()["revision"]}};
        request.update(more);
        must(request);
    };
    const Json drag{{"name", "radius"}, {"joins", true}};
    text("sphere a radius=2\nsphere b\n", {{"count", 1}});
    EXPECT_EQ(session_->state()["ran"], 1);
    for (const char* radius : {"3", "4", "5"}) text(std::string("sphere a radius=") + radius + "\n", drag);
    EXPECT_EQ(session_->state()["undo"], Json::array({"change of the text", "radius"}));
    must({{"type", "undo"}});
    EXPECT_EQ(session_->state()["statements"].size(), 2u);
    must({{"type", "redo"}});
    // An undone and redone change is no longer the newest change of a tool.
    text("sphere a radius=6\n", drag);
    EXPECT_EQ(session_->state()["undo"].size(), 3u);
}

TEST_F(Session, FileNameBelongsToItsText) {
    run("sphere a");
    must({{"type", "save"}, {"file", "a.coppice"}});
    must({{"type", "open"}, {"file", ""}});
    EXPECT_EQ(session_->state()["file"], "");
    EXPECT_TRUE(session_->state()["statements"].empty());
    run("sphere b");
    must({{"type", "save"}, {"file", "b.coppice"}});
    must({{"type", "undo"}});  // of the sphere: b.coppice contains more now
    EXPECT_EQ(session_->state()["file"], "b.coppice");
    EXPECT_FALSE(session_->state()["saved"].get<bool>());
    must({{"type", "undo"}});  // of the new scene
    EXPECT_EQ(session_->state()["file"], "a.coppice");
    EXPECT_TRUE(session_->state()["saved"].get<bool>());
    must({{"type", "redo"}, {"count", 2}});
    EXPECT_EQ(session_->state()["file"], "b.coppice");
    EXPECT_TRUE(session_->state()["saved"].get<bool>());
    EXPECT_EQ(read_file(folder_ / "a.coppice"), "sphere a\n");
    EXPECT_EQ(read_file(folder_ / "b.coppice"), "sphere b\n");
}

TEST_F(Session, SavingChangesTheRevision) {
    run("sphere a");
    const std::uint64_t revision = session_->revision();
    must({{"type", "save"}, {"file", "a.coppice"}});
    EXPECT_NE(session_->revision(), revision);
}

TEST_F(Session, ExportsTheSkeletonIfRequested) {
    run("limb t 0,0,0 0,0,1 0,0,2");
    const auto exported = [&](const char* file, const char* as) {
        return must({{"type", "export"}, {"kind", "skeleton"}, {"name", "t"}, {"file", file}, {"as", as}});
    };
    EXPECT_EQ(exported("tree.ply", "skeleton")["unit"], "nodes");
    EXPECT_EQ(exported("surface.ply", "surface")["unit"], "faces");
    EXPECT_NE(
        refused({{"type", "export"}, {"kind", "skeleton"}, {"name", "t"}, {"file", "x.ply"}, {"as", "x"}})
            .find("skeleton or surface"),
        std::string::npos);
}

TEST_F(Session, GrowthIsShownAndPreservedWhenStopped) {
    run("sphere crown radius=3 center=0,0,4");
    run("pointset generate crown uniform count=60000");
    const std::string line = "grow tree crown influence_radius=0.5 kill_radius=0.05 step=0.02";
    std::stop_source stop;
    std::vector<StudioGrown> seen;
    session_->watch({.runs = {}, .grown = [&](const StudioGrown& grown) {
                         seen.push_back(grown);
                         if (seen.size() == 2) stop.request_stop();
                     }});
    const Context ctx{.threads = 0, .stop = stop.get_token(), .progress = {}};
    const Json reply = ask({{"type", "run"}, {"line", line}}, ctx);
    EXPECT_EQ(reply["kind"], "cancelled");
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen[1].statement, 2u);
    const std::string last = *blobs_.get(seen[0].key);
    EXPECT_EQ(header(last)["kind"], "skeleton");
    EXPECT_EQ(header(last)["version"], 2) << "a late reader receives the newest result";
    EXPECT_EQ(session_->state()["statements"].size(), 2u);
    // Growth had continued before it noticed the stop.
    const std::string until = reply["grown"]["until"].get<std::string>();
    EXPECT_EQ(until, seen[1].until);
    session_->watch({});
    run(line + " " + until);
    EXPECT_EQ(*blobs_.get(seen[1].key), "") << "another growth has begun";
    const std::string again =
        blob(must({{"type", "show"}, {"kind", "skeleton"}, {"name", "tree"}, {"form", "axes"}}));
    EXPECT_EQ(numbers<float>(again, "position"), numbers<float>(last, "position"));
    EXPECT_EQ(numbers<std::uint32_t>(again, "parent"), numbers<std::uint32_t>(last, "parent"));
}

TEST_F(Session, SlicesTheFieldOfASolid) {
    run("sphere a center=0,0,4 radius=2");
    const Json slice{{"type", "slice"}, {"kind", "solid"}, {"name", "a"},
                     {"axis", "y"},     {"at", 0},         {"size", 64}};
    const std::string made = blob(must(slice));
    const Json head = header(made);
    EXPECT_EQ(head["kind"], "slice");
    EXPECT_EQ(head["width"], 64);
    EXPECT_EQ(numbers<float>(made, "value").size(), 64u * 64u);
    Json wrong = slice;
    wrong["axis"] = "w";
    EXPECT_NE(refused(wrong).find("x, y or z"), std::string::npos);
    wrong = slice;
    wrong["size"] = 5000;
    EXPECT_NE(refused(wrong).find("1024"), std::string::npos);
    run("delete a");
    EXPECT_NE(refused(slice).find("no solid"), std::string::npos);
}

TEST_F(Session, AsideChangesNothing) {
    run("sphere a");
    EXPECT_NE(must({{"type", "aside"}, {"line", "describe a"}})["message"].get<std::string>().find("solid"),
              std::string::npos);
    must({{"type", "aside"}, {"line", "sphere b"}});
    EXPECT_EQ(session_->state()["objects"].size(), 1u);
}

TEST_F(Session, SavesOpensAndExportsWithinTheFolder) {
    run("limb t 0,0,0 0,0,1 0,0,2");
    must({{"type", "save"}, {"file", "t.coppice"}});
    EXPECT_EQ(read_file(folder_ / "t.coppice"), "limb t 0,0,0 0,0,1 0,0,2\n");
    EXPECT_TRUE(session_->state()["saved"].get<bool>());
    const Json exported{{"type", "export"}, {"kind", "skeleton"}, {"name", "t"}, {"file", "t.glb"}};
    EXPECT_GT(must(exported)["bytes"].get<int>(), 1000);
    EXPECT_NE(refused(exported).find("already exists"), std::string::npos);
    EXPECT_EQ(session_->state()["statements"].size(), 1u);
    for (const char* name : {"../t.coppice", "/tmp/t.coppice", "", "a/../../t.coppice"})
        refused({{"type", "save"}, {"file", name}});
    run("sphere a");
    must({{"type", "open"}, {"file", "t.coppice"}});
    EXPECT_EQ(session_->state()["statements"].size(), 1u);
    must({{"type", "undo"}});
    EXPECT_EQ(session_->state()["statements"].size(), 2u);
    const Json files = must({{"type", "files"}, {"ending", ".glb"}})["files"];
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(files[0]["name"], "t.glb");
}

TEST_F(Session, ChecksTheSurfaceOfASkeleton) {
    run("limb t 0,0,0 0,0,1 0,0,2");
    const Json verdict = must({{"type", "check"}, {"kind", "skeleton"}, {"name", "t"}});
    EXPECT_TRUE(verdict["good"].get<bool>()) << verdict.dump();
    EXPECT_EQ(verdict["figures"]["components"], 1);
    run("sphere a");
    EXPECT_TRUE(must({{"type", "check"}, {"kind", "solid"}, {"name", "a"}})["good"].get<bool>());
    // A mesh compared with the tree that it should represent: one limb is missing.
    run("mesh t");
    run("edit draw t 0,0,1 2,0,1.5 radius=0.05");
    const Json mesh{{"type", "check"}, {"kind", "mesh"}, {"name", "t"}};
    EXPECT_TRUE(must(mesh)["good"].get<bool>());
    Json by_tree = mesh;
    by_tree["skeleton"] = "t";
    EXPECT_FALSE(must(by_tree)["good"].get<bool>());
    std::stop_source stop;
    stop.request_stop();
    EXPECT_EQ(ask(by_tree, {.threads = 0, .stop = stop.get_token(), .progress = {}})["kind"], "cancelled");
}

TEST_F(Session, RendersTheViewOfTheCamera) {
    run("limb t 0,0,0 0,0,1 0,0,2");
    run("sphere a radius=0.5 center=0,0,2");
    Json picture{{"type", "picture"},
                 {"objects", {{{"kind", "skeleton"}, {"name", "t"}}, {{"kind", "solid"}, {"name", "a"}}}},
                 {"file", "a.png"},
                 {"options", {{"width", 64}, {"height", 48}, {"samples", 1}}},
                 {"camera", {{"eye", {0, -6, 1}}, {"target", {0, 0, 1}}, {"field_of_view", 40}}}};
    EXPECT_GT(must(picture)["bytes"].get<int>(), 100);
    EXPECT_NE(refused(picture).find("already exists"), std::string::npos);
    picture["overwrite"] = true;
    const std::string first = read_file(folder_ / "a.png");
    picture["camera"]["eye"] = {0, -12, 1};
    must(picture);
    EXPECT_NE(read_file(folder_ / "a.png"), first);
    picture["camera"] = {{"eye", {0, 0, 9}}, {"target", {0, 0, 1}}, {"parallel", 3}};  // straight down
    must(picture);
    picture["as"] = "skeleton";
    must(picture);
    for (const Json& wrong : {Json{{"eye", {0, 0, 1}}, {"target", {0, 0, 1}}, {"parallel", 3}},
                              Json{{"eye", {0, 0, 2}}, {"target", {0, 0, 1}}},
                              Json{{"eye", {0, 0, 2}}, {"target", {0, 0, 1}}, {"parallel", -3}},
                              Json{{"eye", {0, 2}}, {"target", {0, 0, 1}}, {"parallel", 3}}}) {
        picture["camera"] = wrong;
        refused(picture);
    }
}

TEST_F(Session, TrialChangesNothing) {
    const Json made = must({{"type", "trial"},
                            {"line", "limb t 0,0,0 0,0,1\nsave t t.swc"},
                            {"kind", "skeleton"},
                            {"name", "t"}});
    EXPECT_EQ(header(blob(made))["kind"], "skeleton");
    EXPECT_TRUE(session_->state()["objects"].empty());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "t.swc"));
    must({{"type", "preview"}, {"seq", 1}, {"line", "limb t 0,0,0 0,0,1\nsave t t.swc"}});
    EXPECT_FALSE(std::filesystem::exists(folder_ / "t.swc"));
    const Json surface{{"type", "trial"},    {"line", "limb t 0,0,0 0,0,1"},
                       {"kind", "skeleton"}, {"name", "t"},
                       {"form", "surface"},  {"surface", {{"levels", 0}}}};
    EXPECT_EQ(header(blob(must(surface)))["kind"], "surface");
    Json wrong = surface;
    wrong["name"] = "u";
    EXPECT_NE(refused(wrong).find("'u'"), std::string::npos);
    wrong = surface;
    wrong["surface"] = {{"levels=0 name", 1}};
    EXPECT_NE(refused(wrong).find("not the name of an option"), std::string::npos);
}

TEST_F(Session, AnchorsSelectTheirNodes) {
    run("limb t 0,0,0 0,0,1 0,0,2");
    const Json anchors = must({{"type", "anchor"}, {"name", "t"}, {"nodes", {2}}})["selections"];
    const std::string message = must(
        {{"type", "aside"}, {"line", "edit select t \"" + anchors[0].get<std::string>() + "\""}})["message"];
    EXPECT_NE(message.find("node 2"), std::string::npos) << message;
}

TEST_F(Session, IsRecoveredFromItsJournal) {
    options_.journal = folder_ / "journal";
    reopen();
    run("sphere a");
    session_->keep_journal();
    reopen();
    EXPECT_EQ(session_->state()["objects"].size(), 1u);
    EXPECT_TRUE(session_->state()["recovered"].get<bool>());
    must({{"type", "save"}, {"file", "a.coppice"}});
    session_->keep_journal();
    EXPECT_FALSE(std::filesystem::exists(options_.journal));
}

TEST_F(Session, ReconstructsASketchAndComputesEpipolarLines) {
    const Json sketch = Json::parse(R"({"format": "coppice-sketch", "version": 1,
        "views": [{"name": "front", "orthographic": "front", "pixels_per_metre": 100, "origin": [200, 300]},
                  {"name": "side", "orthographic": "side", "pixels_per_metre": 100, "origin": [200, 300]}],
        "branches": [{"name": "stem", "strokes": {"front": {"points": [[200, 300], [200, 100]], "widths": [20, 10]},
                                                  "side": {"points": [[200, 300], [200, 100]], "widths": [20, 10]}}}]})");
    const Json made = must({{"type", "sketch"}, {"sketch", sketch}});
    EXPECT_EQ(header(*blobs_.get(made["key"].get<std::string>()))["kind"], "skeleton");
    EXPECT_EQ(made["branches"][0]["refused"], "");
    const Json line = must({{"type", "epipolar"},
                            {"sketch", sketch},
                            {"view", "front"},
                            {"point", {220, 150}},
                            {"other", "side"}})["line"];
    ASSERT_GT(line.size(), 2u);
    for (const Json& p : line) EXPECT_NEAR(p[1].get<double>(), 150, 1e-6);
}

}  // namespace
}  // namespace coppice
