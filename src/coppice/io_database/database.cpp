#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <limits>
#include <thread>
#include <utility>

#include "coppice/io_database/database_internal.h"
#include "coppice/system/file.h"

namespace coppice::io_internal {
namespace {

constexpr int kMaxWaits = 1200;  // waits of 50 ms: one minute
constexpr std::chrono::milliseconds kWait{50};
constexpr int kLargestValue = 1 << 28;  // [bytes]
constexpr int kStepsPerPoll = 10'000;   // virtual machine instructions of SQLite between two polls

int waits_on(void* context, int waits) {
    if (waits >= kMaxWaits || static_cast<const Context*>(context)->stop.stop_requested()) return 0;
    std::this_thread::sleep_for(kWait);
    return 1;
}

int stops(void* context) { return static_cast<const Context*>(context)->stop.stop_requested() ? 1 : 0; }

std::string reason(int code, std::string_view content) {
    switch (code & 0xff) {
        case SQLITE_NOTADB:
            return fmt::format("this is not a {}", content);
        case SQLITE_CORRUPT:
            return fmt::format("the {} is damaged; create a new one", content);
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return "another program has been writing to it for a minute; try again later";
        case SQLITE_READONLY:
        case SQLITE_PERM:
            return "the file is not writable; check its permissions and those of its folder";
        case SQLITE_FULL:
            return "the disk is full";
        case SQLITE_CANTOPEN:
            return "the file cannot be opened";
        default:
            return {};
    }
}

}  // namespace

Sqlite::Sqlite(std::filesystem::path path, int flags, const Context& ctx, std::string_view content)
    : path_(std::move(path)), content_(content), ctx_(ctx) {
    const int code = sqlite3_open_v2(path_.c_str(), &handle_, flags | SQLITE_OPEN_EXRESCODE, nullptr);
    if (handle_ == nullptr) throw std::bad_alloc();
    if (code != SQLITE_OK) {
        sqlite3_close(handle_);
        throw IoError(fmt::format("{}: {}", path_.string(), reason(SQLITE_CANTOPEN, content_)));
    }
    sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, kLargestValue);
    // Libraries are untrusted: views and triggers in them must not have side effects.
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    void* context = const_cast<Context*>(&ctx_);
    sqlite3_busy_handler(handle_, waits_on, context);
    sqlite3_progress_handler(handle_, kStepsPerPoll, stops, context);
}

Sqlite::~Sqlite() { sqlite3_close(handle_); }

void Sqlite::execute(const char* sql) const {
    if (const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr); code != SQLITE_OK) fail(code);
}

void Sqlite::fail(int code) const {
    const int error = errno;  // errno of the failed system call, if any
    ctx_.throw_if_cancelled();
    if ((code & 0xff) == SQLITE_NOMEM) throw std::bad_alloc();
    const std::string known = reason(code, content_);
    if (!known.empty()) fail(known);
    fail(code == SQLITE_IOERR_WRITE ? file_error_text(error) : std::string(sqlite3_errmsg(handle_)));
}

void Sqlite::fail(std::string_view subject) const {
    throw IoError(fmt::format("{}: {}", path_.string(), subject));
}

Statement::Statement(const Sqlite& database, std::string_view sql) : database_(database) {
    const int code = sqlite3_prepare_v2(database_.handle(), sql.data(), static_cast<int>(sql.size()),
                                        &statement_, nullptr);
    if (code != SQLITE_OK) database_.fail(code);
}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::bind(int parameter, std::int64_t value) { sqlite3_bind_int64(statement_, parameter, value); }
void Statement::bind(int parameter, double value) { sqlite3_bind_double(statement_, parameter, value); }
void Statement::bind(int parameter, std::string_view text) {
    sqlite3_bind_text64(statement_, parameter, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
}
void Statement::bind(int parameter, std::span<const std::byte> blob) {
    sqlite3_bind_blob64(statement_, parameter, blob.data(), blob.size(), SQLITE_STATIC);
}
void Statement::bind_null(int parameter) { sqlite3_bind_null(statement_, parameter); }

bool Statement::step() {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) database_.fail(code);
    return false;
}

void Statement::reset() { sqlite3_reset(statement_); }

void Statement::run() {
    while (step()) {
    }
    reset();
}

std::string Statement::text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text == nullptr
               ? std::string{}
               : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
}

std::span<const std::byte> Statement::blob(int column) const {
    const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(statement_, column));
    return {data, data == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

}  // namespace coppice::io_internal
