#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "coppice/base/context.h"
#include "coppice/base/error.h"

namespace coppice::io_internal {

/// A connection to an SQLite file. Errors are IoErrors that name the file and the repair.
class Sqlite {
  public:
    /// `flags` are those of sqlite3_open_v2; `content` is a literal that names the content of the file.
    Sqlite(std::filesystem::path path, int flags, const Context& ctx,
           std::string_view content = "library of trees");
    ~Sqlite();
    Sqlite(const Sqlite&) = delete;
    Sqlite& operator=(const Sqlite&) = delete;

    sqlite3* handle() const { return handle_; }
    void execute(const char* sql) const;
    [[noreturn]] void fail(int code) const;
    [[noreturn]] void fail(std::string_view subject) const;
    void throw_if_cancelled() const { ctx_.throw_if_cancelled(); }
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    std::string_view content_;
    const Context ctx_;
    sqlite3* handle_ = nullptr;
};

/// A prepared statement. Columns are numbered from 0, parameters from 1.
class Statement {
  public:
    Statement(const Sqlite& database, std::string_view sql);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    void bind(int parameter, std::int64_t value);
    void bind(int parameter, double value);
    /// The text must remain valid until the next step.
    void bind(int parameter, std::string_view text);
    void bind(int parameter, std::span<const std::byte> blob);
    void bind_null(int parameter);

    /// Executes the statement up to the next row; returns whether there is one.
    bool step();
    /// Resets the statement for another execution; keeps the parameters.
    void reset();
    /// Executes a statement that returns no rows, and resets it.
    void run();

    /// Returns SQLITE_INTEGER, SQLITE_FLOAT, SQLITE_TEXT, SQLITE_BLOB or SQLITE_NULL, independent of the
    /// declared type.
    int type(int column) const { return sqlite3_column_type(statement_, column); }
    std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
    double real(int column) const { return sqlite3_column_double(statement_, column); }
    std::string text(int column) const;
    std::span<const std::byte> blob(int column) const;

  private:
    const Sqlite& database_;
    sqlite3_stmt* statement_ = nullptr;
};

/// A transaction that is rolled back on destruction unless it was committed.
class Transaction {
  public:
    explicit Transaction(const Sqlite& database) : database_(database) {
        database_.execute("BEGIN IMMEDIATE");
    }
    ~Transaction() {
        if (!done_) sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
    }
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;

    void commit() {
        database_.execute("COMMIT");
        done_ = true;
    }

  private:
    const Sqlite& database_;
    bool done_ = false;
};

}  // namespace coppice::io_internal
