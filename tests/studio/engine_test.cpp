#include "coppice/studio/engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "coppice/options/json.h"
#include "coppice/system/file.h"
#include "temporary_folder.h"

namespace coppice {
namespace {

/// Stores the messages that it receives.
class Listener : public StudioClient {
  public:
    void send_text(std::string message) override {
        const std::scoped_lock lock(mutex_);
        messages_.push_back(Json::parse(message));
        wake_.notify_all();
    }
    void send_binary(StudioBytes) override {}

    /// Waits for the first message that satisfies a condition, and returns it.
    template <class Holds>
    Json wait(const Holds& holds) {
        std::unique_lock lock(mutex_);
        Json found;
        const auto look = [&] {
            for (const Json& m : messages_) {
                if (!holds(m)) continue;
                found = m;
                return true;
            }
            return false;
        };
        wake_.wait(lock, look);
        return found;
    }
    Json answer(int id) {
        return wait([id](const Json& m) { return m.value("re", -1) == id; });
    }
    template <class Holds>
    std::size_t count(const Holds& holds) {
        const std::scoped_lock lock(mutex_);
        return static_cast<std::size_t>(std::ranges::count_if(messages_, holds));
    }
    std::size_t answers(int id) {
        return count([id](const Json& m) { return m.value("re", -1) == id; });
    }

