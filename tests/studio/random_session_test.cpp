#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "coppice/base/error.h"
#include "coppice/scene/scene.h"
#include "coppice/scene/script/statements.h"
#include "coppice/studio/show/geometry_internal.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

using Objects = std::map<std::string, std::string>;  // bytes by kind and name

/// Random actions of tools, forms and the text editor; the seed determines the sequence.
class RandomSession : public test::SessionTest, public testing::WithParamInterface<unsigned> {
  protected:
    std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }
    bool once_in(std::size_t n) { return below(n) == 0; }
    int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
    template <class T>
    const T& choose_one(const std::vector<T>& all) {
        return all[below(all.size())];
    }

    std::string solid() { return choose_one<std::string>({"a", "b", "c"}); }
    std::string points() { return choose_one<std::string>({"a", "b"}); }
    std::string tree() { return choose_one<std::string>({"t", "u", "v"}); }
    std::string place(int far = 3) {
        return fmt::format("{},{},{}", whole(-far, far), whole(-far, far), whole(0, 2 * far));
    }
    std::string selection() {
        return choose_one<std::string>(
            {"tips", "order(1)", "roots", "near(0,0,2)", "subtree(2)", "all", anchored()});
    }

    /// Returns a random node of the tree of a line, in the syntax of tools.
    std::string anchored() {
        const Json reply = ask({{"type", "anchor"}, {"name", "t"}, {"nodes", {whole(0, 30)}}});
        return reply["ok"].get<bool>() ? "\"" + reply["selections"][0].get<std::string>() + "\"" : "tips";
    }

    std::string command() {
        switch (below(30)) {
            case 0:
                return fmt::format("sphere {} radius={} center={}", solid(), whole(1, 4), place());
            case 1:
                return fmt::format("box {} low=-1,-1,0 high=1,2,{} radius=0.2", solid(), whole(1, 5));
            case 2:
                return fmt::format("translate {} {} 0 {} kind=solid", solid(), whole(-2, 2), whole(-2, 2));
            case 3:
                return fmt::format("{} {} {} {}",
                                   choose_one<std::string>({"union", "blend", "diff", "intersection"}),
                                   solid(), solid(), solid());
            case 4:
                return fmt::format("twist {} {}", solid(), whole(-40, 40));
            case 5:
                return fmt::format("pointset generate {} uniform count={} seed={}", points(), whole(5, 80),
                                   whole(0, 9));
            case 6:
                return fmt::format("pointset thin {} {} {}", points(), solid(), whole(0, 100));
            case 7:
                return fmt::format(
                    "grow {} {} root=0,0,-1 influence_radius=3 kill_radius=0.6 step=0.3 jitter=0.2 "
                    "max_iterations=60",
                    tree(), points());
            case 8:
                return fmt::format("limb {} 0,0,0 0,0,2 {} radius=0.2", tree(), place());
            case 9:
                return fmt::format("edit draw {} 0,0,1 {} {} radius=0.05 snap=100", tree(), place(), place());
            case 10:
                return fmt::format("edit rotate {} {} {}", tree(), selection(), whole(-90, 90));
            case 11:
                return fmt::format("edit bend {} {} {}", tree(), selection(), whole(-60, 60));
            case 12:
                return fmt::format("edit delete {} {}", tree(), selection());
            case 13:
                return fmt::format("edit thicken {} {} 1.{}", tree(), selection(), whole(1, 9));
            case 14:
                return fmt::format("edit move {} {} by={}", tree(), selection(), place(1));
            case 15:
                return fmt::format("radii {} tip_radius=0.0{}", tree(), whole(1, 9));
            case 16:
                return fmt::format("tidy {}", tree());
            case 17:
                return fmt::format("mesh {} levels=0", tree());
            case 18:
                return fmt::format("polygonize {} cell=0.7", solid());
            case 19:
                return fmt::format("copy {} {} kind=skeleton", tree(), tree());
            case 20:
                return fmt::format("delete {} kind={}", tree(), once_in(2) ? "skeleton" : "mesh");
            case 21:
                return fmt::format("let size = {}", whole(1, 4));
            case 22:
                return fmt::format("for i in 1..{}\n  sphere {} radius=${{i + size}}\nend", whole(1, 3),
                                   solid());
            case 23:
                return fmt::format("set seed {}", whole(0, 5));
            case 24:
                return fmt::format("sprout {} seasons={} internode=0.3", tree(), whole(1, 4));
            case 25:
                return fmt::format("loadtree {} in.swc", tree());
            case 26:  // has an effect, and then fails
                return fmt::format("repeat 2\n  sphere {} radius=3\n  translate missing 0 0 1\nend", solid());
            default:
                return choose_one<std::string>({"undo", "undo 2", "# a remark", "list", "describe a"});
        }
    }

    Json about() {
        if (once_in(2)) return {{"kind", "skeleton"}, {"name", tree()}};
        return {{"kind", "solid"}, {"name", solid()}};
    }

    void write_input() {
        std::ofstream(folder_ / "in.swc")
            << "1 1 0 0 0 0.2 -1\n2 1 0 0 1 0.2 1\n3 1 0." << whole(0, 9) << " 0 2 0.1 2\n";
    }

    std::string text() {
        std::string out;
        for (const Json all = session_->state(); const Json& s : all["statements"])
            out += s["text"].get<std::string>() + "\n";
        return out;
    }

    /// Changes a statement in the middle, or all of them.
    std::string changed_text() {
        std::vector<std::string> all;
        for (const Json state = session_->state(); const Json& s : state["statements"])
            all.push_back(s["text"]);
        if (all.empty()) return command() + "\n";
        const std::size_t at = below(all.size());
        const auto place = all.begin() + static_cast<std::ptrdiff_t>(at);
        switch (below(4)) {
            case 0:
                all.erase(place);
                break;
            case 1:
                *place = command();
                break;
            case 2:
                all.insert(place, command());
                break;
            default:
                std::swap(all[at], all[below(all.size())]);
        }
        std::string out;
        for (const std::string& s : all) out += s + "\n";
        return out;
    }

    /// May be refused: then the document must be unchanged.
    void step() {
        switch (below(16)) {
            case 0:
            case 1:
                ask({{"type", "text"},
                     {"text", changed_text()},
                     {"revision", session_->state()["revision"]},
                     {"joins", once_in(2)}});
                break;
            case 2:
                ask({{"type", "undo"}, {"count", whole(1, 4)}});
                break;
            case 3:
                ask({{"type", "redo"}, {"count", whole(1, 3)}});
                break;
            case 4:
                ask({{"type", "ran"}, {"count", below(session_->state()["statements"].size() + 1)}});
                break;
            case 5:
                write_input();
                ask({{"type", "rerun"}, {"file", "in.swc"}});
                break;
            case 6:
            case 7:
                ask({{"type", "preview"},
                     {"seq", 1},
                     {"line", command()},
                     {"about", about()},
                     {"surface", Json::object()}});
                if (once_in(2)) ask({{"type", "endpreview"}});
                break;
            case 8:
                ask({{"type", "show"}, {"kind", "skeleton"}, {"name", tree()}, {"form", "surface"}});
                ask({{"type", once_in(2) ? "aside" : "trial"},
                     {"line", command()},
                     {"kind", "skeleton"},
                     {"name", "t"}});
                break;
            default: {
                Json run{{"type", "run"}, {"line", command()}};
                if (once_in(2)) run["about"] = about();
                ask(run);
            }
        }
    }

    /// As clients receive them, without the head, which contains the version number.
    Objects shown() {
        Objects out;
        for (const Json all = session_->state(); const Json& object : all["objects"]) {
            Json show = object;
            show["type"] = "show";
            show["form"] = "coarse";
            out[name_in(object["kind"], object["name"])] = geometry(blob(must(show)));
        }
        return out;
    }
    /// The same for a scene that runs the text from its beginning.
    Objects made(std::string& failure) {
        const Json state = session_->state();
        Scene scene({.folder = folder_, .sandbox = std::make_shared<const FolderSandbox>(folder_)});
        std::size_t k = 0;
        for (const Json& s : state["statements"]) {
            const Scene before = scene;
            try {
                if (k == state["ran"] && state["error"].is_null()) break;
                run_section(scene, s["text"].get<std::string>(), s["line"].get<std::uint32_t>(),
                            state["file"] == "" ? "scene" : state["file"].get<std::string>(), {});
            } catch (const Error& error) {
                failure = error.what();
                scene = before;
                break;
            }
            ++k;
        }
        EXPECT_EQ(k, state["ran"]) << text();
        Objects out;
        for (const auto& [name, object] : scene.state().objects) {
            const GeometryHead head{name.first, name.second, 0, {}};
            out[name_in(std::string(name_of(name.first)), name.second)] =
                geometry(encode_object(*object, head, kCells, StudioColor::plain, {}));
        }
        return out;
    }
    static std::string name_in(const std::string& kind, const std::string& name) { return kind + " " + name; }
    static std::string geometry(const std::string& blob) {
        std::uint32_t length = 0;
        std::memcpy(&length, blob.data() + 4, 4);
        return blob.substr(8 + length);
    }

    void expect_same() {
        std::string failure;
        const Objects expected = made(failure), found = shown();
        const Json state = session_->state();
        EXPECT_EQ(state["error"].is_null() ? "" : state["error"]["message"].get<std::string>(), failure);
        ASSERT_EQ(found.size(), expected.size()) << text();
        for (const auto& [name, bytes] : expected) {
            ASSERT_TRUE(found.contains(name)) << name;
            EXPECT_TRUE(found.at(name) == bytes) << name << " differs from the scene of\n" << text();
        }
    }

    void redo_all() {
        while (ask({{"type", "redo"}})["ok"].get<bool>()) {
        }
        must({{"type", "ran"}});
    }

    static constexpr int kCells = 24;  // of solids that are shown coarsely
    std::mt19937 random_;
};

TEST_P(RandomSession, MatchesRunningItsText) {
    constexpr int kSteps = 200;
    random_.seed(GetParam());
    write_input();
    for (const char* line :
         {"let size = 1", "sphere a radius=2 center=0,0,3", "sphere b center=1,0,2",
          "pointset generate a uniform count=40", "limb t 0,0,0 0,0,1 0,0,2 0,0,3 radius=0.1",
          "edit draw t 0,0,2 1,0,2.5 2,0,3 radius=0.05"})
        run(line);
    run("loadtree u in.swc");
    for (int i = 0; i < kSteps; ++i) {
        step();
        if (once_in(12)) expect_same();
        if (HasFatalFailure()) return;
    }
    redo_all();
    expect_same();
    const std::string last = text();
    const Objects objects = shown();
    while (ask({{"type", "undo"}})["ok"].get<bool>()) {
    }
    EXPECT_EQ(text(), "");
    EXPECT_TRUE(session_->state()["objects"].empty());
    redo_all();
    EXPECT_EQ(text(), last);
    EXPECT_TRUE(shown() == objects);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomSession, testing::Values(1u, 2u, 3u, 4u));

}  // namespace
}  // namespace coppice
