#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice {

/// Data to send, shared by all recipients.
using StudioBytes = std::shared_ptr<const std::string>;

/// Options of a studio.
struct StudioOptions {
    SceneSettings scene = {};            ///< `folder` is the opened folder
    std::string file = {};               ///< name of the scene to open in the folder; empty: a new scene
    std::filesystem::path journal = {};  ///< file that stores the document after every change; empty: none
    /// The user's own menus, which may start programs: never files of the opened folder, which may come from
    /// another person. Missing files are skipped.
    std::vector<std::filesystem::path> menus = {};
};

/// A connected client: a tab, or a test. Called on the engine's thread; must not block or throw.
class StudioClient {
  public:
    virtual ~StudioClient() = default;                ///< not called by the engine
    virtual void send_text(std::string message) = 0;  ///< sends a message of the protocol, as JSON
    virtual void send_binary(StudioBytes frame) = 0;  ///< sends geometry in the format of the protocol
};

/// The engine of a studio: one thread that owns the document and processes messages in order. The messages
/// are documented in docs/library/studio-protocol.md. Independent of sockets and tokens. All functions are
/// thread-safe.
class StudioEngine {
  public:
    explicit StudioEngine(
        const StudioOptions& options);  ///< starts the thread; throws IoError if a file cannot be read
    ~StudioEngine();                    ///< cancels the current request and waits for it
    StudioEngine(const StudioEngine&) = delete;
    StudioEngine& operator=(const StudioEngine&) = delete;

    /// Adds a client, or reconnects one: the first message that it receives is `welcome`.
    void join(const std::string& name, std::shared_ptr<StudioClient> client);
    /// Removes a connection; a client of the same name that has joined again since then stays.
    void leave(const std::string& name, const StudioClient* client);
    /// Queues a message of a client that has joined. Never throws because of its content.
    void post(const std::string& name, const std::string& message);

    /// Returns the geometry of that key; nullptr if it no longer exists. May take as long as computing the
    /// geometry.
    StudioBytes blob(std::string_view key) const;

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
