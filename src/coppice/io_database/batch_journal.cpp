#include "coppice/io_database/batch_journal.h"

#include <bit>

#include "coppice/io_database/database_internal.h"

namespace coppice {
namespace {

using io_internal::Sqlite;
using io_internal::Statement;
using io_internal::Transaction;

constexpr const char* kCreate =
    "CREATE TABLE IF NOT EXISTS item (output TEXT PRIMARY KEY, state INTEGER NOT NULL, row TEXT NOT NULL)";

}  // namespace

class BatchJournal::Database {
  public:
    Database(const std::filesystem::path& path, const Context& ctx)
        : file_(path, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, ctx, "journal of a batch") {
        // The first write locks the file until it is closed.
        file_.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA synchronous = NORMAL");
        Transaction transaction(file_);
        file_.execute(kCreate);
        transaction.commit();
    }

    const Sqlite& file() const { return file_; }

  private:
    Sqlite file_;
};

BatchJournal::BatchJournal(const std::filesystem::path& path, const Context& ctx)
    : database_(std::make_unique<Database>(path, ctx)) {}

BatchJournal::~BatchJournal() = default;

std::optional<JournalEntry> BatchJournal::find(const std::string& output) const {
    Statement select(database_->file(), "SELECT state, row FROM item WHERE output = ?");
    select.bind(1, std::string_view(output));
    if (!select.step()) return std::nullopt;
    return JournalEntry{output, std::bit_cast<std::uint64_t>(select.integer(0)), select.text(1)};
}

void BatchJournal::record(const JournalEntry& entry) {
    Statement insert(database_->file(), "INSERT OR REPLACE INTO item VALUES (?, ?, ?)");
    insert.bind(1, std::string_view(entry.output));
    insert.bind(2, std::bit_cast<std::int64_t>(entry.state));
    insert.bind(3, std::string_view(entry.row));
    insert.run();
}

void BatchJournal::remove(std::span<const std::string> outputs) {
    Transaction transaction(database_->file());
    Statement erase(database_->file(), "DELETE FROM item WHERE output = ?");
    for (const std::string& output : outputs) {
        erase.bind(1, std::string_view(output));
        erase.run();
    }
    transaction.commit();
}

}  // namespace coppice
