// Sends arbitrary bytes as messages to a studio, one per line, in an empty folder and with little memory:
// every message with an id is answered, with a sentence of one line if it is refused; available data are
// fetched; and no internal error occurs.

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/options/json.h"
#include "coppice/studio/engine.h"

namespace {

using namespace coppice;

constexpr std::size_t kMaxMessages = 40;
constexpr std::chrono::milliseconds kRequestTimeout{300};  // together with a request, which is then cancelled

void require(bool condition) {
    if (!condition) std::abort();
}

/// A folder that is emptied for each input.
class Folder {
  public:
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "fuzz-studio-XXXXXX").string();
        require(::mkdtemp(name.data()) != nullptr);
        path_ = name;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// Checks all messages that it receives.
class Watcher : public StudioClient {
  public:
    void send_text(std::string message) override {
        const Json reply = Json::parse(message);
        const std::scoped_lock lock(mutex_);
        if (reply.contains("key") && reply["key"].is_string()) keys_.push_back(reply["key"]);
        if (!reply.contains("re")) return;
        ++answers_;
        wake_.notify_all();
        if (reply["ok"].get<bool>()) return;
        const bool proper =
            reply["kind"] != "internal" && reply["error"].get<std::string>().find('\n') == std::string::npos;
        if (!proper) std::fprintf(stderr, "%s\n", message.c_str());
        require(proper);
    }
    void send_binary(StudioBytes frame) override { require(frame->starts_with("CPB1")); }

    bool wait_for_answer() {
        std::unique_lock lock(mutex_);
        return wake_.wait_for(lock, kRequestTimeout, [&] { return answers_ > 0; });
    }
    std::vector<std::string> keys() {
        const std::scoped_lock lock(mutex_);
        return keys_;
    }

  private:
    std::mutex mutex_;
    std::condition_variable wake_;
    std::size_t answers_ = 0;
    std::vector<std::string> keys_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const Folder folder;
    StudioOptions options;
    options.scene = {.max_memory = 16, .outputs = false, .folder = folder.path(), .max_lines = 60};
    StudioEngine engine(options);
    const auto hand = std::make_shared<Watcher>(), last = std::make_shared<Watcher>();
    engine.join("hand", hand);
    engine.join("last", last);
    std::size_t lines = 0;
    for (std::size_t at = 0; at < text.size() && lines < kMaxMessages; ++lines) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        engine.post("hand", std::string(text.substr(at, end - at)));
        at = end + 1;
    }
    // Requests are answered in order, except `cancel`, which overtakes them.
    int id = 1;
    engine.post("last", Json{{"id", id}, {"type", "ping"}}.dump());
    const auto stopper = std::make_shared<Watcher>();
    engine.join("stopper", stopper);
    while (!last->wait_for_answer()) engine.post("stopper", Json{{"id", id++}, {"type", "cancel"}}.dump());
    for (const std::string& key : hand->keys()) {
        try {
            if (const StudioBytes blob = engine.blob(key)) require(blob->starts_with("CPB1"));
        } catch (const Error&) {  // objects that cannot be shown report it
        }
    }
    return 0;
}
