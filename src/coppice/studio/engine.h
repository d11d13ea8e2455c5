#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/command.h"

namespace coppice {

/// What is sent, shared by all who send it.
using StudioBytes = std::shared_ptr<const std::string>;

/// What a studio begins with and may do.
struct StudioOptions {
    SceneSettings scene = {};            ///< `folder` is the one that was opened
    std::string file = {};               ///< the scene to open, by its name in the folder; empty: a new one
    std::filesystem::path journal = {};  ///< where the document is kept after every change; empty: nowhere
    /// The user's own menus, which may start programs: never files of the folder that is open, which may be
    /// somebody else's. Those that are not there are passed over.
    std::vector<std::filesystem::path> menus = {};
};

/// Somebody who is connected: a tab, or a test. Called on the engine's thread; must not block or throw.
class StudioClient {
  public:
    virtual ~StudioClient() = default;                ///< is not called any more
    virtual void send_text(std::string message) = 0;  ///< a message of the protocol, as JSON
    virtual void send_binary(StudioBytes frame) = 0;  ///< geometry in the form of the protocol
};

/// The engine of a studio: one thread that owns the document and does what messages ask for, in order.
/// docs/library/studio-protocol.md says what they are. Knows nothing of sockets or tokens. All functions may
/// be called from any thread.
class StudioEngine {
  public:
    explicit StudioEngine(
        const StudioOptions& options);  ///< starts the thread; throws IoError for a file it cannot read
    ~StudioEngine();                    ///< stops what runs and waits for it
    StudioEngine(const StudioEngine&) = delete;
    StudioEngine& operator=(const StudioEngine&) = delete;

    /// A client of that name comes, or comes back on another connection: it gets `welcome` first.
    void join(const std::string& name, std::shared_ptr<StudioClient> client);
    /// The connection is gone; a name that joined anew in the meantime stays.
    void leave(const std::string& name, const StudioClient* client);
    /// A message of a client that has joined. Never throws for what it says.
    void post(const std::string& name, const std::string& message);

    /// The geometry of that key; nullptr when there is none any more. May take as long as making it does.
    StudioBytes blob(std::string_view key) const;

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
