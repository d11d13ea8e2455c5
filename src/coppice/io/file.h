#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "coppice/base/context.h"

namespace coppice {

/// No reader takes larger files, unless asked to.
inline constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;

/// Nor more from what does not tell its size, such as a pipe or a device, which need never end.
inline constexpr std::uint64_t kLargestStream = std::uint64_t{1} << 30;

/// The reason for a failed file operation, by its errno, as the end of a sentence.
std::string file_error_text(int error);

/// The bytes of a file, or of a pipe until it ends. Throws `IoError`, one sentence that names the file, when
/// it is missing, a folder, not readable, or larger than `limit` bytes (a pipe: than `kLargestStream`, if
/// that is less); `Cancelled` when a stop is asked for, at once where a pipe gives nothing. Memory: the
/// file's size; for a pipe at most three times what came.
std::string read_file(const std::filesystem::path& path, std::uint64_t limit = kLargestFile,
                      const Context& ctx = {});

/// A file that appears whole or not at all.
///
/// Bytes go to a file without a name in the target's folder; `commit` gives it the target's, and whatever
/// ends earlier (an exception, a cancelled run, even a killed process) leaves nothing, so the target is never
/// half-written. File systems that know no files without a name get a hidden one, which only a killed process
/// leaves behind. A target that
/// exists keeps its permissions; a link is followed; a device or pipe such as /dev/stdout is written
/// straight. Every trouble is an `IoError` that names the target: a folder that is missing, not writable or
/// in the target's place, a write-protected target, a full disk.
class AtomicFile {
  public:
    explicit AtomicFile(std::filesystem::path target);  ///< opens the hidden file
    /// Removes the hidden file where `commit` was not called.
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Small pieces are gathered, large ones go straight to the system.
    void write(std::string_view text);
    void write(std::span<const std::byte> bytes);  ///< the same for bytes

    /// Makes the file appear under its name; to be called once, after the last `write`.
    void commit();

  private:
    void open_unfinished();
    void give_name();
    template <class Make>
    bool make_hidden(const Make& make);
    void write_through(std::string_view bytes);
    void flush();

    std::filesystem::path target_;
    std::filesystem::path folder_;      ///< of the target; empty when that is written straight
    std::filesystem::path unfinished_;  ///< the hidden name; empty without one, and after `commit`
    std::string gathered_;
    int descriptor_ = -1;
};

/// Writes a file that is made already, whole or not at all; throws as AtomicFile does.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace coppice
