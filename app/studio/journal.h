#pragma once

#include <filesystem>

namespace coppice::server {

/// A place for the journal of a document: `$XDG_STATE_HOME/coppice/studio/`, or `~/.local/state/...`. Each
/// document has several, since it may be open more than once: the first that no other studio holds is taken,
/// and held as long as this object lives. So what a killed studio left is found again by the next one.
class JournalPlace {
  public:
    /// Of a scene file, or of a folder for what has no name yet. Where none can be had, file() is empty.
    explicit JournalPlace(const std::filesystem::path& document);
    ~JournalPlace();
    JournalPlace(const JournalPlace&) = delete;
    JournalPlace& operator=(const JournalPlace&) = delete;

    const std::filesystem::path& file() const { return file_; }

  private:
    std::filesystem::path file_;
    int lock_ = -1;
};

}  // namespace coppice::server
