#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "coppice/system/file.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

/// A trunk with one branch, for small images of its motion.
class MotionRequests : public test::SessionTest {
  protected:
    void SetUp() override {
        SessionTest::SetUp();
        make_tree();
    }

    void make_tree() {
        run("limb t 0,0,0 0,0,4 radius=0.2 tip_radius=0.1 spacing=0.5");
        run("edit draw t 0,0,2 1,0,2.5 2,0,3 radius=0.06");
    }

    /// Returns "kind: sentence" of a refused request.
    std::string refusal(const Json& request, const Context& ctx = {}) {
        const Json reply = ask(request, ctx);
        EXPECT_FALSE(reply["ok"].get<bool>()) << reply.dump();
        return reply.value("kind", "") + ": " + reply.value("error", "");
    }

    static Json animate(const std::string& file, const Json& more) {
        Json request{
            {"type", "animate"}, {"name", "t"}, {"file", file}, {"keys", "0.4 linear: rotate order(1) 30"}};
        request["options"] = {{"rate", 5}, {"levels", 1}, {"width", 32}, {"height", 32}, {"samples", 1}};
        if (more.is_object()) request.merge_patch(more);
        return request;
    }
    static Json frame(double time, const Json& more = Json::object()) {
        Json request = animate("", more);
        request["type"] = "frame";
        request["time"] = time;
        return request;
    }

    std::vector<std::string> names() const {
        std::vector<std::string> out;
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            out.push_back(entry.path().filename().string());
        std::ranges::sort(out);
        return out;
    }
    std::vector<float> places(const Json& reply) { return numbers<float>(blob(reply), "position"); }
};

// 0.4 s at 5 frames a second, including the last moment: 3 frames.
TEST_F(MotionRequests, WriteAFileForEachFrame) {
    const Json made = must(animate("sway.png", {}));
    EXPECT_EQ(made["files"], Json::array({"sway_0000.png", "sway_0001.png", "sway_0002.png"}));
    EXPECT_EQ(made["file"], "sway_0000.png");
    EXPECT_EQ(made["frames"], 3);
    EXPECT_EQ(made["frozen"], 0);
    EXPECT_EQ(made["message"].get<std::string>().substr(0, 12), "3 frames of ");
    std::uintmax_t bytes = 0;
    for (const std::string& name : names()) bytes += std::filesystem::file_size(folder_ / name);
    EXPECT_EQ(made["bytes"], bytes);
    EXPECT_NE(read_file(folder_ / "sway_0000.png"), read_file(folder_ / "sway_0002.png"));
}

TEST_F(MotionRequests, ShowTheBarkOfAMaterial) {
    run("material bark oak width=16");
    must(animate("plain.png", {}));
    must(animate("barked.png", {{"material", "bark"}}));
    EXPECT_NE(read_file(folder_ / "barked_0000.png"), read_file(folder_ / "plain_0000.png"));
    must(animate("barked.glb", {{"material", "bark"}}));
    EXPECT_NE(read_file(folder_ / "barked.glb").find("normalTexture"), std::string::npos);
    EXPECT_EQ(names().size(), 7u);  // images of bark are written only for OBJ and USDA
    must(animate("barked.usda", {{"material", "bark"}}));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "barked_bark_color.png"));
    EXPECT_EQ(refusal(animate("none.png", {{"material", "wood"}})), "input: there is no material 'wood'");
}

TEST_F(MotionRequests, WriteOneAnimatedFile) {
    const Json made = must(animate("sway.gif", {}));
    EXPECT_EQ(made["files"], Json::array({"sway.gif"}));
    EXPECT_EQ(read_file(folder_ / "sway.gif").substr(0, 6), "GIF89a");
    EXPECT_EQ(must(animate("sway.glb",
                           {{"keys", ""}, {"options", {{"wind_speed", 9}, {"duration", 1}}}}))["frames"],
              5);
    EXPECT_EQ(read_file(folder_ / "sway.glb").substr(0, 4), "glTF");
}

TEST_F(MotionRequests, WriteAGrowingTree) {
    const Json grow{{"keys", ""}, {"options", {{"grow", true}, {"duration", 0.4}}}};
    EXPECT_EQ(must(animate("up.usda", grow))["frames"], 2);
    EXPECT_EQ(refusal(animate("up.glb", grow)).substr(0, 21), "input: 'up.glb': a GL");
    EXPECT_NE(refusal(animate("up.usda", {{"overwrite", true}, {"options", {{"grow", true}}}}))
                  .find("leave the keys"),
              std::string::npos);
}

TEST_F(MotionRequests, PreserveExistingFiles) {
    std::ofstream(folder_ / "sway_0001.png") << "mine";
    EXPECT_EQ(refusal(animate("sway.png", {})).substr(0, 6), "files:");
    EXPECT_EQ(names(), std::vector<std::string>{"sway_0001.png"});
    EXPECT_EQ(read_file(folder_ / "sway_0001.png"), "mine");
    must(animate("sway.png", {{"overwrite", true}}));
    EXPECT_NE(read_file(folder_ / "sway_0001.png"), "mine");
}