  private:
    std::mutex mutex_;
    std::condition_variable wake_;
    std::vector<Json> messages_;
};

std::string run_request(int id, const std::string& line) {
    return Json{{"id", id}, {"type", "run"}, {"line", line}}.dump();
}

TEST(StudioEngineThread, AnswersInOrderAndNotifiesEveryClient) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>(), b = std::make_shared<Listener>();
    engine.join("a", a);
    engine.join("b", b);
    engine.post("a", run_request(1, "sphere s"));
    engine.post("a", run_request(2, "sphere s radius=-1"));
    EXPECT_TRUE(a->answer(1)["ok"].get<bool>());
    EXPECT_FALSE(a->answer(2)["ok"].get<bool>());
    const Json state = b->wait([](const Json& m) { return m.value("type", "") == "state"; });
    EXPECT_EQ(state["by"], "a");
    EXPECT_EQ(state["objects"].size(), 1u);
}

TEST(StudioEngineThread, RepeatsNothingAfterAReconnection) {
    StudioEngine engine{{}};
    auto first = std::make_shared<Listener>();
    engine.join("a", first);
    engine.post("a", run_request(1, "sphere s"));
    first->answer(1);
    engine.leave("a", first.get());
    engine.post("a", run_request(2, "sphere lost"));  // no client is connected
    auto second = std::make_shared<Listener>();
    engine.join("a", second);
    EXPECT_EQ(second->wait([](const Json& m) { return m.value("type", "") == "welcome"; })["answered"], 1);
    engine.post("a", run_request(1, "sphere s"));
    engine.post("a", run_request(2, "sphere t"));
    EXPECT_TRUE(second->answer(1)["ok"].get<bool>());
    EXPECT_TRUE(second->answer(2)["ok"].get<bool>());
    engine.post("a", Json{{"id", 3}, {"type", "describe"}, {"kind", "solid"}, {"name", "t"}}.dump());
    second->answer(3);
    const Json state =
        second->wait([](const Json& m) { return m.value("type", "") == "state" && m["undo"].size() == 2; });
    EXPECT_EQ(state["undo"], Json::array({"sphere s", "sphere t"}));
}

TEST(StudioEngineThread, ReportsAnAnswerThatIsNoLongerStored) {
    StudioOptions options;
    options.scene.max_memory = 256;  // 32 KiB of answers for each client
    StudioEngine engine{options};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    engine.post("a", R"({"id": 1, "type": "schema"})");
    const std::string ping = Json{{"id", 2}, {"type", "ping"}, {"time", std::string(40'000, 'x')}}.dump();
    engine.post("a", ping);
    a->answer(2);
    engine.post("a", R"({"id": 1, "type": "schema"})");
    const Json refused = a->wait([](const Json& m) { return m.value("re", -1) == 1 && m["ok"] == false; });
    EXPECT_EQ(refused["kind"], "busy");
    engine.post("a", ping);  // the newest is stored, regardless of its length
    while (a->answers(2) < 2) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(StudioEngineThread, StopsARunningRequest) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    engine.post("a", run_request(1, "for i in 1..90000\n  sphere s radius=${i}\nend"));
    a->wait([](const Json& m) { return m.value("type", "") == "progress"; });
    engine.post("a", R"({"id": 2, "type": "cancel"})");
    EXPECT_EQ(a->answer(1)["kind"], "cancelled");
    EXPECT_TRUE(a->answer(2)["ok"].get<bool>());
}

TEST(StudioEngineThread, OnlyTheNewestWaitingPreviewRuns) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    engine.post("a", run_request(1, "repeat 2000\n  sphere s\nend"));
    for (int id = 2; id < 12; ++id)
        engine.post("a",
                    Json{{"id", id}, {"type", "preview"}, {"seq", id}, {"line", "translate s 0 0 1"}}.dump());
    EXPECT_TRUE(a->answer(11)["ok"].get<bool>());
    EXPECT_FALSE(a->answer(11).contains("dropped"));
    for (int id = 2; id < 12; ++id) EXPECT_EQ(a->answers(id), 1u);
}

TEST(StudioEngineThread, CancelsAPreviewOnTheNextRequestOfItsClient) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    const std::string line = "for i in 1..90000\n  sphere s radius=${i}\nend";
    engine.post("a", Json{{"id", 1}, {"type", "preview"}, {"seq", 1}, {"line", line}}.dump());
    // The first of these may arrive before the preview has begun.
    for (int id = 2; a->answers(1) == 0; ++id) {
        engine.post("a", Json{{"id", id}, {"type", "ping"}}.dump());
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(a->answer(1)["dropped"].get<bool>()) << a->answer(1).dump();
}

/// A growth that would take seconds.
constexpr const char* kGrowth = "grow tree crown influence_radius=0.5 kill_radius=0.05 step=0.01";

std::string text_of_growth() {
    return std::string("sphere crown radius=3 center=0,0,4\npointset generate crown uniform count=300000\n") +
           kGrowth + "\n";
}

TEST(StudioEngineThread, ReportsTheRunningStatementAndItsGrowth) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    const Json welcome = a->wait([](const Json& m) { return m.value("type", "") == "welcome"; });
    EXPECT_TRUE(welcome["state"]["running"].is_null());
    const Json text{
        {"id", 1}, {"type", "text"}, {"text", text_of_growth()}, {"revision", welcome["state"]["revision"]}};
    engine.post("a", text.dump());
    const auto grows = [](const Json& m) { return m.value("type", "") == "state" && m["running"] == 2; };
    EXPECT_EQ(a->wait(grows)["doing"], kGrowth);
    const Json grown = a->wait([](const Json& m) { return m.value("type", "") == "grown"; });
    EXPECT_EQ(grown["statement"], 2);
    EXPECT_EQ(grown["until"].get<std::string>().find("max_iterations="), 0u);
    EXPECT_GT(grown["nodes"], 1);
    const auto late = std::make_shared<Listener>();
    engine.join("late", late);  // a client that joins now sees it too
    EXPECT_EQ(late->wait([](const Json& m) { return m.value("type", "") == "welcome"; })["state"]["running"],
              2);
    engine.post("a", R"({"id": 2, "type": "cancel"})");
    EXPECT_EQ(a->answer(1)["kind"], "cancelled");
    EXPECT_EQ(a->answer(1)["grown"]["statement"], 2);
    const Json after =
        late->wait([](const Json& m) { return m.value("type", "") == "state" && m["running"].is_null(); });
    EXPECT_EQ(after["doing"], "");
    EXPECT_TRUE(after["statements"].empty());
}

TEST(StudioEngineThread, ShortRequestsAreNotReported) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    for (int id = 1; id <= 20; ++id) engine.post("a", run_request(id, "sphere s"));
    a->answer(20);
    EXPECT_EQ(
        a->count([](const Json& m) { return m.value("type", "") == "state" && !m["running"].is_null(); }),
        0u);
}

class OpenedFile : public test::FolderTest {};

TEST_F(OpenedFile, RunsWhenOpenedAndCanBeStopped) {
    write_file(folder_ / "long.coppice", text_of_growth());
    StudioOptions options;
    options.scene.folder = folder_;
    options.file = "long.coppice";
    StudioEngine engine{options};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    EXPECT_EQ(
        a->wait([](const Json& m) { return m.value("type", "") == "welcome"; })["state"]["statements"].size(),
        3u);
    a->wait([](const Json& m) { return m.value("type", "") == "state" && m["running"] == 2; });
    engine.post("a", R"({"id": 1, "type": "cancel"})");
    const Json stopped =
        a->wait([](const Json& m) { return m.value("type", "") == "state" && m["running"].is_null(); });
    EXPECT_EQ(stopped["ran"], 0);
    EXPECT_EQ(stopped["statements"].size(), 3u);
    EXPECT_TRUE(stopped["saved"].get<bool>());
    engine.post("a", R"({"id": 2, "type": "ran", "count": 1})");
    EXPECT_TRUE(a->answer(2)["ok"].get<bool>());
    EXPECT_EQ(
        a->wait([](const Json& m) { return m.value("type", "") == "state" && m["ran"] == 1; })["objects"]
            .size(),
        1u);
}

TEST(StudioEngineThread, RejectsInvalidMessages) {
    StudioEngine engine{{}};
    const auto a = std::make_shared<Listener>();
    engine.join("a", a);
    const std::string deep =
        R"({"id": 1, "type": "ping", "time": )" + std::string(1 << 20, '[') + std::string(1 << 20, ']') + "}";
    for (const std::string& text :
         {std::string(), std::string("[]"), std::string("{"), deep,
          std::string(R"({"id": -3, "type": "undo"})"), std::string(R"({"type": "undo"})")})
        engine.post("a", text);
    engine.post("a", R"({"id": 1, "type": "ping"})");
    EXPECT_TRUE(a->answer(1)["ok"].get<bool>());
    EXPECT_EQ(a->answers(0), 6u);
    // Brackets in texts do not count.
    engine.post("a", Json{{"id", 2}, {"type", "ping"}, {"time", "\\\"" + std::string(100, '[')}}.dump());
    EXPECT_TRUE(a->answer(2)["ok"].get<bool>());
}

}  // namespace
}  // namespace coppice
