#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coppice/studio/session.h"
#include "temporary_folder.h"

namespace coppice::test {

/// A session in a new folder, without threads.
class SessionTest : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        reopen();
    }

    /// Restarts with the current options.
    void reopen() {
        options_.scene.folder = folder_;
        session_ = nullptr;
        session_ = std::make_unique<StudioSession>(
            options_, blobs_, [this](const std::string&, StudioBytes frame) { frames_.push_back(*frame); });
        session_->answer("tab", {{"type", "ran"}}, {});
    }

    Json ask(const Json& request, const Context& ctx = {}) { return session_->answer("tab", request, ctx); }

    Json must(const Json& request) {
        Json reply = ask(request);
        EXPECT_TRUE(reply["ok"].get<bool>()) << reply.dump();
        return reply;
    }

    std::string refused(const Json& request) {
        const Json reply = ask(request);
        EXPECT_FALSE(reply["ok"].get<bool>()) << reply.dump();
        return reply.value("error", "");
    }

    void run(const std::string& line) { must({{"type", "run"}, {"line", line}}); }

    static Json header(const std::string& blob) {
        std::uint32_t length = 0;
        std::memcpy(&length, blob.data() + 4, 4);
        return Json::parse(blob.substr(8, length));
    }
    /// Returns the numbers of an array of a blob.
    template <class Number>
    static std::vector<Number> numbers(const std::string& blob, const std::string& name) {
        std::uint32_t length = 0;
        std::memcpy(&length, blob.data() + 4, 4);
        const Json head = header(blob);
        for (const Json& array : head["arrays"]) {
            if (array["name"] != name) continue;
            std::vector<Number> out(array["size"].get<std::size_t>() * array["count"].get<std::size_t>());
            std::memcpy(out.data(), blob.data() + 8 + length + array["offset"].get<std::size_t>(),
                        out.size() * sizeof(Number));
            return out;
        }
        ADD_FAILURE() << "no array " << name;
        return {};
    }
    std::string blob(const Json& reply) {
        const auto bytes = blobs_.get(reply["key"].get<std::string>());
        EXPECT_TRUE(bytes);
        return bytes ? *bytes : std::string();
    }

    StudioOptions options_;
    BlobStore blobs_{std::uint64_t{4} << 20};
    std::vector<std::string> frames_;
    std::unique_ptr<StudioSession> session_;
};

}  // namespace coppice::test
