#pragma once

#include <filesystem>
#include <optional>

#include "coppice/system/file_lock.h"

namespace coppice::server {

/// The file for the journal of a document in `$XDG_STATE_HOME/coppice/studio/`, or `~/.local/state/...`. Each
/// document has several, since it may be open more than once: the first one that no other studio uses is
/// locked for the lifetime of this object. Thus the next studio finds the journal of one that was killed.
class JournalPlace {
  public:
    /// Uses a journal for a scene file, or for a folder if the document has no name yet. If none can be
    /// created, file() is empty.
    explicit JournalPlace(const std::filesystem::path& document);

    const std::filesystem::path& file() const { return file_; }

  private:
    std::filesystem::path file_;
    std::optional<FileLock> lock_;
};

}  // namespace coppice::server