TEST_F(MotionRequests, WriteNothingOutsideTheFolder) {
    const auto outside = folder_.parent_path() / "coppice_outside.png";
    for (const std::string& name : {std::string("../coppice_outside.png"), outside.string()})
        EXPECT_EQ(refusal(animate(name, {})).substr(0, 6), "files:") << name;
    // A series is also refused if only one frame is outside the folder.
    std::filesystem::create_symlink(outside, folder_ / "sway_0002.png");
    EXPECT_EQ(refusal(animate("sway.png", {{"overwrite", true}})).substr(0, 6), "files:");
    EXPECT_FALSE(std::filesystem::exists(outside));
}

TEST_F(MotionRequests, ErrorsOfKeysReportTheLine) {
    EXPECT_EQ(refusal(animate("s.gif", {{"keys", "0: rest\n1: spin 3 20"}})).substr(0, 14), "input: key:2: ");
    EXPECT_EQ(refusal(frame(0, {{"keys", "0: rest\n\n1 bouncy: rest"}})).substr(0, 14), "input: key:3: ");
}

TEST_F(MotionRequests, OptionsMatchThoseOfTheProgram) {
    EXPECT_EQ(refusal(animate("s.gif", {{"keys", ""}})).substr(0, 26), "input: nothing would move;");
    EXPECT_NE(refusal(animate("s.gif", {{"options", {{"wind_sped", 3}}}})).find("did you mean wind_speed"),
              std::string::npos);
    EXPECT_NE(refusal(animate("s.gif", {{"options", {{"rate", 1000}}}})).find("rate takes a number"),
              std::string::npos);
    EXPECT_NE(refusal(animate("s.gif", {{"options", {{"duration", 3600}}}})).find("at most 10000"),
              std::string::npos);
    EXPECT_NE(refusal(animate("s.avi", {})).find("not a valid file name for frames"), std::string::npos);
    EXPECT_TRUE(names().empty());
}

TEST_F(MotionRequests, WriteNothingIfCancelled) {
    std::stop_source stop;
    const Context ctx{.threads = 0, .stop = stop.get_token(), .progress = [&](float f) {
                          if (f > 0.5f) stop.request_stop();
                      }};
    EXPECT_EQ(refusal(animate("sway.png", {}), ctx).substr(0, 10), "cancelled:");
    EXPECT_TRUE(names().empty());
}

TEST_F(MotionRequests, ProgressNeverDecreases) {
    std::vector<float> seen;
    const Context ctx{.threads = 0, .stop = {}, .progress = [&](float f) { seen.push_back(f); }};
    ask(animate("sway.ply", {}), ctx);
    EXPECT_TRUE(std::ranges::is_sorted(seen));
    ASSERT_FALSE(seen.empty());
    EXPECT_EQ(seen.back(), 1);
}

TEST_F(MotionRequests, CheckTheMemoryFirst) {
    options_.scene.max_memory = 1;
    reopen();
    make_tree();
    const Json fine{{"options", {{"levels", 5}}}};
    EXPECT_NE(refusal(animate("s.ply", fine)).find("allowed"), std::string::npos);
    EXPECT_NE(refusal(frame(0, fine)).find("allowed"), std::string::npos);
    const Json large{{"options", {{"width", 512}, {"height", 512}}}};
    EXPECT_NE(refusal(animate("s.png", large)).find("allowed"), std::string::npos);
}

TEST_F(MotionRequests, ReturnTheSurfaceAtATime) {
    const Json rest = must(frame(0)), turned = must(frame(0.4));
    EXPECT_EQ(rest["duration"], 0.4);
    EXPECT_EQ(rest["frames"], 3);
    EXPECT_EQ(must(frame(9))["time"], 0.4);
    const Json before = header(blob(rest));
    EXPECT_EQ(before["kind"], "surface");
    EXPECT_EQ(before["object"], Json({{"kind", "skeleton"}, {"name", "t"}}));
    EXPECT_EQ(before["arrays"], header(blob(turned))["arrays"]);  // the same faces at other positions
    EXPECT_NE(places(rest), places(turned));
    EXPECT_EQ(places(must(frame(0))), places(rest));
}

// The last frame of a film has the same vertices, because no nodes are frozen.
TEST_F(MotionRequests, SurfaceAtATimeMatchesTheFrame) {
    must(animate("sway.obj", {}));
    std::ifstream file(folder_ / "sway_0002.obj");
    std::string mark;
    double x = 0, y = 0, z = 0;
    while (file >> mark && mark != "v") file.ignore(1000, '\n');
    file >> x >> y >> z;
    const std::vector<float> moment = places(must(frame(0.4)));
    EXPECT_NEAR(x, double{moment.at(0)}, 1e-5);
    EXPECT_NEAR(y, double{moment.at(1)}, 1e-5);
    EXPECT_NEAR(z, double{moment.at(2)}, 1e-5);
}

TEST_F(MotionRequests, FollowLaterChangesOfTheTree) {
    const std::vector<float> before = places(must(frame(0)));
    run("edit scale t 0 1.5");
    EXPECT_NE(places(must(frame(0))), before);
}

TEST_F(MotionRequests, ReturnTheSurfaceOfAGrowingTree) {
    const Json grow{{"keys", ""}, {"options", {{"grow", true}}}};
    const Json young = must(frame(1, grow)), old = must(frame(4, grow));
    EXPECT_EQ(old["duration"], 4);
    EXPECT_LT(places(young).size(), places(old).size());
}

}  // namespace
}  // namespace coppice
