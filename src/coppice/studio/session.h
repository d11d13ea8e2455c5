#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/pipeline/json.h"
#include "coppice/studio/document/document.h"
#include "coppice/studio/engine.h"
#include "coppice/studio/show/blob_store.h"

namespace coppice {

/// What a statement has grown so far.
struct StudioGrown {
    std::size_t statement = 0;  ///< its number in the list that is being made
    std::uint32_t nodes = 0;    ///< number of them
    std::string until;          ///< the option with which it ends there: "max_iterations=57"
    std::string key;            ///< of the blob
};

/// Who is told of what runs, on the thread that runs it. Must not throw.
struct StudioWatch {
    Document::Watch runs = {};                           ///< of statements
    std::function<void(const StudioGrown&)> grown = {};  ///< now and then, while something grows
};

/// What a studio does, message by message, without threads or connections: docs/library/studio-protocol.md
/// says what the requests are. Used by one thread.
class StudioSession {
  public:
    /// Takes a binary frame on its way to a client.
    using Frames = std::function<void(const std::string& client, StudioBytes frame)>;

    /// Opens the file of the options, or what the journal holds where that was left behind, and runs nothing
    /// of it yet: that is the request `ran`. Throws IoError for a file that cannot be read. `blobs` must
    /// outlive the session.
    StudioSession(const StudioOptions& options, BlobStore& blobs, Frames frames);
    ~StudioSession();

    /// Does what a request asks for and answers it, with `ok` and all that belongs to it; never throws for
    /// what is asked.
    Json answer(const std::string& client, const Json& request, const Context& ctx);

    Json state() const;              ///< STATE of the protocol
    std::uint64_t revision() const;  ///< another one whenever state() is
    std::string folder() const;      ///< name of the folder that is open
    void watch(StudioWatch watch);   ///< from now on
    /// Writes what changed since the last call to the journal; it goes when the text is saved. Throws
    /// IoError.
    void keep_journal();

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
