#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/options/json.h"
#include "coppice/studio/document/document.h"
#include "coppice/studio/engine.h"
#include "coppice/studio/show/blob_store.h"

namespace coppice {

/// The intermediate result of a growth.
struct StudioGrown {
    std::size_t statement = 0;  ///< its index in the new list
    std::uint32_t nodes = 0;    ///< number of nodes
    std::string until;          ///< the option that would end the growth here: "max_iterations=57"
    std::string key;            ///< key of the blob
};

/// Callbacks for running statements, called on the thread that runs them. Must not throw.
struct StudioWatch {
    Document::Watch runs = {};                           ///< for statements
    std::function<void(const StudioGrown&)> grown = {};  ///< occasionally during growth
};

/// Processes the messages of a studio, without threads or connections: docs/library/studio-protocol.md
/// documents the requests. For use by one thread.
class StudioSession {
  public:
    /// Receives a binary frame to send to a client.
    using Frames = std::function<void(const std::string& client, StudioBytes frame)>;

    /// Opens the file of the options, or the journal if an earlier session left one, without running it: that
    /// is the request `ran`. Throws IoError if a file cannot be read. `blobs` must outlive the session.
    StudioSession(const StudioOptions& options, BlobStore& blobs, Frames frames);
    ~StudioSession();

    /// Processes a request and returns its answer, with `ok` and the fields of the request type; never throws
    /// because of the request.
    Json answer(const std::string& client, const Json& request, const Context& ctx);

    Json state() const;              ///< STATE of the protocol
    std::uint64_t revision() const;  ///< changes whenever state() does
    std::string folder() const;      ///< name of the opened folder
    void watch(StudioWatch watch);   ///< sets the callbacks
    /// Writes the changes since the last call to the journal, which is removed when the text is saved. Throws
    /// IoError.
    void keep_journal();

  private:
    class State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice
