#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "coppice/base/context.h"

namespace coppice {

/// Default maximum size of an input file.
inline constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;

/// Maximum number of bytes read from an input of unknown size, such as a pipe or a device, which may never
/// end.
inline constexpr std::uint64_t kLargestStream = std::uint64_t{1} << 30;

/// Returns a description of the errno value of a failed file operation, to be used at the end of a sentence.
std::string file_error_text(int error);

/// Returns the bytes of a file, or of a pipe until it ends. Throws `IoError` with one sentence that names the
/// file if it is missing, is a folder, is not readable or is larger than `limit` bytes (for a pipe: the
/// minimum of `limit` and `kLargestStream`); throws `Cancelled` on cancellation, immediately while waiting
/// for a pipe. Memory: the size of the file; for a pipe at most three times the number of bytes read.
std::string read_file(const std::filesystem::path& path, std::uint64_t limit = kLargestFile,
                      const Context& ctx = {});

/// A file that is created completely or not at all.
///
/// Bytes are written to an unnamed file in the folder of the target; `commit` links it to the name of the
/// target. If the object is destroyed before that (exception, cancellation) or the process is killed, no file
/// remains, so the target is never incomplete. On file systems without unnamed files a hidden name is used,
/// which remains only if the process is killed. An existing target keeps its permissions; a symbolic link is
/// followed; a device or pipe such as /dev/stdout is written directly. Every error is an `IoError` that names
/// the target: a missing or read-only folder, a folder of that name, a write-protected target, a full disk.
class AtomicFile {
  public:
    explicit AtomicFile(std::filesystem::path target);  ///< opens the temporary file
    /// Removes the temporary file if `commit` was not called.
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Appends the text; small blocks are buffered, large ones are written directly.
    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);  ///< appends bytes in the same way

    /// Gives the file its name; call it once, after the last `write`.
    void commit();

  private:
    void open_unfinished();
    void give_name();
    template <class Make>
    bool make_hidden(const Make& make);
    void write_through(std::string_view bytes);
    void flush();

    std::filesystem::path target_;
    std::filesystem::path folder_;      ///< folder of the target; empty if the target is written directly
    std::filesystem::path unfinished_;  ///< hidden name; empty if the file is unnamed, and after `commit`
    std::string gathered_;
    int descriptor_ = -1;
};

/// Writes `bytes` to a file completely or not at all; throws like AtomicFile.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace coppice
