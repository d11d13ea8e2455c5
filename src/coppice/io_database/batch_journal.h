#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "coppice/base/context.h"

namespace coppice {

/// A finished item of a batch.
struct JournalEntry {
    std::string output;       ///< name of the result, unique in a journal
    std::uint64_t state = 0;  ///< hash of everything that the result depends on
    std::string row;          ///< figures of the item, as text
};

/// The journal of a batch: an SQLite file with the finished items, so that an interrupted batch can be
/// resumed. Every change is complete or not made at all, also if the process is killed. One process at a time
/// has the journal open.
///
/// All functions throw IoError with the file name if it is not a journal, damaged, not writable or in use, or
/// the disk is full; Cancelled. The functions must not be called by several threads at the same time.
class BatchJournal {
  public:
    /// Opens the file; creates it if it does not exist.
    explicit BatchJournal(const std::filesystem::path& path, const Context& ctx = {});
    ~BatchJournal();
    BatchJournal(const BatchJournal&) = delete;
    BatchJournal& operator=(const BatchJournal&) = delete;

    /// Returns the entry of a result; nullopt if there is none.
    std::optional<JournalEntry> find(const std::string& output) const;
    /// Adds an entry, or replaces that of the same result.
    void record(const JournalEntry& entry);
    /// Removes the entries of these results, those that exist.
    void remove(std::span<const std::string> outputs);

  private:
    class Database;
    std::unique_ptr<Database> database_;
};

}  // namespace coppice
