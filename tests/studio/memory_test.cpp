#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "coppice/studio/memory_budget_internal.h"
#include "studio/heap_bytes.h"
#include "studio/session_fixture.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMebibyte = 1 << 20;

/// A studio with a limit of 64 MiB: 20 of them for a scene, and 4 for surfaces that follow edits.
class StudioMemory : public test::SessionTest {
  protected:
    void SetUp() override {
        options_.scene.max_memory = 64;
        SessionTest::SetUp();
    }
    /// Returns a tree with that many nodes.
    void make_tree(int nodes) { run(fmt::format("limb t 0,0,0 0,0,{} spacing=1", nodes - 1)); }
};

TEST(MemoryBudget, SumsToTheTotal) {
    const MemoryBudget shares(4096);
    EXPECT_EQ(2 * shares.scene + shares.states + shares.surfaces + shares.blobs + shares.texts +
                  shares.growth + shares.messages,
              std::uint64_t{4096} << 20);
    EXPECT_GT(MemoryBudget(1).growth, 0u);
    EXPECT_GT(MemoryBudget(-5).scene, 0u);
}

TEST_F(StudioMemory, RejectsTooLargeRequests) {
    run("sphere a");
    EXPECT_NE(refused({{"type", "run"}, {"line", "pointset generate a uniform count=3000000"}}).find("MiB"),
              std::string::npos);
    make_tree(5000);  // 6 MB of surface
    const Json tree{{"kind", "skeleton"}, {"name", "t"}};
    const auto with = [&](const char* type, const Json& more) {
        Json request = tree;
        request["type"] = type;
        request.update(more);
        return request;
    };
    must(with("show", {{"form", "axes"}}));
    EXPECT_NE(refused(with("show", {{"form", "surface"}})).find("--max-memory"), std::string::npos);
    must(with("show", {{"form", "surface"}, {"surface", {{"levels", 0}}}}));
    EXPECT_NE(refused(with("check", {{"surface", {{"levels", 4}}}})).find("MiB"), std::string::npos);
    EXPECT_NE(refused(with("export", {{"file", "t.glb"}, {"surface", {{"levels", 4}}}})).find("MiB"),
              std::string::npos);
    EXPECT_NE(refused(with("trial", {{"line", "list"}, {"form", "surface"}, {"surface", {{"levels", 4}}}}))
                  .find("MiB"),
              std::string::npos);
    EXPECT_NE(
        refused(with("preview", {{"line", "edit rotate t 2 10"}, {"seq", 1}, {"surface", Json::object()}}))
            .find("--max-memory"),
        std::string::npos);
    EXPECT_NE(refused({{"type", "picture"},
                       {"kind", "skeleton"},
                       {"objects", {"t"}},
                       {"file", "t.png"},
                       {"options", {{"width", 8000}, {"height", 8000}}}})
                  .find("MiB"),
              std::string::npos);
    run("pointset generate a uniform count=200000");  // 2.4 MB, of which 2 may be shown
    EXPECT_NE(refused({{"type", "show"}, {"kind", "points"}, {"name", "a"}}).find("--max-memory"),
              std::string::npos);
    const Json slice{{"type", "slice"}, {"kind", "solid"}, {"name", "a"},
                     {"axis", "z"},     {"at", 0},         {"size", 1024}};
    EXPECT_NE(refused(slice).find("--max-memory"), std::string::npos);
    EXPECT_NE(refused({{"type", "text"},
                       {"text", "# " + std::string(1'000'000, 'x') + "\n# " + std::string(100'000, 'x')},
                       {"revision", session_->state()["revision"]}})
                  .find("MiB"),
              std::string::npos);
    // A refused request leaves no trace, and the session still works.
    EXPECT_EQ(session_->state()["statements"].size(), 3u);
    run("sphere b");
}

TEST_F(StudioMemory, UsageIsLimited) {
    run("sphere a");
    make_tree(800);
    const std::uint64_t before = test::heap_bytes();
    std::uint64_t most = 0;
    for (int i = 0; i < 40; ++i) {
        run(fmt::format("pointset generate a uniform count=100000 seed={}", i));
        run(fmt::format("edit rotate t 2 {} axis=0,1,0", 5 + i));
        const Json preview{{"type", "preview"},
                           {"seq", i},
                           {"line", fmt::format("edit rotate t 400 {}", i)},
                           {"surface", Json::object()}};
        must(preview);
        frames_.clear();
        for (const Json all = session_->state(); const Json& object : all["objects"]) {
            Json show = object;
            show["type"] = "show";
            show["form"] = object["kind"] == "skeleton" ? "surface" : "coarse";
            const Json reply = must(show);
            if (!reply["key"].is_null()) blob(reply);
        }
        blob(must({{"type", "slice"},
                   {"kind", "solid"},
                   {"name", "a"},
                   {"axis", "z"},
                   {"at", 0.001 * i},
                   {"size", 600}}));
        if (i % 10 == 9) must({{"type", "undo"}, {"count", 15}});
        most = std::max(most, test::heap_bytes());
    }
    // All points together would be 48 MB, all slices 58.
    EXPECT_LT(most - std::min(most, before), 64 * kMebibyte);
}

}  // namespace
}  // namespace coppice
